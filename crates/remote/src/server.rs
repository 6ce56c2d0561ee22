//! The threads that listen: one that keeps the address, one that takes connections, and one for each of these.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use mariana_control::action::ActionRow;
use mariana_control::limits::LIMITS as CONTROL_LIMITS;
use mariana_control::osc::{Place, PlaceError};
use mariana_control::{Board, InputQueue};

use crate::album::Album;
use crate::connection_limit::{ConnectionLimit, ConnectionSlot};
use crate::http::{self, HeadBounds};
use crate::limits::{LIMITS, Limits};
use crate::page::policy;
use crate::pairing_address::PairingAddress;
use crate::phone_session::{self, PhoneSession};
use crate::route::{Refusal, Route, admit, route};
use crate::token::Token;

/// How often it is looked whether the computer has another address, and whether all is over.
const LOOK: Duration = Duration::from_millis(500);
/// How long nobody is listened to after the system could not give a connection.
const AGAIN: Duration = Duration::from_millis(200);

/// Where phones are listened to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemotePlace(Place);

impl FromStr for RemotePlace {
    type Err = PlaceError;

    /// `8080` is that port in every network of this computer; `ADDRESS:8080` is the port of an address. Port 0 is
    /// whichever is free.
    fn from_str(text: &str) -> Result<Self, PlaceError> {
        Place::parse(text, "0.0.0.0").map(Self)
    }
}

/// How it stands with listening.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RemoteState {
    /// The port is being opened.
    #[default]
    Opening,
    /// Phones can come by this invitation.
    Open(Arc<PairingAddress>),
    /// The system refuses the port, and why: a sentence. The server keeps trying.
    Refused(String),
}

/// Listens to phones until it is dropped.
pub struct Remote(Arc<Shared>);

/// What all threads share.
pub(crate) struct Shared {
    place: Place,
    token: Token,
    pub actions: &'static [ActionRow],
    pub input_queue: InputQueue,
    pub board: Board,
    pub album: Album,
    pub limits: Limits,
    state: Mutex<RemoteState>,
    connection_limit: ConnectionLimit,
    phones: AtomicUsize,
    is_over: AtomicBool,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Remote {
    /// Listens at `place` from now on, or as soon as the system gives the port. Phones send wishes from the table of
    /// actions, and get the board and the pictures of the album. `wake` is called when the state or the number of phones
    /// has changed, and when a phone asks for a picture.
    ///
    /// # Errors
    /// There is no thread, or no random number.
    pub fn start(
        place: RemotePlace,
        actions: &'static [ActionRow],
        input_queue: InputQueue,
        (board, album): (Board, Album),
        wake: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        Self::start_within(LIMITS, place, actions, input_queue, (board, album), wake)
    }

    /// The same within other limits.
    ///
    /// # Errors
    /// There is no thread, or no random number.
    pub fn start_within(
        limits: Limits,
        RemotePlace(place): RemotePlace,
        actions: &'static [ActionRow],
        input_queue: InputQueue,
        (board, album): (Board, Album),
        wake: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            place,
            token: Token::new()?,
            actions,
            input_queue,
            board,
            album,
            limits,
            state: Mutex::default(),
            connection_limit: ConnectionLimit::default(),
            phones: AtomicUsize::new(0),
            is_over: AtomicBool::new(false),
            wake: Box::new(wake),
        });
        let of_thread = shared.clone();
        thread(move || of_thread.keep())?;
        Ok(Self(shared))
    }

    /// How it stands.
    pub fn state(&self) -> RemoteState {
        lock(&self.0.state).clone()
    }

    /// How many phones there are.
    pub fn phones(&self) -> usize {
        self.0.phones.load(Ordering::Relaxed)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // It is not waited for: the threads end by themselves.
        self.0.is_over.store(true, Ordering::Relaxed);
    }
}

fn thread(run: impl FnOnce() + Send + 'static) -> io::Result<()> {
    std::thread::Builder::new().name("phones".into()).spawn(run).map(drop)
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Opens the port, and keeps the invitation up to date until all is over.
    fn keep(self: &Arc<Self>) {
        let Some(listens) = self.open_when_free() else { return };
        while !self.is_over() {
            let pairing_address = PairingAddress::new(listens, self.name(), &self.token);
            self.set_state(RemoteState::Open(Arc::new(pairing_address)));
            std::thread::sleep(LOOK);
        }
        // The thread that takes connections waits for one.
        let local = if listens.ip().is_unspecified() { IpAddr::from([127, 0, 0, 1]) } else { listens.ip() };
        let _ = TcpStream::connect_timeout(&SocketAddr::new(local, listens.port()), LOOK);
    }

    /// Opens the port, and tries again for as long as the system refuses it. `None` if all is over before.
    fn open_when_free(self: &Arc<Self>) -> Option<SocketAddr> {
        while !self.is_over() {
            match self.open() {
                Ok(listens) => return Some(listens),
                Err(error) => self.set_state(RemoteState::Refused(refusal(&self.place, &error))),
            }
            std::thread::sleep(CONTROL_LIMITS.port_retry);
        }
        None
    }

    fn open(self: &Arc<Self>) -> io::Result<SocketAddr> {
        let listener = TcpListener::bind(self.place.resolve()?)?;
        let listens = listener.local_addr()?;
        let shared = self.clone();
        thread(move || shared.take_connections(&listener))?;
        Ok(listens)
    }

    fn set_state(&self, state: RemoteState) {
        let is_new = {
            let mut known = lock(&self.state);
            let is_new = *known != state;
            *known = state;
            is_new
        };
        if is_new {
            (self.wake)();
        }
    }

    /// What the user called this computer, if that is a name.
    fn name(&self) -> Option<&str> {
        Some(self.place.host()).filter(|host| host.parse::<IpAddr>().is_err())
    }

    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    fn take_connections(self: &Arc<Self>, listener: &TcpListener) {
        for stream in listener.incoming() {
            if self.is_over() {
                return;
            }
            let Ok(stream) = stream else {
                // There are too many files open, for instance.
                std::thread::sleep(AGAIN);
                continue;
            };
            let Ok(from) = stream.peer_addr() else { continue };
            // More than there are seats for are cut off: telling them so would take time that others wait for.
            let Some(connection_slot) = self.connection_limit.take(from.ip(), &self.limits) else { continue };
            let shared = self.clone();
            if let Err(error) = thread(move || shared.serve(stream, from.ip(), &connection_slot)) {
                tracing::warn!("a phone is not listened to: {error}");
            }
        }
    }

    /// Answers one connection, which has a seat.
    fn serve(&self, stream: TcpStream, from: IpAddr, _connection_slot: &ConnectionSlot) {
        let limits = &self.limits;
        let within = limits.head_time_max;
        let bounds = HeadBounds {
            bytes_max: limits.head_bytes_max,
            fields_max: limits.head_fields_max,
            time_max: within,
        };
        let (head, rest) = match http::read_head(&stream, &bounds) {
            Ok(read) => read,
            Err(error) => {
                if let Some(status) = error.status() {
                    http::answer_in_words(&stream, status, &error.to_string(), within);
                }
                return;
            }
        };
        let refuse = |refusal: Refusal| {
            let (status, words) = refusal.words();
            http::answer_in_words(&stream, status, words, within);
        };
        let host = match admit(&head, self.name()) {
            Ok(host) => host,
            Err(refusal) => return refuse(refusal),
        };
        match route(&head, host, &self.token) {
            Ok(Route::Text(asset, host)) => {
                let policy = ("Content-Security-Policy", &*policy(&host));
                answer_own(&stream, (asset.kind, asset.text.as_bytes()), &[policy], within);
            }
            Ok(Route::Picture(scene)) => match self.album.find(&scene) {
                Some(jpeg) => answer_own(&stream, ("image/jpeg", &jpeg), &[], within),
                None => {
                    let is_one = self.board.read(|present| present.scenes.contains(&scene));
                    if is_one && self.album.want(&scene) {
                        (self.wake)();
                    }
                    http::answer_in_words(
                        &stream,
                        "404 Not Found",
                        "there is no picture of that yet",
                        within,
                    );
                }
            },
            Ok(Route::Slash) => {
                let to = format!("/{}/", self.token.as_str());
                let fields =
                    [("Location", &*to), ("Cache-Control", "no-store"), ("Referrer-Policy", "no-referrer")];
                http::answer(&stream, "308 Permanent Redirect", &fields, b"", within);
            }
            Ok(Route::PhoneSession(key)) => self.phone_session(stream, &key, rest),
            // Whoever may not talk because all places are taken is told so before being told how to ask.
            Err(Refusal::TalkOnly) if self.phones.load(Ordering::Acquire) >= limits.phones_max => {
                turn_away(&stream, within);
            }
            Err(refusal) => {
                if refusal == Refusal::WrongToken {
                    tracing::debug!("{from} asked with a wrong token");
                }
                refuse(refusal);
            }
        }
    }

    /// Speaks with a phone, if there is a place for it.
    fn phone_session(&self, stream: TcpStream, key: &str, rest: Vec<u8>) {
        let is_free = |phones: usize| (phones < self.limits.phones_max).then_some(phones + 1);
        if self.phones.fetch_update(Ordering::AcqRel, Ordering::Acquire, is_free).is_err() {
            return turn_away(&stream, self.limits.head_time_max);
        }
        (self.wake)();
        let _place = PhonePlace(self);
        tracing::info!("a phone has come");
        let accepted = phone_session::accept(&stream, key, self.limits.head_time_max);
        let end = match accepted {
            Ok(()) => PhoneSession::new(stream, rest, self).go_on(),
            Err(error) => error.to_string(),
        };
        tracing::info!("a phone has gone: {end}");
    }
}

/// A phone's place, free again when dropped.
struct PhonePlace<'a>(&'a Shared);

impl Drop for PhonePlace<'_> {
    fn drop(&mut self) {
        self.0.phones.fetch_sub(1, Ordering::AcqRel);
        (self.0.wake)();
    }
}

/// Answers with what is the program's own: a kind and its bytes.
fn answer_own(stream: &TcpStream, (kind, bytes): (&str, &[u8]), more: &[(&str, &str)], within: Duration) {
    let fields = [
        ("Content-Type", kind),
        ("Cache-Control", "no-store"),
        ("Referrer-Policy", "no-referrer"),
        ("X-Content-Type-Options", "nosniff"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
    ];
    http::answer(stream, "200 OK", &[&fields[..], more].concat(), bytes, within);
}

fn turn_away(stream: &TcpStream, within: Duration) {
    let words = "as many phones as there may be are here already: close the page on one of them";
    http::answer_in_words(stream, "503 Service Unavailable", words, within);
}

fn refusal(place: &Place, error: &io::Error) -> String {
    let sentence = match error.kind() {
        io::ErrorKind::AddrInUse => format!(
            "phones are not listened to: another program has {place}; end it, or choose another port with --remote"
        ),
        io::ErrorKind::PermissionDenied => format!(
            "phones are not listened to: the system gives nobody {place}; choose a port above 1023 with --remote"
        ),
        io::ErrorKind::AddrNotAvailable | io::ErrorKind::NotFound => format!(
            "phones are not listened to: {place} is no address of this computer; give --remote one of its own"
        ),
        _ => format!("phones are not listened to on {place} ({error}); choose another address with --remote"),
    };
    sentence + " (Mariana keeps trying)"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_that_of_every_network() {
        let place = |text: &str| text.parse::<RemotePlace>().map(|place| place.0.to_string());
        assert_eq!(place("8080").as_deref(), Ok("0.0.0.0:8080"));
        assert_eq!(place("127.0.0.1:0").as_deref(), Ok("127.0.0.1:0"));
        assert_eq!(place("x"), Err(PlaceError::Malformed));
        assert_eq!(place("70000"), Err(PlaceError::NoPortNorAny));
    }
}
