//! Declarations at the top of a scene's text: values, parameters, functions and materials.

use super::super::ast::{ExprId, Function};
use super::super::origins::Stretch;
use super::super::scene::{Param, TextureRef};
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::value::Value;

/// The declarations of a scene.
pub(super) struct Declared<'a> {
    /// By symbol.
    pub globals: Vec<Global>,
    pub lets: Vec<GlobalLet>,
    pub functions: Vec<GlobalFunction<'a>>,
    pub params: Vec<Param>,
    /// Pictures in the order of their first use.
    pub textures: Vec<TextureRef>,
}

impl Declared<'_> {
    /// No declarations, with room for `names` names.
    pub(super) fn new(names: usize) -> Self {
        let globals = vec![Global::default(); names];
        Self { globals, lets: Vec::new(), functions: Vec::new(), params: Vec::new(), textures: Vec::new() }
    }

    /// The meaning of a name; nothing for one that is not declared.
    pub(super) fn global(&self, symbol: Symbol) -> Global {
        self.globals.get(symbol.index()).copied().unwrap_or_default()
    }
}

/// The meaning of a name at the top of the scene: values, functions and materials each have names of their own.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Global {
    pub value: GlobalValue,
    /// 1 + index of the function; 0 for none.
    pub function: u32,
    /// 1 + index of the material; 0 for none.
    pub material: u32,
    /// An item of this name was reported.
    pub broken: bool,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) enum GlobalValue {
    #[default]
    None,
    Let(u32),
    Param(u32),
}

/// A `let` of the scene, lowered at its first use or in the order of the text.
pub(super) struct GlobalLet {
    pub name: Symbol,
    pub span: Span,
    pub value: ExprId,
    /// The value and which inputs it uses.
    pub known: Option<(Value, u8)>,
    /// What took part in it.
    pub by: Stretch,
    pub open: bool,
}

pub(super) struct GlobalFunction<'a> {
    pub function: &'a Function,
    pub called: bool,
    pub open: bool,
}
