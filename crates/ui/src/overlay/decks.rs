//! The strip of two decks above the bar: their scenes, the crossfader, and the ways to mix.

use egui::{Align, Id, Layout, Rect, Ui};

use super::acts::{Acts, Pass};
use super::chips::{self, Chip};
use super::content::{Deck, DeckStrip};
use super::{params, style};
use mariana_commands::Command;
use mariana_control::{ChangedBy, Slider};

const WIDTH_MAX: f32 = 560.0;
/// Maximum part of the strip's width for the name of each deck.
const NAME_MAX: f32 = 0.3;

/// Draws the strip at the lower edge of `space`. Returns its area.
pub(super) fn show(pass: &mut Pass<'_>, space: Rect, strip: &DeckStrip) -> Rect {
    let Pass { context, acts } = pass;
    let id = Id::unique("decks");
    if context.memory(|memory| memory.area_rect(id)).is_none() {
        // Discard egui's first pass, because it only finds the size.
        context.request_discard("the size of the decks' strip");
    }
    style::strip(context, id, space, WIDTH_MAX, true, |ui| {
        faders(ui, strip, acts);
        ways(ui, strip, acts);
    })
}

/// The names of both decks with the crossfader between them.
fn faders(ui: &mut Ui, strip: &DeckStrip, acts: &mut Acts) {
    let name_width = NAME_MAX * ui.available_width();
    ui.horizontal(|ui| {
        let [first, second] = &strip.decks;
        name(ui, first, 1, name_width, acts);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            name(ui, second, 2, name_width, acts);
            let mut slider = Slider {
                name: "crossfader from deck A to deck B".to_owned(),
                value: strip.crossfade,
                min: 0.0,
                max: 1.0,
                default: 0.5,
                changed_by: ChangedBy::Text,
                bound: None,
            };
            params::rail(ui, &mut slider, params::STEP, false);
            if slider.value != strip.crossfade {
                acts.commands.push(Command::Crossfade(slider.value));
            }
        });
    });
}

fn name(ui: &mut Ui, deck: &Deck, number: usize, width: f32, acts: &mut Acts) {
    let waits = if deck.is_ready { "" } else { " …" };
    let text = format!("{}  {}{waits}", deck.letter, deck.title);
    let words = match deck.is_ready {
        true => format!("deck {}: {}, change its sliders", deck.letter, deck.title),
        false => format!("deck {}: {} is being prepared", deck.letter, deck.title),
    };
    let chip = Chip { is_dim: !deck.is_ready, ..Chip::new(&text, words, deck.is_in_hand) };
    if chips::single(ui, &chip, width, None) {
        acts.commands.push(Command::TakeDeck(number));
    }
}

/// The ways to mix, and the buttons that move the crossfader.
fn ways(ui: &mut Ui, strip: &DeckStrip, acts: &mut Acts) {
    let of_mix = |(at, name): (usize, &&'static str)| {
        Chip::new(*name, format!("mix the decks by {name}"), at == strip.mix)
    };
    let mut chips: Vec<Chip<'_>> = strip.mixes.iter().enumerate().map(of_mix).collect();
    chips.push(Chip::new("cross over", "move the crossfader to the other deck".to_owned(), false));
    chips.push(Chip::new("swap", "swap the decks at once".to_owned(), false));
    chips.push(Chip::new("one scene", "return to one scene".to_owned(), false));
    let Some(clicked) = chips::row(ui, "ways to mix", chips) else { return };
    let command = match clicked.checked_sub(strip.mixes.len()) {
        None => Command::MixDecks(clicked + 1),
        Some(0) => Command::CrossOver,
        Some(1) => Command::SwapDecks,
        Some(_) => Command::Decks(mariana_commands::Switch::Off),
    };
    acts.commands.push(command);
}
