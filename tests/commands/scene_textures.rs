//! The textures of a scene, from the scene's folder or from the shipped textures, and errors for unreadable files.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;

use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use mariana::scenes::limits;
use mariana::scenes::{SceneSource, TextureCache};
use mariana_field::lang::{Compiled, Diagnostic, Fault, Scene, render_all};
use tempfile::TempDir;

const RED: Rgba<u8> = Rgba([200, 30, 40, 255]);

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir_all(place.path().join("scenes/sub")).unwrap();
        Self(place)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join("scenes").join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    fn scene(&self, textures: &[&str]) -> (SceneSource, Compiled) {
        self.write("main.scene", text(textures));
        let source = SceneSource::File(self.path("main.scene"));
        let compiled = source.compile().unwrap();
        assert!(compiled.scene.is_some(), "{}", compiled.render(false));
        (source, compiled)
    }

    fn textures(&self, textures: &[&str]) -> Result<Vec<Arc<RgbaImage>>, Vec<Diagnostic>> {
        let (source, compiled) = self.scene(textures);
        loaded(&source, compiled.scene.as_ref().unwrap())
    }

    #[track_caller]
    fn refused(&self, texture: &str) -> (Fault, String, String) {
        let mut wrong = self.textures(&[texture]).expect_err(texture);
        assert_eq!(wrong.len(), 1);
        let one = wrong.remove(0);
        (one.fault, one.message, one.hint.unwrap())
    }
}

fn loaded(source: &SceneSource, scene: &Scene) -> Result<Vec<Arc<RgbaImage>>, Vec<Diagnostic>> {
    TextureCache::default().load(source, scene)
}

/// A scene whose material is the sum of these textures. Line 2 reads the first texture, line 3 the second.
fn text(textures: &[&str]) -> String {
    let reads: Vec<String> = textures.iter().map(|name| format!("texture(\"{name}\", p.xy).rgb")).collect();
    let color = reads.join("\n  + ");
    format!("material m {{ color =\n  {color} }}\nobject o {{ shape = length(p) - 1  material = m }}")
}

fn encoded(picture: &RgbaImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = DynamicImage::ImageRgba8(picture.clone());
    match format {
        ImageFormat::Png => picture.write_to(&mut bytes, format).unwrap(),
        _ => picture.to_rgb8().write_to(&mut bytes, format).unwrap(),
    }
    bytes.into_inner()
}

fn png(width: u32, height: u32) -> Vec<u8> {
    encoded(&RgbaImage::from_pixel(width, height, RED), ImageFormat::Png)
}

fn jpeg(width: u32, height: u32) -> Vec<u8> {
    encoded(&RgbaImage::from_pixel(width, height, RED), ImageFormat::Jpeg)
}

fn asset(name: &str) -> RgbaImage {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/textures").join(name);
    image::open(path).unwrap().into_rgba8()
}

#[test]
fn png_and_jpeg_are_recognized_by_their_contents() {
    let place = Place::new();
    place.write("a.png", png(3, 2));
    place.write("sub/b.jpg", jpeg(16, 8));
    place.write("misnamed.png", jpeg(8, 8));
    let pictures = place.textures(&["a.png", "sub/b.jpg", "misnamed.png"]).unwrap();
    let sizes: Vec<_> = pictures.iter().map(|picture| picture.dimensions()).collect();
    assert_eq!(sizes, [(3, 2), (16, 8), (8, 8)]);
    assert_eq!(pictures[0].get_pixel(2, 1), &RED);
    for channel in 0..4 {
        let difference = pictures[1].get_pixel(7, 3).0[channel].abs_diff(RED.0[channel]);
        assert!(difference < 6, "{:?}", pictures[1].get_pixel(7, 3));
    }
}

/// Cameras store upright photographs rotated, with the rotation in the header.
#[test]
fn a_photograph_is_rotated_as_its_header_says() {
    let place = Place::new();
    let plain = jpeg(16, 8);
    // An APP1 segment with an Exif block of one entry: orientation 6, a quarter turn.
    let mut exif = b"Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0".to_vec();
    let length = u16::try_from(exif.len() + 2).unwrap().to_be_bytes();
    let mut bytes = plain[..2].to_vec();
    bytes.extend([0xff, 0xe1, length[0], length[1]]);
    bytes.append(&mut exif);
    bytes.extend(&plain[2..]);
    place.write("photo.jpg", bytes);
    assert_eq!(place.textures(&["photo.jpg"]).unwrap()[0].dimensions(), (8, 16));
}

#[test]
fn shipped_scenes_and_formulas_read_shipped_textures() {
    let speakers = SceneSource::Shipped("speakers".into());
    let scene = speakers.compile().unwrap().scene.unwrap();
    let names: Vec<&str> = scene.textures.iter().map(|texture| texture.name.as_str()).collect();
    assert_eq!(names, ["wood.png", "mallard.png"]);
    let pictures = loaded(&speakers, &scene).unwrap();
    assert!(*pictures[0] == asset("wood.png") && *pictures[1] == asset("mallard.png"));

    let formula = SceneSource::Formula(text(&["mallard.png"]));
    let scene = formula.compile().unwrap().scene.unwrap();
    assert!(*loaded(&formula, &scene).unwrap()[0] == asset("mallard.png"));
    let formula = SceneSource::Formula(text(&["Cargo.toml"]));
    let wrong = loaded(&formula, &formula.compile().unwrap().scene.unwrap()).unwrap_err();
    assert_eq!(wrong[0].message, "there is no shipped image `Cargo.toml`");
}

#[test]
fn files_in_the_folder_take_precedence_over_shipped_textures() {
    let place = Place::new();
    assert!(*place.textures(&["wood.png"]).unwrap()[0] == asset("wood.png"));
    place.write("wood.png", png(2, 2));
    assert_eq!(place.textures(&["wood.png"]).unwrap()[0].dimensions(), (2, 2));
    // A broken file in the scene's folder is an error. The shipped texture does not replace it.
    place.write("wood.png", "none");
    assert_eq!(place.refused("wood.png").1, "`wood.png` is not an image in a known format");
}

#[test]
fn a_missing_texture_is_reported_with_a_suggestion() {
    let place = Place::new();
    place.write("tiger.jpeg", jpeg(8, 8));
    place.write("sub/leaf.png", png(1, 1));
    place.write("notes.txt", "");
    let (fault, message, hint) = place.refused("tigre.jpeg");
    assert_eq!(fault, Fault::Malformed);
    assert_eq!(message, "there is no image `tigre.jpeg` in the scene's folder");
    assert_eq!(hint, "did you mean `tiger.jpeg`?");
    assert_eq!(place.refused("sub/leav.png").2, "did you mean `sub/leaf.png`?");
    assert_eq!(place.refused("wod.png").2, "did you mean `wood.png`?");
    let advice = "put it there, or use a shipped image: mallard.png, wood.png";
    assert_eq!(place.refused("note.txt").2, advice);
    assert_eq!(place.refused("nowhere/at/all.png").2, advice);
}

#[test]
fn every_refusal_has_its_own_message() {
    let place = Place::new();
    place.write("text.png", "this is no picture");
    place.write("gif.png", b"GIF89a\x01\0\x01\0\0\0\0;");
    place.write("half.png", &png(64, 64)[..60]);
    place.write("half.jpg", &jpeg(64, 64)[..200]);
    place.write("empty.png", "");
    let file = fs::File::create(place.path("bytes.png")).unwrap();
    file.set_len(limits::TEXTURE_BYTES_MAX as u64 + 1).unwrap();

    let reported = |name: &str| place.refused(name);
    let none = |name: &str| {
        (
            Fault::Malformed,
            format!("`{name}` is not an image in a known format"),
            "name a PNG or JPEG file".to_owned(),
        )
    };
    assert_eq!(reported("text.png"), none("text.png"));
    assert_eq!(reported("empty.png"), none("empty.png"));
    let (fault, message, hint) = reported("gif.png");
    assert_eq!(fault, Fault::Unsupported);
    assert!(message.contains("Gif") && hint == "save it as PNG or JPEG", "{message}; {hint}");
    for name in ["half.png", "half.jpg"] {
        let (fault, message, hint) = reported(name);
        assert_eq!(fault, Fault::Malformed);
        assert!(message.starts_with(&format!("the image `{name}` is damaged: ")), "{message}");
        assert_eq!(hint, "save it again");
    }
    let (fault, message, _) = reported("bytes.png");
    assert_eq!(fault, Fault::OverLimit);
    assert_eq!(message, "the image `bytes.png` cannot be read: it is larger than 33554432 bytes");
    assert_eq!(reported("sub").1, "the image `sub` cannot be read: it is not a file");
}

#[test]
fn a_too_large_texture_is_refused_by_its_header() {
    let place = Place::new();
    let side = limits::TEXTURE_SIDE_MAX;
    place.write("side.png", png(side, 1));
    assert_eq!(place.textures(&["side.png"]).unwrap()[0].dimensions(), (side, 1));
    let too_wide = png(side + 1, 1);
    // The file ends after its header, so decoding would report a damaged file instead of the width.
    for bytes in [&too_wide[..], &too_wide[..45]] {
        place.write("wide.png", bytes);
        let (fault, message, hint) = place.refused("wide.png");
        assert_eq!(fault, Fault::OverLimit);
        assert_eq!(message, format!("the image `wide.png` is too large: {} x 1 pixels", side + 1));
        assert!(hint.contains(&side.to_string()), "{hint}");
    }
    let rows = u32::try_from(limits::TEXTURE_PIXELS_MAX / u64::from(side)).unwrap() + 1;
    assert!(rows < side);
    place.write("pixels.png", png(side, rows));
    assert_eq!(place.refused("pixels.png").0, Fault::OverLimit);
}

#[cfg(unix)]
#[test]
fn no_file_outside_of_the_folder_is_read() {
    use std::os::unix::fs::symlink;
    let place = Place::new();
    fs::write(place.0.path().join("outside.png"), png(1, 1)).unwrap();
    place.write("own.png", png(4, 4));
    symlink("../outside.png", place.path("link.png")).unwrap();
    symlink("..", place.path("up")).unwrap();
    symlink("own.png", place.path("alias.png")).unwrap();
    // A link that leads out of the folder is an error. The shipped texture does not replace it.
    symlink("../outside.png", place.path("wood.png")).unwrap();
    for name in ["link.png", "up/outside.png", "wood.png"] {
        let (fault, message, hint) = place.refused(name);
        assert_eq!(fault, Fault::Malformed);
        assert_eq!(
            message,
            format!("the image `{name}` cannot be read: it is a link that leads out of the scene's folder")
        );
        assert_eq!(hint, "copy the image into the scene's folder");
    }
    assert_eq!(place.textures(&["alias.png"]).unwrap()[0].dimensions(), (4, 4));
    for name in ["../outside.png", "/etc/passwd"] {
        let source = SceneSource::Formula(text(&[name]));
        assert!(source.compile().unwrap().scene.is_none(), "{name}");
    }
}

#[test]
fn all_texture_errors_are_shown_with_their_positions() {
    let place = Place::new();
    place.write("good.png", png(1, 1));
    place.write("bad.png", "none");
    let (source, compiled) = place.scene(&["gone.png", "good.png", "bad.png"]);
    let wrong = loaded(&source, compiled.scene.as_ref().unwrap()).unwrap_err();
    let shown = render_all(&wrong, &compiled.sources, false);
    let name = place.path("main.scene").display().to_string();
    let messages: Vec<&str> = shown.lines().filter(|line| line.starts_with("error")).collect();
    assert_eq!(messages.len(), 2, "{shown}");
    assert!(messages[0].contains("gone.png") && messages[1].contains("bad.png"), "{shown}");
    assert!(
        shown.contains(&format!("--> {name}:2:")) && shown.contains(&format!("--> {name}:4:")),
        "{shown}"
    );
    assert!(shown.contains("texture(\"bad.png\", p.xy)") && shown.contains("= help: "), "{shown}");
}

#[test]
fn the_cache_decodes_only_changed_textures_again() {
    let place = Place::new();
    place.write("a.png", png(2, 2));
    place.write("b.png", png(3, 3));
    let mut cache = TextureCache::default();
    let mut load = |textures: &[&str]| {
        let (source, compiled) = place.scene(textures);
        cache.load(&source, compiled.scene.as_ref().unwrap())
    };
    let first = load(&["a.png", "b.png"]).unwrap();
    place.write("b.png", png(5, 5));
    let second = load(&["b.png", "a.png"]).unwrap();
    assert!(Arc::ptr_eq(&first[0], &second[1]));
    assert_eq!(second[0].dimensions(), (5, 5));
    // An error of another texture does not clear the cache.
    assert!(load(&["a.png", "none.png"]).is_err());
    assert!(Arc::ptr_eq(&first[0], &load(&["a.png"]).unwrap()[0]));
    let weak = Arc::downgrade(&first[1]);
    drop((first, second));
    assert!(weak.upgrade().is_none());
}
