//! Checks that `docs/language.md` matches the code. `cargo xtask language-page` writes it.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};

use mariana_field::lang::{Camera, Light, Material, Picture, Sky, compile, entries, inputs, no_includes};

const REMEDY: &str = "run `cargo xtask language-page`";

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

fn reference() -> String {
    let path = docs().join("language.md");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.replace("\r\n", "\n")
}

/// Returns the name and formula of every image in the reference: `![name](shapes/name.png)<br>`formula``.
fn pictures(text: &str) -> Vec<(String, String)> {
    let rows = text.lines().filter_map(|line| line.strip_prefix("| !["));
    rows.map(|row| {
        let (name, rest) = row.split_once("](").unwrap();
        let (file, rest) = rest.split_once(")<br>`").unwrap();
        assert_eq!(file, format!("shapes/{name}.png"));
        let (formula, _) = rest.split_once('`').unwrap();
        (name.to_owned(), formula.replace("\\|", "|"))
    })
    .collect()
}

fn compiles(name: &str, text: &str) {
    let compiled = compile(name, text, &mut no_includes);
    assert!(compiled.scene.is_some(), "{name}: {text}\n{}", compiled.render(false));
}

#[test]
fn the_reference_begins_with_its_introduction() {
    let intro = include_str!("../src/language_page/intro.md").replace("\r\n", "\n");
    assert!(
        reference().starts_with(intro.trim_end()),
        "docs/language.md does not begin with intro.md: {REMEDY}"
    );
}

#[test]
fn every_function_and_input_is_in_the_reference() {
    let text = reference();
    for entry in entries() {
        let signature = entry.signature.replace('|', "\\|");
        let row = text.lines().find(|line| line.starts_with('|') && line.contains(&format!("`{signature}`")));
        let row = row.unwrap_or_else(|| panic!("`{signature}` is missing: {REMEDY}"));
        for part in [&entry.doc, &entry.source] {
            assert!(row.contains(&part.replace('|', "\\|")), "{}: {part:?} is missing: {REMEDY}", entry.name);
        }
        let marked = ["**exact**", "**bound**"].map(|mark| row.contains(mark));
        let accuracy = entry.accuracy.map(|accuracy| format!("{accuracy:?}"));
        let expected = ["Exact", "Bound"].map(|name| accuracy.as_deref() == Some(name));
        assert_eq!(marked, expected, "{}: {REMEDY}", entry.name);
    }
    for (name, doc) in inputs() {
        let doc = doc.replace('|', "\\|");
        assert!(text.contains(&format!("| `{name}` | {doc} |")), "the input `{name}` is missing: {REMEDY}");
    }
}

#[test]
fn every_field_of_a_section_is_in_the_reference() {
    let text = reference();
    let sections = [
        ("| `light` | `", Light::FIELDS),
        ("| `camera` | `", Camera::FIELDS),
        ("| `sky` | `", Sky::FIELDS),
        ("| `picture` | `", Picture::FIELDS),
    ];
    for (start, fields) in sections {
        let row = text.lines().find(|line| line.starts_with(start)).unwrap();
        for field in fields {
            let name = format!("`{}`", field.name);
            assert!(row.contains(&name), "the row {start}… of intro.md lacks {name}");
        }
    }
    for field in Material::FIELDS {
        let ends = (format!("| `{}`", field.name), format!("| {} | {} |", field.doc, field.default));
        let stands = text.lines().any(|line| line.starts_with(&ends.0) && line.ends_with(&ends.1));
        assert!(stands, "{} … {} is missing: {REMEDY}", ends.0, ends.1);
    }
}

#[test]
fn every_shape_has_an_image_with_a_visible_shape() {
    let shown = pictures(&reference());
    for entry in entries().iter().filter(|entry| entry.accuracy.is_some()) {
        assert!(shown.iter().any(|(name, _)| name == entry.name), "{} has no image: {REMEDY}", entry.name);
    }
    for (name, _) in &shown {
        let path = docs().join(format!("shapes/{name}.png"));
        let picture =
            image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_rgb8();
        assert_eq!(picture.dimensions(), (200, 150), "{name}");
        // Shapes have a warm colour, and their surroundings are grey.
        let warm = picture.pixels().filter(|pixel| pixel[0] > pixel[2].saturating_add(24)).count();
        let fraction = warm as f32 / (picture.width() * picture.height()) as f32;
        assert!((0.05..0.75).contains(&fraction), "{name}: the shape fills {fraction} of its image");
        let edge = [(0, 0), (199, 0)].map(|(x, y)| picture.get_pixel(x, y).0);
        assert!(edge.iter().all(|pixel| pixel[0].abs_diff(pixel[2]) < 24), "{name} extends beyond the edge");
    }
}

#[test]
fn no_image_is_unused() {
    let shown = pictures(&reference());
    let mut bytes = 0;
    for file in std::fs::read_dir(docs().join("shapes")).unwrap() {
        let file = file.unwrap();
        bytes += file.metadata().unwrap().len();
        let name = file.file_name().into_string().unwrap();
        let known = shown.iter().any(|(shape, _)| *shape == name.trim_end_matches(".png"));
        assert!(known, "docs/shapes/{name} is not in the reference");
    }
    assert!(bytes < 1_500_000, "the images take {bytes} bytes");
}

#[test]
fn every_formula_and_scene_of_the_reference_compiles() {
    let text = reference();
    let shown = pictures(&text);
    assert!(!shown.is_empty());
    for (name, formula) in &shown {
        assert!(formula.contains(&format!("{name}(")), "{name} is not in its own example: {formula}");
        compiles(name, formula);
    }
    let scenes: Vec<&str> =
        text.split("```scene\n").skip(1).filter_map(|rest| rest.split("\n```").next()).collect();
    assert!(!scenes.is_empty());
    for scene in scenes {
        compiles("language.md", scene);
    }
}
