//! The library: shapes, operators and the GLSL functions that are not built in. It is written in the scene language.
//!
//! The library's texts are parsed at the first use. Lines that begin with `##` document the function below them. The
//! last of these lines ends with `[exact; source]`, `[bound; source]` or `[source]`. *Exact* functions return the
//! distance to the surface. *Bound* functions return at most that distance, so rays may still step by the result.

use std::sync::LazyLock;

use super::ast::{Ast, Function, Item};
use super::builtin::{BUILTINS, FOLDS, INPUTS, InputRow};
use super::diagnostic::Diagnostics;
use super::symbol::{Interner, Symbol};
use super::token::RESERVED;
use super::{lexer, parser};
use crate::graph::{LevelList, Part, PartInput};
use crate::limits::LIMITS;

pub(super) const TEXTS: &[(&str, &str)] = &[
    ("Functions of GLSL", include_str!("glsl.scene")),
    ("Shapes in space", include_str!("solids.scene")),
    ("Shapes in the plane", include_str!("plane.scene")),
    ("Combining shapes", include_str!("combine.scene")),
    ("Changing space and shapes", include_str!("space.scene")),
    ("Noise", include_str!("noise.scene")),
    ("Materials", include_str!("materials.scene")),
    ("Cameras and paths", include_str!("camera.scene")),
];

/// The accuracy of a shape's distance function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accuracy {
    /// The function returns the distance.
    Exact,
    /// The function returns at most the distance.
    Bound,
}

/// The documentation of a function that scenes can call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The title of its group.
    pub group: &'static str,
    /// The name.
    pub name: &'static str,
    /// The name and the parameters, as in a declaration.
    pub signature: String,
    /// The description of the result.
    pub doc: String,
    /// The accuracy of the distance; `None` for functions that return no distance.
    pub accuracy: Option<Accuracy>,
    /// The source of the formula; empty for built-in functions.
    pub source: String,
}

pub(super) struct Library {
    /// Reserved words, inputs, built-in functions and the library's names, in this order.
    pub names: Interner,
    /// The names of the song's parts.
    pub parts: [Symbol; Part::ALL.len()],
    pub ast: Ast,
    pub functions: Vec<Function>,
    /// For each symbol: 1 + the function's index; 0 if the symbol is no function.
    pub by_symbol: Vec<u32>,
    /// For each symbol: 1 + the number of final arguments that every step of a fold gets; 0 if it is no fold.
    pub folds: Vec<u8>,
}

static LIBRARY: LazyLock<Library> = LazyLock::new(build);

pub(super) fn library() -> &'static Library {
    &LIBRARY
}

pub(super) const FIRST_INPUT: usize = RESERVED.len();
pub(super) const FIRST_BUILTIN: usize = FIRST_INPUT + INPUTS.len();
const BEHIND_BUILTINS: usize = FIRST_BUILTIN + BUILTINS.len();

pub(super) fn input_index(symbol: Symbol) -> Option<usize> {
    (FIRST_INPUT..FIRST_BUILTIN).contains(&symbol.index()).then(|| symbol.index() - FIRST_INPUT)
}

pub(super) fn builtin_index(symbol: Symbol) -> Option<usize> {
    (FIRST_BUILTIN..BEHIND_BUILTINS).contains(&symbol.index()).then(|| symbol.index() - FIRST_BUILTIN)
}

fn build() -> Library {
    let mut names = Interner::default();
    let brought = RESERVED.iter().copied();
    let brought = brought.chain(INPUTS.iter().map(|row| row.name)).chain(BUILTINS.iter().map(|row| row.name));
    for name in brought {
        names.intern(name);
    }
    let parts = Part::ALL.map(|part| names.intern(part.name()));
    // Ignore the diagnostics: a test checks that these texts have no mistakes.
    let mut diagnostics = Diagnostics::new(LIMITS.scene_diagnostics_max);
    let (mut ast, mut functions) = (Ast::default(), Vec::new());
    for (_, text) in TEXTS {
        let mut tokens = Vec::new();
        lexer::tokenize(text, 0, usize::MAX, &mut names, &mut tokens, &mut diagnostics);
        let items = parser::parse(&tokens, &names, LIMITS.scene_nesting_max, &mut ast, &mut diagnostics);
        functions.extend(items.into_iter().filter_map(|item| match item {
            Item::Fn(function) => Some(function),
            _ => None,
        }));
    }
    let (mut by_symbol, mut folds) = (vec![0; names.len()], vec![0; names.len()]);
    for (index, function) in functions.iter().enumerate() {
        by_symbol[function.name.symbol.index()] = index as u32 + 1;
    }
    for (name, tail) in FOLDS {
        if let Some(symbol) = names.get(name) {
            folds[symbol.index()] = *tail as u8 + 1;
        }
    }
    Library { names, parts, ast, functions, by_symbol, folds }
}

/// Returns the name and description of each input.
pub fn inputs() -> impl Iterator<Item = (&'static str, &'static str)> {
    INPUTS.iter().map(|row| (row.name, row.doc))
}

/// Returns the name and description of each part of the song.
pub fn parts() -> impl Iterator<Item = (&'static str, &'static str)> {
    Part::ALL.into_iter().map(|part| (part.name(), part.doc()))
}

/// True for the name of a part of the song, such as `drums`.
pub fn is_part(name: &str) -> bool {
    Part::ALL.iter().any(|part| part.name() == name)
}

/// Returns the name and description of each input that a part of the song has: `volume` in `drums.volume`.
pub fn part_inputs() -> impl Iterator<Item = (&'static str, &'static str)> {
    let names: Vec<&str> =
        PartInput::sounds().map(|input| input.name().split('.').next().unwrap_or_default()).collect();
    let of_parts = move |row: &&InputRow| names.contains(&row.name);
    let band = (LevelList::Band.name(), LevelList::Band.doc());
    INPUTS.iter().filter(of_parts).map(|row| (row.name, row.doc)).chain([band])
}

/// Returns all functions that a scene can call: the built-in ones, then the library in the order of its texts.
pub fn entries() -> Vec<Entry> {
    let mut entries: Vec<Entry> = BUILTINS
        .iter()
        .map(|row| Entry {
            group: "Built in",
            name: row.name,
            signature: format!("{}({})", row.name, row.parameters),
            doc: row.doc.to_owned(),
            accuracy: None,
            source: String::new(),
        })
        .collect();
    for (group, text) in TEXTS {
        let mut doc = String::new();
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("## ") {
                if !doc.is_empty() {
                    doc.push(' ');
                }
                doc.push_str(rest);
            } else if let Some(rest) = line.strip_prefix("fn ") {
                entries.push(entry(group, rest, std::mem::take(&mut doc)));
            } else {
                doc.clear();
            }
        }
    }
    entries
}

fn entry(group: &'static str, head: &'static str, doc: String) -> Entry {
    let name = head.split('(').next().unwrap_or("");
    let signature = head.find(')').and_then(|end| head.get(..=end)).unwrap_or(head).to_owned();
    let bracket = doc.rfind('[').unwrap_or(doc.len());
    let (sentences, facts) = doc.split_at(bracket);
    let facts = facts.trim_matches(['[', ']']);
    let (accuracy, source) = match facts.split_once(';') {
        Some(("exact", source)) => (Some(Accuracy::Exact), source),
        Some(("bound", source)) => (Some(Accuracy::Bound), source),
        _ => (None, facts),
    };
    let source = source.trim().to_owned();
    Entry { group, name, signature, doc: sentences.trim().to_owned(), accuracy, source }
}

// Example formulas for the previews of the library's functions.

/// Names of functions, each with the formula that its preview shows.
pub const PICTURES: &[(&str, &str)] = &[
    // Shapes in space.
    ("sphere", "sphere(p, 1)"),
    ("box", "box(p, vec3(0.8, 0.5, 0.6))"),
    ("round_box", "round_box(p, vec3(0.65, 0.35, 0.45), 0.15)"),
    ("box_frame", "box_frame(p, vec3(0.8, 0.5, 0.6), 0.06)"),
    ("torus", "torus(p, 0.8, 0.27)"),
    ("capped_torus", "capped_torus(p, 2, 0.75, 0.2)"),
    ("link", "link(p, 0.4, 0.45, 0.17)"),
    ("cylinder", "intersect(cylinder(p, 0.35), abs(y) - 1)"),
    ("capped_cylinder", "capped_cylinder(p, 0.6, 0.7)"),
    ("rounded_cylinder", "rounded_cylinder(p, 0.6, 0.7, 0.18)"),
    ("cone", "cone(p, 0.5, 1.4)"),
    ("capped_cone", "capped_cone(p, 0.6, 0.75, 0.35)"),
    ("round_cone", "round_cone(p, 0.6, 0.25, 1)"),
    ("plane", "intersect(plane(p, vec3(1, 3, -0.5), 0.2), box(p, vec3(1, 0.6, 0.8)))"),
    ("hex_prism", "hex_prism(p, 0.75, 0.35)"),
    ("tri_prism", "tri_prism(p, 0.9, 0.35)"),
    ("capsule", "capsule(p, vec3(-0.8, -0.4, 0), vec3(0.8, 0.5, 0), 0.27)"),
    ("vertical_capsule", "vertical_capsule(p, 1.1, 0.35)"),
    ("ellipsoid", "ellipsoid(p, vec3(1, 0.5, 0.7))"),
    ("octahedron", "octahedron(p, 1)"),
    ("pyramid", "pyramid(p, 0.8)"),
    ("rhombus", "rhombus(p, 1, 0.6, 0.2, 0.06)"),
    ("solid_angle", "solid_angle(p, 0.7, 1.2)"),
    ("cut_sphere", "cut_sphere(p, 1, 0.2)"),
    ("cut_hollow_sphere", "cut_hollow_sphere(p, 0.9, 0.3, 0.06)"),
    ("death_star", "death_star(p, 1, 0.7, 1.05)"),
    ("triangle", "triangle(p, vec3(-0.9, 0, 0.2), vec3(0.9, 0, -0.2), vec3(0.1, 1.2, 0.3)) - 0.03"),
    ("quad", "quad(p, vec3(-0.9, 0, 0), vec3(0.9, 0, 0), vec3(0.6, 0.9, 0.5), vec3(-0.6, 0.9, 0.5)) - 0.03"),
    ("gyroid", "intersect(gyroid(p, 0.9, 0.035), sphere(p, 1))"),
    // Shapes in the plane.
    ("circle", "extrude(circle(p.xy, 0.8), p.z, 0.2)"),
    ("rectangle", "extrude(rectangle(p.xy, vec2(0.9, 0.5)), p.z, 0.2)"),
    ("round_rectangle", "extrude(round_rectangle(p.xy, vec2(0.9, 0.5), 0.2), p.z, 0.2)"),
    ("segment", "extrude(segment(p.xy, vec2(-0.7, -0.4), vec2(0.7, 0.4)) - 0.15, p.z, 0.2)"),
    ("equilateral", "extrude(equilateral(p.xy, 0.9), p.z, 0.2)"),
    ("hexagon", "extrude(hexagon(p.xy, 0.8), p.z, 0.2)"),
    ("polygon", "extrude(polygon(p.xy, 5, 0.9), p.z, 0.2)"),
    ("star", "extrude(star(p.xy, 5, 1, 0.45), p.z, 0.2)"),
    ("ring", "extrude(ring(p.xy, 0.7, 0.15), p.z, 0.2)"),
    ("pie", "extrude(pie(p.xy, 0.9, 1), p.z, 0.2)"),
    ("arc", "extrude(arc(p.xy, 1.9, 0.7, 0.15), p.z, 0.2)"),
    ("heart", "extrude(heart(p.xy), p.z, 0.2)"),
    // Combining shapes.
    ("union", "union(box(p, vec3(0.9, 0.25, 0.6)), sphere(p - vec3(0, 0.4, 0), 0.5))"),
    ("intersect", "intersect(box(p, 0.65), sphere(p, 0.85))"),
    ("subtract", "subtract(box(p, 0.65), sphere(p - vec3(0.4, 0.5, -0.5), 0.7))"),
    ("smooth_union", "smooth_union(box(p, vec3(0.9, 0.25, 0.6)), sphere(p - vec3(0, 0.4, 0), 0.5), 0.4)"),
    ("smooth_intersect", "smooth_intersect(box(p, 0.65), sphere(p, 0.85), 0.3)"),
    ("smooth_subtract", "smooth_subtract(box(p, 0.65), sphere(p - vec3(0.4, 0.5, -0.5), 0.7), 0.25)"),
    ("chamfer_union", "chamfer_union(box(p, vec3(0.9, 0.25, 0.6)), sphere(p - vec3(0, 0.4, 0), 0.5), 0.25)"),
    ("morph", "morph(box(p, 0.65), sphere(p, 0.9), 0.5)"),
    // Changing space and shapes.
    ("translate", "union(box(p, 0.35), sphere(translate(p, vec3(1.1, 0.5, 0)), 0.35))"),
    ("rotate_x", "box(rotate_x(p, 0.5), vec3(0.9, 0.35, 0.55))"),
    ("rotate_y", "box(rotate_y(p, 0.3), vec3(0.9, 0.35, 0.55))"),
    ("rotate_z", "box(rotate_z(p, 0.5), vec3(0.9, 0.35, 0.55))"),
    ("rotate", "box(rotate(p, vec3(1, 1, 0), 0.9), vec3(0.9, 0.35, 0.55))"),
    ("rotate_2d", "extrude(rectangle(rotate_2d(p.xy, 0.5), vec2(0.9, 0.4)), p.z, 0.2)"),
    (
        "scale",
        "union(for i in 0..4: octahedron(scale(p - vec3(i - 0.1 * i * i, 0, 0), 0.8 ^ i), 0.5) * 0.8 ^ i)",
    ),
    ("repeat", "intersect(round_box(repeat(p, vec3(0.6, 0, 0.6)), 0.15, 0.05), length(p.xz) - 1.7)"),
    ("repeat_limited", "sphere(repeat_limited(p, 0.5, vec3(2, 1, 1)), 0.2)"),
    (
        "cell_of",
        "intersect(min(sphere(repeat(p, vec3(0.5, 0, 0.5)), 0.08 + 0.12 * hash(cell_of(p, vec3(0.5, 0, 0.5)))), \
         other_cells(p, vec3(0.5, 0, 0.5), 0.2)), max(abs(x), abs(z)) - 1.25)",
    ),
    (
        "other_cells",
        "intersect(min(box(repeat(p, vec3(0.5, 0, 0.5)), vec3(0.15, 0.1 + 0.5 * hash(cell_of(p, vec3(0.5, 0, 0.5))), 0.15)), \
         other_cells(p, vec3(0.5, 0, 0.5), 0.15)), max(abs(x), abs(z)) - 1.25)",
    ),
    ("hex_repeat", "intersect(extrude(hexagon(hex_repeat(p.xz, 0.5).yx, 0.2), y, 0.15), length(p.xz) - 1.5)"),
    (
        "other_hex_cells",
        "intersect(min(extrude(hexagon(hex_repeat(p.xz, 0.5).yx, 0.19), y, 0.1 + 0.5 * hash(vec3(hex_cell(p.xz, 0.5), 0))), \
         other_hex_cells(p.xz, 0.5, 0.22)), length(p.xz) - 1.3)",
    ),
    ("mirror", "capsule(mirror(p, vec3(1, 0.4, 0)), vec3(0.3, -0.4, 0), vec3(1, 0.7, 0), 0.2)"),
    ("mirror_x", "cone(rotate_z(mirror_x(p) - vec3(0.3, 0.2, 0), 0.9), 0.35, 1)"),
    ("mirror_y", "cone(mirror_y(p) - vec3(0, 0.9, 0), 0.5, 1)"),
    ("mirror_z", "torus(mirror_z(p) - vec3(0, 0, 0.6), 0.45, 0.15)"),
    ("polar_repeat", "round_box(polar_repeat(p, 9) - vec3(0.9, 0, 0), vec3(0.2, 0.2, 0.12), 0.04)"),
    ("smooth_polar_repeat", "sphere(smooth_polar_repeat(p, 7, 0.6) - vec3(0.72, 0, 0), 0.38)"),
    ("twist", "round_box(twist(p, 1.3), vec3(0.4, 1, 0.4), 0.05) / (1 + 1.3 * 0.64)"),
    ("bend", "round_box(bend(p, 0.7), vec3(1.2, 0.15, 0.4), 0.05) / (1 + 0.7 * 1.3)"),
    ("warp", "sphere(warp(p, 0.3, 0.9), 0.9) / (1 + 5.2 * 0.3 / 0.9)"),
    ("elongate", "torus(elongate(p, vec3(0.5, 0, 0.2)), 0.4, 0.2)"),
    ("shell", "subtract(shell(sphere(p, 0.9), 0.07), box(p - vec3(1, 1, -1), 1))"),
    ("extrude", "extrude(heart(p.xy), p.z, 0.35)"),
    ("revolve", "subtract(round_rectangle(revolve(p, 0.7), vec2(0.28, 0.22), 0.08), max(-x, z))"),
    ("displace", "displace(sphere(p, 0.85), 0.07 * sin(9 * x) * sin(9 * y) * sin(9 * z), 0.65)"),
    ("displace_fbm", "displace_fbm(sphere(p, 0.75), p, 0.6, 0.5, 6)"),
    ("round", "round(box(p, vec3(0.5, 0.3, 0.4)), 0.25)"),
    // Noise.
    (
        "hash",
        "union(for i in 0..6: for j in 0..6: box(p - 0.3 * vec3(i, 0, j), vec3(0.12, 0.1 + 0.5 * hash(vec3(i, j, 0)), 0.12)))",
    ),
    ("noise", "displace(sphere(p, 0.8), 0.35 * noise(4 * p), 2.1)"),
    ("noise_2d", "displace(box(p, vec3(1, 0.1, 1)), 0.4 * noise_2d(3 * p.xz), 1.8)"),
    ("fbm", "displace(sphere(p, 0.7), 0.5 * fbm(2 * p, 5), 4.5)"),
    ("ridged", "displace(sphere(p, 0.7), 0.4 * ridged(1.5 * p, 4), 4.5)"),
    ("billow", "displace(sphere(p, 0.7), 0.4 * billow(1.5 * p, 4), 4.5)"),
    ("erosion", "max(y + 0.5 - 0.9 * erosion(1.3 * p.xz + 4, 6), abs(x) - 1, abs(z) - 1, -0.5 - y)"),
    ("voronoi", "intersect(voronoi(3 * p) / 3 - 0.08, sphere(p, 1))"),
    ("voronoi_2d", "intersect(voronoi_2d(3 * p.xz) / 3 - 0.12, abs(y) - 0.2, length(p.xz) - 1.3)"),
    ("voronoi_walls", "subtract(sphere(p, 1), voronoi_walls(2.2 * p) / 2.2 - 0.03)"),
    ("voronoi_walls_2d", "max(0.03 - voronoi_walls_2d(3 * p.xz) / 3, abs(y) - 0.15, length(p.xz) - 1.3)"),
    (
        "voronoi_hash_2d",
        "max(min(max(0.03 - voronoi_walls_2d(3 * p.xz) / 3, y - 0.8 * voronoi_hash_2d(3 * p.xz)), \
         0.03 + voronoi_walls_2d(3 * p.xz) / 3), -0.2 - y, length(p.xz) - 1.2)",
    ),
];
