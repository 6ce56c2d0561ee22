//! The rows of snapshots below the sliders.

use egui::Ui;

use super::acts::Acts;
use super::binding::caption;
use super::chips::{self, Chip};
use super::content::SnapshotRow;
use mariana_commands::{Command, Switch};

/// The lengths of morphs to choose from, in beats.
const BEATS: [u16; 5] = [1, 2, 4, 8, 16];

pub(super) fn show(ui: &mut Ui, row: SnapshotRow, acts: &mut Acts) {
    ui.add_space(4.0);
    caption(ui, "snapshots of the sliders", "");
    let chips = (1..).zip(row.taken).map(|(number, is_taken): (usize, bool)| {
        let act = if is_taken && !row.keys.takes { "recall" } else { "take" };
        let name = format!("{act} snapshot {number} (Shift+{number})");
        Chip { is_dim: !is_taken, ..Chip::new(number.to_string(), name, false) }
    });
    if let Some(place) = chips::row(ui, "snapshots", chips) {
        acts.commands.push(Command::Snapshot(place + 1));
    }
    caption(ui, "time to recall one, in beats", "");
    let at_once = Chip::new("at once", "recall snapshots at once".to_owned(), !row.keys.morphs);
    let lengths = BEATS.map(|beats| {
        let is_chosen = row.keys.morphs && row.keys.beats == beats;
        Chip::new(beats.to_string(), format!("recall snapshots over {beats} beats"), is_chosen)
    });
    if let Some(place) = chips::row(ui, "lengths of morphs", [at_once].into_iter().chain(lengths)) {
        let beats = place.checked_sub(1).and_then(|place| BEATS.get(place)).copied().unwrap_or_default();
        acts.commands.push(Command::MorphBeats(beats.into()));
    }
    let again = "let the next snapshot be taken again instead of recalled (F2)";
    let again = Chip::new("take again", again.to_owned(), row.keys.takes);
    let write = "write the snapshots as a show file with an entry for each";
    let write = row.taken.contains(&true).then(|| Chip::new("write a show", write.to_owned(), false));
    let command = match chips::row(ui, "ways of snapshots", [again].into_iter().chain(write)) {
        Some(0) => Command::TakeNext(Switch::Toggle),
        Some(_) => Command::WriteSnapshots,
        None => return,
    };
    acts.commands.push(command);
}
