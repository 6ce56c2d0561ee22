//! The address that a phone opens, and its QR code.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

use qrcode::{EcLevel, QrCode};

use crate::token::AccessToken;

/// Addresses reserved for documentation (RFC 5737, RFC 3849). Connecting a UDP socket to one makes the system choose a
/// local address, but sends no packet.
const FAR_V4: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::new(192, 0, 2, 1)), 9);
const FAR_V6: SocketAddr = SocketAddr::new(IpAddr::V6(Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1)), 9);

/// The address of the phone page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairingAddress {
    /// The URL.
    pub url: String,
    /// The QR code of the URL.
    pub code: Code,
    /// True if only this computer can open the address.
    pub is_local: bool,
}

impl PairingAddress {
    /// Returns the address of a server listening on `listens`. `name` is the host name given by the user, if any.
    pub(crate) fn new(listens: SocketAddr, name: Option<&str>, token: &AccessToken) -> Self {
        let address = reachable(listens.ip());
        let host = match name {
            Some(name) => format!("{name}:{}", listens.port()),
            None => SocketAddr::new(address, listens.port()).to_string(),
        };
        let url = format!("http://{host}/{}/", token.as_str());
        Self { code: Code::of(&url), url, is_local: address.is_loopback() }
    }
}

/// Returns the address that phones can use. If `listens` is unspecified, returns the address of the default route's
/// interface.
fn reachable(listens: IpAddr) -> IpAddr {
    if !listens.is_unspecified() {
        return listens;
    }
    let (own, far, local) = match listens {
        IpAddr::V4(_) => ("0.0.0.0:0", FAR_V4, IpAddr::V4(Ipv4Addr::LOCALHOST)),
        IpAddr::V6(_) => ("[::]:0", FAR_V6, IpAddr::V6(Ipv6Addr::LOCALHOST)),
    };
    let asked = UdpSocket::bind(own).and_then(|socket| {
        socket.connect(far)?;
        socket.local_addr()
    });
    asked.map(|address| address.ip()).ok().filter(|address| !address.is_unspecified()).unwrap_or(local)
}

/// A QR code without its white margin.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Code {
    /// Number of modules along an edge.
    pub side: usize,
    dark: Vec<bool>,
}

impl Code {
    /// The width of the required white margin, in modules.
    pub const EDGE: usize = 4;

    /// Encodes a text. The code of a text that is too long is empty.
    pub fn of(text: &str) -> Self {
        let Ok(code) = QrCode::with_error_correction_level(text, EcLevel::M) else { return Self::default() };
        let dark = code.to_colors().into_iter().map(|color| color == qrcode::Color::Dark).collect();
        Self { side: code.width(), dark }
    }

    /// Returns the positions of the dark modules, from the left and from the top.
    pub fn dark(&self) -> impl Iterator<Item = (usize, usize)> {
        let side = self.side.max(1);
        self.dark.iter().enumerate().filter(|(_, dark)| **dark).map(move |(at, _)| (at % side, at / side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_url_has_the_listening_address_and_the_token() {
        let token = AccessToken::new().unwrap();
        let pairing_address =
            |listens: &str, name| PairingAddress::new(listens.parse().unwrap(), name, &token);
        let local = pairing_address("127.0.0.1:8080", None);
        assert_eq!(local.url, format!("http://127.0.0.1:8080/{}/", token.as_str()));
        assert!(local.is_local);
        assert_eq!(
            pairing_address("[fe80::1]:1", None).url,
            format!("http://[fe80::1]:1/{}/", token.as_str())
        );
        let named = pairing_address("192.168.0.7:80", Some("studio.local"));
        assert!(named.url.starts_with("http://studio.local:80/") && !named.is_local);
        // An unspecified address is replaced by an address that a phone can open.
        for listens in ["0.0.0.0:8080", "[::]:8080"] {
            let host = pairing_address(listens, None).url;
            let host: SocketAddr = host["http://".len()..].split('/').next().unwrap().parse().unwrap();
            assert!(!host.ip().is_unspecified() && host.port() == 8080, "{host}");
        }
    }

    #[test]
    fn a_code_is_a_square_with_three_finder_patterns() {
        let code = Code::of("http://192.168.100.100:65535/0123456789abcdefghjkmnpqrs/");
        assert!((21..=37).contains(&code.side), "{} modules are hard to scan", code.side);
        let dark: std::collections::BTreeSet<_> = code.dark().collect();
        let last = code.side - 1;
        for corner in [(0, 0), (last, 0), (0, last), (3, 3)] {
            assert!(dark.contains(&corner), "{corner:?}");
        }
        assert!(!dark.contains(&(1, 1)) && dark.iter().all(|(x, y)| *x <= last && *y <= last));
        assert_eq!(Code::of(&"x".repeat(5_000)), Code::default());
    }
}
