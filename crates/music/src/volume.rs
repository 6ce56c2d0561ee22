//! The loudness of each channel: the mean of |sample|.

use super::StereoFrame;

/// The volume is measured over a stretch of this duration, in seconds. The thesis (Abt 2022, section 5, eq. 1) uses the
/// samples since the last video frame, about 1/60 s, which ties the volume to the frame rate and to the sound card's
/// blocks. Here the duration is fixed, and the stretch is centred on the moment of the features.
const SECONDS: f64 = 1.0 / 60.0;

/// Returns the length of the stretch in sample frames: at least 2, and even, so that it has a centre.
pub(super) fn stretch_length(sample_rate: u32) -> usize {
    2 * ((f64::from(sample_rate) * SECONDS / 2.0).round() as usize).max(1)
}

/// Returns the volume V = (Σ |S_i|) / n (Abt 2022, section 5, eq. 1) of the left, right, mid and side channel. The mid
/// channel is (left + right) / 2, the side channel (left - right) / 2.
pub(super) fn volumes(frames: &[StereoFrame]) -> [f32; 4] {
    let mut sums = [0.0_f64; 4];
    for &[left, right] in frames {
        let values = [left, right, 0.5 * (left + right), 0.5 * (left - right)];
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += f64::from(value.abs());
        }
    }
    let count = frames.len().max(1) as f64;
    sums.map(|sum| (sum / count) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_1_of_known_signals() {
        assert_eq!(
            volumes(&[[0.5, -0.25], [-0.5, -0.25], [0.5, 0.75], [-0.5, -0.75]]),
            [0.5, 0.5, 0.4375, 0.1875]
        );
        assert_eq!(volumes(&[[1.0, 0.0], [0.0, 0.0], [0.0, 0.0], [-1.0, -1.0]]), [0.5, 0.25, 0.375, 0.125]);
        assert_eq!(volumes(&[]), [0.0; 4]);

        let sine: Vec<StereoFrame> =
            (0..1000).map(|n| [(std::f32::consts::TAU * n as f32 / 100.0).sin(), 0.0]).collect();
        let [left, right, mid, side] = volumes(&sine);
        assert!((left - std::f32::consts::FRAC_2_PI).abs() < 1e-3, "full-scale sine reads {left}");
        assert_eq!((right, mid, side), (0.0, 0.5 * left, 0.5 * left));
    }

    #[test]
    fn stretch_is_a_sixtieth_of_a_second_and_even() {
        assert_eq!(stretch_length(48_000), 800);
        assert_eq!(stretch_length(44_100), 736);
        assert_eq!(stretch_length(4_000), 66);
    }
}
