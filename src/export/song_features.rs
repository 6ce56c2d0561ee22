//! Features of a song at given times. The song is decoded, and analysed in the same way as during playback.

use std::sync::Arc;

use mariana_field::graph::{Graph, Op};
use mariana_music::{
    Alignment, Analyzer, FeatureTrack, Features, Gain, PartTracks, Recent, SongMoment, SongStructure, Sound,
    StereoFrame, TimedFeatures,
};
use mariana_player::decode::{DecodeError, Decoder};
use mariana_player::lyrics::Lyrics;
use mariana_player::song::{Song, display_name};
use mariana_player::source::FrameSource;
use mariana_player::track::scale;

use super::error::ExportError;
use super::print::print_message;
use crate::config::Folders;
use crate::song_structures::{lyrics_of, structure_cache, structure_of};
use crate::stems::{Parts, SongOfParts, parts_cache};

/// Length of sound analysed before the first requested time, in seconds: enough for the smoothing to settle.
const PRE_ROLL: f64 = 20.0;
/// Time to decode beyond a moment, in seconds: the moment's tables need the next row of the history.
const AROUND: f64 = 0.07;
/// Length of the stored features, in seconds. Requested times may step back by at most this length.
const TRACK_SECONDS: f64 = 4.0;

/// Decodes and analyses a song as far as necessary.
pub struct SongFeatures {
    decoder: Decoder,
    /// The song's title for messages.
    pub name: String,
    analyzer: Analyzer,
    track: FeatureTrack,
    block: Vec<StereoFrame>,
    frames: u64,
    ended: bool,
    pub(super) song: Song,
    gain: Gain,
    structure: Option<SongStructure>,
    lyrics: Option<Lyrics>,
    parts: Option<Arc<PartTracks>>,
    /// True if a scene needs the sound of the last seconds.
    remembers: bool,
}

impl SongFeatures {
    /// Opens `song` for times from `start` seconds on, with automatic gain.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded.
    pub fn open(song: &Song, start: f64) -> Result<Self, DecodeError> {
        Self::open_with(song, start, Gain::Auto)
    }

    /// Opens `song` for times from `start` seconds on.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded.
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
        Ok(Self {
            decoder,
            name,
            analyzer,
            track: FeatureTrack::new(TRACK_SECONDS),
            block: Vec::new(),
            frames,
            ended: false,
            song: song.clone(),
            gain,
            structure: None,
            lyrics: None,
            parts: None,
            remembers: false,
        })
    }

    /// Opens the same song again for times from `start` seconds on. Keeps the song's structure, lyrics and parts if
    /// they are known.
    ///
    /// # Errors
    /// Fails if the song cannot be decoded.
    pub(super) fn beside(&self, start: f64) -> Result<Self, DecodeError> {
        let (structure, lyrics, parts) = (self.structure.clone(), self.lyrics.clone(), self.parts.clone());
        let remembers = self.remembers;
        Ok(Self { structure, lyrics, parts, remembers, ..Self::open_with(&self.song, start, self.gain)? })
    }

    /// Finds the whole song's structure, in the cache or by decoding, and its lyrics. Later results contain the
    /// position in the song.
    pub fn know_song(&mut self) {
        self.structure();
        let song = &self.song;
        self.lyrics.get_or_insert_with(|| lyrics_of(song));
    }

    /// Replaces the lyrics of the song.
    pub fn sing(&mut self, lyrics: Lyrics) {
        self.lyrics = Some(lyrics);
    }

    /// Returns the structure of the whole song. The first call computes the structure.
    pub fn structure(&mut self) -> &SongStructure {
        let song = &self.song;
        self.structure.get_or_insert_with(|| structure_of(song, &structure_cache(&Folders::of_user())))
    }

    /// Reads what a scene with this graph needs besides the sound of a moment: the whole song's structure, its parts, and
    /// the last seconds.
    pub fn know_for(&mut self, graph: &Graph) {
        if graph.reads_song() {
            self.know_song();
        }
        if graph.reads(&Op::PARTS) {
            self.know_parts();
        }
        self.remembers |= !graph.motions().is_empty();
    }

    /// Reads the parts of the song from its stems, and reports what is wrong with them. Later results contain the
    /// parts.
    pub fn know_parts(&mut self) {
        if self.parts.is_some() {
            return;
        }
        let info = self.decoder.info();
        let (duration, scene_gain) = (info.duration, info.scene_gain);
        let song = SongOfParts { song: &self.song, cut: None, duration, scene_gain };
        let Parts { tracks, problems, .. } =
            song.read(&parts_cache(&Folders::of_user()), &|| true, &|_| {}).unwrap_or_default();
        problems.iter().for_each(|problem| print_message(&problem.to_string()));
        self.parts = Some(Arc::new(tracks));
    }

    /// Returns the position of `time` in the whole song. Call [`SongFeatures::know_song`] before this.
    pub fn place_in_song(&self, time: f64) -> SongMoment {
        let mut moment =
            self.structure.as_ref().map_or(SongMoment::UNKNOWN, |structure| structure.moment(time));
        if let Some(lyrics) = &self.lyrics {
            lyrics.mark(time, &mut moment);
        }
        moment
    }

    /// Returns `sound`, which was measured at `time`, with the position in the whole song, its tempo and its phase, and
    /// with the song's parts and the last seconds. Call [`SongFeatures::know_for`] before this.
    pub fn placed(&self, time: f64, sound: Sound) -> Sound {
        let recent = if self.remembers { self.track.recent(time) } else { Vec::new() };
        let recent = recent.into_iter().filter(|one| one.age <= time).map(|one| Recent {
            song: self.place_in_song(time - one.age),
            features: self.guided(time - one.age, one.features),
            parts: self.parts_at(time - one.age),
            ..one
        });
        Sound {
            song: self.place_in_song(time),
            features: self.guided(time, sound.features),
            parts: self.parts_at(time),
            recent: recent.collect(),
            ..sound
        }
    }

    fn parts_at(&self, time: f64) -> Vec<f32> {
        self.parts.as_ref().map(|parts| parts.at(time)).unwrap_or_default()
    }

    /// Returns the features with the tempo and phase of the whole song, if its structure is known.
    fn guided(&self, time: f64, mut features: Features) -> Features {
        if let Some(structure) = &self.structure {
            features.follow_song(structure, time);
        }
        features
    }

    /// Returns the lyrics, if they are known already.
    pub(super) fn lyrics(&self) -> Option<&Lyrics> {
        self.lyrics.as_ref()
    }

    /// Returns the song's length in seconds, once it is known from the container or by decoding to the end.
    pub fn duration(&self) -> Option<f64> {
        if self.ended { Some(self.decoded()) } else { self.decoder.info().duration }
    }

    /// Returns the features at `time` seconds; `None` if the song has ended. Times may step back by a few seconds.
    ///
    /// # Errors
    /// Fails if the file is damaged.
    pub fn at(&mut self, time: f64) -> Result<Option<Features>, DecodeError> {
        self.decode_to(time)?;
        Ok((!self.is_over(time)).then(|| self.guided(time, self.track.at(time))))
    }

    /// Returns the sound (features with tables) at `time` seconds; `None` if the song has ended.
    ///
    /// # Errors
    /// Fails if the file is damaged.
    pub fn sound_at(&mut self, time: f64) -> Result<Option<Sound>, DecodeError> {
        self.decode_to(time)?;
        Ok((!self.is_over(time)).then(|| self.placed(time, self.track.sound_at(time))))
    }

    /// True if the song is known to end at or before `time`.
    pub fn is_over(&self, time: f64) -> bool {
        self.ended && time >= self.decoded()
    }

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

    /// Returns the sound at `time` seconds.
    ///
    /// # Errors
    /// Fails if `time` is after the song's end, or with an error of the decoder.
    pub fn require(&mut self, time: f64) -> Result<Sound, ExportError> {
        let sound = self.sound_at(time)?;
        sound.ok_or_else(|| {
            let (name, end) = (&self.name, self.decoded());
            ExportError::Refused(format!(
                "{name} ends at {end:.2} s: choose a time before the end instead of {time} s"
            ))
        })
    }

    fn decoded(&self) -> f64 {
        self.frames as f64 / f64::from(self.decoder.sample_rate())
    }
}
