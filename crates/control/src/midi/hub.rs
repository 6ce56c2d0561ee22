//! The thread that watches for MIDI devices and opens each of them.

use std::any::Any;
use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mariana_work::{Latest, Shared, lock, looping};

use super::clock::{ClockReading, MidiClock};
use super::device::{Device, Said};
use super::ports::{Hear, Ports};
use crate::InputQueue;
use crate::limits;

/// The interval between two scans for devices.
const LOOK: Duration = Duration::from_millis(500);
/// The time without clock messages, in seconds, after which another device may provide the clock.
const CLOCK_GONE: f64 = 2.0;

/// The state of MIDI.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MidiState {
    /// The devices that are open.
    pub devices: Vec<String>,
    /// The devices that cannot be opened, with the reason.
    pub refused: Vec<(String, String)>,
    /// The reason why this machine has no MIDI, without a capital letter or a full stop.
    pub trouble: Option<String>,
    /// True once the first scan is done.
    pub is_known: bool,
    /// The device whose MIDI clock sets the tempo.
    pub clock_of: Option<String>,
}

/// The state that the threads of the devices share.
struct Receiving {
    input_queue: InputQueue,
    /// The zero point of all clock times.
    zero: Instant,
    clock: Mutex<(MidiClock, Option<Arc<str>>, f64)>,
}

/// Receives MIDI until it is dropped.
// Dropping this does not wait for the thread: closing a port may block.
pub struct MidiHub {
    state: Latest<MidiState>,
    receiving: Arc<Receiving>,
}

impl MidiHub {
    /// Opens all devices of `ports`, and new devices when they are connected. Movements go to `input_queue`. `wake`
    /// is called when devices are connected or removed.
    ///
    /// # Errors
    /// Fails if the thread cannot be started.
    pub fn start(
        mut ports: Box<dyn Ports>,
        input_queue: InputQueue,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let receiving = Arc::new(Receiving { input_queue, zero: Instant::now(), clock: Mutex::default() });
        let of_thread = receiving.clone();
        let state = looping("MIDI", MidiState::default(), move |shared| {
            let mut open = BTreeMap::new();
            while !shared.is_over() {
                if update_ports(&mut *ports, &mut open, &of_thread, shared) {
                    wake();
                }
                shared.rest(LOOK);
            }
        })?;
        Ok(Self { state, receiving })
    }

    /// Returns the current state.
    pub fn state(&self) -> MidiState {
        self.state.lock().clone()
    }

    /// Returns the reading of the followed clock, and the current time on the same scale; `None` without a clock.
    pub fn clock(&self) -> Option<(ClockReading, f64)> {
        let now = self.receiving.zero.elapsed().as_secs_f64();
        let reading = lock(&self.receiving.clock).0.reading()?;
        reading.beat_at(now).map(|_| (reading, now))
    }
}

/// Opens new devices and closes removed ones. Returns true if the state has changed.
fn update_ports(
    ports: &mut dyn Ports,
    open: &mut BTreeMap<String, Box<dyn Any>>,
    receiving: &Arc<Receiving>,
    shared: &Shared<MidiState>,
) -> bool {
    let (names, trouble) = match ports.names() {
        Ok(names) => (names, None),
        Err(trouble) => (Vec::new(), Some(trouble)),
    };
    open.retain(|name, _| names.contains(name));
    let mut refused = Vec::new();
    for name in names.iter().take(limits::MIDI_DEVICES_MAX) {
        if !open.contains_key(name) {
            match ports.open(name, hearing(name, receiving.clone())) {
                Ok(connection) => drop(open.insert(name.clone(), connection)),
                Err(reason) => refused.push((name.clone(), reason)),
            }
        }
    }
    let beyond = names.iter().skip(limits::MIDI_DEVICES_MAX);
    refused.extend(beyond.map(|name| {
        (name.clone(), format!("only {} devices can be open at the same time", limits::MIDI_DEVICES_MAX))
    }));
    let clock_of = {
        let clock = lock(&receiving.clock);
        let now = receiving.zero.elapsed().as_secs_f64();
        clock.1.as_deref().filter(|_| now - clock.2 < CLOCK_GONE).map(str::to_owned)
    };
    let devices = open.keys().cloned().collect();
    let now = MidiState { devices, refused, trouble, is_known: true, clock_of };
    let mut state = shared.lock();
    let is_new = now != *state;
    *state = now;
    is_new
}

fn hearing(name: &str, receiving: Arc<Receiving>) -> Hear {
    let name: Arc<str> = name.into();
    let mut device = Device::new(name.clone());
    Box::new(move |bytes| {
        device.parse(bytes, |said| {
            match said {
                Said::Moved(moved) => receiving.input_queue.moved(moved),
                Said::Time(message) => {
                    let now = receiving.zero.elapsed().as_secs_f64();
                    let mut clock = lock(&receiving.clock);
                    let is_free = clock.1.is_none() || now - clock.2 > CLOCK_GONE;
                    if is_free && clock.1.as_ref() != Some(&name) {
                        *clock = (MidiClock::default(), Some(name.clone()), now);
                    }
                    if clock.1.as_ref() == Some(&name) {
                        clock.0.process(message, now);
                        clock.2 = now;
                    }
                }
            }
            receiving.input_queue.count();
        });
    })
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;

    #[derive(Clone)]
    struct TestHub {
        names: Arc<Mutex<Result<Vec<String>, String>>>,
        hears: Arc<Mutex<BTreeMap<String, Hear>>>,
    }

    impl Default for TestHub {
        fn default() -> Self {
            Self { names: Arc::new(Mutex::new(Ok(Vec::new()))), hears: Arc::default() }
        }
    }

    impl Ports for TestHub {
        fn names(&mut self) -> Result<Vec<String>, String> {
            lock(&self.names).clone()
        }

        fn open(&mut self, name: &str, hear: Hear) -> Result<Box<dyn Any>, String> {
            if name.starts_with("locked") {
                return Err("another program has it".to_owned());
            }
            lock(&self.hears).insert(name.to_owned(), hear);
            Ok(Box::new(()))
        }
    }

    impl TestHub {
        fn plug(&self, names: &[&str]) {
            *lock(&self.names) = Ok(names.iter().map(|name| (*name).to_owned()).collect());
        }

        fn send(&self, name: &str, bytes: &[u8]) {
            if let Some(hear) = lock(&self.hears).get_mut(name) {
                hear(bytes);
            }
        }
    }

    fn hub(hub_test: &TestHub) -> (MidiHub, InputQueue, Receiver<()>) {
        let (reported, news) = channel();
        let reported = Mutex::new(reported);
        let input_queue = InputQueue::new(|| {});
        let hub = MidiHub::start(Box::new(hub_test.clone()), input_queue.clone(), move || {
            let _ = lock(&reported).send(());
        });
        (hub.unwrap(), input_queue, news)
    }

    #[test]
    fn devices_are_opened_when_connected_and_removed_ones_reported() {
        let hub_test = TestHub::default();
        hub_test.plug(&["pads", "locked"]);
        let (hub, input_queue, news) = hub(&hub_test);
        news.recv().unwrap();
        let state = hub.state();
        assert_eq!(state.devices, ["pads"]);
        assert_eq!(state.refused, [("locked".to_owned(), "another program has it".to_owned())]);
        hub_test.send("pads", &[0xb0, 7, 127, 7, 0, 7, 127]);
        let knobs = input_queue.drain().knobs;
        assert_eq!((knobs.len(), knobs[0].value, knobs[0].presses), (1, 1.0, 2), "{knobs:?}");
        hub_test.plug(&[]);
        news.recv().unwrap();
        assert_eq!(hub.state().devices, [""; 0]);
        hub_test.plug(&["pads"]);
        news.recv().unwrap();
        hub_test.send("pads", &[0x90, 60, 1]);
        assert_eq!(input_queue.drain().knobs.len(), 1);
    }

    #[test]
    fn missing_midi_and_devices_beyond_the_limit_are_reported() {
        let hub_test = TestHub::default();
        *lock(&hub_test.names) = Err("there is no sequencer".to_owned());
        let (hub, _, news) = hub(&hub_test);
        news.recv().unwrap();
        assert_eq!(hub.state().trouble.as_deref(), Some("there is no sequencer"));
        let names: Vec<String> =
            (0..=limits::MIDI_DEVICES_MAX).map(|number| format!("{number:03}")).collect();
        hub_test.plug(&names.iter().map(|name| &**name).collect::<Vec<_>>());
        news.recv().unwrap();
        let state = hub.state();
        assert_eq!((state.devices.len(), state.refused.len()), (limits::MIDI_DEVICES_MAX, 1));
    }

    #[test]
    fn the_clock_of_the_first_device_that_has_one_is_followed() {
        let hub_test = TestHub::default();
        hub_test.plug(&["drums", "synth"]);
        let (hub, _, news) = hub(&hub_test);
        news.recv().unwrap();
        assert!(hub.clock().is_none());
        hub_test.send("drums", &[0xfa, 0xf8]);
        hub_test.send("synth", &[0xf8, 0xf8, 0xf8]);
        assert_eq!(lock(&hub.receiving.clock).1.as_deref(), Some("drums"));
        // If the followed clock has been silent for long, another device takes over.
        lock(&hub.receiving.clock).2 = -CLOCK_GONE;
        hub_test.send("synth", &[0xf8]);
        assert_eq!(lock(&hub.receiving.clock).1.as_deref(), Some("synth"));
    }
}
