//! State updates for phones: the changes of the show's state as JSON.
//!
//! ```text
//! {"scene": "orb", "scenes": ["city", "orb"], "params": [{"name": "size", "min": 0, "max": 4, "default": 1}],
//!  "values": {"size": [1.5, "MIDI"]}, "switches": {"pause": false}, "levels": {"volume": 0.8},
//!  "tempo": 120, "track": "Hadal Lanterns", "length": 61.5, "pictures": 3}
//! ```

use std::sync::Arc;

use mariana_control::Present;
use serde_json::{Map, Value, json};

/// The resolution of the track position for phones, in seconds.
const POSITION_STEP: f64 = 0.25;

type State = Map<String, Value>;

/// The state that one phone has received.
#[derive(Debug, Default)]
pub(crate) struct SentState {
    /// The last state of the board, and the number of images at that time.
    seen: Option<(Arc<Present>, u64)>,
    sent: State,
}

impl SentState {
    /// Returns the changes since the last call, or `None` without changes.
    pub(crate) fn state_delta(&mut self, now: &Arc<Present>, pictures: u64) -> Option<String> {
        if self.seen.as_ref().is_some_and(|(seen, count)| Arc::ptr_eq(seen, now) && *count == pictures) {
            return None;
        }
        self.seen = Some((now.clone(), pictures));
        let state = state_of(now, pictures);
        // The page forgets all values when it receives parameters.
        if ["scene", "params"].iter().any(|key| self.sent.get(*key) != state.get(*key)) {
            self.sent.retain(|key, _| !["params", "values"].contains(&key.as_str()));
        }
        let changes = beyond(&self.sent, &state);
        self.sent = state;
        (!changes.is_empty()).then(|| Value::Object(changes).to_string())
    }
}

/// The shortest number that is this one in 32 bits.
fn short(value: f32) -> Value {
    value.to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

fn state_of(now: &Present, pictures: u64) -> State {
    let params = now.params.iter();
    let values: State = params
        .clone()
        .map(|one| (one.name.clone(), json!([short(one.value), one.changed_by.name()])))
        .collect();
    let shapes: Vec<Value> = params
        .map(|one| {
            let [min, max, default] = [one.min, one.max, one.default].map(short);
            json!({ "name": one.name, "min": min, "max": max, "default": default })
        })
        .collect();
    let switches: State =
        now.switches.iter().map(|(name, is_on)| ((*name).to_owned(), json!(is_on))).collect();
    let levels = now.levels.iter().map(|(name, level)| match *name {
        "position" if now.length > 0.0 => {
            let steps = (f64::from(*level) * now.length / POSITION_STEP).floor();
            ((*name).to_owned(), json!(steps * POSITION_STEP / now.length))
        }
        name => (name.to_owned(), short(*level)),
    });
    let all = [
        ("scene", json!(now.scene)),
        ("scenes", json!(now.scenes)),
        ("params", json!(shapes)),
        ("values", Value::Object(values)),
        ("switches", Value::Object(switches)),
        ("levels", Value::Object(levels.collect())),
        ("tempo", json!((10.0 * f64::from(now.tempo)).round() / 10.0)),
        ("track", json!(now.track)),
        ("length", json!(now.length)),
        ("pictures", json!(pictures)),
    ];
    all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Returns the entries of `now` that differ from `before`, of inner objects only the differing entries. Entries that are
/// gone are null.
fn beyond(before: &State, now: &State) -> State {
    let changed = now.iter().filter_map(|(key, value)| {
        let known = before.get(key);
        let value = match value {
            Value::Object(inner) => {
                let none = State::new();
                let inner = beyond(known.and_then(Value::as_object).unwrap_or(&none), inner);
                Some(Value::Object(inner)).filter(|inner| *inner != json!({}))
            }
            value => Some(value.clone()).filter(|value| known != Some(value)),
        };
        Some((key.clone(), value?))
    });
    let gone = before.keys().filter(|key| !now.contains_key(*key)).map(|key| (key.clone(), Value::Null));
    changed.chain(gone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::{ChangedBy, Slider};

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
            "{\"length\":100.0,\"levels\":{\"position\":0.5,\"volume\":0.5},\
             \"params\":[{\"default\":1.0,\"max\":4.0,\"min\":0.0,\"name\":\"size\"}],\"pictures\":0,\
             \"scene\":\"orb\",\"scenes\":[\"city\",\"orb\"],\"switches\":{\"blackout\":false,\"pause\":false},\
             \"tempo\":120.0,\"track\":\"a \\\"song\\\" </script>\",\"values\":{\"size\":[1.5,\"MIDI\"]}}"
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
            r#"{"params":[{"default":1.0,"max":8.0,"min":0.0,"name":"size"}],"values":{"size":[1.5,"MIDI"]}}"#,
        );
        is(|now| (now.scene, now.params) = ("city".into(), Vec::new()), r#"{"params":[],"scene":"city"}"#);
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
            Some(r#"{"levels":{"position":0.5025}}"#)
        );
    }
}
