//! Tests of texts and pictures as shapes.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use image::{DynamicImage, ImageFormat, Rgba};
use mariana_field::graph::{FrameInputs, Point};
use mariana_field::lang::Fault;
use mariana_field::tape::{PointEvaluator, Tape};
use mariana_field::world::World;
use mariana_testing::tiny_font::TinyFont;
use tempfile::TempDir;

use super::*;
use crate::{ReadyScene, SceneError, SceneSource};

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    fn source(&self, shape: &str) -> SceneSource {
        self.write("main.scene", format!("object a {{ shape = {shape} }}\n"));
        SceneSource::File(self.path("main.scene"))
    }

    fn ready(&self, shape: &str) -> Result<ReadyScene, SceneError> {
        self.source(shape).ready()
    }

    /// The one mistake in a scene with this shape.
    #[track_caller]
    fn refused(&self, shape: &str) -> (Fault, String, String) {
        match self.ready(shape) {
            Err(SceneError::Mistakes { found, .. }) => {
                let [one] = &found.diagnostics[..] else { panic!("{:?}", found.diagnostics) };
                (one.fault, one.message.clone(), one.hint.clone().unwrap_or_default())
            }
            other => panic!("{shape}: {:?}", other.map(|ready| ready.world.name.clone())),
        }
    }
}

fn distances(world: &World, points: &[(f32, f32)]) -> Vec<f32> {
    let tape = Tape::new(&world.scene.graph, &[world.scene.distance]);
    let frame = FrameInputs { shapes: world.scene.atlas.clone(), ..FrameInputs::default() };
    let mut evaluator = PointEvaluator::new(&tape, &frame);
    points.iter().map(|(x, y)| evaluator.at(&Point::at(*x, *y, 0.0))[0]).collect()
}

fn png(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = RgbaImage::from_fn(width, height, |x, y| Rgba(pixel(x, y)));
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(image).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The signed distance to a box around the origin.
fn off_box(x: f32, y: f32, width: f32, height: f32) -> f32 {
    let (x, y) = (x.abs() - width, y.abs() - height);
    x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
}

#[test]
fn a_text_is_centred_and_its_capitals_are_1_high() {
    let place = Place::new();
    // The letter is a square of 0.8 em, and capitals of a font that does not tell their height are 0.7 em high.
    place.write("square.ttf", TinyFont::new("Square", "I").bytes());
    let world = place.ready("extrude(text(\"I\", p.xy, \"square.ttf\"), p.z, 1)").unwrap().world;
    let side = 0.5 * 0.8 / 0.7;
    for (x, y) in [(0.0, 0.0), (0.3, 0.2), (0.8, 0.4), (0.6, 0.7), (-0.1, -0.7)] {
        let [found] = distances(&world, &[(x, y)])[..] else { unreachable!() };
        // The square begins at the letter's origin; the letter is 1 em wide.
        let wanted = off_box(x + 0.5 / 0.7 - side, y + 0.5 - side, side, side).max(-1.0);
        assert!((found - wanted).abs() < 0.02 + 0.15 * wanted.abs(), "{found} {wanted} at {x}, {y}");
    }
    let world = place.ready("extrude(text(\"HHH\", p.xy), p.z, 1)").unwrap().world;
    let [top, above, bottom] = distances(&world, &[(0.0, 0.49), (0.0, 0.6), (0.0, -0.6)])[..] else {
        unreachable!()
    };
    assert!(top > 0.0 && (bottom - above).abs() < 0.02, "the middle of H has no stroke at the top");
    let bounds = world.bounds.expect("a word has bounds");
    assert!((bounds.high[1] - 0.5).abs() < 0.06 && (bounds.low[1] + 0.5).abs() < 0.06, "{bounds:?}");
    assert!((bounds.high[0] + bounds.low[0]).abs() < 0.05 && bounds.high[0] < 2.0, "{bounds:?}");
    assert!(!world.non_lipschitz);
}

#[test]
fn slopes_are_at_most_1_within_and_beyond_the_grid() {
    let place = Place::new();
    place.write(
        "ring.svg",
        "<svg viewBox='0 0 20 10'><circle cx='5' cy='5' r='4' fill='none' stroke='red'/></svg>",
    );
    for shape in
        ["text(\"Mariana & Ägir 8\", p.xy)", "image(\"ring.svg\", p.xy)", "text(\"x\", 3 * p.xy) / 3"]
    {
        let world = place.ready(&format!("extrude({shape}, p.z, 0.1)")).unwrap().world;
        assert!(!world.non_lipschitz, "{shape}");
        for grid in world.scene.atlas.shapes() {
            assert!(grid.grid.steepest() <= 1.0 + 1e-5, "{shape}: {}", grid.grid.steepest());
        }
        let along: Vec<(f32, f32)> =
            (-900..900).map(|at| (at as f32 / 100.0, 0.31 * at as f32 / 100.0)).collect();
        for (two, at) in distances(&world, &along).windows(2).zip(&along) {
            assert!((two[1] - two[0]).abs() <= 0.0105, "{shape}: {two:?} at {at:?}");
        }
    }
}

#[test]
fn pictures_are_1_high_and_their_opaque_or_bright_parts_are_inside() {
    let place = Place::new();
    // A rectangle of half the width and half the height: transparent outside, dark on bright, and as a drawing.
    let inside = |x: u32, y: u32| (10..30).contains(&x) && (5..15).contains(&y);
    place.write("alpha.png", png(40, 20, |x, y| [9, 9, 9, if inside(x, y) { 255 } else { 0 }]));
    place.write("bright.png", png(40, 20, |x, y| if inside(x, y) { [255; 4] } else { [0, 0, 0, 255] }));
    place.write("a.svg", "<svg viewBox='0 0 400 200'><g transform='translate(100 50)'><rect width='200' height='100'/></g></svg>");
    place.write("b.svg", "<svg width='40mm' height='20mm'><style>.no{fill:none} path{fill:#fff}</style><rect width='200' \
        height='100' class='no'/><rect width='200' height='200'/><path d='M37.795 18.898 h75.59 v37.795 h-75.59z'/></svg>");
    let scenes = ["alpha.png", "bright.png", "a.svg", "b.svg"];
    for name in scenes {
        let world = place.ready(&format!("extrude(image(\"{name}\", p.xy), p.z, 1)")).unwrap().world;
        for (x, y) in [(0.0, 0.0), (0.45, 0.1), (0.7, 0.2), (0.6, 0.4), (-0.9, 0.0), (3.0, 0.1)] {
            let [found] = distances(&world, &[(x, y)])[..] else { unreachable!() };
            let wanted = off_box(x, y, 0.5, 0.25);
            let near = (found - wanted).abs() < 0.02 + 0.15 * wanted.abs()
                || x > 2.0 && found > 0.6 * wanted && found < wanted;
            assert!(near, "{name}: {found} {wanted} at {x}, {y}");
        }
    }
}

#[test]
fn an_edit_elsewhere_bakes_nothing_again() {
    let place = Place::new();
    place.write("a.svg", "<svg viewBox='0 0 9 9'><rect width='9' height='9'/></svg>");
    let mut cache = ShapeCache::default();
    let mut atlas = |shape: &str| {
        let source = place.source(shape);
        let mut scene = source.checked().unwrap();
        cache.load(&source, &mut scene).unwrap();
        scene.atlas
    };
    let words = "text(\"one\", p.xy) + text(\"two\", p.xy) + image(\"a.svg\", p.xy)";
    let first = atlas(words);
    assert!(first == atlas(&format!("3 * ({words}) + sin(p.z)")), "the atlas stays the same");
    let other = atlas("text(\"one\", p.xy) + image(\"a.svg\", p.xy)");
    let grids =
        |atlas: &ShapeAtlas| atlas.shapes().map(|shape| shape.grid.values().as_ptr()).collect::<Vec<_>>();
    let (first, other) = (grids(&first), grids(&other));
    assert_eq!([first[0], first[2]], other[..], "baked grids are kept");
    place.write("a.svg", "<svg viewBox='0 0 9 9'><rect width='5' height='9'/></svg>");
    assert_ne!(grids(&atlas(words))[2], first[2], "the file has changed");
}

#[test]
fn refusals_say_what_where_and_what_to_do() {
    let place = Place::new();
    place.write("junk.ttf", "no font at all");
    place.write("junk.png", "no picture");
    place.write("junk.svg", "<svg><path d='M0 0 L");
    place.write("words.svg", "<svg viewBox='0 0 9 9'><text>hello</text></svg>");
    place.write("empty.svg", "<svg viewBox='0 0 9 9'/>");
    place.write("html.svg", "<html/>");
    place.write("latin.svg", b"<svg>\xe4</svg>");
    place.write("deep.svg", format!("<svg>{}{}</svg>", "<g>".repeat(90), "</g>".repeat(90)));
    place.write("loop.svg", "<svg><g id='a'><use href='#a'/><use href='#a'/></g></svg>");
    let bomb: String = (1..30)
        .map(|n| format!("<g id='a{n}'><use href='#a{}'/><use href='#a{}'/></g>", n - 1, n - 1))
        .collect();
    place.write(
        "bomb.svg",
        format!("<svg viewBox='0 0 9 9'><rect id='a0' width='9' height='9'/>{bomb}</svg>"),
    );
    place.write("nothing.svg", format!("<svg viewBox='0 0 9 9'><g id='a0'/>{bomb}</svg>"));
    place.write("shapes.svg", format!("<svg>{}</svg>", "<rect width='9' height='9'/>".repeat(10_001)));
    place.write(
        "layers.svg",
        format!("<svg viewBox='0 0 9 9'>{}</svg>", "<rect width='9' height='9'/>".repeat(99)),
    );
    place.write("entities.svg", "<!DOCTYPE svg [<!ENTITY a 'aa'><!ENTITY b '&a;&b;'>]><svg>&b;</svg>");
    place.write("thin.png", png(4000, 2, |_, _| [255; 4]));
    place.write("huge.png", png(16_384, 8, |_, _| [255; 4]));
    let long = "x".repeat(10_000);
    use Fault::{Malformed, OverLimit};
    for (shape, fault, message, hint) in [
        ("text(\"\", p.xy)", Malformed, "no letters", "write a word"),
        ("text(\"  \", p.xy)", Malformed, "no letters", "write a word"),
        (&format!("text(\"{long}\", p.xy)"), OverLimit, "10000 letters", "several texts"),
        ("text(\"a\u{f8fff}b\", p.xy)", Malformed, "\u{f8fff}", "install a font"),
        ("text(\"a\", p)", Malformed, "vec2", "p.xy"),
        ("text(p, p.xy)", Malformed, "text in quotes", "MARIANA"),
        ("text(\"a\", p.xy, \"No Such Font\")", Malformed, "no font `No Such Font`", "scene's folder"),
        ("text(\"a\", p.xy, \"none.ttf\")", Malformed, "`none.ttf` cannot be read", "scene's folder"),
        ("text(\"a\", p.xy, \"../a.ttf\")", Malformed, "outside", "folder"),
        ("text(\"a\", p.xy, \"junk.ttf\")", Malformed, "no font with outlines", "TrueType"),
        ("image(\"none.png\", p.xy)", Malformed, "no image `none.png`", "put it there"),
        ("image(\"clip.mp4\", p.xy)", Fault::Unsupported, "is a video", "PNG, JPEG or SVG"),
        ("image(\"junk.png\", p.xy)", Malformed, "not an image", "PNG or JPEG"),
        ("image(\"huge.png\", p.xy)", OverLimit, "16384 x 8", "scale it down"),
        ("image(\"thin.png\", p.xy)", OverLimit, "too long and narrow", "crop"),
        ("image(\"junk.svg\", p.xy)", Malformed, "`junk.svg` cannot be used", "plain SVG"),
        ("image(\"words.svg\", p.xy)", Malformed, "only texts", "plain SVG"),
        ("image(\"empty.svg\", p.xy)", Malformed, "paints nothing", "plain SVG"),
        ("image(\"html.svg\", p.xy)", Malformed, "`html`, not `svg`", "plain SVG"),
        ("image(\"latin.svg\", p.xy)", Malformed, "byte 5 is not UTF-8", "plain SVG"),
        ("image(\"deep.svg\", p.xy)", OverLimit, "nested more than", "simplify"),
        ("image(\"loop.svg\", p.xy)", OverLimit, "nested more than", "simplify"),
        ("image(\"bomb.svg\", p.xy)", OverLimit, "repeat more than 50000", "simplify"),
        ("image(\"shapes.svg\", p.xy)", OverLimit, "more than 10000 shapes", "simplify"),
        ("image(\"nothing.svg\", p.xy)", OverLimit, "repeat more than 50000", "simplify"),
        ("image(\"layers.svg\", p.xy)", OverLimit, "more than 64 times", "simplify"),
        ("image(\"entities.svg\", p.xy)", Malformed, "cannot be used", "plain SVG"),
        ("title(p.xy, \"No Such Font\")", Malformed, "no font", "scene's folder"),
    ] {
        let found = place.refused(shape);
        let fits = found.0 == fault && found.1.contains(message) && found.2.contains(hint);
        assert!(fits, "{}: {found:?}", &shape[..shape.len().min(60)]);
    }
    let many: Vec<String> = (0..17).map(|at| format!("text(\"{at}\", p.xy)")).collect();
    assert!(place.refused(&many.join(" + ")).1.contains("more than 16 different texts"));
}

#[test]
fn a_drawing_of_115_bytes_asked_for_terabytes() {
    let many = |one: &str, count: usize| one.repeat(count);
    let stroked = |path: &str| format!("<path d='{path}' fill='none' stroke='red'/>");
    let spread = |links: &str| format!("<g id='a'>{links}</g>");
    let refused = [
        stroked("M0 0 S 1e30 1e30 0 0"),
        stroked("M0 0 A 1e300 1e300 0 0 1 9 9"),
        stroked("M0 0 L 1e999 0"),
        format!("<path d='M0 0 {}'/>", many("L0 99 99 0 ", 40_000)),
        "<g transform='matrix(1e308 1e308 1e308 1e308 1e308 1e308)'><circle r='1e300'/></g>".to_owned(),
        many("<g>", 16_000) + &many("</g>", 16_000),
        format!("<rect class='{}'/>", many("x", 1 << 22)),
        format!("<path id='a' d='{}'/>{}", many("z", 1 << 16), many("<use href='#a'/>", 1_000)),
        format!("<style>{}</style>{}", many("*{fill:red}", 9_000), many("<path/>", 9_000)),
        spread(&many("<use href='#a'/>", 9)),
        stroked("M0 0 C 50 50 50 50 100 0' stroke-width='1e30"),
        "<circle r='1e18'/>".to_owned(),
        "<path d='M0 0 A 1e+30 1e+30 0 0 1 9 9'/>".to_owned(),
        "<path d='M0 0 A .5.5e30 1 0 0 1 9 9'/>".to_owned(),
        format!("<rect {}/>", (0..9_000).map(|n| format!("a{n}='' ")).collect::<String>()),
        (0..9_000).map(|n| format!("<g xmlns:a{n}='a'/>")).collect(),
    ];
    let drawn = [
        "<rect width='9' height='9' rx='1e-300'/>".to_owned(),
        stroked("M0 0 C 1e8 9 1e-8 9 1 1' stroke-linejoin='round' stroke-linecap='round"),
        // Selectors that take time which grows with a power of the nesting.
        format!(
            "<style>{}z{{}}</style>{}<path d='M1 1H9V9'/>{}",
            many("* ", 40),
            many("<g>", 60),
            many("</g>", 60)
        ),
        // Left out: markers at each corner, patterns of patterns, filters.
        format!(
            "<marker id='m'>{}</marker><path marker-mid='url(#m)' d='M1 1H9V9{}'/>",
            many("<path d='M1 1H9V9'/>", 9_000),
            many("L 1 2", 90_000)
        ),
        (0..40)
            .map(|n| {
                format!(
                    "<pattern id='p{n}' width='1' height='1'>{}</pattern>",
                    many(&format!("<rect width='1' height='1' fill='url(#p{})'/>", n + 1), 2)
                )
            })
            .collect::<String>()
            + "<rect width='9' height='9' fill='url(#p0)' style='filter:url(#none);font-size:1e30'/>",
    ];
    let drawing = |body: &str, view: &str| {
        let text = format!("<svg viewBox='0 0 {view}'>{body}</svg>");
        Drawing::of(text.as_bytes())?.coverage(Affine::scale(4.0), 400, 400).map(|_| ())
    };
    for body in refused {
        let found = drawing(&body, "100 100");
        assert!(matches!(&found, Err((_, true))), "{}: {found:?}", &body[..body.len().min(70)]);
    }
    for body in drawn {
        for view in ["1e-300 1e-300", "1e300 1", "1e-9 1e8", "100 100"] {
            let found = drawing(&body, view);
            assert!(found.is_ok() || view.contains("300"), "{}: {found:?}", &body[..body.len().min(70)]);
        }
    }
    let entities = many("&a;", 1 << 17);
    let text = format!("<!DOCTYPE svg [<!ENTITY a '{}'>]><svg class='{entities}'/>", many("b", 1 << 17));
    assert!(matches!(Drawing::of(text.as_bytes()), Err((_, true))));
}

#[test]
fn polygons_painted_nothing() {
    let text = "<svg viewBox='0 0 9 9'><polygon points='0,0 9,0 9,9 0,9' fill='white'/></svg>";
    let coverage = Drawing::of(text.as_bytes()).unwrap().coverage(Affine::IDENTITY, 9, 9).unwrap();
    assert!(coverage.values.iter().all(|value| *value > 0.99));
}

#[test]
fn names_of_colours_and_styles_of_the_root_were_ignored() {
    let brightness = |root: &str, body: &str| {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9' {root}>{body}</svg>");
        let coverage = Drawing::of(text.as_bytes()).unwrap().coverage(Affine::IDENTITY, 9, 9).unwrap();
        coverage.values[40]
    };
    let square = "<rect width='9' height='9'/>";
    assert_eq!(brightness("fill='white'", square), 1.0);
    assert!((brightness("style='fill:lime'", square) - 0.7152).abs() < 1e-3);
    assert_eq!(brightness("color='white'", "<rect fill='currentColor' width='100%' height='100%'/>"), 1.0);
    // Rules for dark screens are ignored, so only the rule for two classes applies.
    let sheet = "<style>@media (x) { .a { fill: white } .b { fill: white } } .a.b { fill: lime }</style>";
    let classes = format!("{sheet}<rect class='b a' width='9' height='9'/>");
    assert!((brightness("", &classes) - 0.7152).abs() < 1e-3);
    // A gradient is half bright, and a symbol is fitted into the size of its use.
    let gradient = "<linearGradient id='g'/><rect fill='url(#g)' width='9' height='9'/>";
    assert!((brightness("", gradient) - 0.5).abs() < 0.01);
    let symbol = "<symbol id='s' viewBox='0 0 1 1'><rect fill='white' width='1' height='1'/></symbol>";
    assert_eq!(brightness("", &format!("{symbol}<use href='#s' width='9' height='9'/>")), 1.0);
}

#[test]
fn damaged_fonts_and_drawings_never_panic() {
    let whole = TinyFont::new("Whole", "ab").bytes();
    let svg = "<svg viewBox='0 0 9 9'><g transform='rotate(20 3 4) scale(2)'><path d='M1 1 C2 3 4 5 6 1 A3 3 0 0 1 2 2 Z' \
               style='fill:none;stroke:#123;stroke-width:.5e0'/></g><polygon points='1,2 3-4,5.5.5'/></svg>";
    for at in (0..whole.len()).step_by(3) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0xff;
        for bytes in [bytes, whole[..at].to_vec()] {
            if let Some(font) = Font::of(bytes, 0) {
                let _ = text_grid("ab", Span::default(), &font);
            }
        }
    }
    for at in (0..svg.len()).step_by(2) {
        let mut bytes = svg.as_bytes().to_vec();
        bytes[at] = b'9';
        for bytes in [&bytes[..], &svg.as_bytes()[..at]] {
            if let Ok(drawing) = Drawing::of(bytes) {
                let _ = drawing.coverage(Affine::scale(4.0), 36, 36);
            }
        }
    }
}

#[test]
fn texts_of_the_song_are_broken_into_lines_that_fit() {
    assert_eq!(broken("one two three four", 1), ["one two three four"]);
    assert_eq!(broken("one two three four", 2), ["one two", "three four"]);
    assert_eq!(broken("aaaa bbb ccccc dd", 3), ["aaaa", "bbb", "ccccc dd"]);
    assert_eq!(broken("word", 3), ["word"]);
    let own = Font::own();
    let inside = |text: &str| song_grid(text, &own).values().iter().filter(|value| **value < 0.0).count();
    assert_eq!([inside(""), inside(" \n\t")], [0, 0]);
    let (short, long) = (inside("Hi"), inside(&"long words of a long line ".repeat(9)));
    assert!(short > 500 && long > 3 * short, "{short} {long}");
    for text in ["Hi", "a long line of lyrics that needs three lines, or it would not fit the grid at all"] {
        let grid = song_grid(text, &own);
        assert!(grid.size() == SONG_GRID && grid.steepest() <= 1.0 + 1e-5);
        let (columns, rows) = grid.size();
        let rim = |at: usize| {
            at.is_multiple_of(columns)
                || (at + 1).is_multiple_of(columns)
                || at < columns
                || at >= columns * (rows - 1)
        };
        assert!(
            (0..columns * rows).all(|at| !rim(at) || grid.values()[at] > 0.0),
            "{text}: positive at the rim"
        );
    }
    assert!(song_grid(&"W".repeat(500), &own).values().iter().any(|value| *value < 0.0));
}
