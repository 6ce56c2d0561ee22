//! The thread that receives OSC.

use std::collections::BTreeMap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant, SystemTime};

use mariana_work::{Latest, Shared, looping};
use rosc::{OscMessage, OscPacket, OscTime, OscType, encoder};

use super::address::{Asked, Pattern, Query, fixed_addresses, is_pattern, understand};
use super::packet::messages;
use super::place::{Place, PortState};
use crate::action::ActionRow;
use crate::{Board, InputQueue, Present, Slider, limits};

/// The interval at which the thread checks if the receiver has been dropped.
const LOOK: Duration = Duration::from_millis(200);
const LEAST_LOOK: Duration = Duration::from_millis(1);
const PACKET_MAX: usize = 65_535;

/// The state of the receiver: it is open at an address.
pub type ReceiverState = PortState<SocketAddr>;

/// Receives OSC until it is dropped.
pub struct OscReceiver(Latest<ReceiverState>);

impl OscReceiver {
    /// Receives OSC on `place`, retrying until the port is free. Messages for parameters and `actions` go to the input
    /// queue; queries are answered from the board. `wake` is called when the state changes.
    ///
    /// # Errors
    /// Fails if the thread cannot be started.
    pub fn start(
        place: Place,
        actions: &'static [ActionRow],
        input_queue: InputQueue,
        board: Board,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let receive = move |shared: &Shared<ReceiverState>| {
            let set_state = |now| {
                let is_new = shared.lock().replace(now);
                if is_new {
                    wake();
                }
            };
            let open = |address: SocketAddr| {
                let socket = UdpSocket::bind(address)?;
                set_state(ReceiverState::Open(socket.local_addr()?));
                Ok(socket)
            };
            let refused = |why| set_state(ReceiverState::Refused(why));
            let is_over = || shared.is_over();
            if let Some(socket) = place.open_when_free("OSC input", "--osc", is_over, open, refused) {
                Hearing { actions, input_queue, board }.run(&socket, is_over);
            }
        };
        looping("OSC in", ReceiverState::default(), receive).map(Self)
    }

    /// Returns the current state.
    pub fn state(&self) -> ReceiverState {
        self.0.lock().clone()
    }
}

struct Hearing {
    actions: &'static [ActionRow],
    input_queue: InputQueue,
    board: Board,
}

impl Hearing {
    fn run(&self, socket: &UdpSocket, is_over: impl Fn() -> bool) {
        let mut buffer = vec![0; PACKET_MAX];
        let mut waiting = Waiting::default();
        while !is_over() {
            while let Some((message, from)) = waiting.pop_due(Instant::now()) {
                let mut answers = Vec::new();
                self.obey(&message, &mut answers);
                answers.into_iter().for_each(|answer| send(socket, answer, from));
            }
            // A timeout of 0 is an error, so the minimum is a millisecond.
            let patience = waiting.patience(Instant::now()).map_or(LOOK, |due| due.clamp(LEAST_LOOK, LOOK));
            let _ = socket.set_read_timeout(Some(patience));
            match socket.recv_from(&mut buffer) {
                Ok((length, from)) => {
                    let packet = buffer.get(..length).unwrap_or_default();
                    let answers = self.handle_packet(packet, SystemTime::now(), |ahead, message| {
                        Instant::now().checked_add(ahead).is_some_and(|due| waiting.put(due, message, from))
                    });
                    answers.into_iter().for_each(|answer| send(socket, answer, from));
                }
                Err(error) if is_patience(&error) => {}
                // Keep receiving: an answer was refused, because the client that sent the query has closed its port.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(error) => {
                    tracing::debug!("OSC: {error}");
                    std::thread::sleep(LOOK);
                }
            }
        }
    }

    /// Handles a packet at the system time `now` and returns the answers. `waits` takes the messages that are not due
    /// yet, and returns false if too many messages wait.
    fn handle_packet(
        &self,
        packet: &[u8],
        now: SystemTime,
        mut waits: impl FnMut(Duration, OscMessage) -> bool,
    ) -> Vec<OscMessage> {
        let (messages, rubbish) = messages(packet);
        self.input_queue.refuse(rubbish);
        let mut answers = Vec::new();
        for (message, time) in messages {
            let is_taken = match wait_until(time, now) {
                Some(ahead) if ahead.is_zero() => {
                    self.obey(&message, &mut answers);
                    true
                }
                Some(ahead) => waits(ahead, message),
                None => false,
            };
            if !is_taken {
                self.input_queue.refuse(1);
            }
            self.input_queue.count();
        }
        answers
    }

    /// Handles a message and adds the answers. A pattern counts as one message to each matching address.
    fn obey(&self, message: &OscMessage, answers: &mut Vec<OscMessage>) {
        if !is_pattern(&message.addr) {
            return self.obey_one(message, answers);
        }
        let known = addresses(&self.board.newest(), self.actions);
        // Scene titles may contain pattern characters.
        if known.contains(&message.addr) {
            return self.obey_one(message, answers);
        }
        let pattern = Pattern::read(&message.addr);
        let meant =
            known.into_iter().filter(|address| pattern.as_ref().is_some_and(|one| one.matches(address)));
        let meant: Vec<String> = meant.take(limits::OSC_MATCHES_MAX).collect();
        if meant.is_empty() {
            self.input_queue.refuse(1);
        }
        for addr in meant {
            self.obey_one(&OscMessage { addr, args: message.args.clone() }, answers);
        }
    }

    fn obey_one(&self, message: &OscMessage, answers: &mut Vec<OscMessage>) {
        if let Some(query) = Asked::queue(understand(message, self.actions), &self.input_queue) {
            answers.extend(answers_to(&query, &self.board.newest(), self.actions));
            answers.truncate(limits::OSC_ANSWERS_MAX);
        }
    }
}

fn addresses(present: &Present, actions: &[ActionRow]) -> Vec<String> {
    let params = present.params.iter().map(|param| &param.name);
    let turns = params.flat_map(|name| [format!("/param/{name}"), format!("/share/{name}")]);
    let scenes = present.scenes.iter().map(|title| format!("/scene/{title}"));
    let acts = actions.iter().map(|row| format!("/{}", row.name));
    let questions = fixed_addresses().iter().map(|(address, ..)| *address);
    let questions = questions.filter(|address| address.starts_with("/query") && !address.contains("SWITCH"));
    let switches = present.switches.iter().map(|(name, _)| format!("/query/{name}"));
    turns.chain(scenes).chain(acts).chain(questions.map(str::to_owned)).chain(switches).collect()
}

fn is_patience(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}

fn send(socket: &UdpSocket, message: OscMessage, to: SocketAddr) {
    // Answers are sent once; errors are ignored.
    if let Ok(bytes) = encoder::encode(&OscPacket::Message(message)) {
        let _ = socket.send_to(&bytes, to);
    }
}

fn message(addr: String, args: Vec<OscType>) -> OscMessage {
    OscMessage { addr, args }
}

fn answers_to(query: &Query, present: &Present, actions: &[ActionRow]) -> Vec<OscMessage> {
    let param = |param: &Slider| {
        let numbers = [param.value, param.min, param.max, param.default].map(OscType::Float);
        let changed_by = OscType::String(param.changed_by.name().to_owned());
        message(format!("/param/{}", param.name), numbers.into_iter().chain([changed_by]).collect())
    };
    let of_switch =
        |(name, is_on): &(&str, bool)| message(format!("/{name}"), vec![OscType::Int(i32::from(*is_on))]);
    match query {
        Query::Param(name) => present.params.iter().filter(|one| one.name == *name).map(param).collect(),
        Query::Params => present.params.iter().map(param).collect(),
        Query::Scene => vec![message("/scene".to_owned(), vec![OscType::String(present.scene.clone())])],
        Query::Scenes => {
            let number = |place: usize| OscType::Int(i32::try_from(place + 1).unwrap_or(i32::MAX));
            let scenes = present.scenes.iter().enumerate();
            scenes
                .map(|(place, name)| {
                    message("/scenes".to_owned(), vec![number(place), OscType::String(name.clone())])
                })
                .collect()
        }
        Query::Tempo => vec![message("/tempo".to_owned(), vec![OscType::Float(present.tempo)])],
        Query::Actions => {
            let texts =
                |row: &ActionRow| [row.name, row.meaning].map(|text| OscType::String(text.to_owned()));
            actions.iter().map(|row| message("/actions".to_owned(), texts(row).to_vec())).collect()
        }
        Query::Switch(name) => {
            present.switches.iter().filter(|(one, _)| one == name).map(of_switch).collect()
        }
        Query::All => {
            let parts = [Query::Scene, Query::Tempo, Query::Params];
            let parts = parts.iter().flat_map(|part| answers_to(part, present, actions));
            parts.chain(present.switches.iter().map(of_switch)).collect()
        }
    }
}

// Scheduled OSC messages: a bundle's time tag gives the time at which its messages take effect.

/// Seconds from the OSC epoch (1900) to the Unix epoch (1970).
const TO_UNIX: u64 = 2_208_988_800;
/// The fraction in an OSC time counts this many units per second.
const PARTS: f64 = 4_294_967_296.0;

/// Returns the time from the system time `now` to a time tag, which is 0 for a message outside bundles and for a time
/// that has passed; `None` if it is too long.
pub(super) fn wait_until(time: Option<OscTime>, now: SystemTime) -> Option<Duration> {
    // The time tags 0 and 1 mean "immediately". The standard defines 1; some senders use 0.
    let Some(time) = time.filter(|time| time.seconds > 0 || time.fractional > 1) else {
        return Some(Duration::ZERO);
    };
    let now = now.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs_f64();
    // OSC seconds wrap around in 2036: take the time closest to now.
    let now_of_osc = (now as u64).wrapping_add(TO_UNIX) as u32;
    let seconds = f64::from(time.seconds.wrapping_sub(now_of_osc) as i32) - now.fract();
    let ahead = (seconds + f64::from(time.fractional) / PARTS).max(0.0);
    Duration::try_from_secs_f64(ahead).ok().filter(|_| ahead <= limits::OSC_AHEAD_SECONDS_MAX)
}

#[derive(Default)]
pub(super) struct Waiting {
    /// Messages by due time, then by order of arrival.
    messages: BTreeMap<(Instant, u64), (OscMessage, SocketAddr)>,
    count: u64,
}

impl Waiting {
    /// Schedules a message. Returns false if too many are waiting.
    pub(super) fn put(&mut self, due: Instant, message: OscMessage, from: SocketAddr) -> bool {
        let has_room = self.messages.len() < limits::OSC_WAITING_MAX;
        if has_room {
            self.count += 1;
            self.messages.insert((due, self.count), (message, from));
        }
        has_room
    }

    pub(super) fn pop_due(&mut self, now: Instant) -> Option<(OscMessage, SocketAddr)> {
        let first = self.messages.first_entry().filter(|first| first.key().0 <= now)?;
        Some(first.remove())
    }

    pub(super) fn patience(&self, now: Instant) -> Option<Duration> {
        self.messages.first_key_value().map(|((due, _), _)| due.saturating_duration_since(now))
    }
}

/// The time of OSC: seconds since 1900, and the rest of a second in 2^-32 s.
#[cfg(test)]
pub(super) fn of_osc(time: SystemTime) -> OscTime {
    let time = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let seconds = u32::try_from(time.as_secs() + TO_UNIX).unwrap_or(u32::MAX);
    let fraction = (u64::from(time.subsec_nanos()) << 32).div_ceil(1_000_000_000);
    OscTime { seconds, fractional: u32::try_from(fraction).unwrap_or(u32::MAX) }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod waiting_tests {
    use super::*;

    #[test]
    fn past_and_immediate_messages_are_due_now_and_others_wait() {
        let now = SystemTime::UNIX_EPOCH + Duration::from_millis(1_700_000_000_250);
        let after = |seconds: f64| wait_until(Some(of_osc(now + Duration::from_secs_f64(seconds))), now);
        let at_once = Some(Duration::ZERO);
        assert_eq!(wait_until(None, now), at_once);
        assert_eq!(wait_until(Some(OscTime { seconds: 0, fractional: 1 }), now), at_once);
        assert_eq!(wait_until(Some(OscTime { seconds: 0, fractional: 0 }), now), at_once);
        assert_eq!(wait_until(Some(of_osc(now - Duration::from_secs(5))), now), at_once);
        for seconds in [0.5, 1.0, limits::OSC_AHEAD_SECONDS_MAX - 0.1] {
            let found = after(seconds).unwrap();
            assert!((found.as_secs_f64() - seconds).abs() < 1e-5, "{found:?} instead of {seconds} s");
        }
        assert_eq!(after(limits::OSC_AHEAD_SECONDS_MAX + 1.0), None);
        // OSC seconds wrap around on 7 February 2036.
        let last = SystemTime::UNIX_EPOCH + Duration::from_secs(u64::from(u32::MAX) - TO_UNIX);
        let later = wait_until(Some(OscTime { seconds: 1, fractional: 0 }), last);
        assert_eq!(later, Some(Duration::from_secs(2)));
    }

    #[test]
    fn messages_are_taken_in_order_when_due_and_their_number_is_limited() {
        let (start, from) = (Instant::now(), SocketAddr::from(([127, 0, 0, 1], 9)));
        let at = |ms| start + Duration::from_millis(ms);
        let message = |addr: &str| OscMessage { addr: addr.to_owned(), args: Vec::new() };
        let mut waiting = Waiting::default();
        assert_eq!(waiting.patience(start), None);
        for (ms, addr) in [(20, "/c"), (10, "/a"), (10, "/b")] {
            assert!(waiting.put(at(ms), message(addr), from));
        }
        assert_eq!(waiting.patience(start), Some(Duration::from_millis(10)));
        assert_eq!(waiting.pop_due(at(9)), None);
        let taken = |waiting: &mut Waiting| waiting.pop_due(at(15)).map(|(message, _)| message.addr);
        assert_eq!([(); 3].map(|()| taken(&mut waiting)), [Some("/a".into()), Some("/b".into()), None]);
        let put = (1..=limits::OSC_WAITING_MAX).filter(|_| waiting.put(at(30), message("/d"), from)).count();
        assert_eq!(put, limits::OSC_WAITING_MAX - 1, "one message is already waiting");
    }
}
