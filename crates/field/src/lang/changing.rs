//! Numbers that are being edited in a text. They become inputs of a frame, so that the program compiled for the text
//! can also draw the text with other numbers.
//!
//! A number is identified by its index among the numbers of the scene's own text. If two versions of a text differ
//! only in numbers, an index identifies the same number in both. Some numbers stay constants because they determine
//! the scene's structure: exponents, the bounds of loops, the defaults and ranges of parameters.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use super::diagnostic::Diagnostics;
use super::lexer;
use super::library;
use super::scene::Param;
use super::source::Span;
use super::symbol::Interner;
use super::token::{Kind, Token};
use crate::graph::{FrameInputs, Graph, Input, NodeId, Point};
use crate::limits::LIMITS;

/// A number that the user is dragging in a text, with its range. Outside the range, the text is compiled again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// The index among the numbers of the text, starting at 0.
    pub place: usize,
    /// The minimum, finite.
    pub least: f32,
    /// The maximum, finite.
    pub most: f32,
}

/// Returns the indices, starting at 0, of the numbers that differ between two versions of a text. Returns `None` if
/// the versions differ in anything except numbers, blanks and comments.
pub fn changed_numbers(before: &str, now: &str) -> Option<BTreeSet<usize>> {
    let mut names = library::library().names.clone();
    let (before, now) = (tokens(before, &mut names), tokens(now, &mut names));
    if before.len() != now.len() {
        return None;
    }
    let mut changed = BTreeSet::new();
    let mut place = 0;
    for (before, now) in before.iter().zip(&now) {
        let is_number = now.kind == Kind::Number;
        if (before.kind, before.newline) != (now.kind, now.newline) {
            return None;
        }
        if before.symbol != now.symbol {
            if !is_number {
                return None;
            }
            changed.insert(place);
        }
        place += usize::from(is_number);
    }
    Some(changed)
}

/// Returns the index, starting at 0, of the number that begins at a byte of a text.
pub fn number_place(text: &str, offset: usize) -> Option<usize> {
    let tokens = tokens(text, &mut library::library().names.clone());
    let mut numbers = tokens.iter().filter(|token| token.kind == Kind::Number);
    numbers.position(|token| token.span.start as usize == offset)
}

/// Returns the tokens of a text. Mistakes are ignored here: compiling the text reports them.
fn tokens(text: &str, names: &mut Interner) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut mistakes = Diagnostics::new(1);
    lexer::tokenize(text, 0, LIMITS.scene_tokens_max, names, &mut tokens, &mut mistakes);
    tokens
}

#[derive(Debug, Default)]
pub(super) struct ChangingNumbers {
    /// The edited numbers by their offsets in the text. A number that is being dragged has a range.
    edited: BTreeMap<u32, Option<Turning>>,
    /// The edited numbers found in expressions so far, in the order of their inputs: each number's offset and value.
    found: Vec<(u32, f32)>,
    /// The first input that is a number of the text. The inputs before it are parameters.
    first: usize,
    /// Inputs whose values determine the scene's structure. If one changes, the text has to be compiled again.
    depended_on: RefCell<BTreeSet<u16>>,
}

impl ChangingNumbers {
    pub(super) fn of(text: &str, places: &BTreeSet<usize>, turning: &[Turning]) -> Self {
        let tokens = tokens(text, &mut library::library().names.clone());
        let numbers = tokens.iter().filter(|token| token.kind == Kind::Number).enumerate();
        let mut this = Self::default();
        for (place, token) in numbers {
            let turned = turning.iter().find(|turning| turning.place == place);
            if places.contains(&place) || turned.is_some() {
                this.edited.insert(token.span.start, turned.copied());
            }
        }
        this
    }

    /// Returns the input for the number that begins at `offset`, if it is being edited. The first `declared` inputs are
    /// parameters. There are at most `max` inputs; the remaining numbers stay constants.
    pub(super) fn input(&mut self, offset: u32, value: f32, declared: usize, max: usize) -> Option<Input> {
        self.edited.get(&offset)?;
        if self.found.is_empty() {
            self.first = declared;
        }
        let known = self.found.iter().position(|(known, _)| *known == offset);
        let number = self.first + known.unwrap_or(self.found.len());
        if number >= max {
            return None;
        }
        let input = Input::Param(u16::try_from(number).ok()?);
        if known.is_none() {
            self.found.push((offset, value));
        }
        Some(input)
    }

    /// Returns the inputs as parameters without names, with the ranges in which a frame may set them.
    pub(super) fn params(&self) -> impl Iterator<Item = Param> {
        let fixed = self.depended_on.borrow().clone();
        self.found.iter().zip(self.first..).map(move |(&(offset, value), input)| {
            let is_fixed = fixed.iter().any(|fixed| usize::from(*fixed) == input);
            let (min, max) = match self.edited.get(&offset) {
                Some(Some(turning)) if !is_fixed => (turning.least.min(value), turning.most.max(value)),
                _ => (value, value),
            };
            let span = Span::new(offset, offset);
            Param { name: String::new(), default: value, min, max, is_number: true, span }
        })
    }

    /// Returns the value of an expression that consists only of numbers.
    pub(super) fn known(&self, graph: &Graph, value: NodeId) -> Option<f32> {
        let constant = graph.as_constant(value);
        if constant.is_some() || self.found.is_empty() {
            return constant;
        }
        let used = graph.inputs_used(&[value]);
        let is_number =
            |input: &Input| matches!(input, Input::Param(number) if usize::from(*number) >= self.first);
        if !used.inputs.iter().all(is_number) || !used.tables.is_empty() || !used.textures.is_empty() {
            return None;
        }
        let numbers = used.inputs.iter().filter_map(|input| match input {
            Input::Param(number) => Some(*number),
            _ => None,
        });
        self.depended_on.borrow_mut().extend(numbers);
        let mut params = vec![0.0; self.first];
        params.extend(self.found.iter().map(|(_, value)| *value));
        let frame = FrameInputs { params, ..FrameInputs::default() };
        graph.evaluate(&[value], &Point::default(), &frame).first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{Scene, compile, compile_while_changing, no_includes};
    use crate::world::World;

    fn changing(text: &str, places: &[usize]) -> Scene {
        let places = places.iter().copied().collect();
        let compiled = compile_while_changing("test", text, &mut no_includes, &places, &[]);
        compiled.scene.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics))
    }

    fn world(text: &str, places: &[usize]) -> World {
        World::new("test", changing(text, places), Vec::new()).unwrap()
    }

    fn distance(scene: &Scene, point: Point) -> f32 {
        let params = scene.params.iter().map(|param| param.default).collect();
        scene.graph.evaluate(&[scene.distance], &point, &FrameInputs { params, ..FrameInputs::default() })[0]
    }

    #[test]
    fn only_numbers_that_differ_are_changed() {
        let text = "let r = 1.5 # a radius\nsphere(p, r) - 0.25 * 2";
        let changed =
            |now: &str| changed_numbers(text, now).map(|places| places.into_iter().collect::<Vec<_>>());
        assert_eq!(changed(text), Some(vec![]));
        assert_eq!(changed("let r = 1.50\nsphere(p, r)  - 0.25 * 2 # another word"), Some(vec![]));
        assert_eq!(changed("let r = 0.5\nsphere(p, r) - .3 * 2"), Some(vec![0, 1]));
        assert_eq!(changed("let r = 1.5\nsphere(p, r) + 0.25 * 2"), None);
        assert_eq!(changed("let q = 1.5\nsphere(p, q) - 0.25 * 2"), None);
        assert_eq!(changed("let r = 1.5\nsphere(p, r) - 0.25 * 2 * 2"), None);
    }

    #[test]
    fn a_changed_number_needs_no_other_program() {
        let of = |radius: &str| {
            format!(
                "fn ball(q) = length(q) - {radius}\nmaterial m {{ color = vec3({radius}, 0.5, x) }}\n\
                     object one {{ shape = union(ball(p), ball(p - vec3(2, 0, 0)))  material = m }}"
            )
        };
        let (before, now) = (of("1.25"), of("0.75"));
        let places: Vec<usize> = changed_numbers(&before, &now).unwrap().into_iter().collect();
        assert_eq!(places.len(), 2);
        assert!(!world(&before, &[]).is_compiled_like(&world(&now, &[])));
        let (first, second) = (world(&before, &places), world(&now, &places));
        assert!(first.is_compiled_like(&second));
        assert_eq!(first.compiled_glsl().unwrap(), second.compiled_glsl().unwrap());
        for (text, world) in [(&before, &first), (&now, &second)] {
            let plain = compile("test", text, &mut no_includes).scene.unwrap();
            for at in [Point::at(0.3, -0.2, 2.0), Point::at(1.0, 1.0, -1.0)] {
                assert_eq!(distance(&plain, at), distance(&world.scene, at));
            }
        }
        let with_param = world("param k = 0.5 in 0 .. 1\nsphere(p, k) - 0.1", &[3]);
        let shown: Vec<(&str, bool)> =
            with_param.scene.params.iter().map(|param| (param.name.as_str(), param.is_number)).collect();
        assert_eq!(shown, [("k", false), ("", true)]);
        assert_eq!(with_param.scene.params[1].default, 0.1);
    }

    #[test]
    fn a_dragged_number_has_a_range_and_its_location() {
        let text = "param k = 0.5 in 0 .. 1\nsphere(p, k) - 0.25";
        let turning = Turning { place: 3, least: 0.125, most: 1.0 };
        let compiled = compile_while_changing("test", text, &mut no_includes, &BTreeSet::new(), &[turning]);
        let scene = compiled.scene.unwrap();
        let number = scene.params.last().unwrap();
        assert_eq!((number.is_number, number.default, number.min, number.max), (true, 0.25, 0.125, 1.0));
        assert_eq!(number.span.start as usize, text.find("0.25").unwrap());
        let params = vec![0.5, 1.0];
        let frame = FrameInputs { params, ..FrameInputs::default() };
        let value = scene.graph.evaluate(&[scene.distance], &Point::at(2.0, 0.0, 0.0), &frame);
        assert_eq!(value, [0.5]);
    }

    #[test]
    fn a_dragged_structural_number_has_no_range() {
        let text = "length(p) - sum(for i in 0..4: 0.1 * i) + x^3";
        for (place, has_range) in [(1, false), (2, true), (3, false)] {
            let turning = Turning { place, least: 0.01, most: 9.0 };
            let compiled =
                compile_while_changing("test", text, &mut no_includes, &BTreeSet::new(), &[turning]);
            let params = compiled.scene.unwrap().params;
            assert_eq!(params.iter().any(|param| param.min < param.max), has_range, "{place}");
        }
    }

    #[test]
    fn structural_numbers_stay_constants() {
        // An odd exponent keeps the sign of the base; a power with an unknown exponent does not.
        for text in ["x^3 + y", "fn f(k) = x^(k + 1) + y\nf(2)", "pow(x, 3) + y"] {
            let number = changed_numbers(text, &text.replace(['3', '2'], "5")).unwrap();
            let scene = changing(text, &number.into_iter().collect::<Vec<_>>());
            assert_eq!(distance(&scene, Point::at(-2.0, 0.5, 0.0)), -7.5, "{text}");
        }
        let text =
            "let rounds = 3\nparam k = 0.5 in 0 .. 2\nlength(p) - k * sum(for i in 0..rounds: 0.1 * i)";
        let scene = changing(text, &[0, 1, 2, 3, 4, 5]);
        let plain = compile("test", text, &mut no_includes).scene.unwrap();
        let at = Point::at(1.0, 2.0, 2.0);
        assert_eq!(distance(&scene, at), distance(&plain, at));
        assert_eq!(scene.params[0].max, 2.0);
        let zero = BTreeSet::from([0]);
        let mistake = compile_while_changing("test", "length(p) / 0", &mut no_includes, &zero, &[]);
        assert!(mistake.scene.is_none() && !mistake.diagnostics.is_empty());
    }

    #[test]
    fn more_numbers_than_inputs_stay_in_the_text() {
        let text: String =
            (0..100).map(|i| format!("sphere(p - vec3({i}.5, 0, 0), 1)")).collect::<Vec<_>>().join("\n");
        let text = text.lines().fold("1e3".to_owned(), |all, one| format!("min({all}, {one})"));
        let all: Vec<usize> = (0..401).collect();
        let scene = changing(&text, &all);
        assert_eq!(scene.params.len(), LIMITS.scene_params_max);
        assert_eq!(distance(&scene, Point::at(3.5, 0.0, 0.0)), -1.0);
    }
}
