//! Compiles signed distance functions from text and analyzes them, without a window or a GPU.
//!
//! ```text
//! text ─ lang ─► graph ─┬─► tape: clauses of four bytes, evaluated at points and over intervals
//!                       └─► world: bounds, planes, programs, GLSL ─► region: a tree of bounds and short tapes
//! ```
//!
//! [`Field`] is the type to begin with. It turns a formula into a graph in which equal expressions are stored once, and
//! from there into a tape of clauses, bounds over a box, GLSL, and a tree of cells:
//!
//! ```
//! use mariana_field::Field;
//! use mariana_field::graph::FrameInputs;
//!
//! let field = Field::parse("min(sphere(p, 1), box(p - vec3(3, 0, 0), vec3(0.5)))")?;
//! let silence = FrameInputs::default();
//!
//! // The distance at points.
//! assert_eq!(field.eval(&[[2.0, 0.0, 0.0], [0.0; 3]], &silence), [0.5, -1.0]);
//!
//! // Bounds that hold every value in a box. Both are positive, so the box contains no surface.
//! let bounds = field.bounds([5.0, 5.0, 5.0], [6.0, 6.0, 6.0], &silence);
//! assert!(bounds.lo > 4.0 && bounds.hi < 10.0);
//!
//! // The clauses that compute the field, and the equivalent GLSL.
//! assert!(field.tape().clauses.len() < 40);
//! println!("{}", field.tape());
//! assert!(field.glsl()?.contains("float"));
//!
//! // A tree of cells. A cell near one of the two shapes has a tape without the other shape.
//! let tree = field.tree(&silence);
//! let cell = tree.cell_at([0.0, 0.9, 0.0]).expect("the tree holds all surfaces");
//! assert_eq!(cell.bound, 0.0, "a surface may be in this cell");
//! # Ok::<(), mariana_field::world::WorldError>(())
//! ```
//!
//! Mistakes are reported with their location and a hint:
//!
//! ```
//! let mistake = mariana_field::Field::parse("spere(p, 1)").unwrap_err();
//! assert!(mistake.to_string().contains("sphere"));
//! ```
//!
//! To draw scenes, begin with [`world::World`]. To write tools for the language, begin with [`lang::compile`].

mod bounds;
mod field;
pub mod glsl_export;
pub mod glsl_import;
pub mod graph;
pub mod lang;
pub mod limits;
pub mod ray_probe;
pub mod rays;
pub mod region;
pub mod tape;
mod vectors;
pub mod world;

pub use field::Field;
