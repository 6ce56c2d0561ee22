//! Live input: the handle that the window holds.
//!
//! Every method returns at once: whatever takes time happens on the threads that [`Live::start`] starts.
//!
//! **Live features are the newest ones.** The window of a live moment ends at its newest sample, buffers are a hop
//! long, and nothing waits for a rhythm. Moments go through a wait-free ring to the window, which keeps those of the
//! last seconds and shows the newest, or earlier ones if the picture is shifted. Scene time is then the clock's.
//! Where no sound comes silence takes its place, so that the picture sinks as after a song.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::channel;
use std::time::Duration;

use rtrb::{Consumer, RingBuffer};

use super::listener::{Ear, Heard, Listener};
use super::port::InputPort;
use super::probe::Prober;
use crate::device::Target;
use crate::device_list::{DeviceList, DeviceWatch, ListedDevice};
use crate::error::PlayerError;
use crate::gain_switch::GainSwitch;
use crate::limits::LIMITS;
use crate::player::Moment;
use crate::supervisor::Supervisor;
use crate::worker::Worker;
use mariana_music::{FeatureTrack, Gain, Sound};

/// Moments that may wait for the window: some 2 s.
const MOMENTS: usize = 256;

/// What the track holds beyond the largest shift, in seconds.
const TRACK_RESERVE: f64 = 1.0;

/// An input without signal for this long, in seconds, is reported.
const FLAT_LIMIT: f64 = 2.0;

/// How long to wait for the end of the listening thread.
const END_LIMIT: Duration = Duration::from_millis(500);

/// How to listen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LiveOptions {
    /// What to listen to.
    pub target: Target,
    /// Whether quiet and loud sound move the picture alike.
    pub gain: Gain,
}

/// The state of listening.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveStatus {
    /// What is listened to, in words.
    pub name: String,
    /// The device, if one is open.
    pub device: Option<ListedDevice>,
    /// The device and its format.
    pub description: String,
    /// Why there is no sound, if there is none.
    pub silent: Option<String>,
    /// Why the last choice is not open, while the previous input goes on.
    pub refused: Option<String>,
    /// What is wrong with an input that gives nothing but silence, and what to do.
    pub flat: Option<String>,
    /// In that case, the input that would have signal.
    pub suggestion: Option<ListedDevice>,
    /// Frames that were lost, and glitches.
    pub lost: u64,
    /// Calls of the callback.
    pub callbacks: u64,
    /// Age of a buffer's first frame on arrival, in seconds, as the device reports it.
    pub age: f64,
    /// How often a device was opened.
    pub openings: u64,
}

/// A live input. Dropping it ends the streams and the threads, within a limit.
pub struct Live {
    target: Target,
    ear: Arc<Ear>,
    watch: Arc<DeviceWatch>,
    /// Taken when dropped.
    supervisor: Option<Supervisor<InputPort>>,
    listener: Worker,
    gain: GainSwitch,
    moments: Consumer<Heard>,
    track: FeatureTrack,
    latest: Option<Heard>,
    prober: Prober,
    /// When it was paused, in seconds since the epoch.
    paused: Option<f64>,
    /// How long it has been paused in total, in seconds.
    paused_for: f64,
    /// The time in the track that was reported last.
    heard_at: f64,
    /// The sound of the moment at which it was paused, kept because the track forgets it.
    paused_at: Sound,
    moment: Moment,
}

impl Live {
    /// Starts to listen. The device opens meanwhile; if that fails, [`LiveStatus::silent`] says why.
    ///
    /// # Errors
    /// A thread cannot be started.
    pub fn start(options: LiveOptions) -> Result<Self, PlayerError> {
        let LiveOptions { target, gain } = options;
        let (producer, moments) = RingBuffer::new(MOMENTS);
        let ear = Arc::new(Ear::new());
        let (links, inbox) = channel();
        let gain = GainSwitch::new(gain);
        let work = Listener::new(ear.clone(), producer, gain.clone());
        let listener = Worker::spawn("listening", move || work.run(&inbox))?;
        let thread = listener.thread().cloned().unwrap_or_else(std::thread::current);
        let watch = DeviceWatch::shared()?;
        let supervisor = Supervisor::start(InputPort { links, listener: thread }, Some(target.clone()))?;
        Ok(Self {
            target,
            ear,
            watch,
            supervisor: Some(supervisor),
            listener,
            gain,
            moments,
            track: FeatureTrack::new(LIMITS.latency_ms_max / 1000.0 + TRACK_RESERVE),
            latest: None,
            prober: Prober::new(),
            paused: None,
            paused_for: 0.0,
            heard_at: 0.0,
            paused_at: Sound::default(),
            moment: Moment::default(),
        })
    }

    /// Listens to something else; the present input goes on until the other is open.
    pub fn choose(&mut self, target: Target) {
        self.prober.reset();
        self.target = target.clone();
        if let Some(supervisor) = &self.supervisor {
            supervisor.choose(target);
        }
    }

    /// Levels the sound for the picture from now on, or no longer.
    pub fn set_gain(&self, gain: Gain) {
        self.gain.set(gain);
    }

    /// What it listens to.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Holds the picture still (true) or lets it go on (false).
    pub fn set_paused(&mut self, paused: bool) {
        let now = self.ear.now();
        match (self.paused, paused) {
            (None, true) => {
                self.paused_at = self.sound();
                self.paused = Some(now);
            }
            (Some(since), false) => {
                self.paused_for += now - since;
                self.paused = None;
            }
            _ => {}
        }
    }

    /// What is heard now. A positive `latency_shift` in seconds (within the limits' `latency_ms_max`) delays the
    /// picture, for sound that is heard later than it is recorded. A negative one has no effect: the future is not
    /// known.
    pub fn now(&mut self, latency_shift: f64) -> Moment {
        while let Ok(heard) = self.moments.pop() {
            self.track.push(&heard.heard);
            self.latest = Some(heard);
        }
        if self.paused.is_some() {
            return self.moment;
        }
        let shift = if latency_shift.is_finite() { latency_shift } else { 0.0 };
        let shift = shift.clamp(0.0, LIMITS.latency_ms_max / 1000.0);
        let now = self.ear.now();
        let newest = self.latest.as_ref().map_or(0.0, |heard| heard.heard.time);
        self.heard_at = if shift > 0.0 { now - shift } else { newest };
        let features = self.track.at(self.heard_at);
        let segment = self.latest.as_ref().map_or(0, |heard| heard.stream);
        self.moment = Moment { song_time: now - self.paused_for, features, segment, ..Moment::default() };
        self.moment
    }

    /// The sound, with its curves, of the moment that [`Live::now`] returned last.
    pub fn sound(&self) -> Sound {
        match self.paused {
            Some(_) => self.paused_at.clone(),
            None => self.track.sound_at(self.heard_at),
        }
    }

    /// The present state of listening. Looks for an input with signal if the present one has none.
    pub fn status(&mut self) -> LiveStatus {
        let status = self.supervisor.as_ref().map(Supervisor::status).unwrap_or_default();
        let (_, device_list) = self.watch.latest();
        let name = status
            .device
            .as_ref()
            .map_or_else(|| self.wanted_name(&device_list), |device| device.name.clone());
        let (mut flat, mut suggestion) = (None, None);
        match &status.device {
            Some(device) if status.silent.is_none() && self.ear.flat_for() >= FLAT_LIMIT => {
                suggestion = self.prober.look(|| candidates(&device_list, device)).cloned();
                flat = Some(diagnosis(&name, suggestion.as_ref()));
            }
            _ => self.prober.reset(),
        }
        let count = |of: fn(&super::InputCounters) -> u64| status.note.as_deref().map_or(0, of);
        LiveStatus {
            name,
            device: status.device,
            description: status.description,
            silent: status.silent,
            refused: status.refused,
            flat,
            suggestion,
            lost: count(|counters| counters.lost.load(Ordering::Relaxed)),
            callbacks: count(|counters| counters.calls.load(Ordering::Relaxed)),
            age: count(|counters| counters.age_ns.load(Ordering::Relaxed)) as f64 / 1e9,
            openings: status.openings,
        }
    }

    /// What is to be listened to, in words, while it is not open.
    fn wanted_name(&self, device_list: &DeviceList) -> String {
        match &self.target {
            Target::Default => "the microphone".into(),
            Target::Monitor => "what the computer plays".into(),
            Target::MonitorOf(name) => format!("what {name} plays"),
            Target::Named(id) | Target::Preferred(id) => {
                device_list.input(id).map_or_else(|| id.clone(), |entry| entry.name.clone())
            }
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.supervisor = None;
        self.ear.stop.store(true, Ordering::Relaxed);
        self.listener.wake();
        if !self.listener.join_within(END_LIMIT) {
            tracing::warn!("the listening thread does not end and is abandoned");
        }
    }
}

/// Where a signal is sought: in the monitors, and if the present input is a microphone, in the other microphones too.
/// Whoever shows what the computer plays does not expect microphones to be opened.
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

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::Features;

    fn entry(id: &str, name: &str) -> ListedDevice {
        ListedDevice { id: id.into(), name: name.into() }
    }

    #[test]
    fn a_flat_input_is_told_with_what_to_do() {
        let reported = |other: Option<&ListedDevice>| diagnosis("Mic", other);
        assert_eq!(
            reported(Some(&entry("p:hdmi.monitor", "Monitor of HDMI"))),
            "no sound from Mic; the monitor of HDMI has a signal: press D"
        );
        assert_eq!(reported(Some(&entry("p:usb", "USB"))), "no sound from Mic; USB has a signal: press D");
        assert!(reported(None).contains("press D"));
    }

    #[test]
    fn no_microphone_is_opened_for_one_who_shows_what_the_computer_plays() {
        let (a, b, mic, usb) =
            (entry("a.monitor", "A"), entry("b.monitor", "B"), entry("mic", "M"), entry("usb", "U"));
        let inputs = vec![mic.clone(), a.clone(), usb.clone(), b.clone()];
        let device_list = DeviceList { known: true, inputs, ..DeviceList::default() };
        assert_eq!(candidates(&device_list, &a), std::slice::from_ref(&b));
        assert_eq!(candidates(&device_list, &mic), [a, b, usb]);
    }

    #[test]
    fn the_show_goes_on_without_a_device_and_stands_still_in_a_pause() {
        let target = Target::Named("no such box".into());
        let mut live = Live::start(LiveOptions { target, gain: Gain::Auto }).expect("it starts");
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
