//! The shipped textures: sizes, the wood's seams, the mallard's alpha.

use std::path::PathBuf;

use image::{RgbImage, RgbaImage};

fn texture(name: &str) -> image::DynamicImage {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/textures").join(name);
    image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn wood() -> RgbImage {
    let picture = texture("wood.png");
    assert_eq!(picture.color(), image::ColorType::Rgb8);
    picture.into_rgb8()
}

fn mallard() -> RgbaImage {
    let picture = texture("mallard.png");
    assert_eq!(picture.color(), image::ColorType::Rgba8);
    picture.into_rgba8()
}

fn difference(a: &[u8], b: &[u8]) -> u8 {
    (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0)
}

/// Compares line `a` with line `b`. The lines are columns if `across` is 0, and rows if `across` is 1.
fn line_difference(wood: &RgbImage, across: usize, a: u32, b: u32) -> f64 {
    let length = if across == 0 { wood.height() } else { wood.width() };
    let at = |line: u32, i: u32| if across == 0 { wood.get_pixel(line, i) } else { wood.get_pixel(i, line) };
    (0..length).map(|i| f64::from(difference(&at(a, i).0, &at(b, i).0))).sum::<f64>() / f64::from(length)
}

fn around(picture: &RgbaImage, x: u32, y: u32, radius: u32) -> impl Iterator<Item = [u8; 4]> + '_ {
    let range = |c: u32, side: u32| c.saturating_sub(radius)..(c + radius + 1).min(side);
    let (xs, ys) = (range(x, picture.width()), range(y, picture.height()));
    ys.flat_map(move |y| xs.clone().map(move |x| picture.get_pixel(x, y).0))
}

#[test]
fn wood_has_a_power_of_two_size_and_some_contrast() {
    let wood = wood();
    assert_eq!(wood.dimensions(), (1024, 1024));
    let green = |p: &image::Rgb<u8>| p.0[1];
    let (darkest, brightest) = (wood.pixels().map(green).min(), wood.pixels().map(green).max());
    assert!(darkest < Some(70) && brightest > Some(140), "green from {darkest:?} to {brightest:?}");
    let warm = wood.pixels().filter(|p| p.0[0] > p.0[1] && p.0[1] > p.0[2]).count();
    assert!(warm > 1024 * 1024 * 99 / 100, "only {warm} texels are warm brown");
}

#[test]
fn wood_repeats_without_a_seam() {
    let wood = wood();
    for (across, name) in [(0, "left and right"), (1, "top and bottom")] {
        let last = if across == 0 { wood.width() - 1 } else { wood.height() - 1 };
        let mut inner: Vec<f64> = (0..last).map(|i| line_difference(&wood, across, i, i + 1)).collect();
        inner.sort_by(f64::total_cmp);
        let usual = inner[inner.len() * 99 / 100];
        let seam = line_difference(&wood, across, last, 0);
        assert!(seam <= usual, "{name} differ by {seam:.2}, but 99 of 100 neighbours by at most {usual:.2}");
    }
}

#[test]
fn wood_grain_runs_along_the_rows() {
    let wood = wood();
    let along: f64 = (0..1023).map(|i| line_difference(&wood, 0, i, i + 1)).sum();
    let across: f64 = (0..1023).map(|i| line_difference(&wood, 1, i, i + 1)).sum();
    assert!(across > 2.0 * along, "along the rows {along:.0}, across them {across:.0}");
}

#[test]
fn mallard_has_a_transparent_margin() {
    let mallard = mallard();
    assert_eq!(mallard.dimensions(), (1024, 1024));
    for (x, y, texel) in mallard.enumerate_pixels() {
        let margin = x.min(y).min(1023 - x).min(1023 - y);
        assert!(margin >= 24 || texel.0[3] == 0, "alpha {} at {x}, {y}", texel.0[3]);
    }
    let opaque = mallard.pixels().filter(|p| p.0[3] == 255).count();
    let clear = mallard.pixels().filter(|p| p.0[3] == 0).count();
    let edge = 1024 * 1024 - opaque - clear;
    assert!(opaque > 200_000, "{opaque} opaque texels");
    assert!(clear > 400_000, "{clear} transparent texels");
    assert!(
        (1_000..20_000).contains(&edge),
        "{edge} texels with partial alpha: expected a smooth but narrow \
        edge"
    );
}

#[test]
fn mallard_edges_have_the_colours_of_the_bird() {
    let mallard = mallard();
    let (mut edge, mut foreign) = (0, 0);
    for (x, y, texel) in mallard.enumerate_pixels() {
        if !(1..255).contains(&texel.0[3]) {
            continue;
        }
        let solid = around(&mallard, x, y, 3).filter(|near| near[3] == 255);
        edge += 1;
        foreign += usize::from(solid.map(|near| difference(&near, &texel.0)).min().is_none_or(|d| d > 40));
    }
    assert!(foreign * 100 <= edge, "{foreign} of {edge} edge texels differ from all solid ones near them");
}

#[test]
fn mallard_colours_bleed_into_the_transparent_texels() {
    let mallard = mallard();
    let (mut rim, mut foreign) = (0, 0);
    for (x, y, texel) in mallard.enumerate_pixels() {
        if texel.0[3] != 0 {
            continue;
        }
        let visible = around(&mallard, x, y, 2).filter(|near| near[3] > 0);
        if let Some(nearest) = visible.map(|near| difference(&near, &texel.0)).min() {
            rim += 1;
            foreign += usize::from(nearest > 40);
        }
    }
    assert!(rim > 2_000, "only {rim} transparent texels border on the bird");
    assert!(foreign * 100 <= rim, "{foreign} of {rim} transparent texels at the rim would cause a halo");
}
