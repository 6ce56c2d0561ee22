//! The server's threads. One thread opens the port and keeps the pairing address up to date, one thread accepts
//! connections, and each connection has a thread.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use mariana_control::action::ActionRow;
use mariana_control::osc::{Place, PlaceError, PortState};
use mariana_control::{Board, InputQueue};
use mariana_work::lock;

use crate::album::Album;
use crate::connection_limit::{ConnectionLimit, ConnectionSlot};
use crate::http;
use crate::limits::Limits;
use crate::page::policy;
use crate::pairing_address::PairingAddress;
use crate::phone_session::{self, PhoneSession};
use crate::route::{Refusal, Route, admit, route};
use crate::token::AccessToken;

/// The interval at which the thread updates the pairing address and checks if the server has been dropped.
const LOOK: Duration = Duration::from_millis(500);
/// The pause after the system fails to accept a connection.
const AGAIN: Duration = Duration::from_millis(200);

/// The address on which phones connect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemotePlace(Place);

impl FromStr for RemotePlace {
    type Err = PlaceError;

    /// Parses `8080`, a port on all networks of this computer, or `ADDRESS:8080`. Port 0 means any free port.
    fn from_str(text: &str) -> Result<Self, PlaceError> {
        Place::parse(text, "0.0.0.0").map(Self)
    }
}

/// The state of the server: phones can connect with a pairing address.
pub type RemoteState = PortState<Arc<PairingAddress>>;

/// Serves phones until it is dropped.
pub struct Remote(Arc<Serving>);

pub(crate) struct Serving {
    place: Place,
    token: AccessToken,
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
    /// Starts serving on `place`, retrying until the port is free. Phones can send `actions`, and receive the state on
    /// the board and the images in the album. `wake` is called when the state or the number of phones changes, and when
    /// a phone requests a new image.
    ///
    /// # Errors
    /// Fails if the thread cannot be started, or the system has no random numbers.
    pub fn start(
        limits: Limits,
        RemotePlace(place): RemotePlace,
        actions: &'static [ActionRow],
        input_queue: InputQueue,
        board: Board,
        album: Album,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Serving {
            place,
            token: AccessToken::new()?,
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

    /// Returns the current state.
    pub fn state(&self) -> RemoteState {
        lock(&self.0.state).clone()
    }

    /// Returns the number of connected phones.
    pub fn phones(&self) -> usize {
        self.0.phones.load(Ordering::Relaxed)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // Do not wait: the threads end by themselves.
        self.0.is_over.store(true, Ordering::Relaxed);
    }
}

fn thread(run: impl FnOnce() + Send + 'static) -> io::Result<()> {
    std::thread::Builder::new().name("phones".into()).spawn(run).map(drop)
}

impl Serving {
    fn keep(self: &Arc<Self>) {
        let open = |address: SocketAddr| {
            let listener = TcpListener::bind(address)?;
            let (listens, shared) = (listener.local_addr()?, self.clone());
            thread(move || shared.accept_connections(&listener))?;
            Ok(listens)
        };
        let refused = |why| self.set_state(RemoteState::Refused(why));
        let is_over = || self.is_over();
        let listens = self.place.open_when_free("phone control", "--remote", is_over, open, refused);
        let Some(listens) = listens else { return };
        while !self.is_over() {
            let pairing_address = PairingAddress::new(listens, self.name(), &self.token);
            self.set_state(RemoteState::Open(Arc::new(pairing_address)));
            std::thread::sleep(LOOK);
        }
        // Wake the thread that accepts connections.
        let local = if listens.ip().is_unspecified() { IpAddr::from([127, 0, 0, 1]) } else { listens.ip() };
        let _ = TcpStream::connect_timeout(&SocketAddr::new(local, listens.port()), LOOK);
    }

    fn set_state(&self, state: RemoteState) {
        let is_new = lock(&self.state).replace(state);
        if is_new {
            (self.wake)();
        }
    }

    /// Returns the host given by the user, if it is a name.
    fn name(&self) -> Option<&str> {
        Some(self.place.host()).filter(|host| host.parse::<IpAddr>().is_err())
    }

    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    fn accept_connections(self: &Arc<Self>, listener: &TcpListener) {
        for stream in listener.incoming() {
            if self.is_over() {
                return;
            }
            let Ok(stream) = stream else {
                // Retry later: for example, too many files are open.
                std::thread::sleep(AGAIN);
                continue;
            };
            let Ok(from) = stream.peer_addr() else { continue };
            // Close connections beyond the limit without an answer, because an answer would delay other connections.
            let Some(connection_slot) = self.connection_limit.reserve(from.ip(), &self.limits) else {
                continue;
            };
            let shared = self.clone();
            if let Err(error) = thread(move || shared.serve(stream, from.ip(), &connection_slot)) {
                tracing::warn!("cannot start a thread for a phone: {error}");
            }
        }
    }

    fn serve(&self, stream: TcpStream, from: IpAddr, _connection_slot: &ConnectionSlot) {
        let limits = &self.limits;
        let within = limits.head.time_max;
        let (head, rest) = match http::read_head(&stream, &limits.head) {
            Ok(read) => read,
            Err(error) => {
                if let Some(status) = error.status() {
                    http::answer_in_words(&stream, status, &error.to_string(), within);
                }
                return;
            }
        };
        let refuse = |refusal: Refusal| {
            let Refusal(status, words) = refusal;
            http::answer_in_words(&stream, status, words, within);
        };
        let host = match admit(&head, self.name()) {
            Ok(host) => host,
            Err(refusal) => return refuse(refusal),
        };
        match route(&head, host, &self.token) {
            Ok(Route::Text(asset, host)) => {
                let policy = ("Content-Security-Policy", &*policy(&host));
                answer_own(&stream, asset.kind, asset.text.as_bytes(), &[policy], within);
            }
            Ok(Route::Picture(scene)) => match self.album.find(&scene) {
                Some(jpeg) => answer_own(&stream, "image/jpeg", &jpeg, &[], within),
                None => {
                    if self.board.newest().scenes.contains(&scene) && self.album.request(&scene) {
                        (self.wake)();
                    }
                    let words = "there is no image of this scene yet";
                    http::answer_in_words(&stream, "404 Not Found", words, within);
                }
            },
            Ok(Route::Slash) => {
                let to = format!("/{}/", self.token.as_str());
                let fields =
                    [("Location", &*to), ("Cache-Control", "no-store"), ("Referrer-Policy", "no-referrer")];
                http::answer(&stream, "308 Permanent Redirect", &fields, b"", within);
            }
            Ok(Route::PhoneSession(key)) => self.phone_session(stream, &key, rest),
            // The page asks without an upgrade why the phone was refused: answer that the server is full.
            Err(Refusal::TALK_ONLY) if self.phones.load(Ordering::Acquire) >= limits.phones_max => {
                turn_away(&stream, within);
            }
            Err(refusal) => {
                if refusal == Refusal::WRONG_TOKEN {
                    tracing::debug!("{from} sent a request with a wrong token");
                }
                refuse(refusal);
            }
        }
    }

    fn phone_session(&self, stream: TcpStream, key: &str, rest: Vec<u8>) {
        let is_free = |phones: usize| (phones < self.limits.phones_max).then_some(phones + 1);
        if self.phones.fetch_update(Ordering::AcqRel, Ordering::Acquire, is_free).is_err() {
            return turn_away(&stream, self.limits.head.time_max);
        }
        (self.wake)();
        let _place = PhonePlace(self);
        tracing::info!("a phone connected");
        let accepted = phone_session::accept(&stream, key, self.limits.head.time_max);
        let end = match accepted {
            Ok(()) => PhoneSession::new(stream, rest, self).run(),
            Err(error) => error.to_string(),
        };
        tracing::info!("a phone disconnected: {end}");
    }
}

/// A connected phone, counted until this is dropped.
struct PhonePlace<'a>(&'a Serving);

impl Drop for PhonePlace<'_> {
    fn drop(&mut self) {
        self.0.phones.fetch_sub(1, Ordering::AcqRel);
        (self.0.wake)();
    }
}

fn answer_own(stream: &TcpStream, kind: &str, bytes: &[u8], more: &[(&str, &str)], within: Duration) {
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
    let words = "too many phones are connected; close the page on one of them";
    http::answer_in_words(stream, "503 Service Unavailable", words, within);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_on_all_networks() {
        let place = |text: &str| text.parse::<RemotePlace>().map(|place| place.0.to_string());
        assert_eq!(place("8080").as_deref(), Ok("0.0.0.0:8080"));
        assert_eq!(place("127.0.0.1:0").as_deref(), Ok("127.0.0.1:0"));
        assert_eq!(place("x"), Err(PlaceError::Malformed));
        assert_eq!(place("70000"), Err(PlaceError::NoPortNorAny));
    }
}
