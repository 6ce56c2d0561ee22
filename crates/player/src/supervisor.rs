//! The supervisor of one direction of sound opens a device, monitors it and follows the default device. If the device
//! fails, the supervisor starts a substitute and opens the device again as soon as possible. Outputs and inputs each
//! have a [`Port`].
//!
//! Each device has its own thread, which opens, holds and drops its stream. Any of these calls may hang, so a thread
//! that does not answer in time is abandoned. Only one opening runs at once, so that a hanging sound server costs one
//! thread in total, not one thread for each attempt.
//!
//! The supervisor counts the device's callbacks, and compares the open device with the polled device list, because cpal
//! does not report device changes, and a sound server silently moves the stream of an unplugged device to another
//! device. The open device continues until its successor is open. After an error, the supervisor waits before the next
//! attempt, unless the device has just played. A change in the device list ends the wait. The default may change and
//! change back between two polls, so the supervisor checks an opened device again after the next polls.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::device::{OnFailure, Opened, Port, Target};
use super::device_list::{DeviceList, DeviceWatch, ListedDevice};
use super::devices::monitor_id;
use super::error::{DeviceError, Direction};
use super::server_connection::ServerConnection;
use mariana_work::{Background, Latest, lock};

const OPEN_LIMIT: Duration = Duration::from_secs(3);

const WATCH_PERIOD: Duration = Duration::from_millis(100);

/// A device has stalled after this many checks without a callback. A time limit would expire in a suspended machine.
const SILENT_LOOKS: u32 = 10;

const CLOSE_LIMIT: Duration = Duration::from_millis(500);

/// The wait before another attempt. A change in the device list ends the wait.
const RETRY_WAIT: Duration = Duration::from_millis(500);

/// The same after an error that stays until the user acts.
const LONG_RETRY_WAIT: Duration = Duration::from_secs(5);

#[derive(Clone, Default)]
pub(crate) struct StreamStatus<N> {
    pub(crate) device: Option<ListedDevice>,
    pub(crate) silent: Option<String>,
    /// The reason why the chosen device could not be opened, while the previous device continues.
    pub(crate) refused: Option<String>,
    pub(crate) note: N,
}

/// A status that stays readable after the supervisor has ended.
pub(crate) type SharedStatus<N> = Arc<Mutex<StreamStatus<N>>>;

enum Event<L> {
    Quit,
    Choose(Target),
    Opened(Opened<L>),
    Refused(DeviceError),
    Failed(String),
}

type Numbered<L> = (u64, Event<L>);

pub(crate) struct Supervisor<P: Port> {
    events: Sender<Numbered<P::Link>>,
    status: SharedStatus<P::Note>,
    _worker: Background,
}

impl<P: Port> Supervisor<P> {
    pub(crate) fn start(port: P, target: Option<Target>) -> io::Result<Self> {
        let (events, inbox) = channel();
        let status = SharedStatus::<P::Note>::default();
        let device_list = if target.is_some() { Some(DeviceWatch::shared()?) } else { None };
        let mut watch = Watch {
            port,
            target,
            device_list,
            generation: 0,
            settled_after: None,
            status: status.clone(),
            events: events.clone(),
            last_number: 0,
            current: Current::None,
            opening: None,
            retry_at: None,
            had: None,
            superseded: false,
        };
        let worker = Background::start("sound devices", move || watch.run(&inbox))?;
        Ok(Self { events, status, _worker: worker.finished_at_drop(3 * CLOSE_LIMIT) })
    }

    pub(crate) fn status(&self) -> StreamStatus<P::Note> {
        lock(&self.status).clone()
    }

    pub(crate) fn shared_status(&self) -> SharedStatus<P::Note> {
        self.status.clone()
    }

    pub(crate) fn choose(&self, target: Target) {
        // A failed send means that the thread has ended.
        let _ = self.events.send((0, Event::Choose(target)));
    }
}

impl<P: Port> Drop for Supervisor<P> {
    fn drop(&mut self) {
        let _ = self.events.send((0, Event::Quit));
    }
}

/// A device's thread, which closes the device when `_hold` is dropped.
struct DeviceThread {
    number: u64,
    _hold: Sender<()>,
    worker: Background,
    /// The connection to close if the device does not close.
    connection: Option<ServerConnection>,
}

impl DeviceThread {
    fn close(self) {
        let Self { _hold: hold, mut worker, connection, .. } = self;
        drop(hold);
        if worker.finish(CLOSE_LIMIT) {
            return;
        }
        // Use a separate thread, because the server also may not answer.
        let ending =
            connection.map(|connection| Background::start("sound connection", move || connection.end()));
        if ending.is_none_or(|ending| ending.is_err()) || !worker.finish(CLOSE_LIMIT) {
            tracing::warn!("a sound device did not close and is abandoned");
        }
    }
}

enum Current {
    None,
    Device {
        thread: DeviceThread,
        entry: ListedDevice,
        since: Instant,
        calls: Box<dyn Fn() -> u64 + Send>,
        called: u64,
        silent_looks: u32,
    },
    /// The substitute for a device. The substitute stops when this value is dropped.
    StandIn(#[allow(dead_code, reason = "held because it stops when it is dropped")] Option<Latest<()>>),
}

struct Opening {
    thread: DeviceThread,
    since: Instant,
    /// True if the opening is late. It may still succeed.
    overdue: bool,
}

struct Watch<P: Port> {
    port: P,
    target: Option<Target>,
    device_list: Option<Arc<DeviceWatch>>,
    generation: u64,
    /// The number of polls after which the device list certainly covers the last opening. Until then, the default
    /// device may have changed and changed back unnoticed, so that the opened device is no longer the default.
    settled_after: Option<u64>,
    status: SharedStatus<P::Note>,
    events: Sender<Numbered<P::Link>>,
    last_number: u64,
    current: Current,
    opening: Option<Opening>,
    retry_at: Option<Instant>,
    /// The device that was open last for the current target.
    had: Option<ListedDevice>,
    /// True if the open device was chosen before the current target.
    superseded: bool,
}

impl<P: Port> Watch<P> {
    fn run(&mut self, inbox: &Receiver<Numbered<P::Link>>) {
        if self.target.is_some() {
            self.open();
        } else {
            self.switch_to_silence("the sound is switched off".into());
        }
        loop {
            match inbox.recv_timeout(WATCH_PERIOD) {
                Ok((_, Event::Quit)) | Err(RecvTimeoutError::Disconnected) => break,
                Ok((number, event)) => self.handle_event(number, event),
                Err(RecvTimeoutError::Timeout) => {}
            }
            self.poll();
        }
        if let Some(opening) = self.opening.take() {
            opening.thread.close();
        }
        close(std::mem::replace(&mut self.current, Current::None));
    }

    /// Starts to open the target, unless an opening is running.
    fn open(&mut self) {
        let Some(target) = self.target.clone() else { return };
        if self.opening.is_some() {
            return;
        }
        self.retry_at = None;
        self.last_number += 1;
        let number = self.last_number;
        let (hold, held) = channel::<()>();
        let opener = self.port.opener();
        let events = self.events.clone();
        let failures = events.clone();
        let worker = Background::start("sound device", move || {
            let on_failure: OnFailure =
                Arc::new(move |reason| drop(failures.send((number, Event::Failed(reason)))));
            match opener(target, on_failure) {
                Ok((stream, opened)) => {
                    if events.send((number, Event::Opened(opened))).is_ok() {
                        // This call returns when the other end is dropped, because no message is ever sent.
                        let _ = held.recv();
                    }
                    drop(stream);
                }
                Err(error) => drop(events.send((number, Event::Refused(error)))),
            }
        });
        match worker {
            Ok(worker) => {
                let thread = DeviceThread { number, _hold: hold, worker, connection: None };
                self.opening = Some(Opening { thread, since: Instant::now(), overdue: false });
            }
            Err(error) => self.lose(&DeviceError::Thread(P::DIRECTION, error.to_string())),
        }
    }

    fn handle_event(&mut self, number: u64, event: Event<P::Link>) {
        let is_opening = self.opening.as_ref().is_some_and(|opening| opening.thread.number == number);
        let is_current = matches!(&self.current, Current::Device { thread, .. } if thread.number == number);
        match event {
            Event::Choose(target) => {
                self.target = Some(target);
                self.had = None;
                self.superseded = true;
                lock(&self.status).refused = None;
                if self.device_list.is_none() {
                    self.device_list = DeviceWatch::shared().ok();
                }
                // The running opening is obsolete. If the opening hangs, its thread is abandoned.
                if let Some(opening) = self.opening.take() {
                    opening.thread.close();
                }
                self.open();
            }
            Event::Opened(opened) if is_opening => {
                if let Some(Opening { mut thread, .. }) = self.opening.take() {
                    thread.connection = opened.connection;
                    self.adopt(thread, opened);
                }
            }
            Event::Refused(error) if is_opening => {
                self.opening = None;
                let error = match (&self.had, error) {
                    (Some(had), DeviceError::UnknownDevice(direction, _)) => {
                        DeviceError::Gone(direction, had.name.clone())
                    }
                    (_, error) => error,
                };
                self.lose(&error);
            }
            Event::Failed(reason) if is_current => self.lose(&DeviceError::Lost(P::DIRECTION, reason)),
            // Events of an abandoned device are ignored. If a device fails while it opens, it stalls later, and that is
            // handled.
            _ => {}
        }
    }

    fn adopt(&mut self, thread: DeviceThread, opened: Opened<P::Link>) {
        let Opened { link, entry, description, calls, .. } = opened;
        tracing::info!("sound {}: {description}", P::DIRECTION);
        self.had = Some(entry.clone());
        self.superseded = false;
        self.settled_after = self.device_list.as_ref().map(|watch| watch.looks() + 2);
        self.retry_at = None;
        let since = Instant::now();
        let device =
            Current::Device { thread, entry: entry.clone(), since, calls, called: 0, silent_looks: 0 };
        let before = std::mem::replace(&mut self.current, device);
        let note = P::describe(&link);
        *lock(&self.status) = StreamStatus { device: Some(entry), silent: None, refused: None, note };
        self.port.ready(Some(link));
        close(before);
    }

    /// Handles a failed device, or an opening that failed or is late. A failed device is replaced by silence.
    fn lose(&mut self, error: &DeviceError) {
        let is_of_current =
            matches!(error, DeviceError::Lost(..) | DeviceError::Stalled(_) | DeviceError::Gone(..));
        // Keep a current device that still plays: only the new default or the new choice cannot be opened.
        let stands = !is_of_current
            && matches!(self.current, Current::Device { silent_looks, .. } if silent_looks < SILENT_LOOKS);
        // A stream that has played for a while may only have to be built again, for example with another rate.
        let has_played = matches!(self.current, Current::Device { called: 1.., since, .. }
            if since.elapsed() >= RETRY_WAIT);
        if !stands {
            self.switch_to_silence(error.to_string());
        } else if self.superseded {
            lock(&self.status).refused = Some(error.to_string());
        }
        let wait = match error {
            _ if has_played && !stands => Duration::ZERO,
            DeviceError::Denied(..) | DeviceError::Format(..) | DeviceError::Rate(..) => LONG_RETRY_WAIT,
            _ => RETRY_WAIT,
        };
        self.retry_at = Some(Instant::now() + wait);
    }

    fn poll(&mut self) {
        if let Some(opening) = &mut self.opening
            && !opening.overdue
            && opening.since.elapsed() >= OPEN_LIMIT
        {
            opening.overdue = true;
            let error = DeviceError::Timeout(P::DIRECTION, OPEN_LIMIT.as_secs());
            self.lose(&error);
        }
        if let Current::Device { calls, called, silent_looks, .. } = &mut self.current {
            let now = calls();
            *silent_looks = if now == *called { *silent_looks + 1 } else { 0 };
            *called = now;
            if *silent_looks >= SILENT_LOOKS {
                self.lose(&DeviceError::Stalled(P::DIRECTION));
            }
        }
        self.follow();
        if self.retry_at.is_some_and(|at| at <= Instant::now()) {
            self.retry_at = None;
            match self.current {
                // The current device still plays; only its successor failed to open. Check again which device to use.
                Current::Device { .. } => self.generation = 0,
                _ => self.open(),
            }
        }
    }

    fn follow(&mut self) {
        let Some(watch) = self.device_list.as_ref().filter(|_| self.opening.is_none()) else { return };
        let (generation, device_list) = watch.latest();
        let settled = self.settled_after.is_some_and(|looks| watch.looks() >= looks);
        if generation == self.generation && !settled {
            return;
        }
        self.generation = generation;
        if settled {
            self.settled_after = None;
        }
        if !device_list.known {
            return;
        }
        match &self.current {
            Current::Device { .. } if self.superseded => self.open(),
            Current::Device { entry, .. } => {
                if let Some(gone) = self.has_gone(&device_list, entry) {
                    self.lose(&gone);
                } else if self.default_of(&device_list).is_some_and(|wanted| wanted != entry.id) {
                    self.open();
                }
            }
            Current::StandIn(_) | Current::None => self.open(),
        }
    }

    fn default_of(&self, device_list: &DeviceList) -> Option<String> {
        let (listed, default) = match P::DIRECTION {
            Direction::Output => (&device_list.outputs, &device_list.default_output),
            Direction::Input => (&device_list.inputs, &device_list.default_input),
        };
        match self.target.as_ref()? {
            Target::Named(_) | Target::MonitorOf(_) => None,
            Target::Monitor => device_list.default_output.as_deref().map(monitor_id),
            Target::Preferred(wanted) if listed.iter().any(|entry| entry.id == *wanted) => {
                Some(wanted.clone())
            }
            Target::Preferred(_) | Target::Default => default.clone(),
        }
    }

    /// Returns an error if the named device is gone, because servers silently move its stream to another device.
    fn has_gone(&self, device_list: &DeviceList, entry: &ListedDevice) -> Option<DeviceError> {
        let named = matches!(self.target, Some(Target::Named(_) | Target::MonitorOf(_)));
        let list = match P::DIRECTION {
            Direction::Output => &device_list.outputs,
            Direction::Input => &device_list.inputs,
        };
        // Check only hosts in the list, because devices of other hosts are never listed.
        let same_host = |other: &ListedDevice| other.id.split(':').next() == entry.id.split(':').next();
        let hosts_differ = !device_list.outputs.iter().chain(&device_list.inputs).any(same_host);
        let gone = named && !hosts_differ && !list.iter().any(|other| other.id == entry.id);
        gone.then(|| DeviceError::Gone(P::DIRECTION, entry.name.clone()))
    }

    fn switch_to_silence(&mut self, reason: String) {
        let reported = lock(&self.status).silent.replace(reason.clone());
        if reported.as_ref() != Some(&reason) {
            tracing::info!("no sound {}: {reason}", P::DIRECTION);
        }
        if matches!(self.current, Current::StandIn(_)) {
            return;
        }
        let stand_in = self.port.stand_in().unwrap_or_else(|error| {
            lock(&self.status).silent =
                Some(format!("{reason}; and the silent clock could not start: {error}"));
            None
        });
        let (stand_in, link) = stand_in.unzip();
        {
            let mut status = lock(&self.status);
            status.device = None;
            status.note = link.as_ref().map(P::describe).unwrap_or_default();
        }
        self.port.ready(link);
        close(std::mem::replace(&mut self.current, Current::StandIn(stand_in)));
    }
}

fn close(current: Current) {
    if let Current::Device { thread, .. } = current {
        thread.close();
    }
}
