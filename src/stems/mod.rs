//! The parts of a song, read from its stems: whole, before their sound is heard, so that a window, a still and a video
//! show the same.

use mariana_field::graph::PartInput;
use mariana_music::limits as music_limits;
use mariana_music::{KeptNumber, PART_TRACK_VERSION, PartListener, PartTracks};
use mariana_player::decode::{DecodeError, Decoder};
use mariana_player::playlist::Cut;
use mariana_player::song::Song;
use mariana_player::stems::{Stem, stems_of};
use mariana_player::track::{TrackInfo, scale};

use crate::cached_files::{CachedFiles, FileKey};
use crate::config::Folders;
use crate::limits;
use crate::song_structures::SongReader;

/// A stem and its song may differ by this many seconds without a message: encoders pad files.
const SAME_LENGTH: f64 = 1.0;

/// The parts of a song are published for the first time when this length of them is read, in seconds.
const FIRST_SECONDS: f64 = 10.0;

/// Number of songs whose parts stay in memory: the current and the next one.
const SONGS_KEPT: usize = 2;

/// Returns the cache of the parts of songs in the cache folder of `folders`, if there is one.
pub fn parts_cache(folders: &Folders) -> CachedFiles {
    let folder = folders.cache.as_ref().map(|cache| cache.join("parts"));
    let (bytes_max, kept_max) = (limits::PARTS_BYTES_MAX, limits::PARTS_KEPT_MAX);
    CachedFiles { folder, ending: "parts", bytes_max, kept_max }
}

/// The parts of a song.
#[derive(Debug, Default)]
pub struct Parts {
    /// The features of the parts.
    pub tracks: PartTracks,
    /// Messages about everything that is wrong with the stems, once they are complete.
    pub problems: Vec<String>,
    /// False while only the beginning of the song is known.
    pub are_complete: bool,
}

/// The song whose parts are read.
#[derive(Debug, Clone)]
pub struct SongOfParts<'a> {
    /// The song.
    pub song: &'a Song,
    /// The part of the song that is played; `None` for the whole song.
    pub cut: Option<Cut>,
    /// Length of the played part in seconds, if known.
    pub duration: Option<f64>,
    /// The factor for samples before analysis, as for the song.
    pub scene_gain: f32,
}

/// True while the parts are wanted.
pub type GoOn<'a> = dyn Fn() -> bool + Sync + 'a;

impl SongOfParts<'_> {
    /// Takes the parts from the cache, or reads the stems, all at the same time. A song without stems has no parts, and
    /// a damaged stem is a silent part. Passes the parts of the beginning to `publish`, first after [`FIRST_SECONDS`]
    /// of the song and then each time their length has doubled. Returns `None` if `go_on` returns false.
    pub fn read(&self, cache: &CachedFiles, go_on: &GoOn<'_>, publish: &dyn Fn(Parts)) -> Option<Parts> {
        let (stems, mut problems) = stems_of(self.song);
        let key = self.key(&stems, cache, go_on);
        let decode = |bytes: &[u8]| PartTracks::from_bytes(&kept_numbers(), bytes);
        if let Some(tracks) = key.and_then(|key| cache.load(key, decode)).filter(|_| problems.is_empty()) {
            return Some(Parts { tracks, problems: Vec::new(), are_complete: true });
        }
        let (from, until) = self.cut.map_or((0.0, f64::INFINITY), Cut::seconds);
        let mut readings: Vec<StemReading<'_>> = Vec::new();
        for stem in &stems {
            match StemReading::open(stem, from, self.scene_gain) {
                Ok(reading) => readings.push(reading),
                Err(error) => problems.push(format!("the part {} stays silent: {error}", stem.name())),
            }
        }
        let mut length = FIRST_SECONDS;
        while !readings.iter().all(|reading| reading.is_over) {
            std::thread::scope(|scope| {
                for reading in &mut readings {
                    scope.spawn(move || reading.read_to(length.min(until - from), go_on));
                }
            });
            if !go_on() {
                return None;
            }
            if length >= until - from {
                break;
            }
            publish(Parts { tracks: tracks_of(&readings), ..Parts::default() });
            length *= 2.0;
        }
        for reading in &mut readings {
            reading.finish(self.duration.filter(|_| self.cut.is_none()));
            problems.append(&mut reading.problems);
        }
        let tracks = tracks_of(&readings);
        // Problems are reported each time, so a stem with a problem is read again.
        if let Some(key) = key.filter(|_| problems.is_empty()) {
            cache.save(key, &tracks.to_bytes());
        }
        Some(Parts { tracks, problems, are_complete: true })
    }

    /// Returns the key of the stems' bytes, of what decides about the analysis, and of the version of the analysis; `None`
    /// without stems, and as [`CachedFiles::key`].
    fn key(&self, stems: &[Stem], cache: &CachedFiles, go_on: &GoOn<'_>) -> Option<FileKey> {
        let mut files: Vec<Song> = stems.iter().map(|stem| Song::File(stem.path().to_owned())).collect();
        files.dedup();
        files.first()?;
        let parts: Vec<usize> = stems.iter().map(|stem| stem.part).collect();
        let names: Vec<&str> = kept_numbers().iter().map(|kept| kept.name).collect();
        let cut = self.cut.map(|cut| (cut.start, cut.end));
        let about = (PART_TRACK_VERSION, parts, names, cut, self.scene_gain.to_bits());
        cache.key(about, &files, &|| go_on())
    }
}

fn tracks_of(readings: &[StemReading<'_>]) -> PartTracks {
    let mut tracks = PartTracks::default();
    for reading in readings {
        if let Some(track) = tracks.tracks.get_mut(reading.stem.part) {
            *track = Some(reading.listener.track().clone());
        }
    }
    tracks
}

/// A stem that is being read.
struct StemReading<'a> {
    stem: &'a Stem,
    decoder: Decoder,
    listener: PartListener,
    scene_gain: f32,
    frames: usize,
    /// True once the stem has ended, in whatever way.
    is_over: bool,
    /// True if the stem ended at its last frame.
    is_whole: bool,
    problems: Vec<String>,
}

impl<'a> StemReading<'a> {
    fn open(stem: &'a Stem, from: f64, scene_gain: f32) -> Result<Self, DecodeError> {
        let mut decoder = stem.open()?;
        if from > 0.0 {
            decoder.seek(from)?;
        }
        let listener = PartListener::new(decoder.info().sample_rate, &kept_numbers());
        let (frames, is_over, is_whole, problems) = (0, false, false, Vec::new());
        Ok(Self { stem, decoder, listener, scene_gain, frames, is_over, is_whole, problems })
    }

    fn seconds(&self) -> f64 {
        self.frames as f64 / f64::from(self.decoder.info().sample_rate)
    }

    /// Reads until `length` seconds are read, the stem is over, or `go_on` returns false.
    fn read_to(&mut self, length: f64, go_on: &GoOn<'_>) {
        let mut block = Vec::new();
        while !self.is_over && self.seconds() < length && go_on() {
            block.clear();
            match self.decoder.next_block(&mut block) {
                Ok(0) => (self.is_over, self.is_whole) = (true, true),
                Ok(count) => self.frames += count,
                Err(error) => {
                    let (part, seconds) = (self.stem.name(), self.seconds());
                    self.problems.push(format!("the part {part} is silent from {seconds:.1} s on: {error}"));
                    self.is_over = true;
                }
            }
            scale(&mut block, self.scene_gain);
            if !self.listener.push(&block) {
                let (file, part) = (self.file(), self.stem.name());
                let minutes = music_limits::PART_SECONDS_MAX / 60.0;
                self.problems.push(format!(
                    "{file} is longer than {minutes:.0} minutes, so the part {part} is silent from there on: cut the \
                     song into shorter pieces"
                ));
                self.is_over = true;
            }
        }
    }

    /// Ends the track. Reports a length that differs from the song's.
    fn finish(&mut self, song: Option<f64>) {
        self.listener.finish();
        if let Some(song) = song.filter(|song| self.is_whole && (self.seconds() - song).abs() > SAME_LENGTH) {
            let (file, seconds) = (self.file(), self.seconds());
            self.problems.push(format!(
                "{file} lasts {seconds:.1} s, but its song lasts {song:.1} s: check that it is a stem of this song"
            ));
        }
    }

    fn file(&self) -> String {
        self.stem.path().file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// The numbers of a part, in the order in which scenes number them. The bands follow.
fn kept_numbers() -> Vec<KeptNumber> {
    let sounds = PartInput::sounds();
    sounds
        .map(|input| {
            let (least, most) = input.range();
            KeptNumber { name: input.name(), least, most }
        })
        .collect()
}

/// Starts a thread that reads the parts of tracks during a show. It calls `wake` after each track.
pub fn start_reader(cache: CachedFiles, wake: impl Fn() + Send + 'static) -> SongReader<Parts> {
    let find = move |track: &TrackInfo, go_on: &GoOn<'_>, publish: &dyn Fn(Parts)| {
        let Some(content) = &track.content else { return Some(None) };
        let (cut, duration) = (content.cut, track.duration);
        let song = SongOfParts { song: &content.song, cut, duration, scene_gain: track.scene_gain };
        Some(Some(song.read(&cache, go_on, publish)?))
    };
    SongReader::of("stems", "read the stems of songs", SONGS_KEPT, find, wake)
}

#[cfg(test)]
mod tests;
