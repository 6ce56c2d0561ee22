//! Presets of `--for`: the size, rate and length that video services want.

use clap::ValueEnum;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Place {
    /// 1920x1080 at 60 frames a second
    Youtube,
    /// Portrait, 1080x1920 at 30 frames a second, the first 90 seconds
    Reel,
    /// Portrait, 1080x1920 at 30 frames a second, the first 60 seconds
    Story,
    /// 1080x1080 at 30 frames a second
    Square,
    /// Portrait, 1080x1920 at 30 frames a second; 8 seconds without sound whose end fades into the beginning
    Loop,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Preset {
    /// Width and height in pixels.
    pub(super) size: (u32, u32),
    pub(super) fps: f64,
    /// Maximal length in seconds; `None` for the whole song.
    pub(super) duration: Option<f64>,
    pub(super) sound: bool,
    /// Sample rate of the sound, in hertz; `None` keeps the song's rate.
    pub(super) sound_rate: Option<u32>,
    /// Duration of the fade from the end into the beginning, in seconds; `None` for no loop.
    pub(super) seam: Option<f64>,
}

const PLAIN: Preset =
    Preset { size: (1280, 720), fps: 30.0, duration: None, sound: true, sound_rate: None, seam: None };

/// Returns the preset of a service. All services accept H.264 and 48 kHz, and encode the video again. `Loop` suits
/// Spotify's Canvas: 3 to 8 seconds, portrait, silent, repeated.
pub(super) fn preset(place: Option<Place>) -> Preset {
    let service = Preset { sound_rate: Some(48_000), ..PLAIN };
    let upright = Preset { size: (1080, 1920), ..service };
    match place {
        None => PLAIN,
        Some(Place::Youtube) => Preset { size: (1920, 1080), fps: 60.0, ..service },
        Some(Place::Reel) => Preset { duration: Some(90.0), ..upright },
        Some(Place::Story) => Preset { duration: Some(60.0), ..upright },
        Some(Place::Square) => Preset { size: (1080, 1080), ..service },
        Some(Place::Loop) => Preset { duration: Some(8.0), sound: false, seam: Some(1.0), ..upright },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documentation_has_a_row_for_each_place() {
        let page = include_str!("../../docs/videos.md");
        for place in Place::value_variants() {
            let Preset { size: (width, height), fps, duration, sound, sound_rate, seam } =
                preset(Some(*place));
            let name = place.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
            let length = match (duration, seam) {
                (None, _) => "the song's".to_owned(),
                (Some(seconds), None) => format!("at most {seconds} s"),
                (Some(seconds), Some(_)) => format!("{seconds} s"),
            };
            let sound = match sound_rate.filter(|_| sound) {
                Some(rate) => format!("{} kHz", rate / 1000),
                None => "none".to_owned(),
            };
            let row = format!("| `{name}` | {width}x{height} | {fps} | {length} | {sound} |");
            assert!(page.contains(&row), "docs/videos.md should have the row\n{row}");
        }
    }
}
