//! MJPEG over HTTP on the loopback interface: an endless response (`multipart/x-mixed-replace`) with a part per frame.
//!
//! A frame is encoded once, and only while there is a reader. Each reader has a thread that always writes the latest
//! frame. All other requests, and requests for other hosts, are refused.

use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::latest_frame::{LatestFrame, OutgoingFrame};
use super::{SendError, SenderTarget};
use crate::limits;
use mariana_remote::http::{Head, HeadBounds, answer_in_words, read_head};
use mariana_work::lock;

const BOUNDARY: &str = "mariana-picture";
const QUALITY: u8 = 90;
/// Longest time for a client to send its request.
const QUESTION_TIME: Duration = Duration::from_secs(5);
/// Pause after the system could not accept a connection.
const AGAIN: Duration = Duration::from_millis(200);
/// A reader is disconnected if a write blocks for this long.
const ANSWER_TIME: Duration = Duration::from_secs(30);

/// Starts the server on a port.
///
/// # Errors
/// Fails if the port is in use, or the system cannot start a thread.
pub(super) fn start(port: u16, latest_frame: Arc<LatestFrame>) -> Result<(), SendError> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| SendError::Refused {
        to: SenderTarget::Mjpeg(port).to_string(),
        reason: format!("{error}: choose another port"),
    })?;
    let accept = move || accept(&listener, &latest_frame);
    std::thread::Builder::new().name("sending".into()).spawn(accept).map(drop).map_err(SendError::Thread)
}

/// The latest JPEG, with the number of its frame. Each reader holds a reference.
type SharedJpeg = Mutex<(u64, Arc<Vec<u8>>)>;

fn accept(listener: &TcpListener, latest_frame: &Arc<LatestFrame>) {
    let latest_jpeg = Arc::new(SharedJpeg::default());
    for stream in listener.incoming() {
        if latest_frame.is_over() {
            return;
        }
        let Ok(stream) = stream else {
            // If too many files are open, an immediate retry would fail too.
            latest_frame.rest(AGAIN);
            continue;
        };
        // Besides this thread, each reader's thread holds a reference, so the limit also bounds the number of threads.
        if Arc::strong_count(&latest_jpeg) > limits::SEND_READERS_MAX {
            let words = "too many programs read these frames already: close one of them";
            answer_in_words(&stream, "503 Service Unavailable", words, QUESTION_TIME);
            continue;
        }
        let (latest_frame, latest_jpeg) = (latest_frame.clone(), latest_jpeg.clone());
        let serve = move || serve(stream, &latest_frame, &latest_jpeg);
        if let Err(error) = std::thread::Builder::new().name("sending".into()).spawn(serve) {
            tracing::warn!("a client cannot be served: {error}");
        }
    }
}

fn serve(stream: TcpStream, latest_frame: &LatestFrame, latest_jpeg: &SharedJpeg) {
    let bounds = HeadBounds {
        bytes_max: limits::SEND_REQUEST_BYTES_MAX,
        fields_max: limits::SEND_REQUEST_FIELDS_MAX,
        time_max: QUESTION_TIME,
    };
    let refuse = |status: &str, words: &str| answer_in_words(&stream, status, words, QUESTION_TIME);
    match read_head(&stream, &bounds) {
        Ok((head, _)) => {
            if let Err((status, words)) = judge(&head) {
                return refuse(status, words);
            }
        }
        Err(error) => {
            if let Some(status) = error.status() {
                refuse(status, &error.to_string());
            }
            return;
        }
    }
    latest_frame.has_receiver();
    tracing::info!("{} has a reader", &latest_frame.to);
    let _ = stream.set_write_timeout(Some(ANSWER_TIME));
    let gone = answer(stream, latest_frame, latest_jpeg).err();
    latest_frame.has_lost_receiver();
    tracing::info!("a reader of {} has gone ({gone:?})", &latest_frame.to);
}

fn judge(head: &Head) -> Result<(), (&'static str, &'static str)> {
    // Protects against DNS rebinding: a web page must not read frames under its own host name.
    let host = head.field("Host");
    let name = host.map(|host| host.rsplit_once(':').map_or(host, |(name, _)| name));
    match (&*head.method, &*head.path) {
        _ if head.has("Host") && !name.is_some_and(|name| ["127.0.0.1", "localhost"].contains(&name)) => {
            Err(("403 Forbidden", "only clients on this machine are served: use the address 127.0.0.1"))
        }
        ("GET", "/") => Ok(()),
        ("GET", _) => Err(("404 Not Found", "the frames are at /")),
        _ => Err(("405 Method Not Allowed", "frames can only be read: use GET")),
    }
}

fn answer(
    mut stream: TcpStream,
    latest_frame: &LatestFrame,
    latest_jpeg: &SharedJpeg,
) -> std::io::Result<()> {
    stream.write_all(
        format!(
            "HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary={BOUNDARY}\r\nCache-Control: \
             no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n--{BOUNDARY}\r\n"
        )
        .as_bytes(),
    )?;
    let mut number = 0;
    while let Some((next, picture)) = latest_frame.after(number) {
        number = next;
        let jpeg = jpeg_of(latest_jpeg, next, &picture)?;
        let head = format!("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
        stream.write_all(head.as_bytes())?;
        stream.write_all(&jpeg)?;
        // Send the boundary at once, because browsers show a frame only when they see its end.
        stream.write_all(format!("\r\n--{BOUNDARY}\r\n").as_bytes())?;
        stream.flush()?;
    }
    Ok(())
}

/// Returns the JPEG of a frame. The first reader that needs the JPEG encodes the frame; other readers wait.
fn jpeg_of(known: &SharedJpeg, number: u64, picture: &OutgoingFrame) -> std::io::Result<Arc<Vec<u8>>> {
    let mut known = lock(known);
    if known.0 != number {
        let mut jpeg = Vec::new();
        let rgb: Vec<u8> =
            picture.rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
            .write_image(&rgb, picture.size.0, picture.size.1, ExtendedColorType::Rgb8)
            .map_err(std::io::Error::other)?;
        *known = (number, Arc::new(jpeg));
    }
    Ok(known.1.clone())
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader, Read};

    use super::*;

    fn sending() -> (Arc<LatestFrame>, u16) {
        for port in 20_000..60_000 {
            let latest_frame = Arc::new(LatestFrame::new("a place".into()));
            if start(port, latest_frame.clone()).is_ok() {
                return (latest_frame, port);
            }
        }
        panic!("no port is free");
    }

    fn send_request(port: u16, question: &str) -> TcpStream {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        stream.write_all(question.as_bytes()).unwrap();
        stream
    }

    fn line(lines: &mut impl BufRead) -> String {
        let mut line = String::new();
        lines.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    fn next_picture(lines: &mut impl BufRead) -> image::RgbImage {
        while line(lines) != format!("--{BOUNDARY}") {}
        assert_eq!(line(lines), "Content-Type: image/jpeg");
        let length = line(lines).strip_prefix("Content-Length: ").unwrap().parse().unwrap();
        assert_eq!(line(lines), "");
        let mut jpeg = vec![0; length];
        lines.read_exact(&mut jpeg).unwrap();
        image::load_from_memory(&jpeg).unwrap().to_rgb8()
    }

    fn picture(value: u8) -> OutgoingFrame {
        OutgoingFrame { size: (16, 8), rgba: Arc::new(vec![value; 16 * 8 * 4]) }
    }

    #[test]
    fn readers_get_frames_and_one_that_does_not_read_blocks_nobody() {
        let (latest_frame, port) = sending();
        let question = "GET / HTTP/1.1\r\nHost: localhost:1\r\n\r\n";
        let _blocks = send_request(port, question);
        let mut lines = BufReader::new(send_request(port, question));
        assert_eq!(line(&mut lines), "HTTP/1.1 200 OK");
        for value in [10, 200, 90] {
            latest_frame.put(picture(value));
            let seen = next_picture(&mut lines);
            assert_eq!(seen.dimensions(), (16, 8));
            assert!(seen.pixels().all(|pixel| pixel.0.iter().all(|byte| byte.abs_diff(value) <= 2)));
        }
        latest_frame.end();
        let mut rest = String::new();
        lines.read_to_string(&mut rest).unwrap();
        assert_eq!(rest.trim(), format!("--{BOUNDARY}"));
    }

    #[test]
    fn other_requests_are_refused_with_a_status() {
        let (latest_frame, port) = sending();
        latest_frame.put(picture(1));
        let long = format!("GET / HTTP/1.1\r\nX: {}\r\n\r\n", "x".repeat(limits::SEND_REQUEST_BYTES_MAX));
        let fields =
            format!("GET / HTTP/1.1\r\n{}\r\n", "X: y\r\n".repeat(limits::SEND_REQUEST_FIELDS_MAX + 1));
        for (question, status) in [
            ("GET /etc/passwd HTTP/1.1\r\n\r\n", "404"),
            ("POST / HTTP/1.1\r\n\r\n", "405"),
            ("GET / HTTP/1.1\r\nHost: example.org\r\n\r\n", "403"),
            ("hello\r\n\r\n", "400"),
            ("\0\u{1}\u{2}\n", "400"),
            (&long, "431"),
            (&fields, "431"),
        ] {
            let mut stream = send_request(port, question);
            let mut status_line = [0; 12];
            stream.read_exact(&mut status_line).unwrap();
            let reported = String::from_utf8_lossy(&status_line).into_owned();
            assert_eq!(reported, format!("HTTP/1.1 {status}"), "{question:.40}");
        }
    }

    #[test]
    fn the_number_of_readers_is_limited() {
        let (latest_frame, port) = sending();
        latest_frame.put(picture(1));
        let question = "GET / HTTP/1.1\r\n\r\n";
        let readers = (0..limits::SEND_READERS_MAX).map(|_| BufReader::new(send_request(port, question)));
        let mut readers: Vec<_> = readers.collect();
        for reader in &mut readers {
            assert_eq!(line(reader), "HTTP/1.1 200 OK");
        }
        let mut one_more = String::new();
        send_request(port, question).read_to_string(&mut one_more).unwrap();
        assert!(one_more.starts_with("HTTP/1.1 503"), "{one_more}");
        drop(readers);
    }

    #[test]
    fn a_port_in_use_is_reported() {
        let (_newest, port) = sending();
        let refused = start(port, Arc::new(LatestFrame::new("a place".into()))).unwrap_err().to_string();
        assert!(refused.contains("choose another port") && refused.contains(&port.to_string()), "{refused}");
    }
}
