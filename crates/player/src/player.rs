//! Playback of tracks: the handle that the window holds.
//!
//! Every method returns at once: whatever takes time happens on the threads that [`Player::start`] starts.
//!
//! **Tracks join in the stream.** The list thread (`player::listing`) opens the next track while the current one
//! plays, so neither a slow disk nor a list of missing files keeps the sound waiting. The frames of the next track go
//! into the same ring of the same segment, through the same resampler if the rate is the same: not a sample is added
//! or lost, and a filter never sees an edge that is not in the music. For another rate the resampler is flushed and a
//! new one goes on. Frames still waiting in the ring count as not played: a seek is within the track that is heard,
//! whose decoder is kept until then.

mod analysis;
mod audible;
mod decoding;
mod filling;
mod listing;
mod missed_audio;
mod position;
mod shape;
mod threads;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{channel, sync_channel};
use std::time::Instant;

use super::audible_segments::SharedAudibleSegments;
use super::device::Target;
use super::device_list::ListedDevice;
use super::error::PlayerError;
use super::gain_switch::GainSwitch;
use super::listed::{Edit, ListedTrack, ListedTracks, SharedListing};
pub use super::output::OutputChoice;
use super::output::{Controls, Counters, OutputRequest, Supervisor};
use super::source::FrameSource;
use super::track::{OneTrack, Repeat, Track, TrackInfo, TrackList};
use super::worker::Worker;
use audible::AudibleMoment;
pub use audible::Moment;
use decoding::{Command, Decoding};
pub use listing::TrackErrors;
use listing::{Request, SharedTrackErrors};
use mariana_music::limits::LIMITS as MUSIC_LIMITS;
use mariana_music::{Gain, Sound};
pub use missed_audio::{MissedAudio, SilenceEnd};
pub use position::Position;
pub use shape::LoudnessShape;
use shape::Shapes;
use threads::Threads;

/// Pieces that may wait for the analysis.
const ANALYSIS_QUEUE: usize = 32;

/// How to play.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerOptions {
    /// The output device.
    pub target: Target,
    /// What follows the last track and each track; the list must be told the same.
    pub repeat: Repeat,
    /// Whether the order is random; the list must be told the same.
    pub shuffled: bool,
    /// 0 to 1.
    pub volume: f32,
    /// Start paused.
    pub paused: bool,
    /// A device or the silent clock.
    pub output: OutputChoice,
    /// Whether quiet and loud songs move a picture alike.
    pub gain: Gain,
}

impl Default for PlayerOptions {
    fn default() -> Self {
        Self {
            target: Target::Default,
            repeat: Repeat::All,
            shuffled: false,
            volume: 1.0,
            paused: false,
            output: OutputChoice::Auto,
            gain: Gain::Auto,
        }
    }
}

/// The state of playback.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerStatus {
    /// The audible track.
    pub track: Arc<TrackInfo>,
    /// The track that was opened to follow the one that is decoded; none if it is not open yet, or nothing follows but
    /// the same track again.
    pub next: Option<Arc<TrackInfo>>,
    /// The audible position in the track, in seconds.
    pub position: f64,
    /// What follows the last track, and each one.
    pub repeat: Repeat,
    /// Whether the order is random.
    pub shuffled: bool,
    /// Whether playback is paused.
    pub paused: bool,
    /// 0 to 1.
    pub volume: f32,
    /// Whether it is muted: it runs without sound.
    pub muted: bool,
    /// Whether the last frame was heard (and shown, if the picture is shifted) and nothing follows.
    pub ended: bool,
    /// The output in words.
    pub output: String,
    /// The output device, if one is open.
    pub device: Option<ListedDevice>,
    /// Why there is no sound, if the song runs on the silent clock.
    pub silent: Option<String>,
    /// Why the output that was chosen last is not open, while the one before goes on.
    pub refused: Option<String>,
    /// Stretches of silence because samples came too late.
    pub underruns: u64,
    /// Calls of the callback.
    pub callbacks: u64,
    /// The longest call relative to the duration of its buffer: 0.1 is a tenth.
    pub worst_callback_load: f64,
    /// The load that all but one in a thousand calls stay below, in steps of 0.01.
    pub usual_callback_load: f64,
    /// What went wrong with tracks.
    pub track_errors: TrackErrors,
    /// Parts of the song that nobody heard because devices went and came.
    pub missed_audio: MissedAudio,
}

/// Tracks that play. Dropping it ends the sound and the threads, within a limit.
pub struct Player {
    // First, so that the threads end before what they use.
    threads: Threads,
    controls: Arc<Controls>,
    counters: Arc<Counters>,
    gain: GainSwitch,
    /// The track that was last audible, where it stands in the list now.
    track: Arc<TrackInfo>,
    listing: SharedListing,
    shapes: Shapes,
    repeat: Repeat,
    shuffled: bool,
    track_errors: SharedTrackErrors,
    position: Position,
    audible: AudibleMoment,
}

impl Player {
    /// Starts to play `first`, and then what `list` gives. The device opens meanwhile; if that fails, the song runs
    /// on the silent clock and [`PlayerStatus::silent`] says why.
    ///
    /// # Errors
    /// If the track's rate is beyond the limits or a thread cannot be started.
    pub fn start(
        first: Track,
        mut list: Box<dyn TrackList>,
        options: PlayerOptions,
    ) -> Result<Self, PlayerError> {
        let rate = first.source.sample_rate();
        let (min, max) = (MUSIC_LIMITS.sample_rate_min, MUSIC_LIMITS.sample_rate_max);
        if !(min..=max).contains(&rate) {
            return Err(PlayerError::SampleRate { rate, min, max });
        }
        let track = first.info.clone();
        let listing = SharedListing::default();
        listing.tell(std::iter::once((track.id, ListedTrack::from(&*track))));
        list.fraction(listing.clone());
        let controls = Arc::new(Controls::new(options.volume, options.paused));
        let counters = Arc::new(Counters::default());
        let audible_segments = SharedAudibleSegments::default();
        let track_errors = SharedTrackErrors::default();
        let (to_analysis, analysis_inbox) = sync_channel(ANALYSIS_QUEUE);
        let gain = GainSwitch::new(options.gain);
        let (notes, of_analysis) = (audible_segments.clone(), gain.clone());
        let analyse = move || analysis::run(&analysis_inbox, rate, &of_analysis, &notes);
        let analysis = Worker::spawn("analysis", analyse)?;
        let (commands, inbox) = channel();
        let (to_list, requests) = channel::<Request>();
        let (answers, reported) = (commands.clone(), track_errors.clone());
        let list_thread = Worker::spawn("list", move || listing::run(list, &requests, &answers, &reported))?;
        let work = Decoding::new(first, to_list, audible_segments.clone(), to_analysis, track_errors.clone());
        let decoding = Worker::spawn("decoding", move || work.run(&inbox))?;
        let request = OutputRequest { choice: options.output, target: options.target, silent_rate: rate };
        let outputs = commands.clone();
        // If the decoding thread has ended, so has the playback.
        let deliver = move |link| drop(outputs.send(Command::Output { link, at: Instant::now() }));
        let supervisor = Supervisor::start(request, controls.clone(), counters.clone(), deliver)?;
        let outputs = supervisor.watch();
        Ok(Self {
            controls,
            counters,
            position: Position::new(outputs.clone(), audible_segments.clone(), track.clone()),
            audible: AudibleMoment::new(outputs, audible_segments, track.id),
            threads: Threads {
                commands,
                supervisor: Some(supervisor),
                decoding,
                analysis,
                list: list_thread,
            },
            gain,
            track,
            listing,
            shapes: Shapes::default(),
            repeat: options.repeat,
            shuffled: options.shuffled,
            track_errors,
        })
    }

    /// Starts to play a source that does not belong to a list.
    ///
    /// # Errors
    /// See [`Player::start`].
    pub fn start_alone(source: Box<dyn FrameSource>, options: PlayerOptions) -> Result<Self, PlayerError> {
        Self::start(Track::alone(source), Box::new(OneTrack(options.repeat)), options)
    }

    /// Pauses (true) or resumes (false).
    pub fn set_paused(&self, paused: bool) {
        self.controls.set_paused(paused);
    }

    /// Seeks by `seconds` from what is audible, or from the target of a seek that is not heard yet, but not before
    /// the track's start. Past the end the next track follows. A value that is not finite is ignored.
    pub fn seek_by(&self, seconds: f64) {
        self.threads.send(Command::SeekBy(seconds));
    }

    /// Seeks to a time of the track, in seconds; clamped like [`Player::seek_by`].
    pub fn seek_to(&self, seconds: f64) {
        self.threads.send(Command::SeekTo(seconds));
    }

    /// Goes to the next track or to the previous one; going back later than 3 s into a track leads to its own start.
    pub fn skip(&self, forward: bool) {
        self.threads.send(Command::Skip { forward });
    }

    /// Plays these files, folders or lists instead of the current list, if something in them can be played.
    pub fn play_files(&self, files: Vec<PathBuf>) {
        self.threads.send(Command::Files(files));
    }

    /// Changes the order and the repeating of tracks.
    pub fn set_order(&mut self, repeat: Repeat, shuffled: bool) {
        (self.repeat, self.shuffled) = (repeat, shuffled);
        self.threads.send(Command::Order(repeat, shuffled));
    }

    /// The list as it is now. This is cheap enough to be asked for each picture, however long the list is.
    pub fn playlist(&self) -> Arc<ListedTracks> {
        self.listing.tracks()
    }

    /// How loud the track that [`Player::status`] told last is from its start to its end, as far as is known. It becomes
    /// known while this is asked for, a little at a time; nothing is done before it is asked for once. None while
    /// nothing is known, and for tracks of unknown length, of more than the limits' `shape_seconds_max`, or that cannot
    /// be opened twice.
    pub fn shape(&self) -> Option<Arc<LoudnessShape>> {
        self.shapes.of(&self.track)
    }

    /// Plays the track at this index of the list from its start, or the next one that can be played. An index beyond
    /// the list is ignored.
    pub fn play_entry(&self, entry: usize) {
        self.threads.send(Command::PlayEntry(entry));
    }

    /// Moves the entry at index `from` so that it is at index `to`; what plays goes on. Indices beyond the list are
    /// ignored. Changes are carried out one after the other: indices are those of the list after all changes before.
    pub fn move_entry(&self, from: usize, to: usize) {
        self.threads.send(Command::Edit(Edit::Move { from, to }));
    }

    /// Removes an entry; see [`Player::move_entry`]. If it plays, the one that follows plays instead, and silence if
    /// none does.
    pub fn remove_entry(&self, entry: usize) {
        self.threads.send(Command::Edit(Edit::Remove(entry)));
    }

    /// Appends these files, or what these folders and lists hold, to the list. A list that had ended goes on with them;
    /// a random order has them among the tracks that are still to come.
    pub fn append_files(&self, files: Vec<PathBuf>) {
        self.threads.send(Command::Edit(Edit::Append(files)));
    }

    /// Plays on another output from now on; the present one goes on until that one is open. A song without a device
    /// on purpose has one from then on.
    pub fn choose_output(&self, target: Target) {
        if let Some(supervisor) = &self.threads.supervisor {
            supervisor.choose(target);
        }
    }

    /// Levels the sound for the picture from now on, or no longer. It shows within half a second, because the analysis
    /// is ahead of the sound.
    pub fn set_gain(&self, gain: Gain) {
        self.gain.set(gain);
    }

    /// Changes the volume by `delta`; the result is clamped to 0 to 1.
    pub fn change_volume(&self, delta: f32) {
        self.controls.set_volume(self.controls.volume() + delta);
    }

    /// Sets the volume, clamped to 0 to 1.
    pub fn set_volume(&self, volume: f32) {
        self.controls.set_volume(volume);
    }

    /// Mutes or unmutes; the song runs on.
    pub fn toggle_mute(&self) {
        self.controls.set_muted(!self.controls.muted());
    }

    /// The present state of playback.
    pub fn status(&mut self) -> PlayerStatus {
        let output = self.threads.supervisor.as_ref().map(Supervisor::status).unwrap_or_default();
        let place = self.position.look();
        self.track = place.track;
        let (ended, next) = self.audible.end_and_next(output.history.as_ref());
        self.find_place();
        PlayerStatus {
            track: self.track.clone(),
            next,
            position: place.seconds,
            repeat: self.repeat,
            shuffled: self.shuffled,
            paused: self.controls.paused(),
            volume: self.controls.volume(),
            muted: self.controls.muted(),
            ended,
            output: output.description,
            device: output.device,
            silent: output.silent,
            refused: output.refused,
            underruns: self.counters.underruns.load(Ordering::Relaxed),
            callbacks: self.counters.callbacks.load(Ordering::Relaxed),
            worst_callback_load: self.counters.worst_load_millionths.load(Ordering::Relaxed) as f64 / 1e6,
            usual_callback_load: self.counters.load_of(0.999),
            track_errors: self.track_errors.get(),
            missed_audio: place.missed_audio,
        }
    }

    /// The audible position, for other threads.
    pub fn position(&self) -> Position {
        self.position.clone()
    }

    /// What is audible now. `latency_shift` seconds (within the limits' `latency_ms_max`) are added to the latency
    /// that the device reports: a positive shift where the sound is heard later than the device knows. A negative one
    /// looks ahead, as far as is decoded (0.3 to 0.4 s).
    pub fn now(&mut self, latency_shift: f64) -> Moment {
        self.audible.now(latency_shift)
    }

    /// The sound, with its tables, of the moment that [`Player::now`] returned last.
    pub fn sound(&self) -> Sound {
        self.audible.sound()
    }

    /// Notes where the audible track stands in the list now. A track of a list that was replaced stays as it was.
    fn find_place(&mut self) {
        if let Some((entry, count)) = self.listing.place(self.track.id)
            && (entry, count) != (self.track.entry, self.track.count)
        {
            let info = Arc::make_mut(&mut self.track);
            (info.entry, info.count) = (entry, count);
        }
    }
}

#[cfg(test)]
mod device_tests;
#[cfg(test)]
mod list_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod track_tests;
