//! A minimal HTTP server: reads request heads within bounds and closes the connection after each answer.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// The time to wait for the rest of a request after the answer.
const PARTING_TIME: Duration = Duration::from_millis(200);
const PARTING_BYTES_MAX: usize = 64 << 10;

/// The head of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// The method, such as `GET`.
    pub method: String,
    /// The requested path, undecoded.
    pub path: String,
    fields: Vec<(String, String)>,
    /// The length of the head in bytes.
    pub length: usize,
}

/// The error when no valid head arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum HeadError {
    /// The client closed the connection or was too slow.
    #[error("the connection ended before the request was complete")]
    Gone,
    /// The bytes are not HTTP.
    #[error("this is not an HTTP request; send GET / HTTP/1.1")]
    Malformed,
    /// The head has too many bytes or fields.
    #[error("the request is too large")]
    TooLong,
}

impl HeadError {
    /// Returns the HTTP status of the answer, or `None` if the client is gone.
    pub fn status(self) -> Option<&'static str> {
        match self {
            Self::Gone => None,
            Self::Malformed => Some("400 Bad Request"),
            Self::TooLong => Some("431 Request Header Fields Too Large"),
        }
    }
}

impl Head {
    /// Parses the head at the start of `bytes`. Returns `None` if the head is incomplete.
    ///
    /// # Errors
    /// Fails if the bytes are not HTTP, or the head has more than `fields_max` fields.
    pub fn parse(bytes: &[u8], fields_max: usize) -> Result<Option<Self>, HeadError> {
        let mut fields = vec![httparse::EMPTY_HEADER; fields_max];
        let mut request = httparse::Request::new(&mut fields);
        let length = match request.parse(bytes) {
            Ok(httparse::Status::Complete(length)) => length,
            Ok(httparse::Status::Partial) => return Ok(None),
            Err(httparse::Error::TooManyHeaders) => return Err(HeadError::TooLong),
            Err(_) => return Err(HeadError::Malformed),
        };
        let text = |text: Option<&str>| text.map(str::to_owned).ok_or(HeadError::Malformed);
        let field = |field: &httparse::Header<'_>| {
            (field.name.to_owned(), String::from_utf8_lossy(field.value).trim().to_owned())
        };
        Ok(Some(Self {
            method: text(request.method)?,
            path: text(request.path)?,
            fields: request.headers.iter().map(field).collect(),
            length,
        }))
    }

    /// Returns a field's value by its case-insensitive name; `None` if it is missing or appears twice.
    pub fn field(&self, name: &str) -> Option<&str> {
        let mut found = self.fields.iter().filter(|(one, _)| one.eq_ignore_ascii_case(name));
        let value = found.next().map(|(_, value)| value.as_str());
        value.filter(|_| found.next().is_none())
    }

    /// True if there is a field with this name.
    pub fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|(one, _)| one.eq_ignore_ascii_case(name))
    }
}

/// The limits for reading a head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadBounds {
    /// The maximum length in bytes.
    pub bytes_max: usize,
    /// The maximum number of fields.
    pub fields_max: usize,
    /// The maximum time for the whole head.
    pub time_max: Duration,
}

/// Reads a head. Returns the head, and the bytes that were read after it.
///
/// # Errors
/// Fails if the client is gone, the bytes are not HTTP, or the head exceeds `bounds`.
pub fn read_head(mut stream: &TcpStream, bounds: &HeadBounds) -> Result<(Head, Vec<u8>), HeadError> {
    let end = Instant::now() + bounds.time_max;
    let mut bytes = Vec::new();
    let mut chunk = [0; 1_024];
    loop {
        let count = read_until(&mut stream, &mut chunk, end).map_err(|_| HeadError::Gone)?;
        bytes.extend_from_slice(chunk.get(..count).unwrap_or_default());
        match Head::parse(&bytes, bounds.fields_max)? {
            Some(head) if head.length <= bounds.bytes_max => {
                let rest = bytes.split_off(head.length);
                return Ok((head, rest));
            }
            None if bytes.len() <= bounds.bytes_max && count > 0 => {}
            None if bytes.is_empty() => return Err(HeadError::Gone),
            None if count == 0 => return Err(HeadError::Malformed),
            _ => return Err(HeadError::TooLong),
        }
    }
}

/// Reads the available bytes, waiting until `end` at most. Returns 0 at the end of the stream.
fn read_until(stream: &mut &TcpStream, chunk: &mut [u8], end: Instant) -> io::Result<usize> {
    loop {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(chunk) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

/// Sends an answer with a body and closes the connection. Errors are ignored: the client may be gone.
pub fn answer(mut stream: &TcpStream, status: &str, fields: &[(&str, &str)], body: &[u8], within: Duration) {
    let mut answer = format!("HTTP/1.1 {status}\r\n");
    for (name, value) in fields {
        answer.push_str(&format!("{name}: {value}\r\n"));
    }
    answer.push_str(&format!("Content-Length: {}\r\nConnection: close\r\n\r\n", body.len()));
    let mut answer = answer.into_bytes();
    answer.extend_from_slice(body);
    let _ = stream.set_write_timeout(Some(within));
    let _ = stream.write_all(&answer);
    part(stream);
}

/// Sends a one-line text answer and closes the connection.
pub fn answer_in_words(stream: &TcpStream, status: &str, words: &str, within: Duration) {
    let fields = [("Content-Type", "text/plain; charset=utf-8"), ("X-Content-Type-Options", "nosniff")];
    answer(stream, status, &fields, format!("{words}\n").as_bytes(), within);
}

/// Reads the rest of the request, then closes. Closing with unread bytes would discard the answer.
pub fn part(mut stream: &TcpStream) {
    let _ = stream.shutdown(Shutdown::Write);
    let end = Instant::now() + PARTING_TIME;
    let mut chunk = [0; 1_024];
    for _ in 0..PARTING_BYTES_MAX / chunk.len() {
        match read_until(&mut stream, &mut chunk, end) {
            Ok(1..) => {}
            Ok(0) | Err(_) => break,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    const BOUNDS: HeadBounds =
        HeadBounds { bytes_max: 200, fields_max: 4, time_max: Duration::from_secs(60) };

    fn read(pieces: &[&[u8]]) -> Result<(Head, Vec<u8>), HeadError> {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut sender = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        sender.set_nodelay(true).unwrap();
        let (stream, _) = listener.accept().unwrap();
        for piece in pieces {
            sender.write_all(piece).unwrap();
        }
        sender.shutdown(Shutdown::Write).unwrap();
        read_head(&stream, &BOUNDS)
    }

    #[test]
    fn a_head_is_read_in_pieces_and_the_rest_is_kept() {
        let (head, rest) = read(&[b"GET /a HT", b"TP/1.1\r\nHo", b"st:  x \r\n\r", b"\nmore"]).unwrap();
        assert_eq!((&*head.method, &*head.path, head.field("host")), ("GET", "/a", Some("x")));
        assert_eq!(rest, b"more");
        assert_eq!((head.field("origin"), head.has("HOST"), head.has("origin")), (None, true, false));
    }

    #[test]
    fn a_duplicate_field_has_no_value() {
        let (head, _) = read(&[b"GET / HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n"]).unwrap();
        assert_eq!((head.field("Host"), head.has("Host")), (None, true));
    }

    #[test]
    fn malformed_and_oversized_heads_are_different_errors() {
        let too_long = format!("GET / HTTP/1.1\r\nA: {}\r\n\r\n", "x".repeat(BOUNDS.bytes_max));
        let endless = "x".repeat(BOUNDS.bytes_max + 1);
        let endless = format!("GET /{endless}");
        let fields = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(BOUNDS.fields_max + 1));
        for (text, wanted) in [
            ("", HeadError::Gone),
            ("hello\r\n\r\n", HeadError::Malformed),
            ("GET / HTTP/1.1\r\n", HeadError::Malformed),
            ("PRI * HTTP/2.0\r\n\r\n", HeadError::Malformed),
            ("\u{16}\u{3}\u{1}\u{2}", HeadError::Malformed),
            (&too_long, HeadError::TooLong),
            (&endless, HeadError::TooLong),
            (&fields, HeadError::TooLong),
        ] {
            assert_eq!(read(&[text.as_bytes()]), Err(wanted), "{text:.40}");
        }
        let fits = "GET / HTTP/1.1\r\nA: ";
        let fits = format!("{fits}{}\r\n\r\n", "x".repeat(BOUNDS.bytes_max - fits.len() - 4));
        assert_eq!(read(&[fits.as_bytes()]).map(|(head, _)| head.length), Ok(BOUNDS.bytes_max));
    }

    #[test]
    fn a_request_that_arrives_too_slowly_is_dropped() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut sender = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        sender.write_all(b"GET / HT").unwrap();
        let hurry = HeadBounds { time_max: Duration::from_millis(30), ..BOUNDS };
        assert_eq!(read_head(&stream, &hurry), Err(HeadError::Gone));
    }
}
