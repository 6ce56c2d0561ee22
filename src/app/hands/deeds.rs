//! Everything that hands can do besides turning parameters, by names that never change: in addresses of OSC, in files of
//! mappings, in recorded performances.
//!
//! Most rows are a key's, too, and say what the key says.

use std::sync::OnceLock;

use crate::app::keys::{Action, binding_of};
use crate::app::stage::Stage;
use mariana_control::deed::{DeedRow, Takes};

/// What takes something.
type SetFn = fn(&mut Stage, &mariana_control::deed::Given);

/// What is done.
#[derive(Clone, Copy)]
pub(in crate::app) enum Does {
    /// What a key does.
    Key(Action),
    /// What a key does where it is not so already.
    Switch {
        /// What changes it over.
        action: Action,
        /// Whether it is on.
        is_on: fn(&mut Stage) -> bool,
    },
    /// What no key changes over.
    Turn {
        /// What turns it on or off.
        set: fn(&mut Stage, bool),
        /// Whether it is on.
        is_on: fn(&mut Stage) -> bool,
    },
    /// Something that takes a number or a name.
    Set(SetFn),
    /// Something that takes a share, 0..1.
    Level {
        /// What sets it.
        set: SetFn,
        /// Where it stands; none while there is no such thing.
        stands: fn(&Stage) -> Option<f32>,
    },
}

struct Row {
    name: &'static str,
    takes: Takes,
    /// What it does, where no key says it.
    meaning: &'static str,
    does: Does,
}

const fn key(name: &'static str, action: Action) -> Row {
    Row { name, takes: Takes::Press, meaning: "", does: Does::Key(action) }
}

const fn switch(name: &'static str, action: Action, is_on: fn(&mut Stage) -> bool) -> Row {
    Row { name, takes: Takes::Switch, meaning: "", does: Does::Switch { action, is_on } }
}

/// One row for each. A new action is one line.
const TABLE: &[Row] = &[
    key("next", Action::ChangeScene { forward: true }),
    key("previous", Action::ChangeScene { forward: false }),
    Row {
        name: "scene",
        takes: Takes::Choice,
        meaning: "this scene, by its name or its number; marked ones come first",
        does: Does::Set(Stage::show_scene_named),
    },
    Row {
        name: "cut",
        takes: Takes::Switch,
        meaning: "cut from scene to scene by hand, or fade",
        does: Does::Turn {
            set: |stage, on| stage.cut_by_hand(on),
            is_on: |stage| stage.scene.composer().fading().cuts(),
        },
    },
    Row {
        name: "fade",
        takes: Takes::Number,
        meaning: "so many seconds for a fade from scene to scene by hand; 0 cuts",
        does: Does::Set(Stage::set_fade),
    },
    switch("follow", Action::ToggleFollow, |stage| stage.follows()),
    switch("keep", Action::ToggleKeep, |stage| stage.scene.show().is_locked()),
    key("cue", Action::NextCue),
    switch("record", Action::ToggleRecording, |stage| stage.is_recording()),
    key("beat", Action::Tap),
    Row {
        name: "tempo",
        takes: Takes::Number,
        meaning: "this tempo, in beats per minute; 0 returns to the detected one",
        does: Does::Set(Stage::set_tempo),
    },
    switch("blackout", Action::ToggleBlackout, |stage| stage.is_black()),
    switch("freeze", Action::ToggleFreeze, |stage| stage.is_frozen()),
    Row {
        name: "brightness",
        takes: Takes::Level,
        meaning: "this share of the light of every picture, from 0 to 1",
        does: Does::Level { set: Stage::dim, stands: Stage::brightness },
    },
    switch("clean", Action::ToggleClean, |stage| stage.is_bare()),
    switch("pause", Action::TogglePause, |stage| stage.is_paused()),
    key("next_track", Action::SkipTrack { forward: true }),
    key("previous_track", Action::SkipTrack { forward: false }),
    Row {
        name: "position",
        takes: Takes::Level,
        meaning: "this place in the track, from 0 at its start to 1 at its end",
        does: Does::Level { set: Stage::seek_to_share, stands: Stage::song_share },
    },
    Row {
        name: "volume",
        takes: Takes::Level,
        meaning: "this volume, from 0 to 1",
        does: Does::Level { set: Stage::set_volume, stands: Stage::volume },
    },
    switch("mute", Action::ToggleMute, |stage| stage.is_muted()),
    key("camera", Action::GiveCameraBack),
    switch("fullscreen", Action::ToggleFullscreen, |stage| stage.window.is_fullscreen()),
];

/// The table, as devices and networks know it.
pub(in crate::app) fn table() -> &'static [DeedRow] {
    static ROWS: OnceLock<Vec<DeedRow>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let row = |row: &Row| {
            let of_key = match row.does {
                Does::Key(action) | Does::Switch { action, .. } => binding_of(action),
                Does::Turn { .. } | Does::Set(_) | Does::Level { .. } => None,
            };
            let meaning = of_key.map_or(row.meaning, |binding| binding.meaning);
            DeedRow { name: row.name, takes: row.takes, meaning }
        };
        TABLE.iter().map(row).collect()
    })
}

/// The switches, by their names, and whether each is on.
pub(in crate::app) fn switches(stage: &mut Stage) -> Vec<(&'static str, bool)> {
    let of = |row: &Row| match row.does {
        Does::Switch { is_on, .. } | Does::Turn { is_on, .. } => Some((row.name, is_on(stage))),
        Does::Key(_) | Does::Set(_) | Does::Level { .. } => None,
    };
    TABLE.iter().filter_map(of).collect()
}

/// The table for phones: their requests reach no file, and what is recorded becomes one.
pub(in crate::app) fn table_for_phones() -> &'static [DeedRow] {
    static ROWS: OnceLock<Vec<DeedRow>> = OnceLock::new();
    ROWS.get_or_init(|| table().iter().filter(|row| row.name != "record").copied().collect())
}

/// The levels that there are, by their names, and where each stands, 0..1.
pub(in crate::app) fn levels(stage: &Stage) -> Vec<(&'static str, f32)> {
    let of = |row: &Row| match row.does {
        Does::Level { stands, .. } => Some((row.name, stands(stage)?)),
        Does::Key(_) | Does::Switch { .. } | Does::Turn { .. } | Does::Set(_) => None,
    };
    TABLE.iter().filter_map(of).collect()
}

/// What an action does.
pub(in crate::app) fn does(name: &str) -> Option<Does> {
    TABLE.iter().find(|row| row.name == name).map(|row| row.does)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_name_of_its_own_that_fits_an_address_and_says_what_it_does() {
        let rows = table();
        for (place, row) in rows.iter().enumerate() {
            assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{}", row.name);
            assert!(!row.meaning.is_empty(), "{} has no meaning", row.name);
            assert!(rows[..place].iter().all(|other| other.name != row.name), "{} stands twice", row.name);
            assert!(
                !["param", "query", "sound"].contains(&row.name),
                "{} is an address of its own",
                row.name
            );
        }
    }
}
