//! An OSC client for tests. It implements the OSC 1.0 specification without the program's library.

use std::net::UdpSocket;

pub(crate) struct Sender {
    socket: UdpSocket,
    pub(crate) port: u16,
}

impl Sender {
    pub(crate) fn new() -> Self {
        // This port was free just now.
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_nonblocking(true).unwrap();
        Self { socket, port }
    }

    pub(crate) fn send(&self, address: &str, numbers: &[f32]) {
        self.send_bytes(&message(address, numbers));
    }

    pub(crate) fn send_bytes(&self, bytes: &[u8]) {
        // Ignore errors: the system refuses some packets while no program listens.
        let _ = self.socket.send_to(bytes, ("127.0.0.1", self.port));
    }

    /// Receives an answer; `None` if no answer has arrived.
    pub(crate) fn receive(&self) -> Option<Vec<u8>> {
        let mut buffer = [0; 2_048];
        let (length, _) = self.socket.recv_from(&mut buffer).ok()?;
        Some(buffer[..length].to_vec())
    }
}

/// Strings in OSC are terminated by a zero and padded to a multiple of four bytes.
pub(crate) fn padded(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((text.len() / 4 + 1) * 4, 0);
    bytes
}

pub(crate) fn message(address: &str, numbers: &[f32]) -> Vec<u8> {
    let mut bytes = padded(address);
    bytes.extend(padded(&format!(",{}", "f".repeat(numbers.len()))));
    bytes.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
    bytes
}

/// Returns the newest received sound value `address`; `None` if no bundle contains it.
pub(crate) fn sent_number(lights: &UdpSocket, address: &str) -> Option<f32> {
    lights.set_nonblocking(true).unwrap();
    let (mut buffer, mut newest) = ([0; 2_048], None);
    let head = [padded(address), padded(",f")].concat();
    while let Ok((length, _)) = lights.recv_from(&mut buffer) {
        let packet = &buffer[..length];
        let place = packet.windows(head.len()).position(|part| part == head);
        newest = place.map(|place| packet[place + head.len()..][..4].try_into().unwrap()).or(newest);
    }
    newest.map(f32::from_be_bytes)
}
