//! Snapshots of a scene's parameters as cues.

use std::collections::BTreeMap;

use super::cue_list::{Anchor, CueList, Entry, Length, Setting, Transition, When};
use crate::limits;

/// Returns a cue list in which each press of the cue key sets the parameters of `scene` to the next snapshot.
pub fn snapshot_cues<'a>(
    scene: &str,
    snapshots: impl IntoIterator<Item = &'a BTreeMap<String, f32>>,
) -> CueList {
    let when = When { anchor: Anchor::Cue, offset: Length::ZERO };
    let entries = snapshots.into_iter().map(|values| {
        let settings = values.iter().take(limits::SETTINGS_MAX);
        let settings = settings.map(|(param, value)| Setting::new(param, *value));
        let entry = Entry::new(when.clone(), scene, None, Some(Transition::CUT));
        Entry { settings: settings.collect(), ..entry }
    });
    CueList { entries: entries.take(limits::ENTRIES_MAX).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{parse, print};

    #[test]
    fn each_snapshot_is_a_cue_that_a_show_can_read() {
        let of = |values: &[(&str, f32)]| {
            values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
        };
        let snapshots: [BTreeMap<String, f32>; 2] =
            [of(&[("glow", 0.25), ("size", 1.0)]), of(&[("size", 2.5)])];
        let cues = snapshot_cues("orb", &snapshots);
        let text = print(&cues, &[]);
        assert_eq!(
            text,
            "at cue  orb  cut\n  set glow = 0.25\n  set size = 1\nat cue  orb  cut\n  set size = 2.5\n"
        );
        let read = parse("my.show", &text).cue_list.unwrap();
        assert_eq!(print(&read, &[]), text);
    }
}
