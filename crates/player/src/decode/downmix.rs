//! Down-mix of any number of channels to two.
//!
//! Mono goes to both sides at full level, and stereo is unchanged. With more channels, each side is a weighted sum
//! after the down-mix of ITU-R BS.775-3 (annex 4). The weight is 1 for the side's front channel, 1/sqrt(2) (-3 dB) for
//! the centre, the side's surrounds and LFE channels, and 1/2 for a rear or top centre. ITU-R BS.775-3 leaves LFE to the
//! receiver; here a bass that is only in this channel moves the picture. The weights of both sides are divided by the
//! larger of the two sums, so that the mix never exceeds full scale.
//!
//! If the container gives no positions, the order of WAVE files applies: 3: L R C; 4: L R Ls Rs; 5: L R C Ls Rs; 6: L R
//! C LFE Ls Rs; 7: L R C LFE Cs Ls Rs; 8: L R C LFE Lb Rb Ls Rs. With more than eight unknown channels, even channels
//! (counted from 0) go to the left and odd channels to the right. Ambisonic sound is decoded to two cardioids that
//! point left and right.

use std::f32::consts::FRAC_1_SQRT_2;

use symphonia::core::audio::{ChannelLabel, Channels, Position};

use mariana_music::StereoFrame;

/// Sample values are clamped to this magnitude (24 dB over full scale), because float files may contain any value.
const SAMPLE_MAX: f32 = 16.0;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Downmix {
    weights: Vec<[f32; 2]>,
}

impl Downmix {
    pub(super) fn new(channels: &Channels) -> Self {
        let count = channels.count();
        let weights = match channels {
            _ if count == 1 => Some(vec![[1.0, 1.0]]),
            _ if count == 2 => Some(vec![[1.0, 0.0], [0.0, 1.0]]),
            Channels::Positioned(mask) if !is_placeholder(*mask) => normalised(mask.iter().map(weight)),
            Channels::Custom(labels) => normalised(labels.iter().map(|label| match label {
                ChannelLabel::Positioned(position) => weight(*position),
                _ => [0.0; 2],
            })),
            Channels::Ambisonic(_) => {
                let mut weights = vec![[0.0; 2]; count];
                // Channels 0 and 1 in ACN order: the omnidirectional part, and left minus right.
                for (weight, value) in weights.iter_mut().zip([[0.5, 0.5], [0.5, -0.5]]) {
                    *weight = value;
                }
                Some(weights)
            }
            _ => None,
        }
        .or_else(|| usual_order(count).and_then(|order| normalised(order.iter().copied().map(weight))))
        .unwrap_or_else(|| alternating(count));
        Self { weights }
    }

    /// The down-mix of an input or output with this number of channels in the order of WAVE files.
    pub(crate) fn of_speakers(count: u16) -> Self {
        Self::new(&Channels::Discrete(count))
    }

    pub(super) fn channels(&self) -> usize {
        self.weights.len()
    }

    /// Mixes the samples of one frame.
    pub(crate) fn mix_frame(&self, samples: impl Iterator<Item = f32>) -> StereoFrame {
        samples.zip(&self.weights).fold([0.0; 2], |[left, right], (sample, weight)| {
            let sample = clean(sample);
            [left + weight[0] * sample, right + weight[1] * sample]
        })
    }

    /// Mixes the planes (one per channel, of equal length) into `out`. Samples that are not finite become silence.
    pub(super) fn mix(&self, planes: &[Vec<f32>], frames: usize, out: &mut Vec<StereoFrame>) {
        match planes {
            [mono] => out.extend(mono.iter().take(frames).map(|&s| [clean(s); 2])),
            [left, right] => {
                out.extend(left.iter().zip(right).take(frames).map(|(&l, &r)| [clean(l), clean(r)]));
            }
            _ => out.extend((0..frames).map(|at| {
                self.mix_frame(planes.iter().map(|plane| plane.get(at).copied().unwrap_or_default()))
            })),
        }
    }
}

fn clean(sample: f32) -> f32 {
    if sample.is_finite() { sample.clamp(-SAMPLE_MAX, SAMPLE_MAX) } else { 0.0 }
}

fn weight(position: Position) -> [f32; 2] {
    const SIDE: f32 = FRAC_1_SQRT_2;
    if position == Position::FRONT_LEFT {
        [1.0, 0.0]
    } else if position == Position::FRONT_RIGHT {
        [0.0, 1.0]
    } else if CENTRE.contains(position) {
        [SIDE, SIDE]
    } else if LEFT.contains(position) {
        [SIDE, 0.0]
    } else if RIGHT.contains(position) {
        [0.0, SIDE]
    } else {
        [0.5, 0.5]
    }
}

const CENTRE: Position =
    Position::FRONT_CENTER.union(Position::BOTTOM_FRONT_CENTER).union(Position::LFE1).union(Position::LFE2);

const LEFT: Position = Position::REAR_LEFT
    .union(Position::FRONT_LEFT_CENTER)
    .union(Position::SIDE_LEFT)
    .union(Position::TOP_FRONT_LEFT)
    .union(Position::TOP_REAR_LEFT)
    .union(Position::TOP_SIDE_LEFT)
    .union(Position::BOTTOM_FRONT_LEFT)
    .union(Position::FRONT_LEFT_WIDE);

const RIGHT: Position = Position::REAR_RIGHT
    .union(Position::FRONT_RIGHT_CENTER)
    .union(Position::SIDE_RIGHT)
    .union(Position::TOP_FRONT_RIGHT)
    .union(Position::TOP_REAR_RIGHT)
    .union(Position::TOP_SIDE_RIGHT)
    .union(Position::BOTTOM_FRONT_RIGHT)
    .union(Position::FRONT_RIGHT_WIDE);

/// True for a mask without meaning, which is set by programs that know only the number of channels. Such a mask has a
/// left without its right (or the reverse), or consists of the first four positions, a 3.1 layout that no program
/// writes.
fn is_placeholder(mask: Position) -> bool {
    let first_positions = (mask.bits() & (mask.bits() + 1)) == 0;
    let lefts = (mask & (LEFT | Position::FRONT_LEFT)).bits().count_ones();
    let rights = (mask & (RIGHT | Position::FRONT_RIGHT)).bits().count_ones();
    first_positions && (lefts != rights || mask.bits().count_ones() == 4 || mask.bits().count_ones() > 8)
}

fn usual_order(count: usize) -> Option<&'static [Position]> {
    const L: Position = Position::FRONT_LEFT;
    const R: Position = Position::FRONT_RIGHT;
    const C: Position = Position::FRONT_CENTER;
    const LFE: Position = Position::LFE1;
    const LB: Position = Position::REAR_LEFT;
    const RB: Position = Position::REAR_RIGHT;
    const CS: Position = Position::REAR_CENTER;
    const LS: Position = Position::SIDE_LEFT;
    const RS: Position = Position::SIDE_RIGHT;
    Some(match count {
        3 => &[L, R, C],
        4 => &[L, R, LS, RS],
        5 => &[L, R, C, LS, RS],
        6 => &[L, R, C, LFE, LS, RS],
        7 => &[L, R, C, LFE, CS, LS, RS],
        8 => &[L, R, C, LFE, LB, RB, LS, RS],
        _ => return None,
    })
}

fn alternating(count: usize) -> Vec<[f32; 2]> {
    let fraction = 1.0 / count.div_ceil(2).max(1) as f32;
    (0..count).map(|i| if i % 2 == 0 { [fraction, 0.0] } else { [0.0, fraction] }).collect()
}

/// Scales the weights. Returns `None` if the mix would be silent.
fn normalised(weights: impl Iterator<Item = [f32; 2]>) -> Option<Vec<[f32; 2]>> {
    let mut weights: Vec<[f32; 2]> = weights.collect();
    let sum = weights.iter().fold([0.0f32; 2], |sum, w| [sum[0] + w[0], sum[1] + w[1]]);
    let loudest = sum[0].max(sum[1]);
    if loudest <= 0.0 {
        return None;
    }
    for weight in &mut weights {
        *weight = [weight[0] / loudest, weight[1] / loudest];
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mixed(channels: &Channels, frame: &[f32]) -> StereoFrame {
        let planes: Vec<Vec<f32>> = frame.iter().map(|&s| vec![s]).collect();
        let mut out = Vec::new();
        Downmix::new(channels).mix(&planes, 1, &mut out);
        assert_eq!(out.len(), 1);
        out[0]
    }

    #[test]
    fn no_layout_clips_and_none_is_silent() {
        for count in 1..=32u16 {
            let full = vec![1.0; usize::from(count)];
            let mut layouts = vec![Channels::Discrete(count)];
            if let Some(mask) = Position::from_count(u32::from(count)) {
                layouts.push(Channels::Positioned(mask));
            }
            for layout in layouts {
                let [l, r] = mixed(&layout, &full);
                assert!(l <= 1.000_001 && r <= 1.000_001, "{layout:?}: {l} {r}");
                assert!(l > 0.4 && r > 0.4, "{layout:?}: {l} {r}");
            }
        }
    }

    #[test]
    fn positions_are_heard_on_their_side() {
        let five_one = Position::FRONT_LEFT
            | Position::FRONT_RIGHT
            | Position::FRONT_CENTER
            | Position::LFE1
            | Position::REAR_LEFT
            | Position::REAR_RIGHT;
        let layout = Channels::Positioned(five_one);
        let front = mixed(&layout, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(front[0] > 0.3 && front[1] == 0.0);
        let ratio = |i: usize, side: usize| {
            let mut frame = [0.0; 6];
            frame[i] = 1.0;
            mixed(&layout, &frame)[side] / front[0]
        };
        // The wanted levels are relative to the front: -3 dB for centre, LFE and surrounds.
        let centre = [(2, 0, -3.01), (2, 1, -3.01), (3, 0, -3.01), (3, 1, -3.01)];
        for (i, side, wanted_db) in [(1, 1, 0.0), (4, 0, -3.01), (5, 1, -3.01)].into_iter().chain(centre) {
            assert!((20.0 * ratio(i, side).log10() - wanted_db).abs() < 0.01, "channel {i}");
        }
        assert_eq!((ratio(4, 1), ratio(5, 0)), (0.0, 0.0));
    }

    #[test]
    fn samples_that_are_not_finite_become_silence() {
        let stereo = Channels::Discrete(2);
        assert_eq!(mixed(&stereo, &[f32::NAN, f32::INFINITY]), [0.0, 0.0]);
        assert_eq!(mixed(&stereo, &[1e30, -1e30]), [SAMPLE_MAX, -SAMPLE_MAX]);
        assert_eq!(mixed(&Channels::Discrete(1), &[f32::NAN]), [0.0, 0.0]);
        assert_eq!(mixed(&Channels::Discrete(3), &[f32::NAN, 0.0, 0.0]), [0.0, 0.0]);
    }

    #[test]
    fn a_file_of_lfe_only_is_heard() {
        let [l, r] = mixed(
            &Channels::Custom(Box::new([
                ChannelLabel::Positioned(Position::LFE1),
                ChannelLabel::Positioned(Position::LFE2),
                ChannelLabel::Discrete(2),
            ])),
            &[1.0, 1.0, 1.0],
        );
        assert!(l > 0.0 && r > 0.0);
    }
}
