//! Finds the declaration of each name of a text, for editors: definitions, references, renaming, outlines.
//!
//! The parser records events about names in the order of the text. [`names`] then resolves them by the rules of the
//! language: values, functions and materials have separate namespaces; top-level names are valid everywhere, a local
//! name from its declaration to the end of its block. Texts with mistakes are resolved as far as the parser reads them.

use std::collections::HashMap;

use super::ast::{Name, NameEvent, NameKind, Section};
use super::fields::Holds;
use super::load;
use super::source::{Sources, Span};
use super::symbol::{Interner, Symbol};
use super::{Resolver, lower};
use crate::limits::LIMITS;

/// A declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Declaration {
    /// The kind.
    pub kind: NameKind,
    /// The span of the name.
    pub name: Span,
    /// The whole item; for a local name, the item in which it is declared.
    pub item: Span,
    /// The text in which a local name is valid; `None` for a top-level name.
    pub local: Option<Span>,
}

/// The meaning of a name in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// The name of the declaration with this index in [`Names::declarations`], at the declaration or at a use.
    Declared(usize),
    /// A name of the language, such as an input or a function of the library; or an unknown name.
    OfLanguage,
    /// A field of the section with this keyword.
    Field(&'static str),
    /// The components of a vector, or an input of a part of the song.
    Member,
    /// The quoted path of an included file.
    Include,
}

/// The names of a scene's texts. Offsets refer to [`Sources`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// The declarations, in the order of the texts.
    pub declarations: Vec<Declaration>,
    /// The span and the meaning of each name, in the order of the texts.
    pub all: Vec<(Span, Meaning)>,
}

impl Names {
    /// Returns the name that contains or touches an offset.
    pub fn at(&self, offset: u32) -> Option<(Span, Meaning)> {
        let behind = self.all.partition_point(|(span, _)| span.start <= offset);
        let found = self.all.get(behind.checked_sub(1)?)?;
        (offset <= found.0.end).then_some(*found)
    }

    /// Returns the spans of a declaration's name: of the declaration and of all uses.
    pub fn places(&self, declaration: usize) -> impl Iterator<Item = Span> {
        let found = self.all.iter().filter(move |(_, meaning)| *meaning == Meaning::Declared(declaration));
        found.map(|(span, _)| *span)
    }
}

/// Returns the names of a scene and of the files that it includes.
pub fn names(name: &str, text: &str, resolve: &mut Resolver<'_>) -> (Names, Sources) {
    let (loaded, sources, _) = load::load(name, text, resolve, &LIMITS, true);
    let events = loaded.ast.name_events.unwrap_or_default();
    (resolved(&events, &loaded.names), sources)
}

/// Namespaces. A function and a material may have the name of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Namespace {
    Values,
    Functions,
    Materials,
}

fn namespace(kind: NameKind) -> Option<Namespace> {
    match kind {
        NameKind::Param | NameKind::Let | NameKind::FunctionParameter | NameKind::LoopVariable => {
            Some(Namespace::Values)
        }
        NameKind::Function => Some(Namespace::Functions),
        NameKind::Section(Section::Material) => Some(Namespace::Materials),
        NameKind::Section(_) => None,
    }
}

#[derive(Default)]
struct Resolving {
    names: Names,
    /// The index of the first top-level declaration of each name. Further ones are a mistake.
    global: HashMap<(Namespace, Symbol), usize>,
    /// For each local name that is valid here, the indices of its declarations, the innermost last.
    innermost: HashMap<Symbol, Vec<usize>>,
    /// For each open scope, its names with the indices of their declarations.
    scopes: Vec<Vec<(Symbol, usize)>>,
    /// The offset at which the current item begins.
    item: u32,
    /// The first declaration of the current item.
    first_of_item: usize,
}

fn resolved(events: &[NameEvent], interner: &Interner) -> Names {
    let mut this = Resolving::default();
    // Uses may precede top-level declarations, so the declarations are collected first.
    let mut uses: Vec<(Span, Namespace, Symbol)> = Vec::new();
    let mut before = None;
    for event in events {
        match *event {
            NameEvent::Item(start) => {
                this.close_all(start);
                (this.item, this.first_of_item) = (start, this.names.declarations.len());
            }
            NameEvent::EndOfItem(end) => {
                for declaration in this.names.declarations.iter_mut().skip(this.first_of_item) {
                    declaration.item = Span::new(declaration.item.start, end);
                }
            }
            NameEvent::Opens => this.scopes.push(Vec::new()),
            NameEvent::Closes(end) => this.close(end),
            NameEvent::Declares(kind, name) => this.declare(kind, name),
            NameEvent::Field(section, name) => {
                this.names.all.push((name.span, Meaning::Field(section.word())));
            }
            NameEvent::Member(span) => this.names.all.push((span, Meaning::Member)),
            NameEvent::Includes(name) => this.names.all.push((name.span, Meaning::Include)),
            NameEvent::Calls(name) => uses.push((name.span, Namespace::Functions, name.symbol)),
            NameEvent::Reads(name) => match before.and_then(|field| holds(field, interner)) {
                Some(Holds::Material) => uses.push((name.span, Namespace::Materials, name.symbol)),
                Some(Holds::ToneMap | Holds::TransitionStyle) => {
                    this.names.all.push((name.span, Meaning::OfLanguage));
                }
                _ => match this.innermost.get(&name.symbol).and_then(|indices| indices.last()) {
                    Some(index) => this.names.all.push((name.span, Meaning::Declared(*index))),
                    None => uses.push((name.span, Namespace::Values, name.symbol)),
                },
            },
        }
        before = Some(event);
    }
    this.close_all(u32::MAX);
    for (span, namespace, symbol) in uses {
        let declared = this.global.get(&(namespace, symbol));
        let meaning = declared.map_or(Meaning::OfLanguage, |index| Meaning::Declared(*index));
        this.names.all.push((span, meaning));
    }
    this.names.all.sort_by_key(|(span, _)| *span);
    this.names
}

/// Returns the type of the field whose value begins.
fn holds(before: &NameEvent, interner: &Interner) -> Option<Holds> {
    let NameEvent::Field(section, name) = before else { return None };
    let mut fields = lower::fields(*section).iter();
    fields.find(|field| field.name == interner.name(name.symbol)).map(|field| field.holds)
}

impl Resolving {
    fn declare(&mut self, kind: NameKind, name: Name) {
        let index = self.names.declarations.len();
        let namespace = namespace(kind);
        let local = (!self.scopes.is_empty()).then(|| Span::new(name.span.end, name.span.end));
        match (self.scopes.last_mut(), namespace) {
            (Some(scope), _) => {
                scope.push((name.symbol, index));
                self.innermost.entry(name.symbol).or_default().push(index);
            }
            (None, Some(namespace)) => {
                self.global.entry((namespace, name.symbol)).or_insert(index);
            }
            (None, None) => {}
        }
        let item = Span::new(self.item, name.span.end);
        self.names.declarations.push(Declaration { kind, name: name.span, item, local });
        self.names.all.push((name.span, Meaning::Declared(index)));
    }

    fn close(&mut self, end: u32) {
        for (symbol, index) in self.scopes.pop().unwrap_or_default() {
            if let Some(indices) = self.innermost.get_mut(&symbol) {
                indices.pop();
            }
            if let Some(declaration) = self.names.declarations.get_mut(index) {
                declaration.local = Some(Span::new(declaration.name.end, end));
            }
        }
    }

    fn close_all(&mut self, end: u32) {
        while !self.scopes.is_empty() {
            self.close(end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::diagnostic::Diagnostics;
    use super::super::{compile, library, no_includes};
    use super::*;

    /// Returns the text with the number of its declaration behind each name: `a:0` for the first declaration, `a:-`
    /// for a name of the language.
    fn shown(text: &str) -> String {
        let (names, _) = names("test", text, &mut no_includes);
        let mut out = text.to_owned();
        for (span, meaning) in names.all.iter().rev() {
            let mark = match meaning {
                Meaning::Declared(index) => format!(":{index}"),
                Meaning::OfLanguage => ":-".to_owned(),
                Meaning::Field(section) => format!(":{section}"),
                Meaning::Member => ":m".to_owned(),
                Meaning::Include => ":i".to_owned(),
            };
            out.insert_str(span.end as usize, &mark);
        }
        out
    }

    #[test]
    fn names_are_resolved_in_their_scopes() {
        for (text, expected) in [
            ("let a = b let b = a", "let a:0 = b:1 let b:1 = a:0"),
            ("fn f(p, q) = p + q + r let r = p", "fn f:0(p:1, q:2) = p:1 + q:2 + r:3 let r:3 = p:-"),
            (
                "fn f(a) { let a = a let b = a  { let a = b a } + a }",
                "fn f:0(a:1) { let a:2 = a:1 let b:3 = a:2  { let a:4 = b:3 a:4 } + a:2 }",
            ),
            (
                "let k = 1 let s = sum(for i in 0..k: i * k) + i",
                "let k:0 = 1 let s:2 = sum:-(for i:1 in 0..k:0: i:1 * k:0) + i:-",
            ),
            (
                "object o { let m = 1  shape = m material = m } material m { color = m }",
                "object o:0 { let m:1 = 1  shape:object = m:1 material:object = m:2 } \
                 material m:2 { color:material = m:- }",
            ),
            (
                "let box = box(p, 1) fn length(a) = a let b = length(box).x",
                "let box:0 = box:-(p:-, 1) fn length:1(a:2) = a:2 let b:3 = length:1(box:0).x:m",
            ),
            ("sky { let a = 1 } let b = a", "sky { let a:0 = 1 } let b:1 = a:-"),
            ("picture { tone_map = agx } let agx = 1", "picture { tone_map:picture = agx:- } let agx:0 = 1"),
            ("let d = drums.band(3) + drums.kick", "let d:0 = drums:-.band:m(3) + drums:-.kick:m"),
            ("fn f(a = a let b = a fn g(c) = c", "fn f:0(a:1 = a let b:2 = a:- fn g:3(c:4) = c:4"),
            (
                "fn f(p) { let z = p for i in 0..i while i < z { let k = z.x z.x += k if k < i { let k = i z = k } } z }",
                "fn f:0(p:1) { let z:2 = p:1 for i:3 in 0..i:- while i:3 < z:2 { let k:4 = z:2.x:m z:2.x:m += k:4 \
                 if k:4 < i:3 { let k:5 = i:3 z:2 = k:5 } } z:2 }",
            ),
            ("let r = (near = near, b = 1).near", "let r:0 = (near:m = near:-, b:m = 1).near:m"),
            ("param a = 1 in 0 .. a", "param a:0 = 1 in 0 .. a:0"),
        ] {
            assert_eq!(shown(text), expected);
        }
    }

    #[test]
    fn names_of_included_files_are_found() {
        let mut files = |path: &str| match path {
            "part.scene" => Ok("fn ball(q) = sphere(q, size)".to_owned()),
            _ => Err("there is none".to_owned()),
        };
        let text = "include \"part.scene\" let size = 1 object o { shape = ball(p) }";
        let (names, sources) = names("main", text, &mut files);
        let call = names.at(text.find("ball").unwrap() as u32).unwrap();
        let Meaning::Declared(index) = call.1 else { panic!("{call:?}") };
        let place = sources.place(names.declarations[index].name.start).unwrap();
        assert_eq!((place.file.name.as_str(), place.column), ("part.scene", 4));
        assert_eq!(names.at(9), Some((Span::new(8, 20), Meaning::Include)));
        let size = names.declarations.iter().position(|one| one.kind == NameKind::Let).unwrap();
        assert_eq!(names.places(size).count(), 2);
        assert_eq!(sources.text(names.declarations[index].item), "fn ball(q) = sphere(q, size)");
    }

    fn shipped() -> Vec<(String, String)> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let scenes = paths.filter(|path| path.extension().is_some_and(|end| end == "scene"));
        scenes.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap())).collect()
    }

    #[test]
    fn every_name_of_a_shipped_scene_has_one_meaning() {
        for (file, text) in shipped() {
            let (names, _) = names("test", &text, &mut no_includes);
            let known: Vec<u32> = names.all.iter().map(|(span, _)| span.start).collect();
            let (mut tokens, mut mistakes) = (Vec::new(), Diagnostics::new(1));
            let mut interner = library::library().names.clone();
            super::super::lexer::tokenize(&text, 0, usize::MAX, &mut interner, &mut tokens, &mut mistakes);
            for token in tokens.iter().filter(|token| token.is_name()) {
                let word = &text[token.span.start as usize..token.span.end as usize];
                let times = known.iter().filter(|start| **start == token.span.start).count();
                let may_be_keyword = super::super::parser::is_keyword(word);
                let is_type = super::super::ast::Type::ALL.iter().any(|one| one.name() == word);
                assert!(times == 1 || times == 0 && (may_be_keyword || is_type), "{file}: {word}");
            }
        }
    }

    #[test]
    fn shipped_scenes_stay_the_same_if_every_name_is_replaced() {
        for (file, text) in shipped() {
            let (names, _) = names("test", &text, &mut no_includes);
            let mut renamed = text.clone();
            for (span, meaning) in names.all.iter().rev() {
                if let Meaning::Declared(index) = meaning {
                    renamed.replace_range(span.start as usize..span.end as usize, &format!("fresh_{index}"));
                }
            }
            let before = compile("test", &text, &mut no_includes);
            let before = before.scene.unwrap_or_else(|| panic!("{file}: {:?}", before.diagnostics));
            let after = compile("test", &renamed, &mut no_includes);
            let after = after.scene.unwrap_or_else(|| panic!("{file}: {:?}", after.diagnostics));
            assert!(before.draws_the_same(&after), "{file}");
            assert!(names.declarations.len() > 3, "{file}");
        }
    }

    #[test]
    fn names_are_valid_where_the_language_says() {
        let text = "fn f(a) { let b = a  b }\nlet c = 1";
        let (names, sources) = names("test", text, &mut no_includes);
        let locals: Vec<(&str, Option<&str>)> = names
            .declarations
            .iter()
            .map(|one| (sources.text(one.name), one.local.map(|span| sources.text(span))))
            .collect();
        assert_eq!(
            locals,
            [("f", None), ("a", Some(") { let b = a  b }")), ("b", Some(" = a  b }")), ("c", None)]
        );
        assert_eq!(sources.text(names.declarations[0].item), "fn f(a) { let b = a  b }");
    }
}
