//! The rows of the monitors that the image can fill.

use crate::monitor::{Monitor, named};
use mariana_settings::{Setting, SettingGroup, SettingRow, Values};

/// The rows for the output's monitor. The list is empty if there is only one monitor.
pub(super) fn rows(monitors: &[Monitor], now: Option<&str>, remembered: Option<&str>) -> Vec<SettingRow> {
    if monitors.len() < 2 && now.is_none() {
        return Vec::new();
    }
    let chosen = now.and_then(|name| named(monitors, name)).map(|monitor| monitor.name.as_str()).or(now);
    let there =
        monitors.iter().map(|monitor| (Some(monitor.name.as_str()), format!("Image fills {monitor}")));
    let missing = chosen.filter(|name| named(monitors, name).is_none());
    let missing = missing.map(|name| (Some(name), format!("Image fills {name} (not connected)")));
    let alone = (None, "Image in this window only".to_owned());
    let row = |(name, words): (Option<&str>, String)| SettingRow {
        name: words,
        purpose: "Fills a monitor with the clean image; text and panels stay in this window".to_owned(),
        values: Values::OneOfRows {
            chosen: name == chosen,
            setting: Setting::Screen(name.map(str::to_owned)),
        },
        for_this_run: name == chosen && now != remembered,
        group: SettingGroup::Screens,
    };
    std::iter::once(alone).chain(there).chain(missing).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_two_monitors_the_picture_fills_one_of_them_or_none() {
        let monitor = |name: &str| Monitor { name: name.into(), place: (0, 0), size: (640, 360) };
        let both = [monitor("a"), monitor("b")];
        let marked = |now: Option<&str>| -> Vec<(String, bool)> {
            let rows = super::rows(&both, now, None).into_iter();
            rows.map(|row| (row.name, matches!(row.values, Values::OneOfRows { chosen: true, .. }))).collect()
        };
        let [alone, a, b] = &marked(Some("2"))[..] else { panic!("{:?}", marked(Some("2"))) };
        assert_eq!((alone.1, a.1, b.1), (false, false, true));
        assert!(a.0.contains("a (640x360)"), "{}", a.0);
        assert!(marked(None)[0].1 && marked(Some("c"))[3].1, "a disconnected one stays marked");
        assert!(rows(&both[..1], None, None).is_empty());
    }
}
