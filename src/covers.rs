//! The cover of the playing song, decoded to a small picture on a thread of low priority.
//!
//! A cover comes from the song's file or from an image in its folder ([`mariana_player::covers`]). A cover that is
//! damaged, or larger than the limits, is only logged: the song then has no cover.

use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits, Rgba, RgbaImage};

use crate::limits;
use crate::song_structures::SongReader;
use mariana_player::covers::cover_of;
use mariana_player::decode::{Cover, CoverKind};
use mariana_player::song::Song;
use mariana_player::track::TrackInfo;

/// Maximum width and height of a decoded cover, in pixels.
const SIDE: u32 = 256;
/// Maximum number of covers in memory: of the current track, the next, and some earlier ones.
const KNOWN_MAX: usize = 8;

/// Starts the thread that finds the cover of tracks. It calls `wake` after each track.
pub fn start_reader(wake: impl Fn() + Send + 'static) -> SongReader<RgbaImage> {
    let find = |track: &TrackInfo, _: &(dyn Fn() -> bool + Sync), _: &dyn Fn(RgbaImage)| {
        Some(track.content.as_ref().and_then(|content| picture_of(&content.song)))
    };
    SongReader::of("covers", "show the covers of songs", KNOWN_MAX, find, wake)
}

/// Returns the cover of a song, at most 256 pixels wide and high. Returns `None` for a song without a usable cover.
pub fn picture_of(song: &Song) -> Option<RgbaImage> {
    let cover = cover_of(song)?;
    let decoded = decoded(&cover);
    decoded.inspect_err(|reason| tracing::info!("the cover of a song is not shown: {reason}")).ok()
}

/// Paints a cover for a song that has none: a soft gradient of two colors, which the song's display name chooses.
pub fn painted(name: &str) -> RgbaImage {
    // FNV-1a: the hash must be the same in every version of the program.
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let fraction = |shift: u32| (hash >> shift & 0xffff) as f32 / 65_536.0;
    let hue = fraction(0);
    let (first, second) = (of_hue(hue, 0.85), of_hue(hue + 0.12 + 0.3 * fraction(16), 0.35));
    let angle = std::f32::consts::TAU * fraction(32);
    let (across, down) = (angle.cos(), angle.sin());
    RgbaImage::from_fn(SIDE, SIDE, |x, y| {
        let place = |pixel: u32| (pixel as f32 + 0.5) / SIDE as f32 - 0.5;
        let along = (0.5 + 0.7 * (across * place(x) + down * place(y))).clamp(0.0, 1.0);
        let weight = along * along * (3.0 - 2.0 * along);
        let [red, green, blue] = [0, 1, 2].map(|channel: usize| {
            let of = |color: [f32; 3]| color.get(channel).copied().unwrap_or_default();
            (255.0 * (of(first) + weight * (of(second) - of(first)))) as u8
        });
        Rgba([red, green, blue, 255])
    })
}

/// A color of a hue (1 is the whole circle) and a brightness, 0..1, in sRGB.
fn of_hue(hue: f32, brightness: f32) -> [f32; 3] {
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|offset| {
        let wave = 0.5 + 0.5 * (std::f32::consts::TAU * (hue - offset)).cos();
        brightness * (0.3 + 0.7 * wave)
    })
}

/// Returns the format in which a cover is encoded.
pub fn format_of(kind: CoverKind) -> ImageFormat {
    match kind {
        CoverKind::Jpeg => ImageFormat::Jpeg,
        CoverKind::Png => ImageFormat::Png,
        CoverKind::WebP => ImageFormat::WebP,
        CoverKind::Bmp => ImageFormat::Bmp,
    }
}

fn decoded(Cover { kind, bytes }: &Cover) -> Result<RgbaImage, String> {
    let reader = || ImageReader::with_format(Cursor::new(bytes), format_of(*kind));
    // Look at the size first: decoding a huge image takes seconds even if its memory is limited.
    let (width, height) = reader().into_dimensions().map_err(|error| error.to_string())?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels > limits::COVER_PIXELS_MAX {
        return Err(format!(
            "it has {pixels} pixels, more than {}: make it smaller",
            limits::COVER_PIXELS_MAX
        ));
    }
    let mut reader = reader();
    let mut limits = Limits::default();
    limits.max_alloc = Some(8 * limits::COVER_PIXELS_MAX);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    let is_small = width <= SIDE && height <= SIDE;
    Ok(if is_small { image } else { image.thumbnail(SIDE, SIDE) }.into_rgba8())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(width: u32, height: u32, kind: CoverKind) -> Cover {
        let image = image::RgbImage::from_fn(width, height, |x, _| image::Rgb([(x % 256) as u8, 90, 200]));
        let format = if kind == CoverKind::Png { ImageFormat::Png } else { ImageFormat::Jpeg };
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        Cover { kind, bytes: bytes.into_inner() }
    }

    /// A PNG header that claims a size, without pixels.
    fn claimed(width: u32, height: u32) -> Cover {
        let mut cover = encoded(1, 1, CoverKind::Png);
        cover.bytes.splice(16..24, [width.to_be_bytes(), height.to_be_bytes()].concat());
        // The checksum of the header covers its type and its 13 bytes.
        let sum = crc(&cover.bytes[12..29]);
        cover.bytes.splice(29..33, sum.to_be_bytes());
        cover
    }

    fn crc(bytes: &[u8]) -> u32 {
        let step = |sum: u32, byte: &u8| {
            (0..8)
                .fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
        };
        !bytes.iter().fold(u32::MAX, step)
    }

    #[test]
    fn covers_become_small_and_keep_their_shape() {
        for kind in [CoverKind::Png, CoverKind::Jpeg] {
            assert_eq!(decoded(&encoded(1_000, 500, kind)).unwrap().dimensions(), (256, 128));
            assert_eq!(decoded(&encoded(100, 40, kind)).unwrap().dimensions(), (100, 40));
        }
    }

    #[test]
    fn painted_covers_differ_by_name_and_never_change() {
        let one = painted("Hadal Lanterns");
        assert!(one == painted("Hadal Lanterns") && one != painted("Hadal Lantern") && one != painted(""));
        // A soft gradient has no edges.
        for (x, y, pixel) in one.enumerate_pixels().filter(|(x, y, _)| *x > 0 && *y > 0) {
            for beside in [one.get_pixel(x - 1, y), one.get_pixel(x, y - 1)] {
                assert!((0..3).all(|i| pixel[i].abs_diff(beside[i]) <= 4), "{x}, {y}: {pixel:?} {beside:?}");
            }
        }
    }

    #[test]
    fn huge_and_damaged_covers_are_refused() {
        let refused = decoded(&claimed(10_000, 10_000)).unwrap_err();
        assert!(refused.contains("100000000 pixels"), "{refused}");
        assert!(decoded(&claimed(u32::MAX, u32::MAX)).is_err());
        assert!(decoded(&claimed(0, 7)).is_err());
        for kind in [CoverKind::Png, CoverKind::Jpeg] {
            let whole = encoded(40, 40, kind);
            for length in 0..whole.bytes.len() {
                // A truncated image may be refused or shown in part. It must not panic.
                let _ = decoded(&Cover { kind, bytes: whole.bytes[..length].to_vec() });
                let mut damaged = whole.clone();
                damaged.bytes[length] ^= 0x55;
                let _ = decoded(&damaged);
            }
        }
    }
}
