//! Remote control by phones, as set on the command line.

use crate::commands;
use crate::config::ControllerSettings;
use crate::session::waker::Waker;
use crate::thumbnails::{About, Looked};
use crate::ui::controllers_panel::PhoneFacts;
use mariana_control::{Board, InputQueue};
use mariana_remote::limits::LIMITS;
use mariana_remote::{Album, Remote, RemoteState};

pub(crate) struct Phones {
    pub(crate) remote: Option<Remote>,
    pub(super) album: Album,
    reported: RemoteState,
}

impl Phones {
    pub(super) fn start(
        settings: &ControllerSettings,
        input: &InputQueue,
        board: &Board,
        waker: &Waker,
        news: &mut Vec<(String, bool)>,
    ) -> Self {
        let album = Album::default();
        let remote = settings.remote.clone().and_then(|place| {
            let table = commands::for_phones();
            let (input, board, album) = (input.clone(), board.clone(), album.clone());
            let started = Remote::start(LIMITS, place, table, input, board, album, waker.waking());
            started.map_err(|error| news.push((format!("phones cannot connect: {error}"), true))).ok()
        });
        Self { remote, album, reported: RemoteState::default() }
    }

    pub(crate) fn record_picture(&self, looked: &Looked) {
        if self.remote.is_none() {
            return;
        }
        if let About::Picture(_, jpeg) = &looked.about {
            let _ = self.album.put(&looked.source.title(), jpeg.clone());
        }
    }

    /// The next message; `true` for bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        self.reported = self.remote.as_ref().map(Remote::state).filter(|now| *now != self.reported)?;
        match &self.reported {
            RemoteState::Opening => None,
            RemoteState::Open(pairing_address) => {
                let url = &pairing_address.url;
                let only = if pairing_address.is_local { " (only on this computer)" } else { "" };
                Some((format!("a phone can open {url} or scan the code that J shows{only}"), false))
            }
            RemoteState::Refused(why) => Some((why.clone(), true)),
        }
    }

    pub(super) fn facts(&self) -> Option<PhoneFacts> {
        let remote = self.remote.as_ref()?;
        Some(PhoneFacts { state: remote.state(), phones: remote.phones() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::action::ValueType;

    fn elements(attribute: &str) -> Vec<(&'static str, &'static str)> {
        let parts = mariana_remote::page_text().split(attribute).skip(1);
        parts.filter_map(|part| part.split_once('"')).collect()
    }

    #[test]
    fn the_buttons_and_sliders_of_the_page_are_actions_of_the_table() {
        let row = |name: &str| commands::for_phones().iter().find(|row| row.name == name);
        let buttons = elements("data-do=\"");
        assert!(buttons.len() > 8, "{buttons:?}");
        for (name, rest) in buttons {
            let is_switch = rest.split('>').next().is_some_and(|rest| rest.contains("switch"));
            let takes = if is_switch { ValueType::Switch } else { ValueType::Press };
            assert_eq!(row(name).map(|row| row.takes), Some(takes), "{name}");
        }
        let levels = elements("data-level=\"");
        assert_eq!(levels.len(), 4);
        for (name, _) in levels {
            assert_eq!(row(name).map(|row| row.takes), Some(ValueType::Level), "{name}");
        }
        assert!(row("scene").is_some());
    }
}
