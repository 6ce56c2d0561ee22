//! Measures the cost of input messages: parsing bytes, queueing input, and taking a flood of input once per frame.

#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mariana_control::action::{ActionRow, ValueType};
use mariana_control::midi::{Device, KnobMove, Mapping, Mappings, Outcome, Source, Target};
use mariana_control::osc::{Asked, messages, understand};
use mariana_control::{ChangedBy, InputQueue, Model, Param, ParamChange, Turn};
use rosc::{OscMessage, OscPacket, OscType, encoder};

const ACTIONS: &[ActionRow] = &[ActionRow { name: "next", takes: ValueType::Press, meaning: "" }];
const SIZE: Param<'static> = Param { name: "size", min: 0.0, max: 4.0, default: 1.0 };
const FLOOD: u64 = 10_000;

fn midi(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("midi");
    group.throughput(Throughput::Elements(FLOOD));
    let bytes: Vec<u8> = (0..FLOOD).flat_map(|n| [0xb0, (n % 16) as u8, (n % 128) as u8]).collect();
    group.bench_function("10,000 messages to the queue", |bencher| {
        let (mut device, input_queue) = (Device::new("desk".into()), InputQueue::new(|| {}));
        bencher.iter(|| {
            device.parse(black_box(&bytes), |said| {
                if let mariana_control::midi::Said::Moved(moved) = said {
                    input_queue.moved(moved);
                }
            });
            input_queue.drain()
        });
    });
    group.finish();
    let knob = |number| Source::Control { channel: 0, number };
    let target = |number: u8| Target::Param { scene: "orb".to_owned(), name: format!("param {number}") };
    let mut mappings = Mappings::of((0..64).map(|n| Mapping::learned("desk", knob(n), target(n))).collect());
    let mut value = 0.5;
    criterion.bench_function("midi/64 knobs through 64 mappings, as in a frame", |bencher| {
        bencher.iter(|| {
            value = 1.0 - value;
            let outcomes = (0..64).flat_map(|number| {
                let moved = KnobMove::to("desk".into(), knob(number), value, false);
                mappings.apply(&moved, ACTIONS, |_| Some(0.5))
            });
            outcomes.filter(|outcome| matches!(outcome, Outcome::Turn(_))).count()
        });
    });
}

fn osc(criterion: &mut Criterion) {
    let packets: Vec<Vec<u8>> = (0..FLOOD)
        .map(|n| {
            let (addr, args) = (format!("/param/p{}", n % 16), vec![OscType::Float(n as f32)]);
            encoder::encode(&OscPacket::Message(OscMessage { addr, args })).unwrap()
        })
        .collect();
    let mut group = criterion.benchmark_group("osc");
    group.throughput(Throughput::Elements(FLOOD));
    group.bench_function("10,000 packets to the queue", |bencher| {
        let input_queue = InputQueue::new(|| {});
        bencher.iter(|| {
            for packet in black_box(&packets) {
                for (message, _) in messages(packet).0 {
                    if let Ok(Asked::Turn(change)) = understand(&message, ACTIONS) {
                        input_queue.turn(change);
                    }
                }
            }
            input_queue.drain()
        });
    });
    group.finish();
}

fn model(criterion: &mut Criterion) {
    criterion.bench_function("model/one turn of a parameter, then one read", |bencher| {
        let (mut model, mut now) = (Model::default(), 0.0);
        bencher.iter(|| {
            now += 0.016;
            let turn = Turn { to: (now % 4.0) as f32, seconds: 0.05, changed_by: ChangedBy::Midi };
            model.turn("orb", &SIZE, turn, None, now);
            model.read("orb", &SIZE, None, now)
        });
    });
    criterion.bench_function("queue/put and take", |bencher| {
        let input_queue = InputQueue::new(|| {});
        bencher.iter(|| {
            let to = mariana_control::Amount::Value(1.0);
            input_queue.turn(ParamChange {
                name: "size".to_owned(),
                to,
                seconds: 0.0,
                changed_by: ChangedBy::Osc,
            });
            input_queue.drain()
        });
    });
}

criterion_group!(benches, midi, osc, model);
criterion_main!(benches);
