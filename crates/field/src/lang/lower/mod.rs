//! Lowers the syntax tree to a checked scene with one expression graph: resolves names, checks vector sizes, expands
//! functions where they are called and unrolls loops.
//!
//! [`Lowering`] handles expressions and [`SceneBuilder`] the items of a scene. Recursion follows the nesting of
//! expressions and calls, up to `scene_depth_max`; a chain of operators is followed in a loop. Each visited node counts
//! towards the limit `scene_expansion_max`.

mod builtins;
mod call;
mod declare;
mod declared;
mod expr;
mod foreign;
mod lowering;
mod motions;
mod objects;
mod parts;
mod reads;
mod reports;
mod scene;
mod scope;
mod sections;
mod statements;
mod unused;

pub(crate) use objects::{FORGOTTEN, VISIBLE, outlasting};
pub(in crate::lang) use sections::fields;
pub use sections::{plural, section_fields};

use super::changing::ChangingNumbers;
use super::diagnostic::Diagnostics;
use super::load::Loaded;
use super::scene::Scene;
use super::source::Sources;
use crate::limits::Limits;
use foreign::Foreign;
use lowering::Lowering;
use scene::SceneBuilder;

/// Builds a scene from its tree. Returns `None` if the scene has neither shape nor sky, or exceeds a limit. The caller must also
/// check `diagnostics`: a scene with mistakes may still be returned.
pub(super) fn lower(
    loaded: Loaded,
    changing: ChangingNumbers,
    limits: &Limits,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let Loaded { ast, names, items, includes, foreign, foreign_broken } = loaded;
    let mut lowering = Lowering::new(&ast, &names, changing, limits, diagnostics);
    lowering.declared.foreign = Foreign::new(&foreign, &names, foreign_broken);
    let scene = SceneBuilder::new(lowering).scene(&items, includes, sources);
    // A GLSL file may read any name as a uniform.
    if scene.is_some() && foreign.is_empty() {
        unused::warn(&ast, &names, &items, sources, diagnostics);
    }
    scene
}
