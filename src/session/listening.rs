//! The user's control of the sound: pause, skips, track order, tapped tempo.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use image::RgbaImage;

use crate::clock;
use crate::config::{Choices, Folders};
use crate::covers;
use crate::demo_track::is_demo;
use crate::session::direction::Playing;
use crate::session::heard_parts::HeardParts;
use crate::session::sound::Sound;
use crate::session::waker::Waker;
use crate::song_shapes::{SongTexts, shown_title};
use crate::song_structures::{ReadSong, SongReader};
use crate::stems::{parts_cache, start_reader};
use crate::ui::overlay::OverlayContent;
use crate::ui::settings_panel::Facts;
use mariana_control::midi::ClockReading;
use mariana_music::{Features, LiveEnergy, Recent, SongMoment, SongStructure, TapTempo};
use mariana_player::track::{Repeat, TrackInfo};
use mariana_player::{Edit, LoudnessShape, Moment, Player, PlayerStatus};

const NO_SONG: &str = "this show listens to an input: start Mariana without --mic and --system to play files";

/// The sound, with everything known about it. Returned strings are messages for the user.
pub(crate) struct Listening {
    pub(crate) sound: Sound,
    /// Analyses whole tracks.
    songs: SongReader,
    pub(crate) parts: HeardParts,
    /// Finds the covers of tracks.
    covers: SongReader<RgbaImage>,
    /// Measures tracks for the seek bar.
    shapes: SongReader<LoudnessShape>,
    energy: LiveEnergy,
    taps: TapTempo,
    /// The last reading of a device's clock, which has priority over tapped beats.
    clock: Option<ClockReading>,
    /// The device's clock in seconds at the last update, and the time of that update.
    clock_now: (f64, Instant),
    /// True if the user has paused the sound. The initial wait for the first frame does not count.
    pub(crate) paused: bool,
    pub(crate) started: bool,
    /// Volume of the sound at the last call of `now`, 0..1.
    pub(crate) level: f32,
    playing: Playing,
    track: u64,
    painted: PaintedCover,
}

/// The cover of a song that has none: the track that plays, and the last painted cover with the name of its song.
#[derive(Default)]
struct PaintedCover {
    track: Option<Arc<TrackInfo>>,
    last: Option<(String, Arc<RgbaImage>)>,
}

impl PaintedCover {
    fn picture(&mut self) -> Arc<RgbaImage> {
        let name = self.track.as_ref().map_or("", |track| track.name.as_str());
        match &self.last {
            Some((known, picture)) if known == name => picture.clone(),
            _ => self.last.insert((name.to_owned(), Arc::new(covers::painted(name)))).1.clone(),
        }
    }
}

impl Listening {
    /// Starts the threads that read other data of songs than `songs`.
    pub(crate) fn start(sound: Sound, songs: SongReader, folders: &Folders, waker: &Waker) -> Self {
        let stems = start_reader(parts_cache(folders), waker.waking());
        let (energy, taps) = (LiveEnergy::default(), TapTempo::default());
        let (clock, clock_now) = (None, (0.0, clock::now()));
        Self {
            sound,
            songs,
            parts: HeardParts { reader: stems, wanted: false, found: None },
            covers: covers::start_reader(waker.waking()),
            shapes: SongReader::of_loudness(waker.waking()),
            energy,
            taps,
            clock,
            clock_now,
            paused: false,
            started: false,
            level: 0.0,
            playing: Playing::default(),
            track: 0,
            painted: PaintedCover::default(),
        }
    }

    /// Returns `true` if a song is running. An input does not count: the clock of an input stops in silence.
    pub(crate) fn runs(&mut self) -> bool {
        !self.paused && self.with_song(|player| !player.status().ended).unwrap_or_default()
    }

    pub(crate) fn follow_request(&mut self) {
        self.started = true;
        self.sound.set_paused(self.paused);
    }

    /// Applies `act` to the song. Returns `None` if another source plays.
    pub(crate) fn with_song<T>(&mut self, act: impl FnOnce(&mut Player) -> T) -> Option<T> {
        self.sound.player().map(act)
    }

    /// Switches between random order and list order. Returns a message; `None` while another source plays.
    pub(crate) fn toggle_shuffle(&mut self) -> Option<&'static str> {
        let player = self.sound.player()?;
        let PlayerStatus { repeat, shuffled, .. } = player.status();
        player.set_order(repeat, !shuffled);
        Some(if shuffled { "tracks in list order" } else { "tracks in random order" })
    }

    /// Chooses the part of the list that is repeated; `None` for the next choice. Returns a message; `None` while
    /// another source plays.
    pub(crate) fn set_repeat(&mut self, repeat: Option<Repeat>) -> Option<&'static str> {
        let player = self.sound.player()?;
        let status = player.status();
        let repeat = repeat.unwrap_or(match status.repeat {
            Repeat::All => Repeat::One,
            Repeat::One => Repeat::Off,
            Repeat::Off => Repeat::All,
        });
        player.set_order(repeat, status.shuffled);
        Some(match repeat {
            Repeat::All => "repeat all tracks",
            Repeat::One => "repeat this track",
            Repeat::Off => "end after the last track",
        })
    }

    /// Stops the current source and plays `files`, or appends them. Returns a message about appended files or errors.
    pub(crate) fn play_files(&mut self, files: Vec<PathBuf>, append: bool) -> Option<String> {
        if append {
            return Some(match &self.sound.player {
                Some(player) => {
                    player.edit(Edit::Append(files));
                    "added to the list of tracks".to_owned()
                }
                None => NO_SONG.to_owned(),
            });
        }
        match self.sound.listen_to_song() {
            Some(player) => {
                player.play_files(files);
                None
            }
            None => Some(NO_SONG.to_owned()),
        }
    }

    /// Notes a tapped beat at this moment. Returns a message with the resulting tempo.
    pub(crate) fn tap(&mut self) -> Option<String> {
        let Moment { song_time, .. } = self.sound.now()?;
        self.taps.tap(song_time);
        Some(match self.taps.at(song_time) {
            Some((tempo, _)) => format!("{tempo:.0} beats per minute"),
            None => "tap again to set the tempo".to_owned(),
        })
    }

    /// Sets the tempo in beats per minute; `None` restores the measured tempo. Returns a message.
    pub(crate) fn set_tempo(&mut self, tempo: Option<f64>) -> Option<String> {
        let Some(tempo) = tempo else {
            self.taps = TapTempo::default();
            return Some("the tempo follows the sound again".to_owned());
        };
        let Moment { song_time, .. } = self.sound.now()?;
        self.taps.set(tempo, song_time);
        let (least, most) = TapTempo::TEMPOS.into_inner();
        Some(match TapTempo::TEMPOS.contains(&tempo) {
            true => format!("{tempo:.0} beats per minute"),
            false => format!("{tempo:.0} beats per minute is out of range: send {least:.0} to {most:.0}"),
        })
    }

    /// Skips to the next or the previous track. Resets the tapped tempo, which belongs to the old track.
    pub(crate) fn skip(&mut self, forward: bool) {
        self.taps = TapTempo::default();
        let _ = self.with_song(|player| player.skip(forward));
    }

    pub(crate) fn choose_source(&mut self, place: usize) {
        self.taps = TapTempo::default();
        self.sound.choose_from_list(place);
    }

    pub(crate) fn next_source(&mut self) {
        self.taps = TapTempo::default();
        self.sound.next_source();
    }

    pub(crate) fn facts<'a>(&'a mut self, choices: &'a Choices, names_output: bool) -> Facts<'a> {
        let outputs = self.sound.outputs();
        Facts {
            choices,
            remembered: &self.sound.kept.settings().choices,
            outputs,
            monitors: Vec::new(),
            output_for_this_run: names_output,
            shift: self.sound.shift_ms(),
            device: self.sound.device.as_ref().map(|device| &*device.name),
        }
    }

    /// The current sound, with its position in the song and the tapped tempo. For a track that is not yet analysed, the
    /// song data contain only the energy; for an input, also what is heard of the bar, harmony and form.
    pub(crate) fn now(&mut self) -> Option<Moment> {
        let mut now = self.sound.now()?;
        self.track = now.track;
        now.song = match self.read_song(now.track) {
            Some(song) => {
                now.features.follow_song(&song.structure, now.song_time);
                song.moment(now.song_time)
            }
            None => {
                let energy = self.energy.at(now.song_time, now.features.level_db);
                let heard = SongMoment::of_live(energy, &now.features);
                // Drop the measured bar after taps: it does not match the tapped beats.
                let is_tapped = self.taps.at(now.song_time).is_some();
                let SongMoment { bar, beat_in_bar, to_beat, to_bar, .. } = SongMoment::UNKNOWN;
                if is_tapped { SongMoment { bar, beat_in_bar, to_beat, to_bar, ..heard } } else { heard }
            }
        };
        self.taps.apply(now.song_time, &mut now.features);
        self.apply_clock(&mut now);
        let [left, right] = now.features.volume;
        self.level = left.max(right).clamp(0.0, 1.0);
        Some(now)
    }

    /// The sound of an earlier moment of the track that [`Listening::now`] returned last, as far as it is known. `now`
    /// is that moment; the numbers of an input's form stay as they are there. `remembers` adds the seconds before.
    pub(crate) fn earlier(&self, now: &Moment, song_time: f64, remembers: bool) -> mariana_music::Sound {
        let mut sound = self.sound.heard_at(song_time);
        sound.song = self.placed(now, song_time, &mut sound.features);
        sound.parts = self.parts(Moment { song_time, ..*now });
        if remembers {
            sound.recent = self.recent(now, song_time);
        }
        sound
    }

    /// The sound of the last seconds before such a moment.
    pub(crate) fn recent(&self, now: &Moment, song_time: f64) -> Arc<[Recent]> {
        let recent = self.sound.recent(song_time).into_iter();
        let is_of_song = |one: &Recent| one.age <= song_time || !self.sound.plays_song();
        let placed = |mut one: Recent| {
            let then = song_time - one.age;
            one.song = self.placed(now, then, &mut one.features);
            one.parts = self.parts(Moment { song_time: then, ..*now });
            one
        };
        recent.filter(is_of_song).map(placed).collect()
    }

    /// Adds to `features` what is known of an earlier moment, and returns its place in the song.
    fn placed(&self, now: &Moment, song_time: f64, features: &mut Features) -> SongMoment {
        let song = match self.read_song(now.track) {
            Some(song) => {
                features.follow_song(&song.structure, song_time);
                song.moment(song_time)
            }
            None => now.song,
        };
        self.taps.apply(song_time, features);
        song
    }

    /// Returns true when the parts of the current song become known. Then reports problems with its stems.
    pub(crate) fn parts_arrive(&mut self) -> bool {
        if !self.sound.plays_song() {
            return false;
        }
        let Some(parts) = self.parts.arrived(self.track) else { return false };
        parts.problems.iter().for_each(|problem| self.sound.report(problem));
        true
    }

    /// Returns the numbers of the song's parts at a moment; none for an input, and while they are unknown.
    pub(crate) fn parts(&self, moment: Moment) -> Vec<f32> {
        if self.sound.plays_song() { self.parts.at(moment.track, moment.song_time) } else { Vec::new() }
    }

    /// Follows the `clock` of a device: a reading and the device's time in seconds. `None` stops following.
    pub(crate) fn set_clock(&mut self, clock: Option<(ClockReading, f64)>) {
        self.clock = clock.map(|(reading, _)| reading);
        self.clock_now = (clock.map_or(0.0, |(_, now)| now), clock::now());
    }

    fn apply_clock(&self, now: &mut Moment) {
        let (seconds, at) = self.clock_now;
        let seconds = seconds + clock::since(at).as_secs_f64();
        let Some((reading, (phase, number))) =
            self.clock.and_then(|reading| Some((reading, reading.phase_at(seconds)?)))
        else {
            return;
        };
        (now.features.tempo, now.features.phase) = (reading.tempo as f32, phase);
        if reading.knows_bar {
            (now.features.bar_beat, now.features.bar_beats) =
                ((number + 1) as f32, ClockReading::BEATS as f32);
            let bar = (number as f32 + phase) / ClockReading::BEATS as f32;
            (now.song.bar, now.song.beat_in_bar) = (bar, (number + 1) as f32);
        }
    }

    /// The state of the song, if it is the current source. Requests the analysis of this track and the next.
    pub(crate) fn song_status(&mut self) -> Option<PlayerStatus> {
        let status = self.sound.song_status()?;
        let content = status.track.content.as_ref();
        let is_demo = content.is_some_and(|content| is_demo(&content.song));
        self.playing = if is_demo { Playing::Demo } else { Playing::Song };
        let tracks = || [&status.track].into_iter().chain(&status.next);
        self.songs.request(tracks());
        self.covers.request(tracks());
        self.parts.request(tracks());
        self.painted.track = Some(status.track.clone());
        Some(PlayerStatus { paused: self.paused, ..status })
    }

    pub(crate) fn playing(&self) -> Playing {
        if self.sound.plays_song() { self.playing } else { Playing::Input }
    }

    pub(crate) fn present_structure(&self) -> Option<Arc<SongStructure>> {
        self.structure(self.track)
    }

    /// The cover of the track that plays, at most 256 pixels wide and high, once it is decoded.
    pub(crate) fn cover(&self) -> Option<Arc<RgbaImage>> {
        if self.sound.plays_song() { self.covers.get(self.track) } else { None }
    }

    /// The loudness of the current track, or of its measured part. The first call starts the measurement.
    pub(crate) fn shape(&self) -> Option<Arc<LoudnessShape>> {
        let track = self.painted.track.as_ref().filter(|_| self.sound.plays_song())?;
        self.shapes.request([track]);
        self.shapes.get(track.id)
    }

    /// The cover of the track that plays, or a painted one.
    pub(crate) fn cover_or_painted(&mut self) -> Arc<RgbaImage> {
        self.cover().unwrap_or_else(|| self.painted.picture())
    }

    /// The texts of the track that plays; empty for other sources.
    pub(crate) fn song_texts(&self) -> SongTexts {
        let Some(track) = self.painted.track.as_ref().filter(|_| self.sound.plays_song()) else {
            return SongTexts::default();
        };
        let known = self.read_song(track.id);
        SongTexts {
            title: shown_title(track.title.as_deref(), &track.name),
            artist: track.artist.clone().unwrap_or_default(),
            lyrics: known.map(|song| song.lyrics.clone()).unwrap_or_default(),
        }
    }

    pub(crate) fn track_of(&self, moment: Moment) -> Option<u64> {
        self.sound.plays_song().then_some(moment.track)
    }

    pub(crate) fn structure(&self, track: u64) -> Option<Arc<SongStructure>> {
        Some(self.read_song(track)?.structure.clone())
    }

    /// What is known of a whole track; `None` while another source plays.
    fn read_song(&self, track: u64) -> Option<Arc<ReadSong>> {
        if self.sound.plays_song() { self.songs.get(track) } else { None }
    }

    /// Adds the hints and the source list to the overlay. `stays_open` is true while the user keeps the list open.
    pub(crate) fn show_in<'a>(&'a self, content: &mut OverlayContent<'a>, stays_open: bool, now: Instant) {
        content.hint = self.sound.hint().or(content.hint);
        content.sources = self.sound.list(stays_open, now);
    }
}
