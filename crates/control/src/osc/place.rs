//! Where OSC is heard, or where it goes.

use std::fmt::{self, Display, Formatter};
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr;

/// A computer and a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    host: String,
    port: u16,
}

/// A place that cannot be meant.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlaceError {
    /// It is neither a port nor an address with one.
    #[error("this is neither a port such as 9000 nor an address with one such as 192.168.0.7:9000")]
    Malformed,
    /// Ports have other numbers.
    #[error("a port is a number from 1 to 65535")]
    NoPort,
    /// Ports have other numbers, where [any free one](Place::parse) may be asked for.
    #[error("a port is a number from 1 to 65535, or 0 for any that is free")]
    NoPortNorAny,
}

/// This computer alone.
const LOOPBACK: &str = "127.0.0.1";

impl FromStr for Place {
    type Err = PlaceError;

    /// `9000` is that port of this computer, which no other can reach; `ADDRESS:9000` is the port of an address.
    fn from_str(text: &str) -> Result<Self, PlaceError> {
        match Self::parse(text, LOOPBACK) {
            Ok(Self { port: 0, .. }) | Err(PlaceError::NoPortNorAny) => Err(PlaceError::NoPort),
            place => place,
        }
    }
}

impl Place {
    /// The same with `host` where only a port is given. Port 0 is whichever is free.
    ///
    /// # Errors
    /// [`PlaceError`].
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

    /// The computer, as it was given.
    pub fn host(&self) -> &str {
        &self.host
    }

    /// Its address. Asks the system for names, which may take long.
    ///
    /// # Errors
    /// What the system says; a name that is nobody's.
    pub fn resolve(&self) -> io::Result<SocketAddr> {
        let nobody = || io::Error::new(io::ErrorKind::NotFound, "no computer has this name");
        (&*self.host, self.port).to_socket_addrs()?.next().ok_or_else(nobody)
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
    fn a_port_alone_is_this_computer_and_addresses_are_as_they_are_given() {
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
    fn a_port_that_is_to_be_found_is_only_one_where_it_may_be() {
        let any = Place::parse("0", "0.0.0.0").unwrap();
        assert_eq!((any.to_string(), any.host()), ("0.0.0.0:0".to_owned(), "0.0.0.0"));
        assert_eq!("0".parse::<Place>(), Err(PlaceError::NoPort));
    }

    #[test]
    fn a_port_that_is_too_large_is_told_from_where_0_may_be_asked_for() {
        let reported = |read: Result<Place, PlaceError>| read.unwrap_err().to_string();
        assert!(
            reported(Place::parse("99999", "0.0.0.0"))
                .ends_with("from 1 to 65535, or 0 for any that is free")
        );
        assert!(reported("99999".parse()).ends_with("from 1 to 65535"));
    }

    #[test]
    fn what_is_no_place_is_told_from_a_port_that_is_too_large() {
        for text in ["", "x", ":9000", "host:", "-1", "9e3", "a b:9000", "http://x:9", "host:+9"] {
            assert_eq!(text.parse::<Place>(), Err(PlaceError::Malformed), "{text}");
        }
        for text in ["0", "65536", "host:99999999999999999999"] {
            assert_eq!(text.parse::<Place>(), Err(PlaceError::NoPort), "{text}");
        }
    }
}
