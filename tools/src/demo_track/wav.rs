//! A dithered stereo WAVE file of 16 bits.

use super::drums::Noise;
use super::score::SAMPLE_RATE;
use super::synth::Frame;

/// Encodes the whole file. Triangular dither of ±1 step turns rounding errors into a steady, very soft hiss. Digital
/// silence stays silent.
pub fn encode(frames: &[Frame]) -> Vec<u8> {
    let data_bytes = (frames.len() * 4) as u32;
    let mut file = Vec::with_capacity(44 + frames.len() * 4);
    file.extend_from_slice(b"RIFF");
    file.extend_from_slice(&(36 + data_bytes).to_le_bytes());
    file.extend_from_slice(b"WAVEfmt ");
    file.extend_from_slice(&16_u32.to_le_bytes());
    file.extend_from_slice(&1_u16.to_le_bytes()); // PCM
    file.extend_from_slice(&2_u16.to_le_bytes()); // channels
    file.extend_from_slice(&SAMPLE_RATE.to_le_bytes());
    file.extend_from_slice(&(SAMPLE_RATE * 4).to_le_bytes()); // bytes per second
    file.extend_from_slice(&4_u16.to_le_bytes()); // bytes per frame
    file.extend_from_slice(&16_u16.to_le_bytes()); // bits per sample
    file.extend_from_slice(b"data");
    file.extend_from_slice(&data_bytes.to_le_bytes());
    let mut noise = Noise::new(16);
    for sample in frames.iter().flatten() {
        let dither = if *sample == 0.0 { 0.0 } else { 0.5 * (noise.sample() + noise.sample()) };
        let value = (sample * 32_767.0 + dither).round().clamp(-32_768.0, 32_767.0) as i16;
        file.extend_from_slice(&value.to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_within_two_steps_and_sizes_agree() {
        let frames = [[0.0, 1.0], [-1.0, 0.5], [0.25, 2.0]];
        let file = encode(&frames);
        assert_eq!(file.len(), 44 + 12);
        assert_eq!(file[4..8], (file.len() as u32 - 8).to_le_bytes());
        let values: Vec<i16> = file[44..].chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
        let expected = [0, 32_767, -32_767, 16_383, 8_191, 32_767];
        assert!(values.iter().zip(expected).all(|(&v, e)| (i32::from(v) - e).abs() <= 2), "{values:?}");
    }
}
