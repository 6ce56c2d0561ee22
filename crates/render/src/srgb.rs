//! Conversion of sRGB to linear light (IEC 61966-2-1). Shaders convert light back to sRGB (`shaders/encode.glsl`).

/// Converts an encoded value, 0..1, to linear light, 0..1.
pub fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Converts linear light, 0..1, to an encoded value, 0..1.
pub fn encoded(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear light of each byte value.
pub fn linear_of_bytes() -> [f32; 256] {
    std::array::from_fn(|byte| linear(byte as f32 / 255.0))
}

#[cfg(test)]
mod tests {
    #[test]
    fn black_white_and_the_middle_gray_of_a_camera_are_where_they_belong() {
        let light = super::linear_of_bytes();
        assert_eq!((light[0], light[255]), (0.0, 1.0));
        assert!((light[118] - 0.18).abs() < 0.005, "{}", light[118]);
        assert!(light.is_sorted());
        assert!(
            light
                .iter()
                .enumerate()
                .all(|(byte, light)| (255.0 * super::encoded(*light)).round() == byte as f32)
        );
    }
}
