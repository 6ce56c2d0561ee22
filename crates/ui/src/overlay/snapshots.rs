//! The row of snapshots below the sliders.

use egui::Ui;

use super::chips::{self, Chip};
use super::content::SnapshotRow;
use super::events::UiEvent;
use mariana_commands::{Command, Switch};

pub(super) fn show(ui: &mut Ui, row: SnapshotRow, events: &mut Vec<UiEvent>) {
    ui.add_space(4.0);
    let numbers: Vec<String> = (1..=row.taken.len()).map(|number| number.to_string()).collect();
    let chips: Vec<Chip<'_>> = numbers
        .iter()
        .zip(row.taken)
        .map(|(number, is_taken)| {
            let act = if is_taken && !row.keys.takes { "recall" } else { "take" };
            let name = format!("{act} snapshot {number}");
            Chip { is_dim: !is_taken, ..Chip::new(number, name, false) }
        })
        .collect();
    if let Some(place) = chips::row(ui, "snapshots", &chips) {
        events.push(UiEvent::Command(Command::Snapshot(place + 1)));
    }
    let mut ways = vec![
        Chip::new("take", "take the next snapshot again".to_owned(), row.keys.takes),
        Chip::new("over a bar", "recall snapshots over a bar".to_owned(), row.keys.morphs),
    ];
    if row.taken.contains(&true) {
        ways.push(Chip::new("write show", "write the snapshots as a show".to_owned(), false));
    }
    let command = match chips::row(ui, "ways of snapshots", &ways) {
        Some(0) => Command::TakeNext(Switch::Toggle),
        Some(1) => Command::Morph(Switch::Toggle),
        Some(_) => Command::WriteSnapshots,
        None => return,
    };
    events.push(UiEvent::Command(command));
}
