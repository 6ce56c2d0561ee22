//! YUV4MPEG2 (y4m): a stream of uncompressed frames that encoders and players read. Colours are ITU-R BT.709 with black
//! at 16 and white at 235. The header can state the range, but not the matrix.

/// Chroma subsampling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chroma {
    /// No subsampling (4:4:4).
    Whole,
    /// One value for four pixels, their mean (4:2:0).
    Quarter,
}

const HEAD: &[u8] = b"FRAME\n";

/// Returns the header of the stream.
pub fn header(size: (u32, u32), fps: f64, chroma: Chroma) -> Vec<u8> {
    let (width, height) = size;
    let (frames, seconds) = ratio(fps);
    let chroma = match chroma {
        Chroma::Whole => "C444",
        Chroma::Quarter => "C420jpeg",
    };
    format!("YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 {chroma} XCOLORRANGE=LIMITED\n")
        .into_bytes()
}

/// Returns the exact frame rate that a rate such as 23.976, 23.98 or 29.97 stands for: a whole number of frames in
/// 1.001 seconds. `None` for other rates.
pub fn ntsc_rate(fps: f64) -> Option<f64> {
    let exact = (fps * 1.001).round() / 1.001;
    ((fps - exact).abs() < 5e-3 && (fps - fps.round()).abs() > 5e-3).then_some(exact)
}

/// Returns a frame rate as a fraction. NTSC rates are exact; other rates are rounded to a thousandth.
fn ratio(fps: f64) -> (u64, u64) {
    if let Some(exact) = ntsc_rate(fps) {
        return ((exact * 1.001).round() as u64 * 1_000, 1_001);
    }
    match (fps * 1_000.0).round() as u64 {
        whole if whole.is_multiple_of(1_000) => (whole / 1_000, 1),
        other => (other, 1_000),
    }
}

/// Encodes an RGBA frame, top row first, without subsampling.
pub fn frame(rgba: &[u8]) -> Vec<u8> {
    let pixels = rgba.as_chunks::<4>().0;
    let mut bytes = Vec::with_capacity(HEAD.len() + 3 * pixels.len());
    bytes.extend_from_slice(HEAD);
    for plane in [LUMA, BLUE, RED] {
        bytes.extend(pixels.iter().map(|pixel| plane.of(*pixel)));
    }
    bytes
}

/// Encodes an RGBA frame of even size with 4:2:0 chroma.
pub fn frame_of_quarter(rgba: &[u8], size: (u32, u32)) -> Vec<u8> {
    let mut bytes = HEAD.to_vec();
    bytes.extend(quarter_planes(rgba, size));
    bytes
}

/// Returns the three planes (luma, blue and red difference) of a frame with 4:2:0 chroma, known as I420 or YU12.
pub fn quarter_planes(rgba: &[u8], size: (u32, u32)) -> Vec<u8> {
    let (width, _) = size;
    let pixels = rgba.as_chunks::<4>().0;
    let width = (width as usize).max(2);
    let mut bytes = Vec::with_capacity(pixels.len() + pixels.len() / 2);
    bytes.extend(pixels.iter().map(|pixel| LUMA.of(*pixel)));
    for plane in [BLUE, RED] {
        for rows in pixels.chunks_exact(2 * width) {
            let (upper, lower) = rows.split_at(width);
            let fours = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
            bytes.extend(fours.map(|([a, b], [c, d])| {
                let mean = |i: usize| {
                    let sum: u16 = [a, b, c, d].iter().map(|pixel| u16::from(pixel[i])).sum();
                    ((sum + 2) / 4) as u8
                };
                plane.of([mean(0), mean(1), mean(2), 255])
            }));
        }
    }
    bytes
}

/// Coefficients of a plane for red, green and blue in 0..255, in units of 2^-16, and the plane's value for black.
struct Plane {
    fractions: [i32; 3],
    black: i32,
}

// BT.709: luma is y = 0.2126 r + 0.7152 g + 0.0722 b in 219 steps, and the differences are (b - y) / 1.8556 and
// (r - y) / 1.5748 in 224 steps.
const LUMA: Plane = Plane { fractions: [11_966, 40_254, 4_064], black: 16 };
const BLUE: Plane = Plane { fractions: [-6_596, -22_189, 28_784], black: 128 };
const RED: Plane = Plane { fractions: [28_784, -26_145, -2_639], black: 128 };

impl Plane {
    fn of(&self, [red, green, blue, _]: [u8; 4]) -> u8 {
        let [r, g, b] = self.fractions;
        let sum = r * i32::from(red) + g * i32::from(green) + b * i32::from(blue);
        let value = self.black + ((sum + (1 << 15)) >> 16);
        value.clamp(0, 255) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_bt_709() {
        // From the recommendation's table for 8 bits.
        for (rgb, yuv) in [
            ([0, 0, 0], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            let [r, g, b] = rgb;
            assert_eq!(frame(&[r, g, b, 255]), [&b"FRAME\n"[..], &yuv].concat(), "{rgb:?}");
        }
    }

    #[test]
    fn four_pixels_have_a_common_colour() {
        let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
        let rgba = [[red, red, blue, blue].concat(), [red, red, blue, blue].concat()].concat();
        let planes = quarter_planes(&rgba, (4, 2));
        assert_eq!(planes, [63, 63, 32, 32, 63, 63, 32, 32, 102, 240, 240, 118]);
        assert_eq!(frame_of_quarter(&rgba, (4, 2)), [b"FRAME\n", &planes[..]].concat());
        assert!(header((4, 2), 30.0, Chroma::Quarter).windows(8).any(|word| word == b"C420jpeg"));
    }

    #[test]
    fn rates_are_fractions() {
        for (fps, reported) in [
            (30.0, "F30:1"),
            (29.97, "F30000:1001"),
            (23.976, "F24000:1001"),
            (23.98, "F24000:1001"),
            (12.5, "F12500:1000"),
        ] {
            let header = String::from_utf8(header((4, 2), fps, Chroma::Whole)).unwrap();
            assert!(header.starts_with("YUV4MPEG2 W4 H2 ") && header.contains(reported), "{header}");
        }
    }
}
