//! Playback of tracks: [`Player`], the handle that the window holds. All methods return at once; slow work runs on
//! the threads that [`Player::start`] starts.
//!
//! **Gapless tracks.** The list thread (`player::listing`) opens the next track while the current track plays. The next
//! track's frames enter the same ring of the same segment. At the same sample rate they also pass the same resampler,
//! so that no sample is added or lost. At another rate the resampler is flushed and replaced. Frames that still wait in
//! the ring count as not played: a seek applies to the track that is heard, whose decoder is kept until its last frame
//! was heard.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::time::{Duration, Instant};

use mariana_music::{Gain, Recent, Sound};

use super::audible_segments::SharedAudibleSegments;
use super::device::Target;
use super::device_list::ListedDevice;
use super::error::PlayerError;
use super::gain_switch::GainSwitch;
use super::listed::{Edit, ListedTrack, ListedTracks, SharedListing};
use super::output::{Controls, OutputPort};
use super::track::{Repeat, Track, TrackInfo, TrackList};
use crate::output::Supervisor;
use audible::AudibleMoment;
use decoding::{Command, Decoding};
use listing::{Request, SharedTrackErrors};
use mariana_work::Background;
use position::Place;

mod analysis;
mod audible;
mod decoding;
mod filling;
mod listing;
mod missed_audio;
mod position;

pub use audible::Moment;
pub use listing::TrackErrors;
pub use missed_audio::{MissedAudio, SilenceEnd};
pub use position::Position;

const ANALYSIS_QUEUE: usize = 32;

/// The time that the decoding has to end. A decoder may wait for a slow disk.
const DECODING_END_LIMIT: Duration = Duration::from_secs(1);

/// The time that the analysis and the list each have to end, once the decoding has ended or is abandoned.
const END_LIMIT: Duration = Duration::from_millis(100);

/// The settings of a new player.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerOptions {
    /// The output to play on; `None` plays on the silent clock.
    pub output: Option<Target>,
    /// The repeat mode. The list must have the same repeat mode.
    pub repeat: Repeat,
    /// True for a random order. The list must have the same setting.
    pub shuffled: bool,
    /// The volume, 0 to 1.
    pub volume: f32,
    /// True to start paused.
    pub paused: bool,
    /// The gain control, so that quiet and loud songs can move a scene in the same way.
    pub gain: Gain,
}

impl Default for PlayerOptions {
    fn default() -> Self {
        Self {
            output: Some(Target::Default),
            repeat: Repeat::All,
            shuffled: false,
            volume: 1.0,
            paused: false,
            gain: Gain::Auto,
        }
    }
}

/// The state of playback.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerStatus {
    /// The track that is audible.
    pub track: Arc<TrackInfo>,
    /// The next track, if it is already open and differs from the track that is being decoded.
    pub next: Option<Arc<TrackInfo>>,
    /// The audible position in the track, in seconds.
    pub position: f64,
    /// The repeat mode.
    pub repeat: Repeat,
    /// True if the order is random.
    pub shuffled: bool,
    /// True if playback is paused.
    pub paused: bool,
    /// The volume, 0 to 1.
    pub volume: f32,
    /// True if playback is muted. The song continues silently.
    pub muted: bool,
    /// True if the last frame was heard (and shown, if the image is delayed) and no track follows.
    pub ended: bool,
    /// The output device, if one is open.
    pub device: Option<ListedDevice>,
    /// The reason for the silence, if the song runs on the silent clock.
    pub silent: Option<String>,
    /// The reason why the chosen output could not be opened, while the previous output continues.
    pub refused: Option<String>,
    /// Number of gaps in the sound because samples were too late.
    pub underruns: u64,
    /// Errors of tracks.
    pub track_errors: TrackErrors,
    /// Parts of the song that were not heard because of device changes.
    pub missed_audio: MissedAudio,
}

/// A player of tracks. Dropping the player ends the sound and the threads, within a time limit.
pub struct Player {
    // The fields are dropped in this order: the supervisor ends first, and the threads before the data that they use.
    commands: Sender<Command>,
    supervisor: Supervisor,
    /// The threads of the decoding, of the analysis and of the list. The other two end when the decoding ends.
    _of_song: [Background; 3],
    controls: Arc<Controls>,
    gain: GainSwitch,
    listing: SharedListing,
    repeat: Repeat,
    shuffled: bool,
    track_errors: SharedTrackErrors,
    position: Position,
    audible: AudibleMoment,
}

impl Player {
    /// Starts to play `first`, followed by the tracks of `list`. The device opens in the background. If it cannot be
    /// opened, the song runs on the silent clock and [`PlayerStatus::silent`] gives the reason.
    ///
    /// # Errors
    /// Fails if a thread cannot be started.
    pub fn start(
        first: Track,
        mut list: Box<dyn TrackList>,
        options: PlayerOptions,
    ) -> Result<Self, PlayerError> {
        let rate = first.source.sample_rate();
        let track = first.info.clone();
        let listing = SharedListing::default();
        listing.publish(std::iter::once((track.id, ListedTrack::from(&*track))), None);
        list.fill_listing(listing.clone());
        let controls = Arc::new(Controls::new(options.volume, options.paused));
        let audible_segments = SharedAudibleSegments::default();
        let track_errors = SharedTrackErrors::default();
        let (to_analysis, analysis_inbox) = sync_channel(ANALYSIS_QUEUE);
        let gain = GainSwitch::new(options.gain);
        let (notes, of_analysis) = (audible_segments.clone(), gain.clone());
        let analyse = move || analysis::run(&analysis_inbox, rate, &of_analysis, &notes);
        let analysis = Background::start("analysis", analyse)?;
        let (commands, inbox) = channel();
        let (to_list, requests) = channel::<Request>();
        let (answers, reported) = (commands.clone(), track_errors.clone());
        let list_thread =
            Background::start("list", move || listing::run(list, &requests, &answers, &reported))?;
        let work = Decoding::new(first, to_list, audible_segments.clone(), to_analysis, track_errors.clone());
        let decoding = Background::start("decoding", move || work.run(&inbox))?;
        let outputs = commands.clone();
        // Sending fails only if the decoding thread, and thus playback, has ended.
        let deliver = move |link| drop(outputs.send(Command::Output { link, at: Instant::now() }));
        let port = OutputPort { controls: controls.clone(), silent_rate: rate, deliver: Box::new(deliver) };
        let supervisor = Supervisor::start(port, options.output)?;
        let outputs = supervisor.shared_status();
        let decoding = decoding.finished_at_drop(DECODING_END_LIMIT);
        let [analysis, list] = [analysis, list_thread].map(|thread| thread.finished_at_drop(END_LIMIT));
        let of_song = [decoding, analysis, list];
        Ok(Self {
            controls,
            audible: AudibleMoment::new(outputs.clone(), audible_segments.clone(), track.id),
            position: Position::new(outputs, audible_segments, track),
            commands,
            supervisor,
            _of_song: of_song,
            gain,
            listing,
            repeat: options.repeat,
            shuffled: options.shuffled,
            track_errors,
        })
    }

    /// Pauses (true) or resumes (false) playback.
    pub fn set_paused(&self, paused: bool) {
        self.controls.set_paused(paused);
    }

    /// Seeks by `seconds` from the audible position, or from the target of a seek that is not audible yet. A target
    /// before the track's start becomes the start. A target beyond the track's end leads to the next track. Values that
    /// are not finite are ignored.
    pub fn seek_by(&self, seconds: f64) {
        self.send(Command::SeekBy(seconds));
    }

    /// Seeks to a time of the track, in seconds, clamped like [`Player::seek_by`].
    pub fn seek_to(&self, seconds: f64) {
        self.send(Command::SeekTo(seconds));
    }

    /// Skips to the next or the previous track. After 3 s of a track, a skip back restarts the track.
    pub fn skip(&self, forward: bool) {
        self.send(Command::Skip { forward });
    }

    /// Replaces the list by these files, folders or playlists, if at least one of them can be played.
    pub fn play_files(&self, files: Vec<PathBuf>) {
        self.send(Command::Files(files));
    }

    /// Changes the repeat mode and the order.
    pub fn set_order(&mut self, repeat: Repeat, shuffled: bool) {
        (self.repeat, self.shuffled) = (repeat, shuffled);
        self.send(Command::Order(repeat, shuffled));
    }

    /// Returns the current list. The call is fast enough for each frame, even for long lists.
    pub fn playlist(&self) -> Arc<ListedTracks> {
        self.listing.tracks()
    }

    /// Plays the track at this index, or the next playable track. Indices beyond the list are ignored.
    pub fn play_entry(&self, entry: usize) {
        self.send(Command::PlayEntry(entry));
    }

    /// Edits the list without interrupting playback. Edits apply in order. If the playing entry is removed, the next track
    /// or silence follows. If an undo takes the playing track off the list, the track that played before the edit follows.
    pub fn edit(&self, edit: Edit) {
        self.send(Command::Edit(edit));
    }

    /// Switches to another output. The current output continues until the new output is open. A player that was started
    /// without a device also switches to the output.
    pub fn choose_output(&self, target: Target) {
        self.supervisor.choose(target);
    }

    /// Changes the gain control. The image follows within half a second, because the analysis is ahead of the sound.
    pub fn set_gain(&self, gain: Gain) {
        self.gain.set(gain);
    }

    /// Changes the volume by `delta`, clamped to 0 to 1.
    pub fn change_volume(&self, delta: f32) {
        self.controls.set_volume(self.controls.volume() + delta);
    }

    /// Sets the volume, clamped to 0 to 1.
    pub fn set_volume(&self, volume: f32) {
        self.controls.set_volume(volume);
    }

    /// Mutes or unmutes. The song continues.
    pub fn toggle_mute(&self) {
        self.controls.set_muted(!self.controls.muted());
    }

    /// The current state of playback.
    pub fn status(&mut self) -> PlayerStatus {
        let output = self.supervisor.status();
        let Place { mut track, seconds, missed_audio } = self.position.current();
        if let Some((entry, count)) = self.listing.place(track.id)
            && (entry, count) != (track.entry, track.count)
        {
            let info = Arc::make_mut(&mut track);
            (info.entry, info.count) = (entry, count);
        }
        let (ended, next) = self.audible.end_and_next(output.note.as_ref());
        PlayerStatus {
            track,
            next,
            position: seconds,
            repeat: self.repeat,
            shuffled: self.shuffled,
            paused: self.controls.paused(),
            volume: self.controls.volume(),
            muted: self.controls.muted(),
            ended,
            device: output.device,
            silent: output.silent,
            refused: output.refused,
            underruns: self.controls.underruns.load(Ordering::Relaxed),
            track_errors: self.track_errors.get(),
            missed_audio,
        }
    }

    /// Returns the audible position, for other threads.
    pub fn position(&self) -> Position {
        self.position.clone()
    }

    /// Returns the audible moment. `latency_shift` (in seconds, within the limits' `latency_ms_max`) is positive if the
    /// sound is heard later than the device reports. A negative shift looks ahead, as far as frames are decoded (0.3 to
    /// 0.4 s).
    pub fn now(&mut self, latency_shift: f64) -> Moment {
        self.audible.now(latency_shift)
    }

    /// Returns the sound and its tables at the moment that [`Player::now`] returned last, or at an earlier time of its
    /// track, in seconds. Sound of more than two seconds ago and sound from before a seek are replaced by the nearest
    /// known sound.
    pub fn sound_at(&self, song_time: f64) -> Sound {
        self.audible.sound_at(song_time)
    }

    /// Returns the known sound of the last seconds before a time of the track, with unknown places in the song.
    pub fn recent(&self, song_time: f64) -> Vec<Recent> {
        self.audible.recent(song_time)
    }

    fn send(&self, command: Command) {
        // A failed send means that the decoding thread has ended.
        let _ = self.commands.send(command);
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        self.send(Command::Quit);
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
