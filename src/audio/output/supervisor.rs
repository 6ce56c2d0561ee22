//! Keeps the sound going: opens the device, watches it, and puts the silent clock in its place when it fails.
//!
//! Each device lives on a thread of its own, that opens, holds and drops its stream. None of these calls is trusted to
//! return: a thread that does not answer in time is left behind, and nothing it says later is heard.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::cpal_output;
use super::feeder::{Controls, Counters, Feeder, FeederLink};
use super::null_output::NullOutput;
use crate::audio::clock::SpanHistory;
use crate::audio::error::OutputError;
use crate::audio::worker::Worker;

/// How long a device may take to open.
const OPEN_LIMIT: Duration = Duration::from_secs(3);

/// How often a playing device is looked at.
const WATCH_PERIOD: Duration = Duration::from_millis(250);

/// A device that did not call for so many looks in a row has stalled. Looks are counted, not time: if the whole
/// program stood still, the device is not to blame.
const SILENT_LOOKS: u32 = 5;

/// How long the end of a device's thread is waited for.
const CLOSE_LIMIT: Duration = Duration::from_millis(500);

/// What to play on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutputChoice {
    /// A device if there is one, otherwise the silent clock.
    #[default]
    Auto,
    /// The silent clock.
    Silent,
}

/// What is played on now.
#[derive(Clone, Default)]
pub struct OutputStatus {
    /// In words.
    pub description: String,
    /// Why there is no sound, if there is none.
    pub silent: Option<String>,
    /// What is audible; none while nothing is open yet.
    pub history: Option<Arc<SpanHistory>>,
}

/// Settings of a [`Supervisor`].
pub struct OutputRequest {
    /// What to play on.
    pub choice: OutputChoice,
    /// A device's id or name; none is the default device.
    pub device: Option<String>,
    /// Frames per second of the silent clock.
    pub silent_rate: u32,
}

enum Event {
    Quit,
    Opened { link: FeederLink, description: String },
    Refused(OutputError),
    Failed(String),
}

type Numbered = (u64, Event);

/// The thread that watches over the output. Ends when dropped.
pub struct Supervisor {
    events: Sender<Numbered>,
    status: Arc<Mutex<OutputStatus>>,
    worker: Worker,
}

impl Supervisor {
    /// Starts. Each output that becomes ready is handed to `deliver`; the one before is given up then.
    pub fn start(
        request: OutputRequest,
        controls: Arc<Controls>,
        counters: Arc<Counters>,
        deliver: impl FnMut(FeederLink) + Send + 'static,
    ) -> io::Result<Self> {
        let (events, inbox) = channel();
        let status =
            Arc::new(Mutex::new(OutputStatus { description: "opening".into(), ..OutputStatus::default() }));
        let mut watch = Watch {
            request,
            controls,
            counters,
            status: status.clone(),
            deliver: Box::new(deliver),
            events: events.clone(),
            attempt: 0,
            output: Output::None,
        };
        let worker = Worker::spawn("sound output", move || watch.run(&inbox))?;
        Ok(Self { events, status, worker })
    }

    /// What is played on now.
    pub fn status(&self) -> OutputStatus {
        lock(&self.status).clone()
    }

    /// What is audible of the present output; none while nothing is open yet.
    pub fn history(&self) -> Option<Arc<SpanHistory>> {
        lock(&self.status).history.clone()
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        // If it cannot be sent, the thread has ended.
        let _ = self.events.send((0, Event::Quit));
        self.worker.join_within(2 * CLOSE_LIMIT);
    }
}

fn lock(status: &Mutex<OutputStatus>) -> MutexGuard<'_, OutputStatus> {
    status.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A device's thread; it closes the device when `_hold` is dropped.
struct DeviceThread {
    _hold: Sender<()>,
    worker: Worker,
}

impl DeviceThread {
    fn close(self) {
        let Self { _hold: hold, mut worker } = self;
        drop(hold);
        if !worker.join_within(CLOSE_LIMIT) {
            tracing::warn!("the sound output does not close; it is left behind");
        }
    }
}

enum Output {
    None,
    Opening { device: DeviceThread, since: Instant },
    Playing { device: DeviceThread, history: Arc<SpanHistory>, calls: u64, silent_looks: u32 },
    Silent(#[allow(dead_code, reason = "held: it ends when dropped")] NullOutput),
}

struct Watch {
    request: OutputRequest,
    controls: Arc<Controls>,
    counters: Arc<Counters>,
    status: Arc<Mutex<OutputStatus>>,
    deliver: Box<dyn FnMut(FeederLink) + Send>,
    events: Sender<Numbered>,
    /// Number of the present device; what others say is not heard.
    attempt: u64,
    output: Output,
}

impl Watch {
    fn run(&mut self, inbox: &Receiver<Numbered>) {
        match self.request.choice {
            OutputChoice::Auto => self.open_device(),
            OutputChoice::Silent => self.go_silent("the sound is switched off".into()),
        }
        loop {
            match inbox.recv_timeout(WATCH_PERIOD) {
                Ok((_, Event::Quit)) | Err(RecvTimeoutError::Disconnected) => break,
                Ok((attempt, event)) if attempt == self.attempt => self.hear(event),
                Ok(_) => {}
                Err(RecvTimeoutError::Timeout) => self.look(),
            }
        }
        self.end_output();
    }

    fn open_device(&mut self) {
        self.attempt += 1;
        let attempt = self.attempt;
        let (hold, held) = channel::<()>();
        let (controls, counters) = (self.controls.clone(), self.counters.clone());
        let wanted = self.request.device.clone();
        let events = self.events.clone();
        let failures = events.clone();
        let worker = Worker::spawn("sound device", move || {
            let on_failure = Arc::new(move |reason| drop(failures.send((attempt, Event::Failed(reason)))));
            match cpal_output::open(wanted.as_deref(), &controls, &counters, &(on_failure as _)) {
                Ok(cpal_output::Opened { stream, link, description }) => {
                    if events.send((attempt, Event::Opened { link, description })).is_ok() {
                        // Nothing is ever sent: it returns when the other end is dropped.
                        let _ = held.recv();
                    }
                    drop(stream);
                }
                Err(error) => drop(events.send((attempt, Event::Refused(error)))),
            }
        });
        match worker {
            Ok(worker) => {
                let device = DeviceThread { _hold: hold, worker };
                self.output = Output::Opening { device, since: Instant::now() };
            }
            Err(error) => self.go_silent(error.to_string()),
        }
    }

    fn hear(&mut self, event: Event) {
        match event {
            Event::Opened { link, description } => {
                if let Output::Opening { device, .. } = std::mem::replace(&mut self.output, Output::None) {
                    tracing::info!("sound output: {description}");
                    let history = link.history.clone();
                    self.output =
                        Output::Playing { device, history: history.clone(), calls: 0, silent_looks: 0 };
                    *lock(&self.status) = OutputStatus { description, silent: None, history: Some(history) };
                    (self.deliver)(link);
                }
            }
            Event::Refused(error) => self.go_silent(error.to_string()),
            Event::Failed(reason) => self.go_silent(OutputError::Lost(reason).to_string()),
            Event::Quit => {}
        }
    }

    fn look(&mut self) {
        let failure = match &mut self.output {
            Output::Opening { since, .. } if since.elapsed() >= OPEN_LIMIT => {
                Some(OutputError::Timeout { seconds: OPEN_LIMIT.as_secs() })
            }
            Output::Playing { history, calls, silent_looks, .. } => {
                let now = history.calls();
                *silent_looks = if now == *calls { *silent_looks + 1 } else { 0 };
                *calls = now;
                (*silent_looks >= SILENT_LOOKS).then_some(OutputError::Stalled)
            }
            _ => None,
        };
        if let Some(failure) = failure {
            self.go_silent(failure.to_string());
        }
    }

    /// Puts the silent clock in the place of the present output.
    fn go_silent(&mut self, reason: String) {
        tracing::info!("no sound: {reason}");
        // What the device said until now or says later is void.
        self.attempt += 1;
        let rate = self.request.silent_rate;
        let (feeder, link) = Feeder::new(rate, 0, self.controls.clone(), self.counters.clone());
        let started = NullOutput::start(feeder, rate);
        let before = std::mem::replace(&mut self.output, Output::None);
        match started {
            Ok(silent) => {
                self.output = Output::Silent(silent);
                let (description, history) = ("silent clock".into(), Some(link.history.clone()));
                *lock(&self.status) = OutputStatus { description, silent: Some(reason), history };
                (self.deliver)(link);
            }
            Err(error) => lock(&self.status).silent = Some(format!("{reason}; and no silent clock: {error}")),
        }
        close(before);
    }

    fn end_output(&mut self) {
        close(std::mem::replace(&mut self.output, Output::None));
    }
}

fn close(output: Output) {
    match output {
        Output::Opening { device, .. } | Output::Playing { device, .. } => device.close(),
        Output::None | Output::Silent(_) => {}
    }
}
