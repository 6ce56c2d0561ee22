//! The icon: a woofer with a wooden frame. The left half of the woofer's ring has the colour of the left channel, the
//! right half the colour of the right channel. The SVG and the PNGs come from the same list of layers.

use std::fmt::Write;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// The name of the files: the program's application id.
const APP_ID: &str = "org.mariana.Mariana";

/// Sides of the PNGs in pixels, as required by the hicolor theme.
const SIDES: [u32; 9] = [16, 22, 24, 32, 48, 64, 128, 256, 512];
/// Side of the icon in layer units.
const SIDE: f32 = 64.0;
const MIDDLE: f32 = SIDE / 2.0;

/// A shape, in layer units.
enum Outline {
    /// A square around the centre. The values are half its side, and its corner radius.
    Square(f32, f32),
    /// A disc. The values are its centre (the same on both axes), and its radius.
    Disc(f32, f32),
    /// The right half of a disc around the centre. The value is its radius.
    RightHalf(f32),
}
use Outline::{Disc, RightHalf, Square};

/// The layers from bottom to top, each with an sRGB colour.
const LAYERS: [(Outline, u32); 10] = [
    (Square(30.0, 9.0), 0x6B_2C0D),
    (Square(28.5, 7.5), 0xB3_561F),
    (Disc(MIDDLE, 26.0), 0x1A_191D),
    (Disc(MIDDLE, 24.0), 0xFF_B45A),
    (RightHalf(24.0), 0x7A_C8FF),
    (Disc(MIDDLE, 19.5), 0x1A_191D),
    (Disc(MIDDLE, 16.5), 0x5A_565C),
    (Disc(MIDDLE, 12.5), 0x45_4247),
    (Disc(MIDDLE, 8.0), 0xD8_A03C),
    (Disc(29.3, 2.4), 0xFF_F0CC),
];

/// Writes the icon, in the layout of the hicolor theme, to a folder, by default `assets/desktop/icons`.
pub fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder = arguments.first().map_or("assets/desktop/icons", String::as_str);
    write(folder, &format!("scalable/apps/{APP_ID}.svg"), svg()?.as_bytes())?;
    for side in SIDES {
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive).write_image(
            &pixels(side),
            side,
            side,
            ExtendedColorType::Rgba8,
        )?;
        write(folder, &format!("{side}x{side}/apps/{APP_ID}.png"), &bytes)?;
    }
    Ok(())
}

fn write(folder: &str, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let path = Path::new(folder).join(name);
    std::fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
    Ok(std::fs::write(path, bytes)?)
}

fn svg() -> Result<String, std::fmt::Error> {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIDE} {SIDE}\">\n  <title>Mariana</title>\n"
    );
    for (outline, color) in &LAYERS {
        let shape = match outline {
            Square(half, radius) => {
                let (corner, side) = (MIDDLE - half, 2.0 * half);
                format!(
                    "rect x=\"{corner}\" y=\"{corner}\" width=\"{side}\" height=\"{side}\" rx=\"{radius}\""
                )
            }
            Disc(centre, radius) => format!("circle cx=\"{centre}\" cy=\"{centre}\" r=\"{radius}\""),
            RightHalf(radius) => {
                let (top, across) = (MIDDLE - radius, 2.0 * radius);
                format!("path d=\"M{MIDDLE} {top}a{radius} {radius} 0 0 1 0 {across}z\"")
            }
        };
        writeln!(text, "  <{shape} fill=\"#{color:06x}\"/>")?;
    }
    text.push_str("</svg>\n");
    Ok(text)
}

impl Outline {
    /// Returns the signed distance from a point to the shape, in layer units.
    fn distance(&self, x: f32, y: f32) -> f32 {
        let (x, y) = (x - MIDDLE, y - MIDDLE);
        match self {
            Square(half, radius) => {
                let out = [x.abs(), y.abs()].map(|a| a - half + radius);
                out[0].max(0.0).hypot(out[1].max(0.0)) + out[0].max(out[1]).min(0.0) - radius
            }
            Disc(centre, radius) => (x + MIDDLE - centre).hypot(y + MIDDLE - centre) - radius,
            RightHalf(radius) => (x.hypot(y) - radius).max(-x),
        }
    }
}

/// Draws `side` x `side` RGBA pixels, antialiased in linear light.
fn pixels(side: u32) -> Vec<u8> {
    let scale = side as f32 / SIDE;
    let position = |pixel: u32| (pixel as f32 + 0.5) / scale;
    let places = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    places.flat_map(|(x, y)| pixel(scale, position(x), position(y))).collect()
}

/// Returns the pixel around a point; `scale` is the number of pixels per layer unit.
fn pixel(scale: f32, x: f32, y: f32) -> [u8; 4] {
    // The sum is premultiplied by alpha.
    let mut sum = [0.0; 4];
    for (outline, color) in &LAYERS {
        let cover = (0.5 - outline.distance(x, y) * scale).clamp(0.0, 1.0);
        let [red, green, blue] = rgb(*color);
        let over = [red, green, blue, 1.0];
        for (below, above) in sum.iter_mut().zip(over) {
            *below += (above - *below) * cover;
        }
    }
    let [red, green, blue, alpha] = sum;
    let [red, green, blue] = [red, green, blue].map(|light| to_srgb(light / alpha.max(1e-6)));
    [red, green, blue, (alpha * 255.0).round() as u8]
}

/// Converts a colour such as 0xFF8000 to linear components.
fn rgb(hex: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| to_linear((hex >> shift & 0xFF) as f32 / 255.0))
}

/// Converts a linear component to an sRGB byte.
fn to_srgb(x: f32) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let s = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0).round() as u8
}

/// Converts a value of sRGB, 0..=1, to linear light.
fn to_linear(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
