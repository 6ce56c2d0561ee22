//! Live input: [`Live`], the handle that the window holds. All methods return at once; slow work runs on threads.
//!
//! **Live features have the shortest possible delay.** The analysis window of a live moment ends at its newest sample,
//! and buffers are one hop long. Moments go through a wait-free ring to the window on the screen, which keeps the last
//! seconds and shows the newest moment, or an earlier moment if the image is delayed. Silence replaces missing sound,
//! so that the image calms down as after a song.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use mariana_music::{FeatureTrack, Gain, Recent, Sound};
use rtrb::{Consumer, RingBuffer};

use super::listener::{Ear, Heard, Listener, has_signal};
use super::port::{InputPort, open};
use crate::device::Target;
use crate::device_list::{DeviceList, DeviceWatch, ListedDevice};
use crate::error::PlayerError;
use crate::gain_switch::GainSwitch;
use crate::limits;
use crate::player::Moment;
use crate::supervisor::Supervisor;
use mariana_work::{Awaited, Latest, looping, once};

const MOMENTS: usize = 256;

/// Seconds of features that are kept beyond the largest shift.
const TRACK_RESERVE: f64 = 1.0;

/// An input that has had no signal for this long, in seconds, is reported.
const FLAT_LIMIT: f64 = 2.0;

const END_LIMIT: Duration = Duration::from_millis(500);

/// The state of a live input.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveStatus {
    /// The name of the input.
    pub name: String,
    /// The device, if one is open.
    pub device: Option<ListedDevice>,
    /// The reason for the silence; `None` if there is sound.
    pub silent: Option<String>,
    /// The reason why the chosen input could not be opened, while the previous input continues.
    pub refused: Option<String>,
    /// If the input has no signal: the problem and a remedy.
    pub flat: Option<String>,
    /// An input with a signal, if `flat` is set and such an input was found.
    pub suggestion: Option<ListedDevice>,
    /// Number of lost frames and glitches.
    pub lost: u64,
}

/// A live input. Dropping the input ends the streams and the threads, within a time limit.
pub struct Live {
    target: Target,
    ear: Arc<Ear>,
    watch: Arc<DeviceWatch>,
    // Ends before the listener when this is dropped.
    supervisor: Supervisor<InputPort>,
    _listener: Latest<()>,
    gain: GainSwitch,
    moments: Consumer<Heard>,
    track: FeatureTrack,
    latest: Option<Heard>,
    prober: Prober,
    /// The time of the pause, in seconds since the epoch.
    paused: Option<f64>,
    /// The total time of earlier pauses, in seconds.
    paused_for: f64,
    heard_at: f64,
    /// The sound at the start of the pause. It is kept here because the track drops old sound.
    paused_at: Sound,
    moment: Moment,
}

impl Live {
    /// Starts to listen. The device opens in the background. If that fails, [`LiveStatus::silent`] gives the reason.
    /// `gain` lets quiet and loud sound move a scene in the same way.
    ///
    /// # Errors
    /// Fails if a thread cannot be started.
    pub fn start(target: Target, gain: Gain) -> Result<Self, PlayerError> {
        let (producer, moments) = RingBuffer::new(MOMENTS);
        let ear = Arc::new(Ear::new());
        let (links, inbox) = channel();
        let gain = GainSwitch::new(gain);
        let work = Listener::new(ear.clone(), producer, gain.clone());
        let listener = looping("listening", (), move |shared| work.run(&inbox, shared))?;
        let listener = listener.finished_at_drop(END_LIMIT);
        let thread = listener.thread().cloned().unwrap_or_else(std::thread::current);
        let watch = DeviceWatch::shared()?;
        let supervisor = Supervisor::start(InputPort { links, listener: thread }, Some(target.clone()))?;
        Ok(Self {
            target,
            ear,
            watch,
            supervisor,
            _listener: listener,
            gain,
            moments,
            track: FeatureTrack::new(limits::LATENCY_MS_MAX / 1000.0 + TRACK_RESERVE),
            latest: None,
            prober: Prober::new(),
            paused: None,
            paused_for: 0.0,
            heard_at: 0.0,
            paused_at: Sound::default(),
            moment: Moment::default(),
        })
    }

    /// Switches to another input. The current input continues until the new input is open.
    pub fn choose(&mut self, target: Target) {
        self.prober.reset();
        self.target = target.clone();
        self.supervisor.choose(target);
    }

    /// Changes the gain control.
    pub fn set_gain(&self, gain: Gain) {
        self.gain.set(gain);
    }

    /// The chosen input.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Freezes the image (true) or lets the image continue (false).
    pub fn set_paused(&mut self, paused: bool) {
        let now = self.ear.now();
        match (self.paused, paused) {
            (None, true) => {
                let song_time = self.moment.song_time;
                self.paused_at = Sound { recent: self.recent(song_time).into(), ..self.sound_at(song_time) };
                self.paused = Some(now);
            }
            (Some(since), false) => {
                self.paused_for += now - since;
                self.paused = None;
            }
            _ => {}
        }
    }

    /// Returns the moment that is heard now. A positive `latency_shift` (in seconds, within the limits'
    /// `latency_ms_max`) delays the image, for sound that is heard later than it is recorded. A negative
    /// `latency_shift` has no effect.
    pub fn now(&mut self, latency_shift: f64) -> Moment {
        while let Ok(heard) = self.moments.pop() {
            self.track.push(&heard.heard);
            self.latest = Some(heard);
        }
        if self.paused.is_some() {
            return self.moment;
        }
        let shift = if latency_shift.is_finite() { latency_shift } else { 0.0 };
        let shift = shift.clamp(0.0, limits::LATENCY_MS_MAX / 1000.0);
        let now = self.ear.now();
        let newest = self.latest.as_ref().map_or(0.0, |heard| heard.heard.time);
        self.heard_at = if shift > 0.0 { now - shift } else { newest };
        let features = self.track.at(self.heard_at);
        let segment = self.latest.as_ref().map_or(0, |heard| heard.stream);
        self.moment = Moment { song_time: now - self.paused_for, features, segment, ..Moment::default() };
        self.moment
    }

    /// Returns the sound and its tables at the moment that [`Live::now`] returned last or an earlier one, given by its
    /// song time, or the oldest known sound.
    pub fn sound_at(&self, song_time: f64) -> Sound {
        match self.paused {
            Some(_) => self.paused_at.clone(),
            None => self.track.sound_at(self.heard_at - (self.moment.song_time - song_time)),
        }
    }

    /// Returns the known sound of the last seconds before a moment, given by its song time.
    pub fn recent(&self, song_time: f64) -> Vec<Recent> {
        match self.paused {
            Some(_) => self.paused_at.recent.to_vec(),
            None => self.track.recent(self.heard_at - (self.moment.song_time - song_time)),
        }
    }

    /// Returns the current state. If the input has no signal, searches for an input with a signal.
    pub fn status(&mut self) -> LiveStatus {
        let status = self.supervisor.status();
        let (_, device_list) = self.watch.latest();
        let name = status
            .device
            .as_ref()
            .map_or_else(|| self.wanted_name(&device_list), |device| device.name.clone());
        let (mut flat, mut suggestion) = (None, None);
        match &status.device {
            Some(device) if status.silent.is_none() && self.ear.flat_for() >= FLAT_LIMIT => {
                suggestion = self.prober.search(|| candidates(&device_list, device)).cloned();
                flat = Some(diagnosis(&name, suggestion.as_ref()));
            }
            _ => self.prober.reset(),
        }
        LiveStatus {
            name,
            device: status.device,
            silent: status.silent,
            refused: status.refused,
            flat,
            suggestion,
            lost: status.note.map_or(0, |counters| counters.lost.load(Ordering::Relaxed)),
        }
    }

    fn wanted_name(&self, device_list: &DeviceList) -> String {
        match &self.target {
            Target::Default => "the microphone".into(),
            Target::Monitor => "the computer's sound".into(),
            Target::MonitorOf(name) => format!("the sound of {name}"),
            Target::Named(id) | Target::Preferred(id) => {
                device_list.input(id).map_or_else(|| id.clone(), |entry| entry.name.clone())
            }
        }
    }
}

/// Returns the inputs to search for a signal: monitors, and also microphones if the current input is a microphone. A
/// user who visualizes the computer's own sound does not expect Mariana to open a microphone.
fn candidates(device_list: &DeviceList, present: &ListedDevice) -> Vec<ListedDevice> {
    let others = || device_list.inputs.iter().filter(|entry| entry.id != present.id);
    let monitors = others().filter(|entry| entry.is_monitor());
    let microphones = others().filter(|entry| !entry.is_monitor() && !present.is_monitor());
    monitors.chain(microphones).cloned().collect()
}

fn diagnosis(name: &str, suggestion: Option<&ListedDevice>) -> String {
    match suggestion {
        Some(other) => {
            let known = other.name.to_lowercase().starts_with("monitor of");
            let article = if other.is_monitor() { if known { "the " } else { "the monitor " } } else { "" };
            let words = if known { other.name.replacen("Monitor", "monitor", 1) } else { other.name.clone() };
            format!("no sound from {name}; {article}{words} has a signal: press D")
        }
        None => format!("no sound from {name}: play something, or press D for another source"),
    }
}

// Searches for an input with a signal while the current input has none.

const LISTENING: Duration = Duration::from_millis(400);

const CANDIDATES_MAX: usize = 8;

/// Wait after the first search without success. The wait doubles with each further search, up to [`PAUSE_MAX`].
const PAUSE: Duration = Duration::from_secs(2);

const PAUSE_MAX: Duration = Duration::from_secs(30);

pub(super) struct Prober {
    /// The running search. A hanging input delays the next search, so that searches do not accumulate.
    search: Awaited<Option<ListedDevice>>,
    found: Option<ListedDevice>,
    /// True if the running search ends and its answer must be ignored.
    is_over: Arc<AtomicBool>,
    next: Instant,
    pause: Duration,
}

impl Prober {
    pub(super) fn new() -> Self {
        let (search, is_over) = (Awaited::default(), Arc::default());
        Self { search, found: None, is_over, next: Instant::now(), pause: PAUSE }
    }

    pub(super) fn reset(&mut self) {
        // A running search would answer for the previous input.
        self.is_over.store(true, Ordering::Relaxed);
        (self.found, self.next, self.pause) = (None, Instant::now(), PAUSE);
    }

    /// Returns the input with a signal that a search has found. Starts a search of `candidates` if a search is due.
    pub(super) fn search(&mut self, candidates: impl FnOnce() -> Vec<ListedDevice>) -> Option<&ListedDevice> {
        if let Some(answer) = self.search.poll() {
            self.found = answer.ok().flatten().filter(|_| !self.is_over.load(Ordering::Relaxed));
            self.next = Instant::now() + self.pause;
            self.pause = (2 * self.pause).min(PAUSE_MAX);
        }
        if !self.search.is_awaited() && self.next <= Instant::now() {
            let (candidates, is_over) = (candidates(), Arc::new(AtomicBool::new(false)));
            self.is_over = is_over.clone();
            let search = move || {
                let mut candidates = candidates.into_iter().take(CANDIDATES_MAX);
                candidates.find(|entry| !is_over.load(Ordering::Relaxed) && probe(&entry.id))
            };
            self.search = once("sound search", || {}, search).unwrap_or_default();
        }
        self.found.as_ref()
    }
}

impl Drop for Prober {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

/// True if this input has a signal.
fn probe(id: &str) -> bool {
    match open(&Target::Named(id.to_owned()), &std::thread::current(), &(Arc::new(|_| {}) as _)) {
        Ok((stream, mut opened)) => {
            let start = Instant::now();
            let mut heard = false;
            while !heard && start.elapsed() < LISTENING {
                std::thread::park_timeout(LISTENING.saturating_sub(start.elapsed()));
                let ring = &mut opened.link.ring;
                if let Ok(chunk) = ring.read_chunk(ring.slots()) {
                    let (front, back) = chunk.as_slices();
                    heard = has_signal(front) || has_signal(back);
                    chunk.commit_all();
                }
            }
            drop(stream);
            heard
        }
        Err(error) => {
            tracing::debug!("{error}");
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::Features;

    fn entry(id: &str, name: &str) -> ListedDevice {
        ListedDevice { id: id.into(), name: name.into() }
    }

    #[test]
    fn a_flat_input_is_reported_with_advice() {
        let reported = |other: Option<&ListedDevice>| diagnosis("Mic", other);
        assert_eq!(
            reported(Some(&entry("p:hdmi.monitor", "Monitor of HDMI"))),
            "no sound from Mic; the monitor of HDMI has a signal: press D"
        );
        assert_eq!(reported(Some(&entry("p:usb", "USB"))), "no sound from Mic; USB has a signal: press D");
        assert!(reported(None).contains("press D"));
    }

    #[test]
    fn no_microphone_is_opened_while_listening_to_a_monitor() {
        let (a, b, mic, usb) =
            (entry("a.monitor", "A"), entry("b.monitor", "B"), entry("mic", "M"), entry("usb", "U"));
        let inputs = vec![mic.clone(), a.clone(), usb.clone(), b.clone()];
        let device_list = DeviceList { known: true, inputs, ..DeviceList::default() };
        assert_eq!(candidates(&device_list, &a), std::slice::from_ref(&b));
        assert_eq!(candidates(&device_list, &mic), [a, b, usb]);
    }

    #[test]
    fn time_runs_without_a_device_and_stops_in_a_pause() {
        let target = Target::Named("no such box".into());
        let mut live = Live::start(target, Gain::Auto).expect("a live input");
        let first = live.now(0.0).song_time;
        std::thread::sleep(Duration::from_millis(20));
        let second = live.now(0.0).song_time;
        assert!(second >= first + 0.02);
        live.set_paused(true);
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(live.now(0.0).song_time, second);
        live.set_paused(false);
        let third = live.now(0.0).song_time;
        assert!(third >= second && third < second + 0.02, "{second} to {third}");
        let start = std::time::Instant::now();
        while live.status().silent.is_none() {
            assert!(start.elapsed() < Duration::from_secs(5), "{:?}", live.status());
            std::thread::sleep(Duration::from_millis(5));
        }
        let reported = live.status().silent.unwrap_or_default();
        assert!(reported.contains("no such box") && reported.contains("mariana devices"), "{reported}");
        assert_eq!(live.now(0.0).features, Features::SILENCE);
    }
}
