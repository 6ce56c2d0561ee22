//! Moves a parameter of the scene, or the camera, during builds and at drops.

use super::Shown;
use crate::bar_lines::BarLines;
use crate::cue_list::{CAMERA_TURNS, CueList, Length, Setting, Step};
use mariana_music::SongStructure;

/// The camera's zoom at the end of a build and at a drop, where it falls back. The camera only comes nearer: in a
/// flight, the way back may lead through a wall.
const NEAR: f32 = 0.85;
/// The time in which a value falls back, in bars.
const BACK_BARS: f64 = 1.0;
/// Shorter remains of a build do not move anything, in bars.
const BARS_MIN: f64 = 2.0;

/// Adds the movements to the entries of a cue list. `shown` has the scene of each entry.
pub(super) fn add(song: &SongStructure, lines: &BarLines, shown: &[Shown<'_>], cue_list: &mut CueList) {
    let zoom = |from: f32, steps: Vec<Step>, after: f64| Setting {
        steps,
        after: if after > 0.0 { Length::Bars(after) } else { Length::ZERO },
        ..Setting::new(CAMERA_TURNS[2], from)
    };
    for (entry, _) in cue_list.entries.iter_mut().zip(shown).filter(|(_, shown)| shown.is_drop) {
        entry.settings.push(zoom(NEAR, vec![step(1.0, BACK_BARS)], 0.0));
    }
    for build in &song.builds {
        let clip = shown.iter().rposition(|shown| shown.time <= build.start + 0.05).unwrap_or(0);
        // If the scene changes during the build, the last scene moves.
        let last = shown.iter().rposition(|shown| shown.time < build.end - 0.05).unwrap_or(clip);
        let (Some(shown), Some(entry)) = (shown.get(last), cue_list.entries.get_mut(last)) else { continue };
        let lead = if let Length::Bars(bars) = entry.when.offset { bars } else { 0.0 };
        let begin = lines.bar_at(shown.time) + lead;
        let after = rounded((lines.bar_at(build.start) - begin).max(0.0));
        let bars = rounded(lines.bar_at(build.end) - begin - after);
        if bars < BARS_MIN {
            continue;
        }
        entry.settings.push(match &shown.card.rise {
            Some(rise) => Setting {
                param: rise.param.clone(),
                ..zoom(rise.from, vec![step(rise.to, bars), step(rise.from, BACK_BARS)], after)
            },
            None => zoom(1.0, vec![step(NEAR, bars), step(1.0, BACK_BARS)], after),
        });
    }
}

/// Rounds bars to hundredths, for the text of the show.
fn rounded(bars: f64) -> f64 {
    (100.0 * bars).round() / 100.0
}

fn step(to: f32, bars: f64) -> Step {
    Step { to, over: Length::Bars(bars) }
}
