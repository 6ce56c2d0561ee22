//! The network address on which OSC is received, or to which OSC is sent.

use std::fmt::{self, Display, Formatter};
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr;

use crate::limits;

/// A host and a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    host: String,
    port: u16,
}

/// The error for a text that is no host and port.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlaceError {
    /// The text is neither a port nor an address with a port.
    #[error("give a port such as 9000, or an address and a port such as 192.168.0.7:9000")]
    Malformed,
    /// The port is out of range.
    #[error("the port must be a number from 1 to 65535")]
    NoPort,
    /// The port is out of range, and [port 0](Place::parse) is allowed.
    #[error("the port must be a number from 1 to 65535, or 0 for any free port")]
    NoPortNorAny,
}

/// The state of a port that a thread opens.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum PortState<T> {
    /// The port is being opened.
    #[default]
    Opening,
    /// The port is open.
    Open(T),
    /// The port cannot be opened; the text explains the reason. The thread keeps trying.
    Refused(String),
}

impl<T: PartialEq> PortState<T> {
    /// Stores a new state. Returns true if it differs from the state before.
    pub fn replace(&mut self, now: Self) -> bool {
        std::mem::replace(self, now) != *self
    }
}

const LOOPBACK: &str = "127.0.0.1";

impl FromStr for Place {
    type Err = PlaceError;

    /// Parses `9000`, a port that only this computer can reach, or `ADDRESS:9000`.
    fn from_str(text: &str) -> Result<Self, PlaceError> {
        match Self::parse(text, LOOPBACK) {
            Ok(Self { port: 0, .. }) | Err(PlaceError::NoPortNorAny) => Err(PlaceError::NoPort),
            place => place,
        }
    }
}

impl Place {
    /// Parses a port, or a host and a port. Without a host, `host` is used. Port 0 means any free port.
    ///
    /// # Errors
    /// Fails if the text has a different form, or the port is out of range.
    pub fn parse(text: &str, host: &str) -> Result<Self, PlaceError> {
        let (host, port) = text.rsplit_once(':').unwrap_or((host, text));
        let host = host.strip_prefix('[').and_then(|host| host.strip_suffix(']')).unwrap_or(host);
        if port.is_empty() || !port.bytes().all(|byte| byte.is_ascii_digit()) || host.is_empty() {
            return Err(PlaceError::Malformed);
        }
        if host.chars().any(|c| c.is_whitespace() || c.is_control() || c == '/') {
            return Err(PlaceError::Malformed);
        }
        let port = port.parse().map_err(|_| PlaceError::NoPortNorAny)?;
        Ok(Self { host: host.to_owned(), port })
    }

    /// Returns the host as written.
    pub fn host(&self) -> &str {
        &self.host
    }

    /// Resolves the address. For a host name, the call asks the system and may block.
    ///
    /// # Errors
    /// Fails if the name cannot be resolved.
    pub fn resolve(&self) -> io::Result<SocketAddr> {
        let nobody = || io::Error::new(io::ErrorKind::NotFound, "no computer has this name");
        (&*self.host, self.port).to_socket_addrs()?.next().ok_or_else(nobody)
    }

    /// Opens the port, retrying while `open` fails. Returns `None` if `is_over` returns true first. `refused` gets the
    /// reason of each failure as a sentence, in which `name` is what uses the port, and `flag` chooses the port.
    pub fn open_when_free<T>(
        &self,
        name: &str,
        flag: &str,
        is_over: impl Fn() -> bool,
        open: impl Fn(SocketAddr) -> io::Result<T>,
        refused: impl Fn(String),
    ) -> Option<T> {
        while !is_over() {
            match self.resolve().and_then(&open) {
                Ok(opened) => return Some(opened),
                Err(error) => refused(self.refusal(name, flag, &error)),
            }
            std::thread::sleep(limits::PORT_RETRY);
        }
        None
    }

    fn refusal(&self, name: &str, flag: &str, error: &io::Error) -> String {
        let sentence = match error.kind() {
            io::ErrorKind::AddrInUse => format!(
                "{name} is off: another program uses {self}; close it, or choose another port with {flag}"
            ),
            io::ErrorKind::PermissionDenied => {
                format!("{name} is off: the system denies {self}; choose a port above 1023 with {flag}")
            }
            io::ErrorKind::AddrNotAvailable | io::ErrorKind::NotFound => format!(
                "{name} is off: {self} is not an address of this computer; give {flag} one of its addresses"
            ),
            _ => format!("{name} on {self} failed ({error}); choose another address with {flag}"),
        };
        sentence + " (Mariana keeps trying)"
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.host.contains(':') {
            true => write!(f, "[{}]:{}", self.host, self.port),
            false => write!(f, "{}:{}", self.host, self.port),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_on_this_computer() {
        for (text, wanted) in [
            ("9000", "127.0.0.1:9000"),
            ("0.0.0.0:1", "0.0.0.0:1"),
            ("[::1]:65535", "[::1]:65535"),
            ("studio.local:8000", "studio.local:8000"),
        ] {
            assert_eq!(text.parse::<Place>().map(|place| place.to_string()), Ok(wanted.to_owned()));
        }
        assert!("9000".parse::<Place>().unwrap().resolve().unwrap().ip().is_loopback());
    }

    #[test]
    fn port_0_is_accepted_only_where_any_port_is_allowed() {
        let any = Place::parse("0", "0.0.0.0").unwrap();
        assert_eq!((any.to_string(), any.host()), ("0.0.0.0:0".to_owned(), "0.0.0.0"));
        assert_eq!("0".parse::<Place>(), Err(PlaceError::NoPort));
    }

    #[test]
    fn errors_mention_port_0_only_where_it_is_allowed() {
        let reported = |read: Result<Place, PlaceError>| read.unwrap_err().to_string();
        assert!(
            reported(Place::parse("99999", "0.0.0.0")).ends_with("from 1 to 65535, or 0 for any free port")
        );
        assert!(reported("99999".parse()).ends_with("from 1 to 65535"));
    }

    #[test]
    fn malformed_addresses_and_ports_out_of_range_are_different_errors() {
        for text in ["", "x", ":9000", "host:", "-1", "9e3", "a b:9000", "http://x:9", "host:+9"] {
            assert_eq!(text.parse::<Place>(), Err(PlaceError::Malformed), "{text}");
        }
        for text in ["0", "65536", "host:99999999999999999999"] {
            assert_eq!(text.parse::<Place>(), Err(PlaceError::NoPort), "{text}");
        }
    }
}
