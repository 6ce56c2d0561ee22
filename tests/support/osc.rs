//! A program that speaks OSC with Mariana, by the book (OSC 1.0) and not by the program's own library.

use std::net::UdpSocket;

/// A program that sends OSC, and hears the answers.
pub(crate) struct Sender {
    socket: UdpSocket,
    /// Where Mariana is to hear it.
    pub(crate) port: u16,
}

impl Sender {
    pub(crate) fn new() -> Self {
        // A port that was free a moment ago.
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_nonblocking(true).unwrap();
        Self { socket, port }
    }

    /// Sends a message with numbers.
    pub(crate) fn send(&self, address: &str, numbers: &[f32]) {
        self.send_bytes(&message(address, numbers));
    }

    /// Sends bytes of any kind.
    pub(crate) fn send_bytes(&self, bytes: &[u8]) {
        // What nobody hears yet is refused now and then.
        let _ = self.socket.send_to(bytes, ("127.0.0.1", self.port));
    }

    /// An answer that has come.
    pub(crate) fn receive(&self) -> Option<Vec<u8>> {
        let mut buffer = [0; 2_048];
        let (length, _) = self.socket.recv_from(&mut buffer).ok()?;
        Some(buffer[..length].to_vec())
    }
}

/// A text as messages have it.
pub(crate) fn padded(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((text.len() / 4 + 1) * 4, 0);
    bytes
}

/// The bytes of a message.
pub(crate) fn message(address: &str, numbers: &[f32]) -> Vec<u8> {
    let mut bytes = padded(address);
    bytes.extend(padded(&format!(",{}", "f".repeat(numbers.len()))));
    bytes.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
    bytes
}

/// What the newest bundle that has come says of a number of the sound.
pub(crate) fn sent_number(lights: &UdpSocket, address: &str) -> Option<f32> {
    lights.set_nonblocking(true).unwrap();
    let (mut buffer, mut newest) = ([0; 2_048], None);
    while let Ok((length, _)) = lights.recv_from(&mut buffer) {
        newest = Some(buffer[..length].to_vec());
    }
    let (packet, head) = (newest?, [padded(address), padded(",f")].concat());
    let place = packet.windows(head.len()).position(|part| part == head)? + head.len();
    Some(f32::from_be_bytes(packet.get(place..place + 4)?.try_into().unwrap()))
}
