//! Presets of videos: the size, rate and length that video services want.

use crate::config::Choice;
use crate::frame::projection::Projection;

/// A service, or a use of a video.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the table says it")]
pub enum VideoPlace {
    Youtube,
    FourK,
    Shorts,
    Tiktok,
    Reel,
    Story,
    Square,
    Loop,
}

impl Choice for VideoPlace {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Youtube, "youtube", "1920x1080 at 60 frames a second"),
        (Self::FourK, "4k", "3840x2160 at 30 frames a second"),
        (Self::Shorts, "shorts", "Portrait, 1080x1920 at 30 frames a second, the first 180 seconds"),
        (Self::Tiktok, "tiktok", "Portrait, 1080x1920 at 30 frames a second"),
        (Self::Reel, "reel", "Portrait, 1080x1920 at 30 frames a second, the first 90 seconds"),
        (Self::Story, "story", "Portrait, 1080x1920 at 30 frames a second, the first 60 seconds"),
        (Self::Square, "square", "1080x1080 at 30 frames a second"),
        (
            Self::Loop,
            "loop",
            "Portrait, 1080x1920 at 30 frames a second; 8 seconds without sound whose end fades into the beginning",
        ),
    ];
}

/// The requirements of a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Frames per second.
    pub fps: f64,
    /// Maximal length in seconds; `None` for the whole song.
    pub duration: Option<f64>,
    /// True if the video has sound.
    pub sound: bool,
    /// Sample rate of the sound, in hertz; `None` keeps the song's rate.
    pub sound_rate: Option<u32>,
    /// Duration of the fade from the end into the beginning, in seconds; `None` for no loop.
    pub seam: Option<f64>,
}

impl Preset {
    /// The preset without a place.
    pub const PLAIN: Self =
        Self { size: (1280, 720), fps: 30.0, duration: None, sound: true, sound_rate: None, seam: None };

    /// Returns the preset of a place. All services accept H.264 and 48 kHz, and encode the video again. `Loop` suits
    /// Spotify's Canvas: 3 to 8 seconds, portrait, silent, repeated.
    pub fn of(place: Option<VideoPlace>) -> Self {
        let service = Self { sound_rate: Some(48_000), ..Self::PLAIN };
        let upright = Self { size: (1080, 1920), ..service };
        match place {
            None => Self::PLAIN,
            Some(VideoPlace::Youtube) => Self { size: (1920, 1080), fps: 60.0, ..service },
            Some(VideoPlace::FourK) => Self { size: (3840, 2160), ..service },
            Some(VideoPlace::Shorts) => Self { duration: Some(180.0), ..upright },
            Some(VideoPlace::Tiktok) => upright,
            Some(VideoPlace::Reel) => Self { duration: Some(90.0), ..upright },
            Some(VideoPlace::Story) => Self { duration: Some(60.0), ..upright },
            Some(VideoPlace::Square) => Self { size: (1080, 1080), ..service },
            Some(VideoPlace::Loop) => Self { duration: Some(8.0), sound: false, seam: Some(1.0), ..upright },
        }
    }

    /// Returns the size of a picture in a projection, which has its own size unless it is flat.
    pub fn size_in(&self, projection: &Projection) -> (u32, u32) {
        if projection.is_plain() { self.size } else { projection.default_size() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_and_the_documentation_have_the_numbers_of_each_place() {
        let page = include_str!("../../../docs/videos.md");
        for (place, name, meaning) in VideoPlace::ALL {
            let Preset { size: (width, height), fps, duration, sound, sound_rate, seam } =
                Preset::of(Some(*place));
            let numbers = format!("{width}x{height} at {fps} frames a second");
            assert!(meaning.contains(&numbers), "{name}: the meaning should contain {numbers}");
            let seconds = duration.map_or(String::new(), |seconds| format!("{seconds} seconds"));
            assert!(meaning.contains(&seconds), "{name}: the meaning should contain {seconds}");
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
