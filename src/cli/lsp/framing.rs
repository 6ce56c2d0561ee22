//! Splits a stream of bytes into messages: a header with `Content-Length`, an empty line, and JSON.

use std::io::{self, BufRead, Read};

use serde_json::Value;

use crate::limits::{EDITOR_HEADER_BYTES_MAX, EDITOR_MESSAGE_BYTES_MAX};

/// Reads the next message; `None` at the end of the stream. A message that is no JSON or is too large is an explanation.
///
/// # Errors
/// Fails if reading fails, and for a header without a length: the start of the next message is unknown then.
pub(super) fn read_message(input: &mut impl BufRead) -> io::Result<Option<Result<Value, String>>> {
    let max = EDITOR_HEADER_BYTES_MAX;
    let mut header = input.by_ref().take(max);
    let mut length = None;
    loop {
        let mut line = Vec::new();
        header.read_until(b'\n', &mut line)?;
        let line = String::from_utf8_lossy(&line);
        match line.split_once(':') {
            _ if header.limit() == 0 => {
                let message = format!("the header of a message is longer than {max} bytes");
                return Err(io::Error::other(message));
            }
            _ if !line.ends_with('\n') => return Ok(None),
            Some((name, value)) if name.trim().eq_ignore_ascii_case("content-length") => {
                length = length.or(value.trim().parse().ok());
            }
            None if line.trim().is_empty() => break,
            _ => {}
        }
    }
    let message = "a message has no header `Content-Length`: send its length in bytes";
    let length = length.ok_or_else(|| io::Error::other(message))?;
    let (mut body, max) = (input.take(length), EDITOR_MESSAGE_BYTES_MAX);
    if length > max {
        io::copy(&mut body, &mut io::sink())?;
        return Ok(Some(Err(format!("a message has {length} bytes; the maximum is {max}"))));
    }
    let mut bytes = Vec::new();
    body.read_to_end(&mut bytes)?;
    let message =
        || serde_json::from_slice(&bytes).map_err(|error| format!("a message is not JSON: {error}"));
    Ok((body.limit() == 0).then(message))
}

/// Returns the bytes of a message with its header.
pub(super) fn framed(message: &Value) -> Vec<u8> {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;
    use serde_json::json;

    #[test]
    fn messages_arrive_in_any_pieces() {
        let mut stream = framed(&json!({"id": 1, "text": "ä"}));
        stream.extend(b"content-length:2\r\nContent-Type: x\r\n\r\n{}");
        for size in [1, 3, 7, 1000] {
            let mut input = BufReader::with_capacity(size, &*stream);
            let messages = std::iter::from_fn(|| read_message(&mut input).unwrap());
            let seen: Vec<Value> = messages.map(Result::unwrap).collect();
            assert_eq!(seen, [json!({"id": 1, "text": "ä"}), json!({})], "{size}");
        }
    }

    #[test]
    fn a_wrong_message_does_not_hide_the_next() {
        let mut input: &[u8] = b"Content-Length: 3\r\n\r\n{]}Content-Length: 2\r\n\r\n[]";
        assert!(read_message(&mut input).unwrap().unwrap().is_err());
        assert_eq!(read_message(&mut input).unwrap(), Some(Ok(json!([]))));
        assert_eq!(read_message(&mut input).unwrap(), None);

        let large = EDITOR_MESSAGE_BYTES_MAX + 1;
        let header = format!("Content-Length: {large}\r\n\r\n").into_bytes();
        let mut input = BufReader::new(
            header.chain(io::repeat(b' ').take(large)).chain(&b"Content-Length: 1\r\n\r\n7"[..]),
        );
        assert!(read_message(&mut input).unwrap().unwrap().is_err());
        assert_eq!(read_message(&mut input).unwrap(), Some(Ok(json!(7))));
    }

    #[test]
    fn a_stream_without_lengths_is_given_up() {
        for wrong in
            ["{}\r\n\r\n{}", "Content-Length: -1\r\n\r\n", "Content-Length: 9999999999999999999999\r\n\r\n"]
        {
            assert!(read_message(&mut wrong.as_bytes()).is_err(), "{wrong}");
        }
        let endless = vec![b'x'; 8_192];
        assert!(read_message(&mut &*endless).is_err());
        assert_eq!(read_message(&mut &b"Content-Length: 3\r\n\r\n{}"[..]).unwrap(), None);
    }
}
