//! The window function for Fourier transforms.

/// Returns the periodic Hann window, `length` weights 0..1: w(n) = ½ - ½·cos(2πn / length). The window's peak is at
/// `length / 2`, and its equivalent noise bandwidth is 1.5 bins (Harris 1978, table 1).
pub(super) fn hann(length: usize) -> Vec<f32> {
    let step = std::f64::consts::TAU / length as f64;
    (0..length).map(|n| (0.5 - 0.5 * (step * n as f64).cos()) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hann_has_its_known_gain_and_noise_bandwidth() {
        let window = hann(4096);
        let sum: f64 = window.iter().map(|&w| f64::from(w)).sum();
        let squares: f64 = window.iter().map(|&w| f64::from(w).powi(2)).sum();
        let noise_bandwidth = 4096.0 * squares / (sum * sum);
        assert!((sum / 4096.0 - 0.5).abs() < 1e-6, "coherent gain {}", sum / 4096.0);
        assert!((noise_bandwidth - 1.5).abs() < 1e-6, "noise bandwidth {noise_bandwidth} bins");
        assert_eq!(window[2048], 1.0);
        assert_eq!(window[0], 0.0);
    }
}
