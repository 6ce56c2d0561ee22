//! Mixes the instruments, adds reverb and delay, and returns one stereo piece that can be looped.

use super::drums;
use super::effects::{PingPong, Reverb, ducking, fade_edges, limit, remove_rumble};
use super::score::{self, BAR, BARS, Drum, Note};
use super::synth::{self, Filter, Frame, Pass};
use std::f32::consts::TAU;

/// Number of bars to render after the end, for reverb tails. The tails are added to the beginning, as in a loop.
const TAIL_BARS: usize = 4;
const MASTER_GAIN: f32 = 0.5;
/// Peak level: -2 dBFS leaves room for overshoots of lossy codecs.
const CEILING: f32 = 0.794;

/// A value that is linear between (bar, value) points.
struct Curve(&'static [(f32, f32)]);

impl Curve {
    fn at(&self, sample: usize) -> f32 {
        let bar = sample as f32 / BAR as f32;
        let next = self.0.iter().position(|p| p.0 > bar);
        match next {
            Some(0) => self.0[0].1,
            Some(i) => {
                let ((b0, v0), (b1, v1)) = (self.0[i - 1], self.0[i]);
                v0 + (v1 - v0) * (bar - b0) / (b1 - b0)
            }
            None => self.0.last().map_or(0.0, |p| p.1),
        }
    }
}

const PAD_LEVEL: Curve = Curve(&[
    (0.0, 0.30),
    (4.0, 0.36),
    (8.0, 0.38),
    (11.8, 0.50),
    (12.0, 0.34),
    (20.0, 0.34),
    (22.0, 0.12),
    (24.0, 0.36),
    (36.0, 0.36),
    (40.0, 0.22),
]);
/// Corner frequency in octaves above 100 Hz.
const PAD_CORNER: Curve = Curve(&[
    (0.0, 2.6),
    (4.0, 3.3),
    (8.0, 3.4),
    (11.8, 5.6),
    (12.0, 4.8),
    (20.0, 5.0),
    (22.0, 3.0),
    (24.0, 4.9),
    (32.0, 5.3),
    (36.0, 4.6),
    (39.0, 2.6),
]);
const PAD_SWAY: Curve = Curve(&[(0.0, 0.45), (6.0, 0.45), (8.0, 0.0), (36.0, 0.0), (38.0, 0.45)]);
const ARP_LEVEL: Curve = Curve(&[(8.0, 0.4), (12.0, 0.5), (36.0, 0.5), (39.0, 0.35)]);
/// The reverb is muted for the silence before the second loud part.
const RETURN_LEVEL: Curve = Curve(&[(23.0, 1.0), (23.45, 0.0), (23.85, 0.0), (23.9, 1.0)]);

/// The level of an instrument, and the fractions that go to the reverb and the delay.
struct Channel {
    level: f32,
    /// Amount of ducking under the kick, 0..1.
    duck: f32,
    reverb: f32,
    delay: f32,
}

struct Mixer {
    dry: Vec<Frame>,
    reverb: Vec<Frame>,
    delay: Vec<Frame>,
    duck: Vec<f32>,
}

impl Mixer {
    fn add(&mut self, bus: &[Frame], channel: &Channel) {
        for (n, frame) in bus.iter().enumerate() {
            let gain = channel.level * (1.0 - channel.duck * self.duck[n]);
            for (side, sample) in frame.iter().enumerate() {
                let x = gain * sample;
                self.dry[n][side] += x;
                self.reverb[n][side] += channel.reverb * x;
                self.delay[n][side] += channel.delay * x;
            }
        }
    }

    /// Adds the reverb and the delay. The echoes get reverb as well.
    fn finish(mut self) -> Vec<Frame> {
        let (mut reverb, mut delay) = (Reverb::new(2.4), PingPong::new(0.42));
        let mut clean = [Filter::new(Pass::High, 180.0, 0.6); 2];
        for n in 0..self.dry.len() {
            let echo = delay.run(self.delay[n]);
            let sent = std::array::from_fn(|i| clean[i].run(self.reverb[n][i] + 0.3 * echo[i]));
            let room = reverb.run(sent);
            let open = RETURN_LEVEL.at(n);
            for side in 0..2 {
                self.dry[n][side] += open * (echo[side] + (1.0 - 0.45 * self.duck[n]) * room[side]);
            }
        }
        self.dry
    }
}

fn bus(length: usize, notes: &[Note], instrument: impl Fn(&mut [Frame], &Note)) -> Vec<Frame> {
    let mut out = vec![[0.0; 2]; length];
    notes.iter().for_each(|note| instrument(&mut out, note));
    out
}

/// Filters the pads with [`PAD_CORNER`], and moves them from side to side in quiet parts.
fn shape_pads(pads: &mut [Frame]) {
    let mut low = [Filter::new(Pass::Low, 400.0, 0.75); 2];
    let mut high = [Filter::new(Pass::High, 130.0, 0.6); 2];
    for (n, frame) in pads.iter_mut().enumerate() {
        let turn = TAU * n as f32 / (4 * BAR) as f32;
        if n % 32 == 0 {
            let corner = 100.0 * (PAD_CORNER.at(n) + 0.25 * (turn * 2.0).sin()).exp2();
            low.iter_mut().for_each(|f| f.tune(corner));
        }
        let sway = PAD_SWAY.at(n) * turn.sin();
        let level = PAD_LEVEL.at(n);
        for (side, lean) in [1.0 - sway, 1.0 + sway].into_iter().enumerate() {
            frame[side] = level * lean * high[side].run(low[side].run(frame[side]));
        }
    }
}

pub fn render() -> Vec<Frame> {
    let length = (BARS + TAIL_BARS) * BAR;
    let hits = score::drums();
    let kicks: Vec<(usize, f32)> =
        hits.iter().filter(|h| h.drum == Drum::Kick).map(|h| (h.start, h.velocity)).collect();
    let silence = vec![[0.0; 2]; length];
    let mut mixer = Mixer {
        dry: silence.clone(),
        reverb: silence.clone(),
        delay: silence,
        duck: ducking(&kicks, length),
    };

    let mut pads = bus(length, &score::pads(), synth::pad);
    shape_pads(&mut pads);
    mixer.add(&pads, &Channel { level: 0.75, duck: 0.7, reverb: 0.35, delay: 0.0 });

    let mut arpeggio = bus(length, &score::arpeggio(), |out, note| synth::pluck(out, note, 0.9));
    arpeggio.iter_mut().enumerate().for_each(|(n, f)| *f = f.map(|x| x * ARP_LEVEL.at(n)));
    mixer.add(&arpeggio, &Channel { level: 1.0, duck: 0.35, reverb: 0.12, delay: 0.1 });

    let stabs = bus(length, &score::stabs(), |out, note| synth::pluck(out, note, 0.7));
    mixer.add(&stabs, &Channel { level: 0.62, duck: 0.1, reverb: 0.15, delay: 0.0 });

    let bells = bus(length, &score::bells(), synth::bell);
    mixer.add(&bells, &Channel { level: 0.30, duck: 0.0, reverb: 0.3, delay: 0.25 });

    let lead = bus(length, &score::lead(), synth::lead);
    mixer.add(&lead, &Channel { level: 0.50, duck: 0.15, reverb: 0.28, delay: 0.32 });

    let bass = bus(length, &score::bass(), synth::bass);
    mixer.add(&bass, &Channel { level: 0.62, duck: 0.75, reverb: 0.0, delay: 0.0 });

    // Low drums stay almost dry, and high drums get reverb.
    let (mut low, mut high) = (vec![[0.0; 2]; length], vec![[0.0; 2]; length]);
    for (index, hit) in hits.iter().enumerate() {
        let out = if matches!(hit.drum, Drum::Kick | Drum::Impact) { &mut low } else { &mut high };
        drums::strike(out, hit, index);
    }
    mixer.add(&low, &Channel { level: 0.95, duck: 0.0, reverb: 0.02, delay: 0.0 });
    mixer.add(&high, &Channel { level: 0.55, duck: 0.0, reverb: 0.14, delay: 0.0 });

    let mut piece = mixer.finish();
    let tail = piece.split_off(BARS * BAR);
    for (frame, rest) in piece.iter_mut().zip(tail) {
        *frame = std::array::from_fn(|i| frame[i] + rest[i]);
    }
    piece.iter_mut().for_each(|f| *f = f.map(|x| x * MASTER_GAIN));
    remove_rumble(&mut piece);
    limit(&mut piece, CEILING);
    fade_edges(&mut piece, 0.005);
    piece
}

#[cfg(test)]
mod tests {
    use super::synth::DT;
    use super::*;

    fn rms(frames: &[Frame], side: usize) -> f32 {
        (frames.iter().map(|f| f64::from(f[side] * f[side])).sum::<f64>() / frames.len() as f64).sqrt() as f32
    }

    /// Renders the piece once and checks the properties that the visualizer relies on: sides, silence, loud parts
    /// and a clean loop.
    #[test]
    fn the_piece_has_its_form() {
        let piece = render();
        assert_eq!(piece.len(), BARS * BAR);
        assert!(piece.iter().flatten().all(|x| x.is_finite() && x.abs() <= CEILING));
        let bars = |from: f32, to: f32| &piece[(from * BAR as f32) as usize..(to * BAR as f32) as usize];
        let both = |from, to| 0.5 * (rms(bars(from, to), 0) + rms(bars(from, to), 1));
        assert!(both(12.0, 20.0) > 2.5 * both(0.0, 8.0), "the loud part is louder");
        assert!(both(23.5, 23.85) < 0.01 * both(12.0, 20.0), "the silence is silent");
        assert!(rms(bars(20.5, 21.0), 0) > 3.0 * rms(bars(20.5, 21.0), 1), "left only");
        assert!(rms(bars(21.5, 22.0), 1) > 3.0 * rms(bars(21.5, 22.0), 0), "right only");
        // At the loop point, both ends are 0 and the sound is quiet.
        assert_eq!((piece[0], piece[piece.len() - 1]), ([0.0; 2], [0.0; 2]));
        let last = (0.1 / DT) as usize;
        assert!(rms(&piece[piece.len() - last..], 0) < 0.03 && rms(&piece[..last], 0) < 0.03);
        let mean = piece.iter().map(|f| f64::from(f[0])).sum::<f64>() / piece.len() as f64;
        assert!(mean.abs() < 1e-4, "no DC offset: {mean}");
    }

    #[test]
    fn curves_are_straight_between_points() {
        const CURVE: Curve = Curve(&[(1.0, 2.0), (3.0, 4.0)]);
        assert_eq!([0, BAR, 2 * BAR, 3 * BAR, 9 * BAR].map(|n| CURVE.at(n)), [2.0, 2.0, 3.0, 4.0, 4.0]);
    }
}
