//! Tests of the server with real local connections: phones, and other clients.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use mariana_control::action::{ActionRow, ActionValue, ValueType};
use mariana_control::{Amount, Board, ChangedBy, InputQueue, Present, Slider};
use mariana_remote::http::HeadBounds;
use mariana_remote::limits::{LIMITS, Limits};
use mariana_remote::{Album, Remote, RemoteState, SESSION_PATH};
use tungstenite::client::{IntoClientRequest, client};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Error, Message, WebSocket};

const ACTIONS: &[ActionRow] = &[
    ActionRow { name: "blackout", takes: ValueType::Switch, meaning: "blackout" },
    ActionRow { name: "scene", takes: ValueType::Choice, meaning: "a scene" },
];
/// Longer than any wait in these tests.
const PATIENCE: Duration = Duration::from_secs(240);

struct Place {
    remote: Remote,
    input_queue: InputQueue,
    board: Board,
    album: Album,
    state_delta: Receiver<()>,
    address: SocketAddr,
    /// `/TOKEN/`
    path: String,
}

fn size(value: f32) -> Slider {
    Slider {
        name: "size".into(),
        value,
        min: 0.0,
        max: 4.0,
        default: 1.0,
        changed_by: ChangedBy::Text,
        bound: None,
    }
}

fn present(value: f32) -> Present {
    Present { scene: "orb".into(), params: vec![size(value)], ..Present::default() }
}

impl Place {
    fn within(limits: Limits) -> Self {
        let (reported, state_delta) = channel();
        let (input_queue, board, album) = (InputQueue::new(|| {}), Board::default(), Album::default());
        board.put(present(1.0));
        let place = "127.0.0.1:0".parse().unwrap();
        let remote = Remote::start(
            limits,
            place,
            ACTIONS,
            input_queue.clone(),
            board.clone(),
            album.clone(),
            move || {
                let _ = reported.send(());
            },
        )
        .unwrap();
        state_delta.recv_timeout(PATIENCE).unwrap();
        let RemoteState::Open(pairing_address) = remote.state() else { panic!("{:?}", remote.state()) };
        let (address, token) =
            pairing_address.url.strip_prefix("http://").and_then(|url| url.split_once('/')).unwrap();
        let (address, path) = (address.parse().unwrap(), format!("/{token}"));
        Self { remote, input_queue, board, album, state_delta, address, path }
    }

    fn new() -> Self {
        Self::within(LIMITS)
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    fn answer_to(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        // A server that refuses a request may stop reading before the end.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn get(&self, path: &str) -> String {
        self.answer_to(format!("GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.address).as_bytes())
    }

    fn status(&self, path: &str) -> String {
        status(&self.get(path))
    }

    fn phone_from(&self, path: &str, origin: &str) -> Result<Phone, String> {
        let url = format!("ws://{}{path}", self.address);
        let mut request = url.into_client_request().unwrap();
        request.headers_mut().insert("Origin", origin.parse().unwrap());
        match client(request, self.connect()) {
            Ok((socket, _)) => Ok(Phone(socket)),
            Err(tungstenite::HandshakeError::Failure(Error::Http(answer))) => {
                Err(answer.status().to_string())
            }
            Err(error) => panic!("{error}"),
        }
    }

    fn phone(&self) -> Phone {
        let path = format!("{}{SESSION_PATH}", self.path);
        self.phone_from(&path, &format!("http://{}", self.address)).unwrap()
    }

    fn wait_for_counts(&self, messages: u64, refused: u64) {
        let end = Instant::now() + PATIENCE;
        while self.input_queue.counts() != (messages, refused) {
            assert!(Instant::now() < end, "{:?}", self.input_queue.counts());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn wait_for_phones(&self, count: usize) {
        while self.remote.phones() != count {
            self.state_delta.recv_timeout(PATIENCE).unwrap();
        }
    }
}

fn status(answer: &str) -> String {
    answer.split(' ').nth(1).unwrap_or_default().to_owned()
}

struct Phone(WebSocket<TcpStream>);

impl Phone {
    fn say(&mut self, text: &str) {
        self.0.send(Message::text(text)).unwrap();
    }

    fn state_delta_with(&mut self, part: &str) -> String {
        let limit = Instant::now() + PATIENCE;
        loop {
            assert!(Instant::now() < limit, "no update contains {part}");
            if let Message::Text(text) = self.0.read().unwrap()
                && text.contains(part)
            {
                return text.to_string();
            }
        }
    }

    fn end(&mut self) -> Option<CloseCode> {
        let limit = Instant::now() + PATIENCE;
        loop {
            assert!(Instant::now() < limit, "the phone is not disconnected");
            match self.0.read() {
                Ok(Message::Close(frame)) => return frame.map(|frame| frame.code),
                Ok(_) => {}
                Err(_) => return None,
            }
        }
    }
}

#[test]
fn the_page_has_a_policy_against_other_hosts() {
    let place = Place::new();
    let page = place.get(&place.path);
    assert_eq!(status(&page), "200");
    for part in [
        "default-src 'none'",
        &format!("connect-src 'self' ws://{};", place.address),
        "frame-ancestors 'none'",
        "Cache-Control: no-store",
        "Referrer-Policy: no-referrer",
        "X-Content-Type-Options: nosniff",
        "Connection: close",
        "<!doctype html>",
    ] {
        assert!(page.contains(part), "{part} is missing in {page}");
    }
    for part in ["style.css", "page.js"] {
        assert_eq!(place.status(&format!("{}{part}", place.path)), "200");
    }
    let without_slash = place.get(place.path.trim_end_matches('/'));
    assert!(without_slash.contains(&format!("Location: {}\r\n", place.path)), "{without_slash}");
}

#[test]
fn error_answers_do_not_repeat_the_request() {
    let place = Place::new();
    for path in ["/<script>", "/favicon.ico", "/?<script>", &format!("{}<script>", place.path)] {
        let answer = place.get(path);
        assert!(["403", "404"].contains(&&*status(&answer)) && !answer.contains("<script>"), "{answer}");
    }
    for (question, wanted) in [
        (format!("POST {} HTTP/1.1\r\nHost: {}\r\n\r\n", place.path, place.address), "405"),
        (format!("GET {} HTTP/1.1\r\nHost: example.org\r\n\r\n", place.path), "403"),
        (format!("GET {} HTTP/1.1\r\n\r\n", place.path), "403"),
        ("hello\r\n\r\n".to_owned(), "400"),
        (format!("GET / HTTP/1.1\r\nA: {}\r\n\r\n", "x".repeat(LIMITS.head.bytes_max)), "431"),
        (format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(LIMITS.head.fields_max + 1)), "431"),
    ] {
        assert_eq!(status(&place.answer_to(question.as_bytes())), wanted, "{question:.40}");
    }
}

#[test]
fn wrong_tokens_do_not_lock_out_good_ones_from_the_same_address() {
    let place = Place::new();
    let own = format!("http://{}", place.address);
    let wrong = format!("/{}/", "0".repeat(place.path.len() - 2));
    for path in [wrong, format!("{}x/", place.path.trim_end_matches('/'))] {
        for _ in 0..20 {
            assert_eq!(place.status(&path), "403", "{path}");
        }
        let refused = place.phone_from(&format!("{path}{SESSION_PATH}"), &own).map(drop);
        assert!(refused.unwrap_err().starts_with("403"), "{path}");
        assert_eq!(place.status(&place.path), "200");
        place.phone().state_delta_with("scene");
    }
}

#[test]
fn a_requested_image_of_an_existing_scene_is_made_and_served() {
    let place = Place::new();
    let scenes = vec!["first steps".to_owned(), "größe".to_owned()];
    place.board.put(Present { scenes, ..present(1.0) });
    let at = |title: &str| format!("{}picture/{title}", place.path);
    for nothing in ["orb", "..%2F..%2Fetc%2Fpasswd", "", "page.js", "%"] {
        assert_eq!(place.status(&at(nothing)), "404", "{nothing}");
    }
    assert!(place.album.drain_requested().is_empty(), "only images of existing scenes are requested");
    assert_eq!(place.status(&at("gr%C3%B6%C3%9Fe")), "404");
    // The show is woken once for the requested image.
    place.state_delta.recv_timeout(PATIENCE).unwrap();
    assert_eq!(place.album.drain_requested(), ["größe"]);
    let mut phone = place.phone();
    phone.state_delta_with("scene");
    assert!(place.album.put("größe", std::sync::Arc::from(&b"a picture"[..])));
    assert_eq!(phone.state_delta_with("pictures"), r#"{"pictures":1}"#);
    let answer = place.get(&at("gr%C3%B6%C3%9Fe?1"));
    assert!(answer.starts_with("HTTP/1.1 200 OK") && answer.ends_with("\r\n\r\na picture"), "{answer}");
    for field in ["Content-Type: image/jpeg", "Cache-Control: no-store", "X-Content-Type-Options: nosniff"] {
        assert!(answer.contains(field), "no {field} in {answer}");
    }
    // Without the token, the answer does not reveal if the image exists.
    assert_eq!(place.status("/picture/gr%C3%B6%C3%9Fe"), "403");
}

#[test]
fn sessions_from_other_pages_or_without_the_token_are_refused() {
    let place = Place::new();
    let own = format!("http://{}", place.address);
    let phone_session = format!("{}{SESSION_PATH}", place.path);
    for origin in ["http://example.org", "null", "https://127.0.0.1"] {
        assert!(
            place.phone_from(&phone_session, origin).map(drop).unwrap_err().starts_with("403"),
            "{origin}"
        );
    }
    assert!(place.get(&phone_session).starts_with("HTTP/1.1 426"));
    assert!(place.phone_from("/hands", &own).map(drop).unwrap_err().starts_with("403"));
}

#[test]
fn a_phone_sends_input_and_receives_others_changes() {
    let place = Place::new();
    let (mut phone, mut other) = (place.phone(), place.phone());
    for one in [&mut phone, &mut other] {
        let all = one.state_delta_with("scene");
        assert!(all.contains(r#""values":{"size":[1.0,"text"]}"#), "{all}");
    }
    phone.say(r#"{"turn":"size","to":3.5}"#);
    phone.say(r#"{"do":"scene","with":"city"}"#);
    place.wait_for_counts(2, 0);
    let heard = place.input_queue.drain();
    let turned = &heard.params[0];
    assert_eq!((&*turned.name, turned.to, turned.changed_by), ("size", Amount::Value(3.5), ChangedBy::Phone));
    assert_eq!(heard.actions[0].given, ActionValue::Text("city".into()));
    place.board.put(present(3.5));
    assert_eq!(other.state_delta_with("values"), r#"{"values":{"size":[3.5,"text"]}}"#);
    assert_eq!(phone.state_delta_with("values"), r#"{"values":{"size":[3.5,"text"]}}"#);
    drop(phone);
    place.wait_for_phones(1);
}

#[test]
fn bad_messages_are_counted_and_the_session_continues() {
    let place = Place::new();
    let mut phone = place.phone();
    let long = format!(r#"{{"turn":"{}","to":1}}"#, "x".repeat(300));
    let rubbish = ["", "{", "null", r#"{"turn":"size","to":NaN}"#, r#"{"turn":"size","to":1e999}"#, "[[[[[["];
    let unknown = [r#"{"do":"quit"}"#, r#"{"turn":"size","to":1e300}"#, &long];
    for text in rubbish.iter().chain(&unknown) {
        phone.say(text);
    }
    phone.say(r#"{"turn":"size","to":2}"#);
    place.wait_for_counts(10, 9);
    assert_eq!(place.input_queue.drain().params.len(), 1);
}

#[test]
fn a_message_beyond_the_size_limit_ends_the_session() {
    let place = Place::new();
    let mut phone = place.phone();
    let sized = |bytes: usize| format!("{:bytes$}", r#"{"do":"blackout"}"#);
    phone.say(&sized(LIMITS.message_bytes_max));
    place.wait_for_counts(1, 0);
    assert_eq!(place.input_queue.drain().actions.len(), 1);
    phone.say(&sized(LIMITS.message_bytes_max + 1));
    assert_eq!(phone.end(), Some(CloseCode::Size));
    // A fragmented message has the same limit.
    let mut phone = place.phone();
    use tungstenite::protocol::frame::coding::{Data, OpCode};
    let piece = |code, last| {
        let bytes = vec![b' '; LIMITS.message_bytes_max / 2 + 1];
        Message::Frame(tungstenite::protocol::frame::Frame::message(bytes, OpCode::Data(code), last))
    };
    phone.0.send(piece(Data::Text, false)).unwrap();
    phone.0.send(piece(Data::Continue, true)).unwrap();
    assert_eq!(phone.end(), Some(CloseCode::Size));
}

#[test]
fn binary_messages_end_the_session() {
    let place = Place::new();
    let mut phone = place.phone();
    phone.0.send(Message::binary(vec![0xFF; 10])).unwrap();
    assert_eq!(phone.end(), Some(CloseCode::Unsupported));
    let mut phone = place.phone();
    phone.0.get_mut().write_all(&[0xFF; 64]).unwrap();
    assert!(matches!(phone.end(), Some(CloseCode::Protocol) | None));
    place.wait_for_phones(0);
}

#[test]
fn a_flooding_phone_is_disconnected_and_others_are_served() {
    let place = Place::new();
    let (mut flood, mut phone) = (place.phone(), place.phone());
    for number in 0..100 * LIMITS.messages_per_second_max {
        // Sending fails once the server has disconnected the phone.
        if flood.0.send(Message::text(format!(r#"{{"turn":"size","to":{number}}}"#))).is_err() {
            break;
        }
    }
    // Unread messages may reset the connection before the reason arrives.
    assert!(matches!(flood.end(), Some(CloseCode::Policy) | None));
    place.wait_for_phones(1);
    assert_eq!(place.input_queue.counts().1, 1);
    place.input_queue.drain();
    phone.say(r#"{"turn":"size","to":0.25}"#);
    while place.input_queue.drain().params.iter().all(|change| change.to != Amount::Value(0.25)) {
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_phone_that_reads_nothing_is_disconnected_and_blocks_nobody() {
    let limits = Limits { unread_time_max: Duration::from_millis(200), ..LIMITS };
    let place = Place::within(limits);
    let (_deaf, mut phone) = (place.phone(), place.phone());
    place.wait_for_phones(2);
    let names = |number: usize| (0..4_000).map(|name| format!("scene {name} of {number}")).collect();
    let mut number = 0;
    // The network holds only a few of these large states for a client that does not read.
    while place.remote.phones() == 2 {
        number += 1;
        place.board.put(Present { scenes: names(number), ..present(1.0) });
        phone.state_delta_with("scene 3999 of");
    }
    assert_eq!(place.remote.phones(), 1);
    place.board.put(present(2.0));
    phone.state_delta_with(r#""size":[2.0"#);
}

#[test]
fn a_slow_phone_gets_the_newest_state_and_not_all_of_them() {
    let limits = Limits {
        delta_interval: Duration::from_millis(5),
        unread_time_max: PATIENCE,
        silence_max: PATIENCE,
        ..LIMITS
    };
    let place = Place::within(limits);
    let (mut late, mut phone) = (place.phone(), place.phone());
    // Each state has half a megabyte. The network holds about twenty states for a client that does not read.
    let states = 120;
    for number in 1..=states {
        let scenes = (0..20_000).map(|name| format!("scene {name} of {number}")).collect();
        place.board.put(Present { scenes, ..present(1.0) });
        phone.state_delta_with(&format!("scene 19999 of {number}\""));
    }
    let mut count = 0;
    while !late.state_delta_with("scene 19999 of").contains(&format!("scene 19999 of {states}\"")) {
        count += 1;
    }
    assert!(count < states / 4, "the phone received {count} states");
}

#[test]
fn a_silent_phone_is_disconnected() {
    let place = Place::within(Limits { silence_max: Duration::from_millis(300), ..LIMITS });
    let (mut deaf, mut phone) = (place.phone(), place.phone());
    place.wait_for_phones(2);
    // A phone that reads also answers pings.
    while place.remote.phones() == 2 {
        phone.state_delta_with("");
    }
    assert_eq!(place.remote.phones(), 1);
    // The phone's late pings may reset the connection before the reason arrives.
    assert!(matches!(deaf.end(), Some(CloseCode::Policy) | None));
    place.board.put(present(2.0));
    phone.state_delta_with(r#""size":[2.0"#);
}

#[test]
fn phones_beyond_the_limit_are_refused() {
    let place = Place::new();
    let mut phones: Vec<Phone> = (0..LIMITS.phones_max).map(|_| place.phone()).collect();
    let (phone_session, own) = (format!("{}{SESSION_PATH}", place.path), format!("http://{}", place.address));
    assert!(place.phone_from(&phone_session, &own).map(drop).unwrap_err().starts_with("503"));
    assert!(place.get(&phone_session).starts_with("HTTP/1.1 503"), "the page can read the reason");
    phones.pop();
    place.wait_for_phones(LIMITS.phones_max - 1);
    place.phone();
}

#[test]
fn idle_connections_are_limited_and_closed() {
    let limits =
        Limits { head: HeadBounds { time_max: Duration::from_millis(500), ..LIMITS.head }, ..LIMITS };
    let place = Place::within(limits);
    let mut idle: Vec<TcpStream> = (0..limits.connections_per_address_max).map(|_| place.connect()).collect();
    // One more connection is closed at once.
    assert_eq!(place.get("/"), "");
    // Idle connections are closed after the time limit, which makes room again.
    for stream in &mut idle {
        assert_eq!(stream.read(&mut [0; 8]).unwrap_or_default(), 0);
    }
    while status(&place.get("/")) != "404" {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_port_in_use_is_reported() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let (reported, state_delta) = channel();
    let place = other.local_addr().unwrap().to_string().parse().unwrap();
    let remote = Remote::start(
        LIMITS,
        place,
        ACTIONS,
        InputQueue::new(|| {}),
        Default::default(),
        Default::default(),
        move || {
            let _ = reported.send(());
        },
    );
    let remote = remote.unwrap();
    state_delta.recv_timeout(PATIENCE).unwrap();
    let RemoteState::Refused(why) = remote.state() else { panic!("{:?}", remote.state()) };
    assert!(why.contains("another program uses 127.0.0.1:") && why.contains("--remote"), "{why}");
}

#[test]
fn a_port_in_use_at_the_start_is_tried_again() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = other.local_addr().unwrap();
    let (reported, state_delta) = channel();
    let place = address.to_string().parse().unwrap();
    let remote = Remote::start(
        LIMITS,
        place,
        ACTIONS,
        InputQueue::new(|| {}),
        Default::default(),
        Default::default(),
        move || {
            let _ = reported.send(());
        },
    );
    let remote = remote.unwrap();
    state_delta.recv_timeout(PATIENCE).unwrap();
    assert!(matches!(remote.state(), RemoteState::Refused(_)), "{:?}", remote.state());
    drop(other);
    // Only a change of state is reported, not each failed attempt.
    state_delta.recv_timeout(PATIENCE).unwrap();
    let RemoteState::Open(pairing_address) = remote.state() else { panic!("{:?}", remote.state()) };
    assert!(pairing_address.url.starts_with(&format!("http://{address}/")), "{}", pairing_address.url);
    TcpStream::connect(address).unwrap();
}

#[test]
fn dropping_the_server_disconnects_phones_and_frees_the_port() {
    let place = Place::new();
    let mut phone = place.phone();
    let address = place.address;
    drop(place.remote);
    assert_eq!(phone.end(), Some(CloseCode::Away));
    while TcpListener::bind(address).is_err() {
        std::thread::sleep(Duration::from_millis(20));
    }
}
