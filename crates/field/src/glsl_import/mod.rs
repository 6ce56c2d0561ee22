//! GLSL as a source of functions: reads a file as people write it for viewers of shaders, and executes its functions
//! symbolically into an expression graph.
//!
//! ```text
//! text → tokens → preprocess → items → rewrite → naga → execute: nodes of the graph
//! ```
//!
//! [`GlslFile::parse`] returns the functions of a file, [`GlslSession::call`] executes one. Loops are unrolled and both
//! sides of an unknown condition are executed; the values that they leave are selected by the condition. The graph's
//! operators are total, so a side that is not selected cannot spoil the result. Whole numbers that depend on the point
//! are floats: they are exact up to 2^24. Constant whole numbers have 32 bits.

mod around;
mod calls;
mod evaluate;
mod execute;
mod includes;
mod isf;
mod items;
mod layout;
mod math;
mod operators;
mod outside;
mod parse;
mod preprocess;
mod quiet;
mod rewrite;
mod samplers;
mod tokens;

pub(crate) use around::scene_around_file;
pub use around::{SceneAround, Shown, scene_around};
pub use calls::{Budget, GlslSession};
pub use includes::{Whole, whole};
pub use outside::candidate;
pub(crate) use outside::{Channel, Meaning, meaning};
pub use parse::{GlslFile, GlslFunction, GlslParameter, GlslType};
pub use samplers::image_sampler;

use crate::lang::Diagnostic;

/// A result of reading or executing GLSL. The spans of a mistake are bytes of the GLSL text as the user wrote it.
type Result<T, E = Diagnostic> = std::result::Result<T, E>;

#[cfg(test)]
mod tests;
