//! Measures the response time of a window, as compositors do, by pings (Extended Window Manager Hints, `_NET_WM_PING`).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::cookie::VoidCookie;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ChangeWindowAttributesAux, ClientMessageEvent, ConnectionExt, EventMask, Window,
};
use x11rb::rust_connection::RustConnection;

const PERIOD: Duration = Duration::from_millis(20);
/// The maximum time to wait for an answer.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) struct Pings {
    thread: Option<JoinHandle<()>>,
    over: Arc<AtomicBool>,
    answers: Arc<Mutex<Vec<Answer>>>,
}

/// The response time of a ping, and the time at which the ping was sent.
type Answer = (Duration, Instant);

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Answers {
    pub count: usize,
    pub median: Duration,
    /// The 99.9th percentile.
    pub permille: Duration,
    pub worst: Duration,
    /// The time from the first ping to the ping with the slowest answer.
    pub worst_at: Duration,
}

impl Pings {
    pub(crate) fn start(display: &str, window: Window) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let answers = Arc::<Mutex<Vec<Answer>>>::default();
        let (display, stop, noted) = (display.to_owned(), over.clone(), answers.clone());
        let thread = std::thread::spawn(move || ask(&display, window, &stop, &noted));
        Self { thread: Some(thread), over, answers }
    }

    pub(crate) fn stop(mut self) -> Answers {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
        let mut times = self.answers.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let Some((_, first)) = times.first().copied() else { return Answers::default() };
        times.sort();
        let at = |fraction: f64| times[((times.len() as f64 * fraction) as usize).min(times.len() - 1)];
        Answers {
            count: times.len(),
            median: at(0.5).0,
            permille: at(0.999).0,
            worst: at(1.0).0,
            worst_at: at(1.0).1 - first,
        }
    }
}

/// Pings a window over a separate connection to the X server.
pub(crate) struct Pinger {
    connection: RustConnection,
    root: Window,
    window: Window,
    atoms: [u32; 2],
    number: u32,
}

impl Pinger {
    pub(crate) fn connect(display: &str, window: Window) -> Self {
        let (connection, screen) = RustConnection::connect(Some(display)).unwrap();
        let root = connection.setup().roots[screen].root;
        // The root window receives the answers.
        let mask = ChangeWindowAttributesAux::new().event_mask(EventMask::SUBSTRUCTURE_NOTIFY);
        connection.change_window_attributes(root, &mask).unwrap().check().unwrap();
        let atoms = ["WM_PROTOCOLS", "_NET_WM_PING"]
            .map(|name| connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom);
        Self { connection, root, window, atoms, number: 1 }
    }

    /// Sends a ping without waiting for the X server.
    pub(crate) fn send(&mut self) -> VoidCookie<'_, RustConnection> {
        self.number += 1;
        let [protocols, ping] = self.atoms;
        let message =
            ClientMessageEvent::new(32, self.window, protocols, [ping, self.number, self.window, 0, 0]);
        let sent = self.connection.send_event(false, self.window, EventMask::NO_EVENT, message).unwrap();
        self.connection.flush().unwrap();
        sent
    }

    /// Waits for the answer to the last ping, or until `gives_up` returns true. Returns true if the answer arrived.
    pub(crate) fn wait(&self, mut gives_up: impl FnMut() -> bool) -> bool {
        loop {
            match self.connection.poll_for_event().unwrap() {
                Some(Event::ClientMessage(answer))
                    if answer.window == self.root && answer.data.as_data32()[1] == self.number =>
                {
                    return true;
                }
                Some(_) => {}
                None if gives_up() => return false,
                None => std::thread::sleep(Duration::from_millis(1)),
            }
        }
    }
}

fn ask(display: &str, window: Window, over: &AtomicBool, answers: &Mutex<Vec<Answer>>) {
    let mut pinger = Pinger::connect(display, window);
    while !over.load(Ordering::Relaxed) {
        let asked = Instant::now();
        if pinger.send().check().is_err() {
            return;
        }
        pinger.wait(|| {
            let waited = asked.elapsed();
            waited >= PATIENCE || over.load(Ordering::Relaxed) && waited > PERIOD
        });
        answers.lock().unwrap_or_else(PoisonError::into_inner).push((asked.elapsed(), asked));
        std::thread::sleep(PERIOD.saturating_sub(asked.elapsed()));
    }
}
