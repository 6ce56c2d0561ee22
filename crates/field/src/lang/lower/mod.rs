//! The tree to a checked scene: names are looked up, sizes are checked, functions are expanded where they are called,
//! loops are unrolled, and everything is built into one graph.
//!
//! [`Lowering`] knows the meaning of expressions, [`SceneBuilder`] that of a scene's items. Recursion follows the nesting
//! of the text and of calls and is bounded by `scene_depth_max`; chains of operators are loops. Every visited node counts
//! against `scene_expansion_max`.

mod builtins;
mod call;
mod declare;
mod declared;
mod expr;
mod lights;
mod lowering;
mod objects;
mod reports;
mod scene;
mod scope;
mod sections;

pub use sections::section_fields;

use super::changing::ChangingNumbers;
use super::diagnostic::Diagnostics;
use super::load::Loaded;
use super::scene::Scene;
use super::source::Sources;
use crate::limits::Limits;
use lowering::Lowering;
use scene::SceneBuilder;

/// Makes a scene from a tree; `None` if the scene has no shape or has mistakes.
pub(super) fn lower(
    loaded: Loaded,
    changing: ChangingNumbers,
    limits: &Limits,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let Loaded { ast, names, items, includes } = loaded;
    let lowering = Lowering::new(&ast, &names, changing, limits, diagnostics);
    SceneBuilder::new(lowering).scene(&items, includes, sources)
}
