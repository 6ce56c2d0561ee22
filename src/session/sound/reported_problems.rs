//! Messages about the input and the audio devices.

use std::collections::BTreeSet;

use crate::export::print::print_message;
use mariana_player::device_list::ListedDevice;
use mariana_player::input::LiveStatus;

#[derive(Default)]
pub(super) struct Hints {
    pub(super) shown: Option<String>,
    pub(super) suggestion: Option<ListedDevice>,
    /// The last reason for silence that was printed.
    reported: Option<String>,
}

impl Hints {
    /// Updates the hints from the input's state. Prints a new reason for silence.
    pub(super) fn drain(&mut self, status: &LiveStatus) {
        self.suggestion.clone_from(&status.suggestion);
        self.shown = status.silent.clone().or_else(|| status.refused.clone()).or_else(|| status.flat.clone());
        if self.reported != status.silent {
            if let Some(reason) = &status.silent {
                print_message(&format!("no sound: {reason}"));
            }
            self.reported.clone_from(&status.silent);
        }
    }

    pub(super) fn forget(&mut self) {
        (self.shown, self.reported) = (None, None);
    }
}

/// Problems with settings or devices, each reported once.
#[derive(Default)]
pub(super) struct ReportedProblems {
    all: BTreeSet<String>,
    unsaid: Vec<String>,
}

impl ReportedProblems {
    /// Prints a problem on the terminal and queues it for the overlay.
    pub(super) fn add(&mut self, text: &str) {
        if self.all.insert(text.to_owned()) {
            print_message(text);
            self.unsaid.push(text.to_owned());
        }
    }

    pub(super) fn drain(&mut self) -> Vec<String> {
        std::mem::take(&mut self.unsaid)
    }
}
