//! A song for tests and benchmarks of devices.

use mariana_music::StereoFrame;
use mariana_player::playlist::Playlist;
use mariana_player::source::{FrameSource, SourceError};
use mariana_player::track::Track;
use mariana_player::{Player, PlayerError, PlayerOptions};

struct Tone(u64);

/// Plays an endless tone, which belongs to no list.
pub(crate) fn start_tone(options: PlayerOptions) -> Result<Player, PlayerError> {
    let list = Box::new(Playlist::default());
    Player::start(Track::alone(Box::new(Tone(0))), list, options)
}

impl FrameSource for Tone {
    fn sample_rate(&self) -> u32 {
        48_000
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        out.extend((self.0..self.0 + 1000).map(|n| [0.5 * (n as f32 * 0.05).sin(); 2]));
        self.0 += 1000;
        Ok(1000)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        self.0 = (seconds * 48_000.0).round() as u64;
        Ok(seconds)
    }
}
