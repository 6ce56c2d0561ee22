//! The top-level declarations of a scene: lets, parameters, functions and materials.

use super::super::ast::{ExprId, Function, Name};
use super::super::origins::Stretch;
use super::super::scene::{Param, TextureRef};
use super::super::shape::ShapeRef;
use super::super::symbol::Symbol;
use super::super::value::Value;
use super::foreign::Foreign;

#[derive(Default)]
pub(super) struct Declared<'a> {
    /// Indexed by symbol.
    pub globals: Vec<Global>,
    pub lets: Vec<GlobalLet>,
    pub functions: Vec<GlobalFunction<'a>>,
    pub params: Vec<Param>,
    pub textures: Vec<TextureRef>,
    pub shapes: Vec<ShapeRef>,
    pub foreign: Foreign<'a>,
}

impl Declared<'_> {
    pub(super) fn new(names: usize) -> Self {
        Self { globals: vec![Global::default(); names], ..Self::default() }
    }

    /// Returns the declarations of a name; empty for an undeclared name.
    pub(super) fn global(&self, symbol: Symbol) -> Global {
        self.globals.get(symbol.index()).copied().unwrap_or_default()
    }
}

/// The top-level declarations of one name. Values, functions and materials have separate namespaces.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Global {
    pub value: GlobalValue,
    /// 1 + the function's index, or 0.
    pub function: u32,
    /// 1 + the material's index, or 0.
    pub material: u32,
    pub broken: bool,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) enum GlobalValue {
    #[default]
    None,
    Let(u32),
    Param(u32),
}

/// A `let` of the scene. Lets are lowered in the order of the text. A let that is used before its declaration is
/// lowered at the use.
pub(super) struct GlobalLet {
    pub name: Name,
    pub value: ExprId,
    /// The value, the inputs that it uses, as bits of `uses`, and the notes of the text that computes it (see
    /// `lang::origins`); `None` until it is lowered.
    pub known: Option<(Value, u16, Stretch)>,
    /// True while the value is being lowered.
    pub open: bool,
}

pub(super) struct GlobalFunction<'a> {
    pub function: &'a Function,
    pub called: bool,
    /// True while the body is being expanded.
    pub open: bool,
}
