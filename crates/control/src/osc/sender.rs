//! The thread that sends audio features to lights and other programs, at a fixed rate independent of the frame rate.

use std::io;
use std::net::UdpSocket;
use std::time::{Duration, Instant};

use mariana_work::{Latest, Shared, looping};
use rosc::{OscBundle, OscMessage, OscPacket, OscTime, OscType, encoder};

use super::place::Place;

/// The wait before another attempt after a failure.
const AGAIN: Duration = Duration::from_secs(2);
/// The OSC time tag for "immediately".
const NOW: OscTime = OscTime { seconds: 0, fractional: 1 };

/// The maximum size of a packet in bytes. Networks deliver packets of this size in one piece.
const PACKET_BYTES_MAX: usize = 1_400;
/// The size of a bundle's header, and of the length before each of its messages, in bytes.
const HEADER_BYTES: usize = 16;
const LENGTH_BYTES: usize = 4;

/// Numbers to send, by address.
pub type Sample = Vec<(String, Vec<f32>)>;

/// Sends OSC until it is dropped.
pub struct OscSender(Latest<Sending>);

#[derive(Default)]
struct Sending {
    sample: Sample,
    problem: Option<String>,
}

impl OscSender {
    /// Starts sending to `place`, `rate` times a second. `wake` is called when there is a new problem.
    ///
    /// # Errors
    /// Fails if the thread cannot be started.
    pub fn start(place: Place, rate: f64, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let interval = Duration::try_from_secs_f64(1.0 / rate).unwrap_or(Duration::from_millis(33));
        let work = move |shared: &Shared<Sending>| {
            while !shared.is_over() {
                let Err(error) = send(&place, interval, shared) else { return };
                let sentence =
                    format!("audio features cannot be sent to {place} ({error}); Mariana keeps trying");
                let is_first = shared.lock().problem.is_none();
                if is_first {
                    shared.lock().problem = Some(sentence);
                    wake();
                }
                shared.rest(AGAIN);
            }
        };
        looping("OSC out", Sending::default(), work).map(Self)
    }

    /// Sets the numbers to send from now on.
    pub fn put(&self, sample: Sample) {
        self.0.lock().sample = sample;
    }

    /// Returns the first problem, if any.
    pub fn problem(&self) -> Option<String> {
        self.0.lock().problem.clone()
    }
}

/// Sends until the owner is gone.
fn send(place: &Place, interval: Duration, shared: &Shared<Sending>) -> io::Result<()> {
    let to = place.resolve()?;
    let socket = UdpSocket::bind(if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" })?;
    let mut due = Instant::now();
    while !shared.is_over() {
        let now = Instant::now();
        // After the computer was suspended, do not send the missed packets.
        due = (due + interval).max(now);
        std::thread::sleep(due.saturating_duration_since(now));
        let sample = shared.lock().sample.clone();
        for bytes in packets(sample) {
            match socket.send_to(&bytes, to) {
                // Keep sending: no program is listening yet.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                sent => drop(sent?),
            }
        }
    }
    Ok(())
}

/// Encodes all numbers as bundles of at most [`PACKET_BYTES_MAX`]. Values that are not finite are sent as 0.
fn packets(sample: Sample) -> Vec<Vec<u8>> {
    let argument = |number: f32| OscType::Float(if number.is_finite() { number } else { 0.0 });
    let mut bundles: Vec<(usize, Vec<OscPacket>)> = Vec::new();
    for (addr, numbers) in sample {
        // Texts end with a 0 and fill whole words. A message has a type for each number, after a comma.
        let text_bytes = |letters: usize| (letters + 1).next_multiple_of(4);
        let bytes = LENGTH_BYTES + text_bytes(addr.len()) + text_bytes(1 + numbers.len()) + 4 * numbers.len();
        let args = numbers.into_iter().map(argument).collect();
        let message = OscPacket::Message(OscMessage { addr, args });
        match bundles.last_mut() {
            Some((size, content)) if *size + bytes <= PACKET_BYTES_MAX => {
                *size += bytes;
                content.push(message);
            }
            _ => bundles.push((HEADER_BYTES + bytes, vec![message])),
        }
    }
    let encoded =
        |(_, content)| encoder::encode(&OscPacket::Bundle(OscBundle { timetag: NOW, content })).ok();
    bundles.into_iter().filter_map(encoded).collect()
}

#[cfg(test)]
mod tests {
    use super::super::messages;
    use super::*;
    use std::sync::mpsc::{RecvTimeoutError, channel};

    #[test]
    fn numbers_are_sent_repeatedly() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let place = socket.local_addr().unwrap().to_string().parse().unwrap();
        let sender = OscSender::start(place, 200.0, || {}).unwrap();
        sender
            .put(vec![("/sound/bass".to_owned(), vec![0.5]), ("/sound/band".to_owned(), vec![f32::NAN; 3])]);
        for _ in 0..3 {
            let mut buffer = [0; 1_500];
            let (length, _) = socket.recv_from(&mut buffer).unwrap();
            let (found, rubbish) = messages(&buffer[..length]);
            let found: Vec<_> = found.into_iter().map(|(message, _)| message).collect();
            assert_eq!(rubbish, 0);
            assert_eq!(
                (found[0].addr.as_str(), &found[0].args[..]),
                ("/sound/bass", &[OscType::Float(0.5)][..])
            );
            assert_eq!(found[1].args, vec![OscType::Float(0.0); 3], "only finite numbers may be sent");
        }
        assert_eq!(sender.problem(), None);
    }

    #[test]
    fn many_numbers_are_split_into_small_packets_in_their_order() {
        let sample: Sample = (0..200_usize)
            .map(|n| (format!("/sound/{}", "x".repeat(n % 9)), vec![n as f32; n % 5]))
            .collect();
        let packets = packets(sample.clone());
        let sizes: Vec<usize> = packets.iter().map(Vec::len).collect();
        assert!(sizes.iter().all(|size| *size <= PACKET_BYTES_MAX), "{sizes:?}");
        assert!(sizes.iter().rev().skip(1).all(|size| *size > PACKET_BYTES_MAX - 60), "{sizes:?}");
        let sent = packets.iter().flat_map(|packet| messages(packet).0);
        let sent: Vec<String> = sent.map(|(message, _)| message.addr).collect();
        assert_eq!(sent, sample.into_iter().map(|(addr, _)| addr).collect::<Vec<_>>());
        assert!(super::packets(Sample::new()).is_empty());
    }

    #[test]
    fn an_unknown_host_is_reported_and_does_not_keep_the_thread() {
        let (reported, news) = channel();
        let place = "no.such.computer.invalid:9000".parse().unwrap();
        let sender = OscSender::start(place, 30.0, move || {
            let _ = reported.send(());
        });
        let sender = sender.unwrap();
        news.recv().unwrap();
        let problem = sender.problem().unwrap_or_default();
        assert!(problem.contains("no.such.computer.invalid:9000"), "{problem}");
        drop(sender);
        assert!(
            news.recv_timeout(Duration::from_secs(60))
                .is_err_and(|error| error == RecvTimeoutError::Disconnected)
        );
    }
}
