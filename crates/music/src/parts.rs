//! The features of a song's parts, such as its drums: whole songs, in little memory.
//!
//! A part is analysed like a song, but without automatic gain: a part that pauses is silent, and a quiet part stays
//! quiet. A track keeps one set of numbers for each hop, numbers in two bytes and bands in one byte. It takes about 80
//! bytes for each hop: 1.8 MB for four minutes.

use super::StereoFrame;
use super::analyzer::{Alignment, Analyzer};
use super::features::Features;
use super::gain::Gain;
use super::scale::BAND_COUNT;
use crate::limits;

/// The version of the analysis of parts. Increase it whenever the same sound gives other numbers.
pub const PART_TRACK_VERSION: u32 = 1;

/// The names of the parts.
pub const PART_NAMES: [&str; 4] = ["drums", "bass", "vocals", "other"];

/// A number that tracks keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptNumber {
    /// A name of [`Features::number`].
    pub name: &'static str,
    /// The least value; lesser values are clamped.
    pub least: f32,
    /// The greatest value; greater values are clamped.
    pub most: f32,
}

/// The numbers and bands of a part at each hop of its sound.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTrack {
    kept: Vec<KeptNumber>,
    hop_seconds: f64,
    numbers: Vec<u16>,
    bands: Vec<u8>,
}

impl PartTrack {
    /// Keeps the numbers of a moment, unless the track has reached `seconds_max`.
    fn push(&mut self, features: &Features, seconds_max: f64) {
        if self.seconds() >= seconds_max {
            return;
        }
        for kept in &self.kept {
            let value = features.number(kept.name).unwrap_or(kept.least);
            let fraction = (value - kept.least) / (kept.most - kept.least);
            // The conversion saturates and maps NaN to 0.
            self.numbers.push((fraction * f32::from(u16::MAX)).round() as u16);
        }
        self.bands.extend(features.bands.map(|band| (band * f32::from(u8::MAX)).round() as u8));
    }

    /// The length in seconds.
    pub fn seconds(&self) -> f64 {
        (self.bands.len() / BAND_COUNT) as f64 * self.hop_seconds
    }

    /// Number of values that [`PartTrack::append`] appends.
    pub fn width(&self) -> usize {
        self.kept.len() + BAND_COUNT
    }

    /// Appends the kept numbers at `time` in seconds, in their order, and the bands. All are 0 outside the track.
    pub fn append(&self, time: f64, values: &mut Vec<f32>) {
        let along = time / self.hop_seconds;
        let hops = (self.bands.len() / BAND_COUNT) as f64;
        let is_inside = (0.0..hops).contains(&along);
        let place = if is_inside { along as usize } else { 0 };
        let rows = |place: usize| {
            let numbers = self.numbers.get(place * self.kept.len()..)?.get(..self.kept.len())?;
            Some((numbers, self.bands.get(place * BAND_COUNT..)?.get(..BAND_COUNT)?))
        };
        let Some((numbers, bands)) = rows(place).filter(|_| is_inside) else {
            values.resize(values.len() + self.width(), 0.0);
            return;
        };
        let (next_numbers, next_bands) = rows(place + 1).unwrap_or((numbers, bands));
        let amount = (along - place as f64) as f32;
        let between = |a: f32, b: f32| a + (b - a) * amount;
        for ((kept, a), b) in self.kept.iter().zip(numbers).zip(next_numbers) {
            let value = |number: &u16| {
                kept.least + (kept.most - kept.least) * (f32::from(*number) / f32::from(u16::MAX))
            };
            let is_mixed = Features::is_mixed(kept.name);
            values.push(if is_mixed { between(value(a), value(b)) } else { value(a) });
        }
        let value = |band: &u8| f32::from(*band) / f32::from(u8::MAX);
        values.extend(bands.iter().zip(next_bands).map(|(a, b)| between(value(a), value(b))));
    }

    /// Appends the track as bytes, for [`PartTrack::from_bytes`].
    pub fn append_bytes(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.hop_seconds.to_le_bytes());
        bytes.extend((self.bands.len() as u64 / BAND_COUNT as u64).to_le_bytes());
        bytes.extend(self.numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend(&self.bands);
    }

    /// Reads a track that keeps these numbers from the start of `bytes`, and removes its bytes. Returns `None` for
    /// other bytes.
    pub fn from_bytes(kept: &[KeptNumber], bytes: &mut &[u8]) -> Option<Self> {
        let hop_seconds = f64::from_le_bytes(*taken(bytes, 8)?.first_chunk()?);
        let hops = usize::try_from(u64::from_le_bytes(*taken(bytes, 8)?.first_chunk()?)).ok()?;
        let numbers = taken(bytes, hops.checked_mul(2 * kept.len())?)?;
        let numbers = numbers.as_chunks::<2>().0.iter().map(|number| u16::from_le_bytes(*number)).collect();
        let bands = taken(bytes, hops.checked_mul(BAND_COUNT)?)?.to_vec();
        let is_valid = hop_seconds > 0.0 && hop_seconds < 1.0;
        is_valid.then(|| Self { kept: kept.to_vec(), hop_seconds, numbers, bands })
    }
}

/// Removes the first `count` bytes and returns them; `None` if there are fewer.
fn taken<'a>(bytes: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, rest) = bytes.split_at_checked(count)?;
    *bytes = rest;
    Some(taken)
}

/// Analyses the sound of a part from its start.
pub struct PartListener {
    analyzer: Analyzer,
    track: PartTrack,
    seconds_max: f64,
}

impl PartListener {
    /// Listens to a stream of `sample_rate` frames per second, and keeps these numbers.
    pub fn new(sample_rate: u32, kept: &[KeptNumber]) -> Self {
        let analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, Gain::Off);
        let hop_seconds = analyzer.hop() as f64 / f64::from(analyzer.sample_rate());
        let track = PartTrack { kept: kept.to_vec(), hop_seconds, numbers: Vec::new(), bands: Vec::new() };
        Self { analyzer, track, seconds_max: limits::PART_SECONDS_MAX }
    }

    /// Analyses the next frames. Returns false once the part has reached the limit; later frames are ignored.
    pub fn push(&mut self, frames: &[StereoFrame]) -> bool {
        let Self { analyzer, track, seconds_max } = self;
        analyzer.push(frames, &mut |moment| track.push(&moment.features, *seconds_max));
        self.track.seconds() < self.seconds_max
    }

    /// Ends the stream: later sound is silence.
    pub fn finish(&mut self) {
        let Self { analyzer, track, seconds_max } = self;
        analyzer.finish(&mut |moment| track.push(&moment.features, *seconds_max));
    }

    /// The track so far.
    pub fn track(&self) -> &PartTrack {
        &self.track
    }
}

/// The tracks of a song's parts, in the order of [`PART_NAMES`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTracks {
    /// The tracks; `None` for a part without a file.
    pub tracks: [Option<PartTrack>; PART_NAMES.len()],
}

impl PartTracks {
    /// Returns the tracks as bytes, for [`PartTracks::from_bytes`].
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for track in &self.tracks {
            bytes.push(u8::from(track.is_some()));
            if let Some(track) = track {
                track.append_bytes(&mut bytes);
            }
        }
        bytes
    }

    /// Reads tracks that keep these numbers. Returns `None` for bytes that [`PartTracks::to_bytes`] did not write.
    pub fn from_bytes(kept: &[KeptNumber], mut bytes: &[u8]) -> Option<Self> {
        let mut tracks = Self::default();
        for track in &mut tracks.tracks {
            match taken(&mut bytes, 1)? {
                [0] => {}
                _ => *track = Some(PartTrack::from_bytes(kept, &mut bytes)?),
            }
        }
        bytes.is_empty().then_some(tracks)
    }

    /// Returns the numbers of all parts at `time` in seconds, part by part ([`PartTrack::append`]). A part without a
    /// track is 0. Returns nothing if no part has a track.
    pub fn at(&self, time: f64) -> Vec<f32> {
        let width = self.tracks.iter().flatten().map(PartTrack::width).max().unwrap_or(0);
        let mut values = Vec::with_capacity(width * PART_NAMES.len());
        for track in &self.tracks {
            match track {
                Some(track) => track.append(time, &mut values),
                None => values.resize(values.len() + width, 0.0),
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEPT: [KeptNumber; 3] = [
        KeptNumber { name: "volume.x", least: 0.0, most: 1.0 },
        KeptNumber { name: "tempo", least: 0.0, most: 1000.0 },
        KeptNumber { name: "brightness", least: 0.0, most: 1.0 },
    ];

    fn heard(rate: u32, seconds: f64, amplitude: f32) -> PartTrack {
        let mut listener = PartListener::new(rate, &KEPT);
        let frames = (0..(seconds * f64::from(rate)) as usize).map(|n| {
            let sample = amplitude * (std::f32::consts::TAU * 440.0 * n as f32 / rate as f32).sin();
            [sample, 0.0]
        });
        let frames: Vec<StereoFrame> = frames.collect();
        assert!(frames.chunks(1000).all(|block| listener.push(block)));
        listener.finish();
        listener.track().clone()
    }

    fn at(track: &PartTrack, time: f64) -> Vec<f32> {
        let mut values = Vec::new();
        track.append(time, &mut values);
        values
    }

    #[test]
    fn tracks_of_different_rates_agree_and_silence_is_0() {
        let (one, other) = (heard(48_000, 2.0, 0.5), heard(22_050, 2.0, 0.5));
        for time in [0.5, 1.0, 1.3337] {
            for (a, b) in at(&one, time).iter().zip(at(&other, time)).take(KEPT.len()) {
                assert!((a - b).abs() < 0.03, "{a} and {b} at {time}");
            }
        }
        assert!((at(&one, 1.0)[0] - 0.5 * 0.637).abs() < 0.01, "{:?}", at(&one, 1.0));
        let silent = heard(44_100, 2.0, 0.0);
        assert_eq!(at(&silent, 1.0), vec![0.0; 3 + BAND_COUNT]);
        for time in [-0.1, 2.2, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(at(&one, time), vec![0.0; 3 + BAND_COUNT], "at {time}");
        }
        assert!((one.seconds() - 2.0).abs() < 0.03);
    }

    #[test]
    fn numbers_are_interpolated_unless_they_jump() {
        let mut track = PartTrack { kept: KEPT.to_vec(), hop_seconds: 0.01, numbers: vec![], bands: vec![] };
        let features = |value: f32, tempo: f32| Features {
            volume: [value; 2],
            brightness: value,
            tempo,
            bands: [value; BAND_COUNT],
            ..Features::SILENCE
        };
        [features(0.2, 120.0), features(0.6, 60.0), features(9.0, f32::NAN)]
            .iter()
            .for_each(|f| track.push(f, f64::INFINITY));
        let values = at(&track, 0.005);
        for (value, expected) in values.iter().zip([0.4, 120.0, 0.4, 0.4]) {
            assert!((value - expected).abs() < 0.01, "{values:?}");
        }
        assert_eq!(at(&track, 0.025)[..3], [1.0, 0.0, 1.0], "values out of range are clamped");
        let tracks = PartTracks { tracks: [None, Some(track), None, None] };
        let all = tracks.at(0.025);
        assert_eq!((all.len(), all[0], all[3 + BAND_COUNT]), (4 * (3 + BAND_COUNT), 0.0, 1.0));
        assert_eq!(PartTracks::default().at(0.0), []);
        let bytes = tracks.to_bytes();
        assert_eq!(PartTracks::from_bytes(&KEPT, &bytes), Some(tracks));
        for end in 0..bytes.len() {
            assert_eq!(PartTracks::from_bytes(&KEPT, &bytes[..end]), None, "{end} bytes");
        }
        assert_eq!(PartTracks::from_bytes(&KEPT[..2], &bytes), None, "other numbers");
        let mut many = bytes;
        many[9..17].fill(255);
        assert_eq!(PartTracks::from_bytes(&KEPT, &many), None, "an impossible number of hops");
    }

    #[test]
    fn a_part_ends_at_the_limit() {
        let mut listener = PartListener { seconds_max: 2.0, ..PartListener::new(4_000, &KEPT) };
        let second = vec![[0.1; 2]; 4_000];
        assert_eq!((0..9).take_while(|_| listener.push(&second)).count(), 2);
        listener.finish();
        assert!((listener.track().seconds() - 2.0).abs() < 0.02);
    }
}
