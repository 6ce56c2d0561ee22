//! State updates for phones: the changes of the show's state as JSON.
//!
//! ```text
//! {"scene": "orb", "scenes": ["city", "orb"], "params": [{"name": "size", "min": 0, "max": 4, "default": 1}],
//!  "values": {"size": [1.5, "MIDI"]}, "switches": {"pause": false}, "levels": {"volume": 0.8},
//!  "tempo": 120, "track": "Hadal Lanterns", "length": 61.5, "pictures": 3}
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use mariana_control::{Present, Slider};
use serde::Serialize;

/// The resolution of the track position for phones, in seconds.
const POSITION_STEP: f64 = 0.25;
const POSITION: &str = "position";

#[derive(Serialize)]
struct Shape<'a> {
    name: &'a str,
    min: f32,
    max: f32,
    default: f32,
}

#[derive(Serialize, Default)]
struct StateDelta<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scenes: Option<&'a [String]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    params: Option<Vec<Shape<'a>>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    values: BTreeMap<&'a str, (f32, &'static str)>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    switches: BTreeMap<&'a str, bool>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    levels: BTreeMap<&'a str, Option<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tempo: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    track: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    length: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<u64>,
}

/// The state that one phone has received, and the number of images at that time.
#[derive(Debug, Default)]
pub(crate) struct SentState(Option<Arc<Present>>, u64);

impl SentState {
    /// Returns the changes since the last call, or `None` without changes.
    pub(crate) fn state_delta(&mut self, now: &Arc<Present>, pictures: u64) -> Option<String> {
        let are_known = self.1 == pictures;
        if are_known && self.0.as_ref().is_some_and(|before| Arc::ptr_eq(before, now)) {
            return None;
        }
        let state_delta =
            StateDelta { pictures: (!are_known).then_some(pictures), ..state_delta(self.0.as_deref(), now) };
        let text = serde_json::to_string(&state_delta).ok();
        *self = Self(Some(now.clone()), pictures);
        text.filter(|text| text != "{}")
    }
}

fn state_delta<'a>(before: Option<&Present>, now: &'a Present) -> StateDelta<'a> {
    let was = |same: fn(&Present, &Present) -> bool| before.is_some_and(|before| same(before, now));
    let is_scene_known = was(|a, b| a.scene == b.scene);
    let is_shape_known = is_scene_known && was(|a, b| shape(a).eq(shape(b)));
    let value = |param: &Slider| (param.value, param.changed_by.name());
    let known = |name: &str| before?.params.iter().find(|param| param.name == name).map(value);
    let values = now.params.iter().map(|param| (&*param.name, value(param)));
    let switches = now.switches.iter().filter(|one| !was_there(before, |before| &before.switches, *one));
    let position =
        |present: &Present, fraction: f32| (f64::from(fraction) * present.length / POSITION_STEP).floor();
    let is_level_known = |level: &&(&'static str, f32)| match before {
        Some(before) if level.0 == POSITION && before.length == now.length && now.length > 0.0 => {
            let known = before.levels.iter().find(|known| known.0 == POSITION);
            known.is_some_and(|known| position(before, known.1) == position(now, level.1))
        }
        _ => was_there(before, |before| &before.levels, *level),
    };
    let gone = before.into_iter().flat_map(|before| &before.levels);
    let gone = gone.filter(|level| now.levels.iter().all(|known| known.0 != level.0));
    StateDelta {
        scene: (!is_scene_known).then_some(&now.scene),
        scenes: (!was(|a, b| a.scenes == b.scenes)).then_some(&now.scenes),
        params: (!is_shape_known).then(|| {
            let shape = shape(now);
            shape.map(|(name, [min, max, default])| Shape { name, min, max, default }).collect()
        }),
        values: values.filter(|(name, value)| !is_shape_known || known(name) != Some(*value)).collect(),
        switches: switches.copied().collect(),
        levels: now
            .levels
            .iter()
            .filter(|level| !is_level_known(level))
            .map(|(name, level)| (*name, Some(*level)))
            .chain(gone.map(|(name, _)| (*name, None)))
            .collect(),
        tempo: (!was(|a, b| tenths(a.tempo) == tenths(b.tempo))).then_some(tenths(now.tempo)),
        track: (!was(|a, b| a.track == b.track)).then_some(&now.track),
        length: (!was(|a, b| a.length == b.length)).then_some(now.length),
        pictures: None,
    }
}

fn was_there<T: PartialEq>(before: Option<&Present>, list: fn(&Present) -> &Vec<T>, one: &T) -> bool {
    before.is_some_and(|before| list(before).contains(one))
}

/// Returns the names and ranges of the parameters, which stay the same when values change.
fn shape(present: &Present) -> impl Iterator<Item = (&str, [f32; 3])> {
    present.params.iter().map(|param| (&*param.name, [param.min, param.max, param.default]))
}

fn tenths(tempo: f32) -> f32 {
    (10.0 * tempo).round() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::ChangedBy;

    fn present() -> Present {
        let param = Slider {
            name: "size".into(),
            value: 1.5,
            min: 0.0,
            max: 4.0,
            default: 1.0,
            changed_by: ChangedBy::Midi,
            bound: None,
        };
        Present {
            scene: "orb".into(),
            scenes: vec!["city".into(), "orb".into()],
            params: vec![param],
            switches: vec![("pause", false), ("blackout", false)],
            levels: vec![("volume", 0.5), ("position", 0.5)],
            tempo: 120.04,
            track: "a \"song\" </script>".into(),
            length: 100.0,
        }
    }

    fn reported(change: impl FnOnce(&mut Present)) -> Option<String> {
        let mut reported = SentState::default();
        reported.state_delta(&Arc::new(present()), 0);
        let mut now = present();
        change(&mut now);
        reported.state_delta(&Arc::new(now), 0)
    }

    #[test]
    fn the_first_update_has_the_whole_state() {
        let text = SentState::default().state_delta(&Arc::new(present()), 0).unwrap();
        assert_eq!(
            text,
            "{\"scene\":\"orb\",\"scenes\":[\"city\",\"orb\"],\
             \"params\":[{\"name\":\"size\",\"min\":0.0,\"max\":4.0,\"default\":1.0}],\
             \"values\":{\"size\":[1.5,\"MIDI\"]},\"switches\":{\"blackout\":false,\"pause\":false},\
             \"levels\":{\"position\":0.5,\"volume\":0.5},\"tempo\":120.0,\
             \"track\":\"a \\\"song\\\" </script>\",\"length\":100.0}"
        );
    }

    #[test]
    fn later_updates_have_only_the_changes() {
        assert_eq!(reported(|_| {}), None);
        let is =
            |change: fn(&mut Present), wanted: &str| assert_eq!(reported(change).as_deref(), Some(wanted));
        is(|now| now.params[0].value = 2.0, r#"{"values":{"size":[2.0,"MIDI"]}}"#);
        is(|now| now.params[0].changed_by = ChangedBy::Phone, r#"{"values":{"size":[1.5,"phone"]}}"#);
        is(|now| now.switches[0].1 = true, r#"{"switches":{"pause":true}}"#);
        is(|now| now.levels[0].1 = 0.25, r#"{"levels":{"volume":0.25}}"#);
        is(|now| now.levels.truncate(1), r#"{"levels":{"position":null}}"#);
        is(|now| now.tempo = 98.0, r#"{"tempo":98.0}"#);
        is(
            |now| now.params[0].max = 8.0,
            r#"{"params":[{"name":"size","min":0.0,"max":8.0,"default":1.0}],"values":{"size":[1.5,"MIDI"]}}"#,
        );
        is(|now| (now.scene, now.params) = ("city".into(), Vec::new()), r#"{"scene":"city","params":[]}"#);
    }

    #[test]
    fn new_images_are_reported_without_other_changes() {
        let (mut reported, stands) = (SentState::default(), Arc::new(present()));
        reported.state_delta(&stands, 0);
        assert_eq!(reported.state_delta(&stands, 2).as_deref(), Some(r#"{"pictures":2}"#));
        assert_eq!(reported.state_delta(&stands, 2), None);
    }

    #[test]
    fn imperceptible_changes_are_not_sent() {
        assert_eq!(reported(|now| now.tempo = 120.02), None);
        assert_eq!(reported(|now| now.levels[1].1 = 0.501), None, "a tenth of a second later");
        assert_eq!(
            reported(|now| now.levels[1].1 = 0.505).as_deref(),
            Some(r#"{"levels":{"position":0.505}}"#)
        );
    }
}
