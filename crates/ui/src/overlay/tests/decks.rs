//! Tests of the strip of decks, with the pointer.

use super::*;
use crate::overlay::{Deck, DeckStrip};
use egui::vec2;
use mariana_commands::Switch;

fn strip(title: &str) -> DeckStrip {
    let deck = |letter, title: &str| Deck {
        letter,
        title: title.to_owned(),
        is_in_hand: letter == 'A',
        is_ready: letter == 'A',
    };
    let mixes = vec!["melt", "fade", "ball", "plane"];
    DeckStrip { decks: [deck('A', "orb"), deck('B', title)], crossfade: 0.25, mixes, mix: 0 }
}

fn events_of(stage: &mut Stage, strip: &DeckStrip, at: Pos2) -> Vec<Command> {
    let content = || OverlayContent { decks: Some(strip.clone()), ..Default::default() };
    stage.seconds += 2.0;
    stage.frame(Vec::new(), content());
    commands(stage, at, content)
}

#[test]
fn the_pointer_moves_the_crossfader_and_chooses_decks_and_mixes() {
    let strip = strip("city");
    for screen in [vec2(1280.0, 720.0), vec2(640.0, 360.0)] {
        let mut stage = Stage::new(screen);
        stage.panels.context.enable_accesskit();
        let content = || OverlayContent { decks: Some(strip.clone()), ..Default::default() };
        stage.frame(Vec::new(), content());
        let update = stage.frame(Vec::new(), content()).output.platform_output.accesskit_update.unwrap();
        let place = |name: &str| {
            let by_name =
                |node: &&(egui::accesskit::NodeId, egui::accesskit::Node)| node.1.label() == Some(name);
            let node = update.nodes.iter().find(by_name).unwrap_or_else(|| panic!("no control '{name}'"));
            let bounds = node.1.bounds().unwrap();
            let [x0, y0, x1, y1] = [bounds.x0, bounds.y0, bounds.x1, bounds.y1].map(|at| at as f32);
            assert!(Rect::from_min_max(Pos2::ZERO, screen.to_pos2()).contains(Pos2::new(x1, y1)), "{name}");
            Pos2::new(0.5 * (x0 + x1), 0.5 * (y0 + y1))
        };
        for (name, wanted) in [
            ("crossfader from deck A to deck B", Command::Crossfade(0.5)),
            ("deck B: city is being prepared", Command::TakeDeck(2)),
            ("mix the decks by ball", Command::MixDecks(3)),
            ("move the crossfader to the other deck", Command::CrossOver),
            ("swap the decks at once", Command::SwapDecks),
            ("return to one scene", Command::Decks(Switch::Off)),
        ] {
            let at = place(name);
            let events = events_of(&mut stage, &strip, at);
            assert!(events.contains(&wanted.clone()), "{name}: {events:?}");
        }
    }
}

#[test]
fn a_long_title_does_not_push_the_crossfader_out_of_the_window() {
    let screen = vec2(400.0, 300.0);
    let mut stage = Stage::new(screen);
    let strip = strip(&"a long title ".repeat(20));
    let content = || OverlayContent { decks: Some(strip.clone()), ..Default::default() };
    stage.frame(Vec::new(), content());
    let panels = stage.frame(Vec::new(), content()).panels;
    let window = Rect::from_min_max(Pos2::ZERO, screen.to_pos2());
    assert!(panels.iter().all(|panel| window.contains_rect(*panel)), "{panels:?}");
}
