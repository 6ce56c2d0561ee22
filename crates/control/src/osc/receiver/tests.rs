use std::sync::Mutex;
use std::sync::mpsc::channel;

use rosc::OscBundle;

use super::*;
use crate::action::{ActionValue, ValueType};
use crate::osc::receiver::of_osc;
use crate::{Amount, ChangedBy};

const ACTIONS: &[ActionRow] = &[ActionRow { name: "pause", takes: ValueType::Switch, meaning: "pause" }];

fn hearing() -> Hearing {
    let board = Board::default();
    let param = Slider {
        name: "size".into(),
        value: 2.0,
        min: 0.0,
        max: 4.0,
        default: 1.0,
        changed_by: ChangedBy::Midi,
        bound: None,
    };
    board.put(Present {
        scene: "orb".into(),
        scenes: vec!["city".into(), "orb".into()],
        params: vec![param],
        switches: vec![("pause", true)],
        tempo: 120.0,
        ..Present::default()
    });
    Hearing { actions: ACTIONS, input_queue: InputQueue::new(|| {}), board }
}

fn packet(addr: &str, args: Vec<OscType>) -> Vec<u8> {
    encoder::encode(&OscPacket::Message(message(addr.to_owned(), args))).unwrap()
}

fn batch(hearing: &Hearing, packet: &[u8]) -> Vec<OscMessage> {
    hearing.handle_packet(packet, SystemTime::now(), |_, _| false)
}

fn bundle(time: SystemTime, addr: &str, args: Vec<OscType>) -> Vec<u8> {
    let timetag = of_osc(time);
    let content = vec![OscPacket::Message(message(addr.to_owned(), args))];
    encoder::encode(&OscPacket::Bundle(OscBundle { timetag, content })).unwrap()
}

#[test]
fn a_pattern_is_a_message_to_each_matching_address() {
    let hearing = hearing();
    let ask = |addr: &str| batch(&hearing, &packet(addr, Vec::new()));
    let names = |answers: Vec<OscMessage>| answers.into_iter().map(|answer| answer.addr).collect::<Vec<_>>();
    assert_eq!(names(ask("/param/*")), ["/param/size"]);
    assert_eq!(names(ask("/query/{pause,scene}")), ["/scene", "/pause"]);
    batch(&hearing, &packet("/{param,none}/s?z[a-e]", vec![OscType::Float(3.0)]));
    batch(&hearing, &packet("/p*e", vec![OscType::Int(0)]));
    let batch = hearing.input_queue.drain();
    assert_eq!(batch.params.first().map(|change| change.to), Some(Amount::Value(3.0)));
    assert_eq!(batch.actions.first().map(|action| action.name), Some("pause"));
    // Patterns without a match and malformed patterns count as unknown.
    for nothing in ["/none/*", "/param/[s", "/param/{size"] {
        assert_eq!(ask(nothing), []);
    }
    assert_eq!(hearing.input_queue.counts().1, 3);
}

#[test]
fn a_pattern_matches_at_most_the_limit_of_addresses() {
    let hearing = hearing();
    let mut present = Present::clone(&hearing.board.newest());
    let param = present.params.remove(0);
    let name = |number| Slider { name: format!("p{number}"), ..param.clone() };
    present.params = (0..limits::OSC_MATCHES_MAX + 9).map(name).collect();
    hearing.board.put(present);
    assert_eq!(batch(&hearing, &packet("/param/*", Vec::new())).len(), limits::OSC_MATCHES_MAX);
}

#[test]
fn a_title_with_pattern_characters_is_matched_literally() {
    let hearing = hearing();
    let scenes = vec!["orb [2]".into(), "orb 2".into()];
    hearing.board.put(Present { scenes, ..Present::default() });
    let actions = &[ActionRow { name: "scene", takes: ValueType::Choice, meaning: "a scene" }];
    let hearing = Hearing { actions, ..hearing };
    batch(&hearing, &packet("/scene/orb [2]", Vec::new()));
    let actions = hearing.input_queue.drain().actions;
    assert_eq!(
        actions.iter().map(|action| action.given.clone()).collect::<Vec<_>>(),
        [ActionValue::Text("orb [2]".into())]
    );
}

#[test]
fn scheduled_messages_wait_and_those_beyond_the_limits_are_counted() {
    let (hearing, now) = (hearing(), SystemTime::now());
    let half = [OscType::Float(3.0)];
    let mut waits = Vec::new();
    let later = bundle(now + Duration::from_secs(2), "/param/size", half.to_vec());
    hearing.handle_packet(&later, now, |ahead, message| {
        waits.push((ahead.as_secs_f64().round(), message.addr));
        true
    });
    assert_eq!(waits, [(2.0, "/param/size".to_owned())]);
    hearing.handle_packet(&later, now, |_, _| false);
    let much_later = now + Duration::from_secs_f64(limits::OSC_AHEAD_SECONDS_MAX + 9.0);
    hearing.handle_packet(&bundle(much_later, "/param/size", half.to_vec()), now, |_, _| true);
    assert!(hearing.input_queue.drain().is_empty());
    assert_eq!(hearing.input_queue.counts().1, 2);
    hearing.handle_packet(
        &bundle(now - Duration::from_secs(9), "/param/size", half.to_vec()),
        now,
        |_, _| false,
    );
    assert_eq!(hearing.input_queue.drain().params.len(), 1);
}

#[test]
fn questions_are_answered_from_the_board() {
    let hearing = hearing();
    let ask = |addr: &str| batch(&hearing, &packet(addr, Vec::new()));
    let numbers = [2.0, 0.0, 4.0, 1.0].map(OscType::Float);
    let of_midi = numbers.into_iter().chain([OscType::String("MIDI".into())]).collect();
    assert_eq!(ask("/param/size"), [message("/param/size".into(), of_midi)]);
    assert_eq!(ask("/param/none"), []);
    assert_eq!(ask("/query/pause"), [message("/pause".into(), vec![OscType::Int(1)])]);
    let names: Vec<String> = ask("/query").into_iter().map(|answer| answer.addr).collect();
    assert_eq!(names, ["/scene", "/tempo", "/param/size", "/pause"]);
    assert_eq!(ask("/query/scenes").len(), 2);
    assert_eq!(ask("/query/actions").len(), 1);
}

#[test]
fn answers_are_limited() {
    let hearing = hearing();
    hearing
        .board
        .put(Present { scenes: vec!["x".into(); limits::OSC_ANSWERS_MAX + 9], ..Present::default() });
    assert_eq!(batch(&hearing, &packet("/query/scenes", Vec::new())).len(), limits::OSC_ANSWERS_MAX);
}

#[test]
fn bad_messages_are_counted() {
    let hearing = hearing();
    assert_eq!(batch(&hearing, b"no OSC at all"), []);
    batch(&hearing, &packet("/nothing", Vec::new()));
    batch(&hearing, &packet("/param/size", vec![OscType::Float(f32::NAN)]));
    batch(&hearing, &packet("/param/size", vec![OscType::Float(3.0)]));
    assert_eq!(hearing.input_queue.counts(), (3, 3));
    assert_eq!(hearing.input_queue.drain().params[0].to, Amount::Value(3.0));
}

#[test]
fn a_port_in_use_is_reported() {
    let other = UdpSocket::bind("127.0.0.1:0").unwrap();
    let place: Place = other.local_addr().unwrap().to_string().parse().unwrap();
    let (reported, news) = channel();
    let started = OscReceiver::start(place, ACTIONS, InputQueue::new(|| {}), Board::default(), move || {
        let _ = reported.send(());
    });
    let receiver = started.unwrap();
    news.recv().unwrap();
    let ReceiverState::Refused(why) = receiver.state() else { panic!("{:?}", receiver.state()) };
    assert!(why.contains("another program uses 127.0.0.1:") && why.contains("--osc"), "{why}");
}

#[test]
fn packets_come_through_a_real_socket_and_answers_go_back() {
    let (reported, news) = channel();
    let free = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (woken, wakes) = channel();
    let woken = Mutex::new(woken);
    let input_queue = InputQueue::new(move || {
        let _ = woken.lock().unwrap().send(());
    });
    let board = hearing().board;
    let place = free.to_string().parse().unwrap();
    let started = OscReceiver::start(place, ACTIONS, input_queue.clone(), board, move || {
        let _ = reported.send(());
    });
    let receiver = started.unwrap();
    news.recv().unwrap();
    assert_eq!(receiver.state(), ReceiverState::Open(free));
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.send_to(&packet("/param/size", vec![OscType::Float(3.0)]), free).unwrap();
    wakes.recv().unwrap();
    assert_eq!(input_queue.drain().params[0].name, "size");
    let soon = SystemTime::now() + Duration::from_millis(300);
    socket.send_to(&bundle(soon, "/share/size", vec![OscType::Float(0.5)]), free).unwrap();
    wakes.recv().unwrap();
    assert!(SystemTime::now() >= soon, "it came too early");
    assert_eq!(input_queue.drain().params[0].to, Amount::Fraction(0.5));
    socket.send_to(&packet("/scene", Vec::new()), free).unwrap();
    let mut answer = [0; 64];
    let (length, from) = socket.recv_from(&mut answer).unwrap();
    assert_eq!((from, &answer[..length]), (free, &packet("/scene", vec![OscType::String("orb".into())])[..]));
}

#[test]
fn a_port_in_use_at_the_start_is_tried_again() {
    let patience = Duration::from_secs(60);
    let other = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = other.local_addr().unwrap();
    let (reported, news) = channel();
    let (woken, wakes) = channel();
    let woken = Mutex::new(woken);
    let input_queue = InputQueue::new(move || {
        let _ = woken.lock().unwrap().send(());
    });
    let place = address.to_string().parse().unwrap();
    let receiver = OscReceiver::start(place, ACTIONS, input_queue.clone(), Board::default(), move || {
        let _ = reported.send(());
    });
    let receiver = receiver.unwrap();
    news.recv_timeout(patience).unwrap();
    assert!(matches!(receiver.state(), ReceiverState::Refused(_)), "{:?}", receiver.state());
    drop(other);
    // Only a change of state is reported, not each failed attempt.
    news.recv_timeout(patience).unwrap();
    assert_eq!(receiver.state(), ReceiverState::Open(address));
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    sender.send_to(&packet("/param/size", vec![OscType::Float(3.0)]), address).unwrap();
    wakes.recv_timeout(patience).unwrap();
    assert_eq!(input_queue.drain().params[0].name, "size");
}
