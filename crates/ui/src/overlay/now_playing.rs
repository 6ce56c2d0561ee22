//! The playing track or input, as the bar and messages show it.

use std::hash::{Hash, Hasher};

use mariana_player::PlayerStatus;
use mariana_player::input::LiveStatus;
use mariana_player::track::Repeat;

/// The bar is laid out again each time that the position has moved on by this many seconds.
const POSITION_STEP: f64 = 0.1;

/// A snapshot of the player for display.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NowPlaying {
    /// The track's title, or the input's name.
    pub title: String,
    /// The track's artist.
    pub artist: Option<String>,
    /// The track's index from 0, and the number of tracks.
    pub place: (usize, usize),
    /// Seconds since the start of the track.
    pub position: f64,
    /// Length of the track in seconds, if known.
    pub duration: Option<f64>,
    /// True if the user has paused.
    pub paused: bool,
    /// Volume, 0..1.
    pub volume: f32,
    /// True if the user has muted the sound.
    pub muted: bool,
    /// The repeat mode.
    pub repeat: Repeat,
    /// True if the order of tracks is random.
    pub shuffled: bool,
    /// True for a live input.
    pub live: bool,
}

impl NowPlaying {
    /// Describes a playing song.
    pub fn of_song(status: &PlayerStatus) -> Self {
        let track = &status.track;
        Self {
            title: track.title.clone().unwrap_or_else(|| track.name.clone()),
            artist: track.title.as_ref().and(track.artist.clone()),
            place: (track.entry, track.count),
            position: status.position,
            duration: track.duration,
            paused: status.paused,
            volume: status.volume,
            muted: status.muted,
            repeat: status.repeat,
            shuffled: status.shuffled,
            live: false,
        }
    }

    /// Describes a live input.
    pub fn of_input(status: &LiveStatus, paused: bool) -> Self {
        Self { title: status.name.clone(), paused, live: true, ..Self::default() }
    }

    /// The played fraction of the track, 0..1; `None` if the track's length is unknown.
    pub fn fraction(&self) -> Option<f32> {
        let duration = self.duration.filter(|duration| *duration > 0.0)?;
        Some((self.position / duration).clamp(0.0, 1.0) as f32)
    }

    /// Formats position and length, such as "1:23 / 3:45", or "1:23" if the length is unknown.
    pub fn times(&self) -> String {
        let position = clock_time(self.position);
        match self.duration {
            Some(duration) => format!("{position} / {}", clock_time(duration)),
            None => position,
        }
    }
}

impl Hash for NowPlaying {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (&self.title, &self.artist, self.place, self.paused, self.muted).hash(state);
        (self.shuffled, self.live, self.volume.to_bits()).hash(state);
        ((self.position / POSITION_STEP) as i64, self.duration.map(f64::to_bits)).hash(state);
        std::mem::discriminant(&self.repeat).hash(state);
    }
}

/// Formats seconds: "0:07", "12:34", "1:02:03".
pub fn clock_time(seconds: f64) -> String {
    let whole = if seconds.is_finite() { seconds.max(0.0) as u64 } else { 0 };
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    match hours {
        0 => format!("{minutes}:{seconds:02}"),
        _ => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_the_usual_format() {
        let written = [0.0, 7.9, 83.0, 3_599.9, 3_723.0, -4.0, f64::NAN].map(clock_time);
        assert_eq!(written, ["0:00", "0:07", "1:23", "59:59", "1:02:03", "0:00", "0:00"]);
        let mut playing = NowPlaying { position: 83.0, duration: Some(225.0), ..Default::default() };
        assert_eq!(playing.times(), "1:23 / 3:45");
        assert_eq!(playing.fraction().map(|fraction| (fraction * 1000.0).round()), Some(369.0));
        playing.duration = None;
        assert_eq!((playing.times().as_str(), playing.fraction()), ("1:23", None));
    }
}
