//! The rows of how pictures come onto screens.

use super::{Fact, SettingRow, Values, row_of};
use crate::app::monitors::{Monitor, named};
use crate::config::StageChoices;
use crate::placement::Crop;

/// Times of a fade that can be chosen, in seconds. The command line takes any.
const FADES: [(f64, &str); 5] = [(0.0, "0 s"), (0.5, "0.5 s"), (1.0, "1 s"), (2.0, "2 s"), (5.0, "5 s")];

/// The time at a place of that list.
pub(super) fn fade(place: usize) -> Option<f64> {
    FADES.get(place).map(|(seconds, _)| *seconds)
}

/// What each edge of the picture may lose, in percent. The command line takes any, and of each edge for itself.
const CROPS: [(f64, &str); 6] =
    [(0.0, "0 %"), (1.0, "1 %"), (2.0, "2 %"), (3.0, "3 %"), (5.0, "5 %"), (10.0, "10 %")];

/// What the edges lose at a place of that list.
pub(super) fn crop(place: usize) -> Option<Crop> {
    CROPS.get(place).and_then(|(percent, _)| Crop::try_from([*percent; 4]).ok())
}

/// The rows of where the picture shows: with one monitor there is no choice.
pub(super) fn screens(monitors: &[Monitor], now: Option<&str>, remembered: Option<&str>) -> Vec<SettingRow> {
    if monitors.len() < 2 && now.is_none() {
        return Vec::new();
    }
    let chosen = now.and_then(|name| named(monitors, name)).map(|monitor| monitor.name.as_str()).or(now);
    let there =
        monitors.iter().map(|monitor| (Some(monitor.name.as_str()), format!("Picture fills {monitor}")));
    let missing = chosen.filter(|name| named(monitors, name).is_none());
    let missing = missing.map(|name| (Some(name), format!("Picture fills {name}, which is not there")));
    let alone = (None, "Picture in this window alone".to_owned());
    let row = |(name, words): (Option<&str>, String)| SettingRow {
        fact: Fact::Screen(name.map(str::to_owned)),
        name: words,
        meaning:
            "A clean picture that fills a monitor; this window stays beside it, with its words and panels"
                .to_owned(),
        values: Values::OneOfRows { holds: name == chosen },
        for_this_run: name == chosen && now != remembered,
    };
    std::iter::once(alone).chain(there).chain(missing).map(row).collect()
}

/// The rows of how pictures come onto screens.
pub(super) fn rows(now: &StageChoices, remembered: &StageChoices) -> [SettingRow; 4] {
    [
        SettingRow {
            fact: Fact::Brightness,
            name: "Brightness".to_owned(),
            meaning:
                "How much of its light the picture has, in the window and wherever it is sent; X is blackout"
                    .to_owned(),
            values: Values::Percent(f64::from(now.brightness)),
            for_this_run: now.brightness != remembered.brightness,
        },
        SettingRow {
            fact: Fact::BlackoutFade,
            name: "Blackout fade".to_owned(),
            meaning:
                "How long a blackout (X) takes to come and to go, and a picture that was held (Z) to give way"
                    .to_owned(),
            values: Values::Names {
                names: FADES.iter().map(|(_, name)| *name).collect(),
                present: FADES
                    .iter()
                    .position(|(seconds, _)| *seconds == now.blackout_fade)
                    .unwrap_or(FADES.len()),
            },
            for_this_run: now.blackout_fade != remembered.blackout_fade,
        },
        row_of(
            Fact::Flip,
            "Mirror",
            "Mirrors the picture, for projectors; Y moves its corners",
            now.flip,
            remembered.flip,
        ),
        SettingRow {
            fact: Fact::Crop,
            name: "Crop".to_owned(),
            meaning: "How much each edge of the picture loses, where a screen hides its edges; `--crop` takes each edge for itself".to_owned(),
            values: Values::Names {
                names: CROPS.iter().map(|(_, name)| *name).collect(),
                present: (0..CROPS.len()).find(|place| crop(*place) == Some(now.crop)).unwrap_or(CROPS.len()),
            },
            for_this_run: now.crop != remembered.crop,
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_two_monitors_the_picture_fills_one_of_them_or_none() {
        let monitor = |name: &str| Monitor { name: name.into(), place: (0, 0), size: (640, 360) };
        let both = [monitor("a"), monitor("b")];
        let marked = |now: Option<&str>| -> Vec<(String, bool)> {
            let rows = screens(&both, now, None).into_iter();
            rows.map(|row| (row.name, row.values == Values::OneOfRows { holds: true })).collect()
        };
        let [alone, a, b] = &marked(Some("2"))[..] else { panic!("{:?}", marked(Some("2"))) };
        assert_eq!((alone.1, a.1, b.1), (false, false, true));
        assert!(a.0.contains("a (640x360)"), "{}", a.0);
        assert!(marked(None)[0].1 && marked(Some("c"))[3].1, "one that is gone is marked, too");
        assert!(screens(&both[..1], None, None).is_empty());
    }
}
