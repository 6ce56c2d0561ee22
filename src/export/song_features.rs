//! The features of a song at given times, by decoding it: the same analysis that runs beside playback.

use mariana_music::{
    Alignment, Analyzer, FeatureTrack, Features, Gain, SongMoment, SongStructure, Sound, StereoFrame,
    TimedFeatures,
};
use mariana_player::decode::{DecodeError, Decoder};
use mariana_player::song::{Song, display_name};
use mariana_player::source::FrameSource;
use mariana_player::track::scale;

use super::error::ExportError;
use crate::song_structures::{StructureCache, structure_of};

/// Sound analysed before the first requested time, in seconds: long enough for the smoothing to settle.
const PRE_ROLL: f64 = 20.0;
/// How far a moment's tables reach beyond it, in seconds: the next row of the history.
const AROUND: f64 = 0.07;
/// Seconds of features that are kept; times may step back by that much.
const TRACK_SECONDS: f64 = 4.0;

/// Decodes and analyses a song just as far as it is needed.
pub struct SongFeatures {
    decoder: Decoder,
    name: String,
    analyzer: Analyzer,
    track: FeatureTrack,
    block: Vec<StereoFrame>,
    frames: u64,
    ended: bool,
    song: Song,
    /// What the whole song is made of, for who asked for it.
    structure: Option<SongStructure>,
}

impl SongFeatures {
    /// Opens `song` for times from `start` seconds on, with automatic gain.
    ///
    /// # Errors
    /// What the decoder says about the file.
    pub fn open(song: &Song, start: f64) -> Result<Self, DecodeError> {
        Self::open_with(song, start, Gain::Auto)
    }

    /// The same with automatic gain or without.
    ///
    /// # Errors
    /// What the decoder says about the file.
    pub fn open_with(song: &Song, start: f64, gain: Gain) -> Result<Self, DecodeError> {
        let mut decoder = song.open()?;
        let name = display_name(&decoder);
        let mut analyzer = Analyzer::with_gain(decoder.sample_rate(), Alignment::Centred, gain);
        let mut frames = 0;
        if start > PRE_ROLL {
            let reached = decoder.seek(start - PRE_ROLL)?;
            frames = (reached * f64::from(decoder.sample_rate())).round() as u64;
            analyzer.restart(frames);
        }
        let track = FeatureTrack::new(TRACK_SECONDS);
        let (block, song) = (Vec::new(), song.clone());
        Ok(Self { decoder, name, analyzer, track, block, frames, ended: false, song, structure: None })
    }

    /// The same song for times from another moment on, in seconds, and with as much knowledge of it.
    ///
    /// # Errors
    /// What the decoder says about the file.
    pub fn beside(&self, start: f64, gain: Gain) -> Result<Self, DecodeError> {
        Ok(Self { structure: self.structure.clone(), ..Self::open_with(&self.song, start, gain)? })
    }

    /// From now on sounds come with their places in the whole song, which is listened to first, unless it is known from
    /// an earlier run. Without this nothing of that is known.
    pub fn know_song(&mut self) {
        self.structure();
    }

    /// What the whole song is made of; see [`SongFeatures::know_song`].
    pub fn structure(&mut self) -> &SongStructure {
        let song = &self.song;
        self.structure.get_or_insert_with(|| structure_of(song, &StructureCache::of_user()))
    }

    /// The place of `time` in the whole song, as far as it is known.
    pub fn place_in_song(&self, time: f64) -> SongMoment {
        self.structure.as_ref().map_or(SongMoment::UNKNOWN, |structure| structure.moment(time))
    }

    /// What the song is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Length in seconds: as the container reports it, or as found by decoding to the end.
    pub fn duration(&self) -> Option<f64> {
        if self.ended { Some(self.decoded()) } else { self.decoder.info().duration }
    }

    /// The features at `time` seconds; none if the song ends at or before it. Times must not step back by more
    /// than a few seconds.
    ///
    /// # Errors
    /// What the decoder says about a damaged file.
    pub fn at(&mut self, time: f64) -> Result<Option<Features>, DecodeError> {
        self.decode_to(time)?;
        Ok((!self.is_over(time)).then(|| self.track.at(time)))
    }

    /// The same with the tables.
    ///
    /// # Errors
    /// What the decoder says about a damaged file.
    pub fn sound_at(&mut self, time: f64) -> Result<Option<Sound>, DecodeError> {
        self.decode_to(time)?;
        let sound = || Sound { song: self.place_in_song(time), ..self.track.sound_at(time) };
        Ok((!self.is_over(time)).then(sound))
    }

    /// Whether the song is known to end at or before a time.
    pub fn is_over(&self, time: f64) -> bool {
        self.ended && time >= self.decoded()
    }

    /// Decodes as far as is needed for the surroundings of a time.
    fn decode_to(&mut self, time: f64) -> Result<(), DecodeError> {
        let time = time + AROUND;
        while !self.ended && self.track.span().is_none_or(|(_, last)| last <= time) {
            self.block.clear();
            let track = &mut self.track;
            let mut emit = |moment: &TimedFeatures| track.push(moment);
            if self.decoder.next_block(&mut self.block)? == 0 {
                self.ended = true;
                self.analyzer.finish(&mut emit);
            } else {
                self.frames += self.block.len() as u64;
                scale(&mut self.block, self.decoder.info().scene_gain);
                self.analyzer.push(&self.block, &mut emit);
            }
        }
        Ok(())
    }

    /// The sound at `time`; a time after the end is an error.
    ///
    /// # Errors
    /// [`ExportError::AfterTheEnd`], and what the decoder says.
    pub fn require(&mut self, time: f64) -> Result<Sound, ExportError> {
        let sound = self.sound_at(time)?;
        sound.ok_or_else(|| ExportError::AfterTheEnd {
            name: self.name.clone(),
            asked: time,
            end: self.decoded(),
        })
    }

    fn decoded(&self) -> f64 {
        self.frames as f64 / f64::from(self.decoder.sample_rate())
    }
}
