//! The parser's result: expressions in one arena, and the items of a scene.
//!
//! Children precede their parents. Code that visits the expressions recurses no deeper than the parser did: a chain
//! of a million additions is deep only to the left, and visitors follow the left side in a loop.

use super::source::Span;
use super::symbol::Symbol;
use super::token::Kind;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ExprId(pub u32);

/// Declares the operators between two expressions: the token, how tightly the operator binds, and how tightly an
/// operator in its right operand must bind at least.
macro_rules! binary_operators {
    ($($op:ident = $kind:ident $binds:literal $right:literal;)+) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(super) enum BinaryOp { $($op,)+ }

        impl BinaryOp {
            /// The tokens of the operators.
            pub(super) const TOKENS: &[Kind] = &[$(Kind::$kind,)+];

            /// Returns the operator of a token, and how tightly it binds to its left and right operand.
            pub(super) fn infix(token: Kind) -> Option<(Self, u8, u8)> {
                match token { $(Kind::$kind => Some((Self::$op, $binds, $right)),)+ _ => None }
            }

            pub(super) fn sign(self) -> &'static str {
                match self { $(Self::$op => Kind::$kind.sign(),)+ }
            }
        }
    };
}

binary_operators! {
    Or = Or 1 2;
    And = And 2 3;
    Equal = Equal 3 4;
    NotEqual = NotEqual 3 4;
    Less = Less 4 5;
    LessEqual = LessEqual 4 5;
    Greater = Greater 4 5;
    GreaterEqual = GreaterEqual 4 5;
    Add = Plus 5 6;
    Subtract = Minus 5 6;
    Multiply = Star 6 7;
    Divide = Slash 6 7;
    Modulo = Percent 6 7;
    Power = Caret 8 8;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Expr {
    /// A mistake that was already reported.
    Error,
    Number(f32),
    Bool(bool),
    Text(Symbol),
    Name(Symbol),
    Negate(ExprId),
    Not(ExprId),
    Binary(BinaryOp, ExprId, ExprId),
    Swizzle(ExprId, Symbol),
    /// A band of a part of the song: the part's name and the band's index.
    PartBand(Symbol, ExprId),
    /// A function's name, the index in `extra` of the first argument, and the number of arguments.
    Call(Symbol, u32, u32),
    If(ExprId, ExprId, ExprId),
    /// The index in `extra` of the first statement, the number of statements, and the result.
    Block(u32, u32, ExprId),
    /// Four entries in `extra`: variable, first, end, body.
    For(u32),
    /// `(name = value, …)`: the index in `extra` of the first pair of name and value, and the number of pairs.
    Record(u32, u32),
    /// A statement of a block: `let name = value`.
    Let(Symbol, ExprId),
    /// The number of a [`Statement`].
    Statement(u32),
    /// A statement: ends the innermost loop.
    Break,
}

/// A statement that is too large for an [`Expr`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Statement {
    Assign(Assignment),
    Loop(Loop),
    When(When),
}

/// An index in `extra` of consecutive statements, and their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Statements {
    pub first: u32,
    pub count: u32,
}

/// `name = value`, `name.xz = value` or, with an operator, `name.xz += value`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Assignment {
    pub name: Symbol,
    pub components: Option<Symbol>,
    pub op: Option<BinaryOp>,
    pub value: ExprId,
}

/// `for variable in first..end while condition { body }`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Loop {
    pub variable: Symbol,
    pub first: ExprId,
    pub end: ExprId,
    pub condition: Option<ExprId>,
    pub body: Statements,
}

/// `if condition { yes } else { no }`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct When {
    pub condition: ExprId,
    pub yes: Statements,
    pub no: Statements,
}

#[derive(Debug, Default)]
pub(super) struct Ast {
    nodes: Vec<(Expr, Span)>,
    pub extra: Vec<u32>,
    /// Records about names, in the order of the text. `None` unless an editor needs them.
    pub name_events: Option<Vec<NameEvent>>,
    statements: Vec<Statement>,
}

impl Ast {
    pub(super) fn push(&mut self, expr: Expr, span: Span) -> ExprId {
        self.nodes.push((expr, span));
        ExprId(self.nodes.len() as u32 - 1)
    }

    #[inline]
    pub(super) fn record(&mut self, event: NameEvent) {
        if let Some(events) = &mut self.name_events {
            events.push(event);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn reserve(&mut self, nodes: usize) {
        self.nodes.reserve(nodes);
    }

    pub(super) fn expr(&self, id: ExprId) -> Expr {
        self.nodes.get(id.0 as usize).map_or(Expr::Error, |node| node.0)
    }

    pub(super) fn span(&self, id: ExprId) -> Span {
        self.nodes.get(id.0 as usize).map_or(Span::default(), |node| node.1)
    }

    /// Returns all expressions with their locations; an expression follows its operands.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (Expr, Span)> + '_ {
        self.nodes.iter().copied()
    }

    pub(super) fn extra(&self, index: u32) -> u32 {
        self.extra.get(index as usize).copied().unwrap_or(0)
    }

    pub(super) fn push_statement(&mut self, statement: Statement, span: Span) -> ExprId {
        self.statements.push(statement);
        self.push(Expr::Statement(self.statements.len() as u32 - 1), span)
    }

    pub(super) fn statement(&self, index: u32) -> Option<Statement> {
        self.statements.get(index as usize).copied()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Name {
    pub symbol: Symbol,
    pub span: Span,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Number,
    Bool,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Texture,
}

impl Type {
    pub(super) const ALL: [Self; 8] =
        [Self::Number, Self::Bool, Self::Vec2, Self::Vec3, Self::Vec4, Self::Mat2, Self::Mat3, Self::Texture];

    /// Returns the name in a scene's text, and the type in words.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Number => ("number", "a number"),
            Self::Bool => ("bool", "a condition"),
            Self::Vec2 => ("vec2", "a vec2"),
            Self::Vec3 => ("vec3", "a vec3"),
            Self::Vec4 => ("vec4", "a vec4"),
            Self::Mat2 => ("mat2", "a mat2"),
            Self::Mat3 => ("mat3", "a mat3"),
            Self::Texture => ("texture", "a text"),
        }
    }

    pub(super) fn name(self) -> &'static str {
        self.names().0
    }

    pub(super) fn described(self) -> &'static str {
        self.names().1
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Parameter {
    pub name: Name,
    pub of: Option<Type>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Function {
    pub name: Name,
    pub parameters: Vec<Parameter>,
    pub body: ExprId,
}

/// A block with fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Section {
    /// A shape with its material.
    Object,
    /// The material of a surface.
    Material,
    /// A light.
    Light,
    /// A medium that fills space.
    Medium,
    /// A swarm of points.
    Swarm,
    /// A camera. Only one may be without a name.
    Camera,
    /// The background.
    Sky,
    /// The conversion of light to an image.
    Picture,
    /// Facts about the scene.
    About,
}

impl Section {
    /// All sections with the words that begin them.
    pub(super) const ALL: [(Self, &str); 9] = [
        (Self::Object, "object"),
        (Self::Material, "material"),
        (Self::Light, "light"),
        (Self::Medium, "medium"),
        (Self::Swarm, "swarm"),
        (Self::Camera, "camera"),
        (Self::Sky, "sky"),
        (Self::Picture, "picture"),
        (Self::About, "about"),
    ];

    pub(super) fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, own)| *own == word).map(|(section, _)| section)
    }

    pub(super) fn word(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// `name = value`, `name = value .. end` or, with `is_let`, `let name = value`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Entry {
    pub is_let: bool,
    pub name: Name,
    pub value: ExprId,
    pub end: Option<ExprId>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Item {
    Param {
        name: Name,
        value: ExprId,
        range: Option<(ExprId, ExprId)>,
    },
    Fn(Function),
    Let {
        name: Name,
        value: ExprId,
    },
    /// Sky, picture and about have no name; a camera may have one. `broken` is true if a missing field was already
    /// reported.
    Section {
        section: Section,
        name: Option<Name>,
        span: Span,
        entries: Vec<Entry>,
        broken: bool,
    },
    Bare(ExprId),
    Include {
        path: Name,
    },
    /// An item with a mistake that was already reported. Uses of the item's name are not reported again.
    Broken(Name),
}

/// The kind of a declared name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameKind {
    /// A parameter of the scene.
    Param,
    /// A `let`, of the scene or local.
    Let,
    /// A function.
    Function,
    /// A parameter of a function.
    FunctionParameter,
    /// The variable of a loop.
    LoopVariable,
    /// A section, such as an object.
    Section(Section),
}

/// A record of the parser about a name or a scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NameEvent {
    /// An item begins at this offset, outside of all scopes.
    Item(u32),
    /// The item ends at this offset.
    EndOfItem(u32),
    /// A scope begins.
    Opens,
    /// The innermost scope ends at this offset.
    Closes(u32),
    /// A name is declared in the innermost scope, or at the top level.
    Declares(NameKind, Name),
    /// A field of a section begins. Its value follows.
    Field(Section, Name),
    /// The value of a name is read.
    Reads(Name),
    /// A function is called.
    Calls(Name),
    /// A name after a point.
    Member(Span),
    /// A file is included.
    Includes(Name),
}
