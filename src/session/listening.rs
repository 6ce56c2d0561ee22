//! What is listened to, as the user steers it: pause, skips, the order of tracks, the tapped tempo.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::clock;
use crate::config::{Choices, Settings};
use crate::demo_track::is_demo;
use crate::session::announcer::{TrackOrder, words_of};
use crate::session::direction::Playing;
use crate::session::sound::Sound;
use crate::song_structures::SongReader;
use crate::ui::overlay::OverlayContent;
use crate::ui::settings_panel::Facts;
use mariana_control::midi::ClockReading;
use mariana_music::{Gain, LiveEnergy, SongMoment, SongStructure, Tables, TapTempo};
use mariana_player::input::LiveStatus;
use mariana_player::{Moment, Player, PlayerStatus};

/// What is said of files in a show that began with an input.
const NO_SONG: &str = "this show listens to an input: start Mariana without --mic and --system to play files";

/// See the module. What it returns in words is for the user to read.
pub(crate) struct Listening {
    sound: Sound,
    /// What listens to whole tracks; none without a thread for it.
    songs: Option<SongReader>,
    /// The energy of what is not known as a whole.
    energy: LiveEnergy,
    /// The tempo tapped by hand.
    taps: TapTempo,
    /// The clock of a device; it comes before taps.
    clock: Option<ClockReading>,
    /// Its seconds when it was last looked at, and that moment.
    clock_now: (f64, Instant),
    /// What the user wants; until the first picture the player waits in any case.
    paused: bool,
    /// Set by the first picture.
    started: bool,
    /// How loud it was at the last look, 0..1.
    level: f32,
    /// The kind of song in the latest status.
    playing: Playing,
    /// The number of the track that was heard last.
    track: u64,
}

impl Listening {
    /// Begins with a sound that waits for the first picture.
    pub(crate) fn new(sound: Sound, songs: Option<SongReader>) -> Self {
        let (energy, taps) = (LiveEnergy::default(), TapTempo::default());
        let (clock, clock_now) = (None, (0.0, clock::now()));
        Self {
            sound,
            songs,
            energy,
            taps,
            clock,
            clock_now,
            paused: false,
            started: false,
            level: 0.0,
            playing: Playing::default(),
            track: 0,
        }
    }

    /// Whether the user wants a pause.
    pub(crate) fn is_paused(&self) -> bool {
        self.paused
    }

    /// Returns `true` once the first picture has let the sound begin.
    pub(crate) fn has_started(&self) -> bool {
        self.started
    }

    /// Whether a song goes on. An input may fall silent at any time, and its time with it.
    pub(crate) fn runs(&mut self) -> bool {
        !self.paused && self.with_song(|player| !player.status().ended).unwrap_or_default()
    }

    /// Notes whether the user wants a pause.
    pub(crate) fn want_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Pauses the sound or lets it run, as the user wants.
    pub(crate) fn follow_request(&mut self) {
        self.started = true;
        self.sound.set_paused(self.paused);
    }

    /// Does something with the song, if it is what is listened to; else there is nothing to return.
    pub(crate) fn with_song<T>(&mut self, act: impl FnOnce(&mut Player) -> T) -> Option<T> {
        self.sound.player().map(act)
    }

    /// Changes the order of the tracks and says how; does nothing while another source is listened to.
    pub(crate) fn set_order(&mut self, change: impl FnOnce(TrackOrder) -> TrackOrder) -> Option<String> {
        let player = self.sound.player()?;
        let status = player.status();
        let before = TrackOrder { repeat: status.repeat, shuffled: status.shuffled };
        let after = change(before);
        player.set_order(after.repeat, after.shuffled);
        Some(words_of(before, after).to_owned())
    }

    /// Plays files instead of what was listened to, or says why not. If they are to follow the tracks that are there,
    /// it says that they do.
    pub(crate) fn play_files(&mut self, files: Vec<PathBuf>, append: bool) -> Option<String> {
        if append {
            return Some(match self.sound.song() {
                Some(player) => {
                    player.append_files(files);
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

    /// Takes this moment as a beat, and says which tempo that makes.
    pub(crate) fn tap(&mut self) -> Option<String> {
        let Moment { song_time, .. } = self.sound.now()?;
        self.taps.tap(song_time);
        Some(match self.taps.at(song_time) {
            Some((tempo, _)) => format!("{tempo:.0} beats per minute"),
            None => "tap again to set the tempo".to_owned(),
        })
    }

    /// Sets the tempo in beats per minute, or gives it back to what is heard, and says so.
    pub(crate) fn set_tempo(&mut self, tempo: Option<f64>) -> Option<String> {
        let Some(tempo) = tempo else {
            self.taps = TapTempo::default();
            return Some("the tempo is that of the sound again".to_owned());
        };
        let Moment { song_time, .. } = self.sound.now()?;
        self.taps.set(tempo, song_time);
        let (least, most) = TapTempo::TEMPOS.into_inner();
        Some(match TapTempo::TEMPOS.contains(&tempo) {
            true => format!("{tempo:.0} beats per minute"),
            false => format!("{tempo:.0} beats per minute are no tempo: send {least:.0} to {most:.0}"),
        })
    }

    /// Goes to the next track, or back. A tapped tempo belonged to the track before, so it is forgotten.
    pub(crate) fn skip(&mut self, forward: bool) {
        self.taps = TapTempo::default();
        let _ = self.with_song(|player| player.skip(forward));
    }

    /// Listens to a source of the list that shows. A tapped tempo belonged to the one before, so it is forgotten.
    pub(crate) fn choose_source(&mut self, place: usize) {
        self.taps = TapTempo::default();
        self.sound.choose_from_list(place);
    }

    /// Shows the list of sources.
    pub(crate) fn show_sources(&mut self) {
        self.sound.show_list();
    }

    /// Listens to the next source. A tapped tempo belonged to the one before, so it is forgotten.
    pub(crate) fn next_source(&mut self) {
        self.taps = TapTempo::default();
        self.sound.next_source();
    }

    /// Shows the picture later by this many steps, and says how late that is.
    pub(crate) fn shift(&mut self, steps: f64) -> String {
        self.sound.shift(steps)
    }

    /// Shifts the picture to so many milliseconds; `settled` if they are to be remembered for the device.
    pub(crate) fn shift_to(&mut self, shift: f64, settled: bool) {
        self.sound.shift_to(shift, settled);
    }

    /// Plays songs on the output with this id, or on the system's default.
    pub(crate) fn choose_output(&mut self, id: Option<String>) {
        self.sound.choose_output(id);
    }

    /// Levels the sound for the picture from now on, or no longer.
    pub(crate) fn set_gain(&mut self, gain: Gain) {
        self.sound.set_gain(gain);
    }

    /// What the panel of settings shows, while these choices hold in this run.
    pub(crate) fn facts<'a>(&'a mut self, choices: &'a Choices, names_output: bool) -> Facts<'a> {
        let outputs = self.sound.outputs();
        Facts {
            choices,
            remembered: &self.sound.settings().choices,
            outputs,
            monitors: Vec::new(),
            output_for_this_run: names_output,
            shift: self.sound.shift_ms(),
            device: self.sound.device_name(),
        }
    }

    /// What is wrong with settings and devices since the last call.
    pub(crate) fn take_reported_problems(&mut self) -> Vec<String> {
        self.sound.take_reported_problems()
    }

    /// What is heard now, with its place in the song, and with the tapped tempo. Of an input the energy is known, and the
    /// bar where it is sure; of a track that was not listened to yet, only the energy.
    pub(crate) fn now(&mut self) -> Option<Moment> {
        let mut now = self.sound.now()?;
        self.track = now.track;
        let songs = self.songs.as_ref().filter(|_| self.sound.plays_song());
        now.song = match songs.and_then(|songs| songs.get(now.track)) {
            Some(structure) => structure.moment(now.song_time),
            None => {
                let energy = self.energy.at(now.song_time, now.features.level_db);
                let heard = SongMoment::of_live(energy, &now.features);
                // A bar that is heard does not go with a beat that is tapped.
                let is_tapped = self.taps.at(now.song_time).is_some();
                if is_tapped { SongMoment { energy, ..SongMoment::UNKNOWN } } else { heard }
            }
        };
        self.taps.apply(now.song_time, &mut now.features);
        self.apply_clock(&mut now);
        let [left, right] = now.features.volume;
        self.level = left.max(right).clamp(0.0, 1.0);
        Some(now)
    }

    /// Follows the clock of a device from now on, which says this at these seconds of it; or none.
    pub(crate) fn set_clock(&mut self, clock: Option<(ClockReading, f64)>) {
        self.clock = clock.map(|(reading, _)| reading);
        self.clock_now = (clock.map_or(0.0, |(_, now)| now), clock::now());
    }

    /// Replaces tempo, phase and bar by those of the clock, if there is one.
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

    /// How loud it was when [`Listening::now`] was last asked, 0..1.
    pub(crate) fn level(&self) -> f32 {
        self.level
    }

    /// The curves of the sound at the moment that [`Listening::now`] last returned.
    pub(crate) fn curves(&self) -> Tables {
        self.sound.heard().tables
    }

    /// What is remembered from run to run.
    pub(crate) fn settings(&self) -> &Settings {
        self.sound.settings()
    }

    /// Keeps a list of tracks for the next show, or none.
    pub(crate) fn keep_tracks(&mut self, tracks: Option<Vec<PathBuf>>) {
        self.sound.keep_tracks(tracks);
    }

    /// Remembers a change of it.
    pub(crate) fn remember(&mut self, change: impl Fn(&mut Settings) + Send + 'static) {
        self.sound.remember(change);
    }

    /// The state of the song, if it is what is listened to. What plays and what follows will be known.
    pub(crate) fn song_status(&mut self) -> Option<PlayerStatus> {
        let status = self.sound.song_status()?;
        let content = status.track.reopen.content();
        let is_demo = content.is_some_and(|content| is_demo(&content.song));
        self.playing = if is_demo { Playing::Demo } else { Playing::Song };
        if let Some(songs) = &self.songs {
            songs.want([&status.track].into_iter().chain(&status.next));
        }
        Some(PlayerStatus { paused: self.paused, ..status })
    }

    /// The source of the sound.
    pub(crate) fn playing(&self) -> Playing {
        if self.sound.plays_song() { self.playing } else { Playing::Input }
    }

    /// What is known of the whole track that was heard last.
    pub(crate) fn present_structure(&self) -> Option<Arc<SongStructure>> {
        self.structure(self.track)
    }

    /// The number of the track that is heard at a moment; none if it is an input.
    pub(crate) fn track_of(&self, moment: Moment) -> Option<u64> {
        self.sound.plays_song().then_some(moment.track)
    }

    /// What is known of a whole track, by its number; nothing of an input.
    pub(crate) fn structure(&self, track: u64) -> Option<Arc<SongStructure>> {
        self.songs.as_ref().filter(|_| self.sound.plays_song())?.get(track)
    }

    /// The state of the input, if one is listened to.
    pub(crate) fn live_status(&mut self) -> Option<LiveStatus> {
        self.sound.live_status()
    }

    /// Adds what there is to show of the sources; `clips` while the user keeps their list open.
    pub(crate) fn show_in<'a>(&'a self, content: &mut OverlayContent<'a>, clips: bool, now: Instant) {
        content.hint = self.sound.hint().or(content.hint);
        content.sources = self.sound.list(clips, now);
    }
}
