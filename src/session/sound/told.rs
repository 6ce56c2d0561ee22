//! What is told of what the show listens to.

use std::collections::BTreeSet;

use crate::export::print::tell;
use mariana_player::device_list::ListedDevice;
use mariana_player::input::LiveStatus;

/// What the input tells: what is wrong with it, and which other one has a signal.
#[derive(Default)]
pub(super) struct Hints {
    /// What stays over the picture for as long as it holds.
    pub(super) shown: Option<String>,
    /// A device that has a signal.
    pub(super) suggestion: Option<ListedDevice>,
    /// What the terminal was told.
    told: Option<String>,
}

impl Hints {
    /// Takes the state of the input. Prints what is new on the terminal.
    pub(super) fn take(&mut self, status: &LiveStatus) {
        self.suggestion.clone_from(&status.suggestion);
        self.shown = status.silent.clone().or_else(|| status.refused.clone()).or_else(|| status.flat.clone());
        if self.told != status.silent {
            if let Some(reason) = &status.silent {
                tell(&format!("nothing is heard: {reason}"));
            }
            self.told.clone_from(&status.silent);
        }
    }

    /// Another source is listened to.
    pub(super) fn forget(&mut self) {
        (self.shown, self.told) = (None, None);
    }
}

/// What is wrong with settings or devices. Each is said once, however often it is tried again.
#[derive(Default)]
pub(super) struct Complaints {
    all: BTreeSet<String>,
    /// Those that are not over the picture yet.
    unsaid: Vec<String>,
}

impl Complaints {
    /// Reports one: on the terminal, and over the picture.
    pub(super) fn add(&mut self, text: &str) {
        if self.all.insert(text.to_owned()) {
            tell(text);
            self.unsaid.push(text.to_owned());
        }
    }

    /// Those since the last call.
    pub(super) fn take(&mut self) -> Vec<String> {
        std::mem::take(&mut self.unsaid)
    }
}
