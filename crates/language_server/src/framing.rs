//! Splits a stream of bytes into messages: a header with `Content-Length`, an empty line, and JSON.

use serde_json::Value;

use crate::limits;

/// The bytes that have arrived and are not yet a whole message.
#[derive(Debug, Default)]
pub struct Framing {
    bytes: Vec<u8>,
    /// Start of the unread bytes.
    at: usize,
    /// Bytes of a message that is too large, which are still to be skipped.
    to_skip: usize,
    is_broken: bool,
}

impl Framing {
    /// Appends bytes that have arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        let skipped = self.to_skip.min(bytes.len());
        self.to_skip -= skipped;
        if self.is_broken {
            return;
        }
        self.bytes.drain(..self.at);
        self.at = 0;
        self.bytes.extend_from_slice(bytes.get(skipped..).unwrap_or_default());
    }

    /// True after a header without a length: the start of the next message is unknown, and no further message is
    /// returned.
    pub fn is_broken(&self) -> bool {
        self.is_broken
    }

    /// Returns the next complete message.
    ///
    /// # Errors
    /// Fails with an explanation for a message that is no JSON or is too large, and for a header without a length.
    pub fn message(&mut self) -> Option<Result<Value, String>> {
        if self.is_broken {
            return None;
        }
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some((header, length)) = header(rest) else {
            if rest.len() <= limits::HEADER_BYTES_MAX {
                return None;
            }
            self.is_broken = true;
            let max = limits::HEADER_BYTES_MAX;
            return Some(Err(format!("the header of a message is longer than {max} bytes")));
        };
        let Some(length) = length else {
            self.is_broken = true;
            let message = "a message has no header `Content-Length`: send its length in bytes";
            return Some(Err(message.to_owned()));
        };
        let max = limits::MESSAGE_BYTES_MAX;
        if length > max {
            let here = rest.len().saturating_sub(header).min(length);
            self.at += header + here;
            self.to_skip = length - here;
            return Some(Err(format!("a message has {length} bytes; the maximum is {max}")));
        }
        let body = rest.get(header..header + length)?;
        let message = serde_json::from_slice(body);
        self.at += header + length;
        Some(message.map_err(|error| format!("a message is not JSON: {error}")))
    }
}

/// Returns the length of a header with its empty line, and the length of the message; `None` for an incomplete header.
fn header(bytes: &[u8]) -> Option<(usize, Option<usize>)> {
    let searched = bytes.get(..bytes.len().min(limits::HEADER_BYTES_MAX)).unwrap_or_default();
    let end = searched.windows(4).position(|four| four == b"\r\n\r\n")?;
    let text = String::from_utf8_lossy(searched.get(..end).unwrap_or_default()).into_owned();
    let length = text.split("\r\n").find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.trim().eq_ignore_ascii_case("content-length").then(|| value.trim().parse().ok()).flatten()
    });
    Some((end + 4, length))
}

/// Returns the bytes of a message with its header.
pub fn framed(message: &Value) -> Vec<u8> {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn messages_arrive_in_any_pieces() {
        let mut stream = framed(&json!({"id": 1, "text": "ä"}));
        stream.extend(b"content-length:2\r\nContent-Type: x\r\n\r\n{}");
        for size in [1, 3, 7, 1000] {
            let (mut framing, mut seen) = (Framing::default(), Vec::new());
            for piece in stream.chunks(size) {
                framing.push(piece);
                while let Some(message) = framing.message() {
                    seen.push(message.unwrap());
                }
            }
            assert_eq!(seen, [json!({"id": 1, "text": "ä"}), json!({})], "{size}");
        }
    }

    #[test]
    fn a_wrong_message_does_not_hide_the_next() {
        let mut framing = Framing::default();
        framing.push(b"Content-Length: 3\r\n\r\n{]}Content-Length: 2\r\n\r\n[]");
        assert!(framing.message().unwrap().is_err() && !framing.is_broken());
        assert_eq!(framing.message(), Some(Ok(json!([]))));
        assert_eq!(framing.message(), None);

        let large = limits::MESSAGE_BYTES_MAX + 1;
        framing.push(format!("Content-Length: {large}\r\n\r\n").as_bytes());
        assert!(framing.message().unwrap().is_err() && !framing.is_broken());
        for _ in 0..large / 100_000 {
            framing.push(&[b' '; 100_000]);
        }
        framing.push(&vec![b' '; large % 100_000]);
        framing.push(b"Content-Length: 1\r\n\r\n7");
        assert_eq!(framing.message(), Some(Ok(json!(7))));
        assert!(framing.bytes.capacity() < 1 << 20, "the large message was kept");
    }

    #[test]
    fn a_stream_without_lengths_is_given_up() {
        for wrong in
            ["{}\r\n\r\n{}", "Content-Length: -1\r\n\r\n", "Content-Length: 9999999999999999999999\r\n\r\n"]
        {
            let mut framing = Framing::default();
            framing.push(wrong.as_bytes());
            assert!(framing.message().unwrap().is_err() && framing.is_broken(), "{wrong}");
            framing.push(b"Content-Length: 2\r\n\r\n[]");
            assert_eq!(framing.message(), None);
        }
        let mut framing = Framing::default();
        framing.push(&vec![b'x'; limits::HEADER_BYTES_MAX + 1]);
        assert!(framing.message().unwrap().is_err() && framing.is_broken());
    }
}
