//! YUV4MPEG2: a stream of uncompressed pictures that encoders and players read, with the whole chroma (4:4:4), in the
//! colours of ITU-R BT.709 with 16 to 235 for black to white. Its header has no word for the matrix.

/// What the stream begins with.
pub(super) fn header((width, height): (u32, u32), fps: f64) -> Vec<u8> {
    let (frames, seconds) = ratio(fps);
    format!("YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C444 XCOLORRANGE=LIMITED\n")
        .into_bytes()
}

/// A rate as a fraction: those of NTSC exactly, others to a thousandth.
fn ratio(fps: f64) -> (u64, u64) {
    let ntsc = (fps * 1.001).round();
    if (fps - ntsc / 1.001).abs() < 1e-3 && (fps - fps.round()).abs() > 1e-3 {
        return (ntsc as u64 * 1_000, 1_001);
    }
    match (fps * 1_000.0).round() as u64 {
        whole if whole.is_multiple_of(1_000) => (whole / 1_000, 1),
        other => (other, 1_000),
    }
}

/// A picture of RGBA bytes, the top row first, as the stream holds it.
pub(super) fn frame(rgba: &[u8]) -> Vec<u8> {
    const HEAD: &[u8] = b"FRAME\n";
    let pixels = rgba.as_chunks::<4>().0;
    let mut bytes = Vec::with_capacity(HEAD.len() + 3 * pixels.len());
    bytes.extend_from_slice(HEAD);
    for plane in [LUMA, BLUE, RED] {
        bytes.extend(pixels.iter().map(|pixel| plane.of(*pixel)));
    }
    bytes
}

/// A plane: what each colour of 0..255 adds to it, in units of 2^-16, and what black has.
struct Plane {
    shares: [i32; 3],
    black: i32,
}

const UNIT: f64 = 65_536.0;
/// How much red, green and blue add to the light, by BT.709.
const LIGHT: [f64; 3] = [0.2126, 0.7152, 0.0722];

const LUMA: Plane = Plane { shares: shares(LIGHT, 219.0), black: 16 };
const BLUE: Plane = Plane { shares: shares(difference(2), 224.0), black: 128 };
const RED: Plane = Plane { shares: shares(difference(0), 224.0), black: 128 };

/// A colour less the light, from -1/2 to 1/2.
const fn difference(color: usize) -> [f64; 3] {
    let scale = 2.0 * (1.0 - LIGHT[color]);
    let mut difference = [-LIGHT[0] / scale, -LIGHT[1] / scale, -LIGHT[2] / scale];
    difference[color] += 1.0 / scale;
    difference
}

const fn shares(of: [f64; 3], range: f64) -> [i32; 3] {
    let unit = UNIT * range / 255.0;
    [rounded(of[0] * unit), rounded(of[1] * unit), rounded(of[2] * unit)]
}

const fn rounded(value: f64) -> i32 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i32
}

impl Plane {
    fn of(&self, [red, green, blue, _]: [u8; 4]) -> u8 {
        let [r, g, b] = self.shares;
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
        // Of the recommendation's table for 8 bits.
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
    fn rates_are_fractions() {
        for (fps, told) in
            [(30.0, "F30:1"), (29.97, "F30000:1001"), (23.976, "F24000:1001"), (12.5, "F12500:1000")]
        {
            let header = String::from_utf8(header((4, 2), fps)).unwrap();
            assert!(header.starts_with("YUV4MPEG2 W4 H2 ") && header.contains(told), "{header}");
        }
    }
}
