//! The text of the window's title.

use mariana_player::PlayerStatus;
use mariana_player::input::LiveStatus;

/// The window's title: track, program, notes on the scene, unusual states. Silence is unusual unless `silence_asked`.
pub(crate) fn title(scene: Vec<String>, status: &PlayerStatus, silence_asked: bool) -> String {
    let track = &status.track;
    let mut title = format!("{} - Mariana", track.name);
    let mut notes = Vec::new();
    if track.count > 1 {
        notes.push(format!("{}/{}", track.entry + 1, track.count));
    }
    notes.extend(scene);
    if status.paused {
        notes.push("paused".to_owned());
    }
    if status.muted {
        notes.push("muted".to_owned());
    } else if status.volume < 0.995 {
        notes.push(format!("volume {:.0} %", status.volume * 100.0));
    }
    if status.silent.is_some() && !silence_asked {
        notes.push("no sound device".to_owned());
    }
    if !notes.is_empty() {
        title.push_str(&format!(" ({})", notes.join(", ")));
    }
    title
}

pub(crate) fn live_title(status: &LiveStatus, scene: Vec<String>, paused: bool) -> String {
    let mut notes = scene;
    if paused {
        notes.push("paused".to_owned());
    }
    notes.push(if status.silent.is_some() { "no sound".to_owned() } else { "live".to_owned() });
    format!("{} - Mariana ({})", status.name, notes.join(", "))
}
