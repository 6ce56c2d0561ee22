//! Trains a network on 25 hours of generated music and writes its weights. No recording is used. This takes about six
//! minutes of one core: `MARIANA_TRAIN=live_weights.bin RUSTFLAGS="-C target-cpu=native" cargo test --release
//! -p mariana-music activation::training -- --nocapture`

mod effects;
mod music;
mod net;
mod patterns;
mod synth;
mod tones;

use std::f32::consts::PI;
use std::path::Path;

use super::input::{BANDS, Input, NUMBERS};
use super::network::Network;
use super::{STEP_HOPS, WINDOW_HOPS};
use crate::spectrum::Spectrum;
use net::{Net, OUT, Values};
use synth::{RATE, Random};

const HOP: usize = 512;
const STEP_SECONDS: f32 = (STEP_HOPS * HOP) as f32 / RATE;
/// The files of weights for whole songs and for live input, the numbers of blocks, and of blocks that look ahead.
const NETWORKS: [(&str, usize, usize); 2] = [("weights.bin", 9, 9), ("live_weights.bin", 8, 2)];
/// The highest learning rate, and the number of pieces for each step of the training.
const RATE_MAX: f32 = 2.5e-3;
const TOGETHER: usize = 2;
/// The fraction of units that are dropped.
const DROPPED: f32 = 0.1;

struct Example {
    input: Vec<f32>,
    /// For each step, how near the next beat and the next downbeat are, 0..1.
    targets: Vec<[f32; OUT]>,
}

fn example(seed: u64, seconds: f32) -> Example {
    let piece = music::piece(seed, seconds);
    let (step, length) = (STEP_HOPS * HOP, WINDOW_HOPS * HOP);
    let mut spectrum = Spectrum::new(length, |_| 1.0);
    let mut measured = Input::new(length / 2, f64::from(RATE) / length as f64, f64::from(STEP_SECONDS));
    let mut window = vec![[0.0; 2]; length];
    let mut input = Vec::new();
    for samples in piece.sound.chunks_exact(step) {
        window.copy_within(step.., 0);
        window[length - step..].iter_mut().zip(samples).for_each(|(frame, sample)| *frame = [*sample; 2]);
        input.extend(measured.follow(&spectrum.measure(&window).power));
    }
    let mut targets = vec![[0.0_f32; OUT]; input.len() / NUMBERS];
    for (beat, is_downbeat) in piece.beats {
        let place = beat / STEP_SECONDS;
        let near = (place.max(1.0) as usize - 1)..(place as usize + 3).min(targets.len());
        for step in near {
            let nearness = (1.0 - (step as f32 - place).abs() / 1.5).max(0.0);
            let [of_beat, of_downbeat] = &mut targets[step];
            *of_beat = of_beat.max(nearness);
            if is_downbeat {
                *of_downbeat = of_downbeat.max(nearness);
            }
        }
    }
    Example { input, targets }
}

/// Changes the levels of the bands at random, and silences some of them.
fn varied(input: &[f32], random: &mut Random) -> Vec<f32> {
    let mut gains = [random.ratio(0.7, 1.4); BANDS];
    if random.chance(0.5) {
        let (first, count) = (random.below(BANDS), random.below(16));
        gains[first..(first + count).min(BANDS)].fill(0.0);
    }
    let tilt = random.between(-0.5, 0.5);
    for (band, gain) in gains.iter_mut().enumerate() {
        *gain *= (1.0 + tilt * (band as f32 / 20.0 - 1.0)) * random.ratio(0.8, 1.25);
    }
    let varied = input.iter().enumerate().map(|(index, number)| number * gains[index % BANDS]);
    varied.collect()
}

/// Returns the cross entropy, and its gradient.
fn loss(out: &[f32], targets: &[[f32; OUT]], gradient: &mut Vec<f32>) -> f32 {
    gradient.clear();
    let mut sum = 0.0;
    for (odds, target) in out.iter().zip(targets.as_flattened()) {
        let p = (1.0 / (1.0 + (-odds).exp())).clamp(1e-6, 1.0 - 1e-6);
        sum -= target * p.ln() + (1.0 - target) * (1.0 - p).ln();
        gradient.push(p - target);
    }
    sum
}

fn trained(mut net: Net, examples: &[Example], epochs: usize, random: &mut Random) -> (Net, Vec<f32>) {
    let (mut values, mut gradient, mut losses) = (Values::default(), Vec::new(), Vec::new());
    let steps = (epochs * examples.len().div_ceil(TOGETHER)) as f32;
    let mut step = 0.0_f32;
    for epoch in 0..epochs {
        let mut order: Vec<usize> = (0..examples.len()).collect();
        (1..order.len()).rev().for_each(|index| order.swap(index, random.below(index + 1)));
        let (mut sum, mut count) = (0.0, 0);
        for group in order.chunks(TOGETHER) {
            let mut moments = 0;
            for index in group {
                let Example { input, targets } = &examples[*index];
                let input = varied(input, random);
                net.forward(&input, &mut values, Some((DROPPED, &mut *random)));
                sum += loss(&values.out, targets, &mut gradient);
                net.backward(&input, &values, &gradient);
                moments += targets.len();
            }
            count += moments;
            step += 1.0;
            let rate = (step / 100.0).min(1.0) * (0.5 + 0.5 * (PI * step / steps).cos()).max(0.01);
            net.step(RATE_MAX * rate, 20.0 / moments as f32);
        }
        losses.push(sum / count as f32);
        println!("epoch {epoch}: loss {:.4}", sum / count as f32);
    }
    (net, losses)
}

/// Checks that training lowers the loss, and that the analysis computes the same odds as the training.
/// With `MARIANA_TRAIN` set, trains the network of that name on all pieces and writes its weights.
#[test]
fn training_lowers_the_loss_and_the_weights_can_be_read() {
    let wanted = std::env::var("MARIANA_TRAIN").ok();
    let (count, seconds, epochs) = if wanted.is_some() { (3_000, 30.0, 6) } else { (8, 12.0, 6) };
    let examples: Vec<Example> = (1..=count).map(|seed| example(seed, seconds)).collect();
    for (name, blocks, ahead) in NETWORKS {
        if wanted.as_ref().is_some_and(|wanted| wanted != name) {
            continue;
        }
        let mut random = Random::new(5);
        let net = Net::new(NUMBERS, blocks, ahead, &mut random);
        let (net, losses) = trained(net, &examples, epochs, &mut random);
        assert!(losses.last() < losses.first(), "{name}: {losses:?}");

        let file = net.file();
        let mut network = Network::read(&file).expect("a readable network");
        let mut values = Values::default();
        let input = &examples[0].input;
        net.forward(input, &mut values, None);
        let late = network.late();
        let streamed = input.as_chunks().0.iter().map(Some).chain(std::iter::repeat_n(None, late));
        let streamed: Vec<f32> = streamed.map(|numbers| network.follow(numbers)).collect();
        for (step, (odds, expected)) in
            streamed[late..].iter().zip(values.out.iter().step_by(OUT)).enumerate()
        {
            // The weights are rounded to 8 bits.
            assert!((odds - expected).abs() < 0.25, "{name}, step {step}: {odds}, not {expected}");
        }
        if wanted.is_some() {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/activation").join(name);
            std::fs::write(path, file).expect("a writable file");
        }
    }
}
