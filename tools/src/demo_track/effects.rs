//! Reverb, ping-pong delay, ducking and a limiter.

use super::score::{SAMPLE_RATE, STEP};
use super::synth::{DT, Filter, Frame, Pass};
use std::collections::VecDeque;

/// A ring buffer that delays a signal by `length` samples.
#[derive(Clone, Debug)]
struct DelayLine {
    samples: Vec<f32>,
    position: usize,
}

impl DelayLine {
    fn new(length: usize) -> Self {
        Self { samples: vec![0.0; length], position: 0 }
    }

    fn read(&self) -> f32 {
        self.samples[self.position]
    }

    fn write(&mut self, x: f32) {
        self.samples[self.position] = x;
        self.position = (self.position + 1) % self.samples.len();
    }

    /// Processes a sample with a Schroeder all-pass filter that uses this delay line.
    fn all_pass(&mut self, x: f32) -> f32 {
        const GAIN: f32 = 0.6;
        let delayed = self.read();
        let y = delayed - GAIN * x;
        self.write(x + GAIN * y);
        y
    }
}

/// A feedback delay network of eight lines with a Hadamard matrix (Jot and Chaigne, "Digital Delay Networks for
/// Designing Artificial Reverberators", 1991), after two all-pass diffusers per side. Even lines have input and
/// output on the left, odd lines on the right.
#[derive(Debug)]
pub struct Reverb {
    diffusers: [[DelayLine; 2]; 2],
    lines: [DelayLine; 8],
    gains: [f32; 8],
    damped: [f32; 8],
}

impl Reverb {
    /// Creates a reverb in which low frequencies decay by 60 dB in `t60` seconds.
    pub fn new(t60: f32) -> Self {
        // The lengths are mutually prime and take 30 to 58 ms.
        const LENGTHS: [usize; 8] = [1433, 1601, 1867, 2053, 2251, 2399, 2617, 2797];
        Self {
            diffusers: [
                [DelayLine::new(241), DelayLine::new(571)],
                [DelayLine::new(263), DelayLine::new(547)],
            ],
            lines: LENGTHS.map(DelayLine::new),
            gains: LENGTHS.map(|n| 10.0_f32.powf(-3.0 * n as f32 * DT / t60)),
            damped: [0.0; 8],
        }
    }

    /// Processes one sample frame. Returns the reverberation without the dry sound.
    pub fn run(&mut self, input: Frame) -> Frame {
        const DAMPING: f32 = 0.32;
        let fed: Frame = std::array::from_fn(|side| {
            self.diffusers[side].iter_mut().fold(input[side], |x, diffuser| diffuser.all_pass(x))
        });
        let mut v: [f32; 8] = std::array::from_fn(|i| {
            self.damped[i] += (1.0 - DAMPING) * (self.lines[i].read() - self.damped[i]);
            self.damped[i] * self.gains[i]
        });
        let out = [v[0] - v[2] + v[4] - v[6], v[1] - v[3] + v[5] - v[7]];
        for half in [1, 2, 4] {
            for i in 0..8 {
                if i & half == 0 {
                    (v[i], v[i | half]) = (v[i] + v[i | half], v[i] - v[i | half]);
                }
            }
        }
        for (i, line) in self.lines.iter_mut().enumerate() {
            line.write(v[i] / 8.0_f32.sqrt() + 0.5 * fed[i % 2]);
        }
        out.map(|x| 0.5 * x)
    }
}

/// Echoes that alternate between the sides every dotted eighth, each darker and softer than the previous echo.
#[derive(Debug)]
pub struct PingPong {
    lines: [DelayLine; 2],
    low: [Filter; 2],
    high: [Filter; 2],
    feedback: f32,
}

impl PingPong {
    /// Creates a delay. `feedback` is the level of each echo relative to the previous echo, 0..1.
    pub fn new(feedback: f32) -> Self {
        Self {
            lines: [DelayLine::new(3 * STEP), DelayLine::new(3 * STEP)],
            low: [Filter::new(Pass::Low, 4_500.0, 0.6); 2],
            high: [Filter::new(Pass::High, 260.0, 0.6); 2],
            feedback,
        }
    }

    /// Processes one sample frame. Returns the echoes without the dry sound. The first echo is on the left.
    pub fn run(&mut self, input: Frame) -> Frame {
        let echoes = [self.lines[0].read(), self.lines[1].read()];
        let coloured: Frame = std::array::from_fn(|i| self.high[i].run(self.low[i].run(echoes[i])));
        self.lines[0].write(0.5 * (input[0] + input[1]) + self.feedback * coloured[1]);
        self.lines[1].write(self.feedback.sqrt() * coloured[0]);
        echoes
    }
}

/// Returns the amount of ducking for each sample, from 0 (no ducking) to 1 (at a full kick). Each instrument scales
/// this amount.
pub fn ducking(kicks: &[(usize, f32)], length: usize) -> Vec<f32> {
    let mut duck = vec![0.0_f32; length];
    let (fall, rise) = (0.004, 0.26);
    for &(start, velocity) in kicks {
        let end = length.min(start + ((fall + rise) / DT) as usize);
        for (n, depth) in duck[start.min(end)..end].iter_mut().enumerate() {
            let t = n as f32 * DT;
            let shape = if t < fall { t / fall } else { (1.0 - (t - fall) / rise).powi(2) };
            *depth = depth.max(velocity * shape);
        }
    }
    duck
}

/// Limits `frames` in place with a stereo-linked look-ahead limiter. Afterwards, no sample exceeds `ceiling`. The
/// gain changes smoothly.
pub fn limit(frames: &mut [Frame], ceiling: f32) {
    const LOOK_AHEAD: usize = 240; // 5 ms
    let release = 1.0 - (-DT / 0.12).exp();
    let needed: Vec<f32> = frames
        .iter()
        .map(|f| {
            let peak = f[0].abs().max(f[1].abs());
            if peak > ceiling { ceiling / peak } else { 1.0 }
        })
        .collect();
    // `held` is the lowest gain that the next `LOOK_AHEAD` samples need. It drops at once and recovers slowly. Its
    // moving average reaches the needed gain exactly at the peak.
    let mut least: VecDeque<usize> = VecDeque::new();
    let mut held = 1.0_f32;
    let mut recent: VecDeque<f32> = VecDeque::from(vec![1.0; LOOK_AHEAD]);
    let mut sum = LOOK_AHEAD as f64;
    let mut seen = 0;
    for (n, frame) in frames.iter_mut().enumerate() {
        while seen < needed.len().min(n + LOOK_AHEAD) {
            while least.back().is_some_and(|&i| needed[i] >= needed[seen]) {
                least.pop_back();
            }
            least.push_back(seen);
            seen += 1;
        }
        while least.front().is_some_and(|&i| i < n) {
            least.pop_front();
        }
        let target = least.front().map_or(1.0, |&i| needed[i]);
        held = target.min(held + (1.0 - held) * release);
        recent.push_back(held);
        sum += f64::from(held) - f64::from(recent.pop_front().unwrap_or(1.0));
        let gain = (sum / LOOK_AHEAD as f64) as f32;
        *frame = frame.map(|x| (x * gain).clamp(-ceiling, ceiling));
    }
}

/// Removes inaudibly low frequencies and the DC offset, in place.
pub fn remove_rumble(frames: &mut [Frame]) {
    let mut filters = [Filter::new(Pass::High, 24.0, 0.7); 2];
    for frame in frames {
        *frame = std::array::from_fn(|i| filters[i].run(frame[i]));
    }
}

/// Fades both ends to 0 within `seconds`, to avoid clicks when a player starts or stops.
pub fn fade_edges(frames: &mut [Frame], seconds: f32) {
    let span = ((seconds * SAMPLE_RATE as f32) as usize).min(frames.len() / 2);
    let last = frames.len().saturating_sub(1);
    for n in 0..span {
        let u = n as f32 / span as f32;
        let gain = u * u * (3.0 - 2.0 * u);
        frames[n] = frames[n].map(|x| x * gain);
        frames[last - n] = frames[last - n].map(|x| x * gain);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    #[test]
    fn the_limiter_keeps_its_ceiling_and_does_not_change_soft_sounds() {
        let wave = |n: usize, level: f32| level * (TAU * 100.0 * n as f32 * DT).sin();
        let mut frames: Vec<Frame> =
            (0..48_000).map(|n| [wave(n, if n > 30_000 { 3.0 } else { 0.3 }), 0.0]).collect();
        let before = frames.clone();
        limit(&mut frames, 0.8);
        assert!(frames.iter().all(|f| f[0].abs() <= 0.8));
        assert!(frames[35_000..].iter().any(|f| f[0].abs() > 0.7));
        assert!((0..29_000).all(|n| (frames[n][0] - before[n][0]).abs() < 1e-6));
    }

    #[test]
    fn the_reverb_decays_in_time() {
        let mut reverb = Reverb::new(1.5);
        let energy: Vec<f32> = (0..4)
            .map(|second| {
                (0..48_000)
                    .map(|n| reverb.run(if second == 0 && n == 0 { [1.0, 1.0] } else { [0.0; 2] }))
                    .map(|f| f[0] * f[0] + f[1] * f[1])
                    .sum()
            })
            .collect();
        // A decay by 60 dB in 1.5 s is 40 dB per second. Damping makes the decay faster.
        assert!(
            energy[0] > 0.01 && energy[1] < energy[0] * 2e-4 && energy[3] < energy[0] * 1e-9,
            "{energy:?}"
        );
    }

    #[test]
    fn echoes_change_sides() {
        let mut delay = PingPong::new(0.5);
        let out: Vec<Frame> =
            (0..8 * STEP).map(|n| delay.run(if n == 0 { [1.0, 1.0] } else { [0.0; 2] })).collect();
        let peak = |side: usize, from: usize| {
            out[from..from + STEP].iter().fold(0.0_f32, |m, f| m.max(f[side].abs()))
        };
        assert!(peak(0, 3 * STEP) > 0.9 && peak(1, 3 * STEP) == 0.0);
        assert!(peak(1, 6 * STEP) > 0.1 && peak(0, 6 * STEP) < 0.01);
    }

    #[test]
    fn ducking_is_deepest_after_a_kick_and_recovers() {
        let duck = ducking(&[(1000, 1.0)], 48_000);
        assert_eq!((duck[999], duck[47_000]), (0.0, 0.0));
        assert!(duck[1200] > 0.9 && duck.windows(2).all(|w| (w[1] - w[0]).abs() < 0.01));
    }
}
