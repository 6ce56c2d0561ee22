//! The scene's declarations: collects all names, and evaluates numbers that must be constant.

use std::collections::HashMap;

use super::super::ast::{ExprId, Item, Name, Section};
use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::library;
use super::super::scene::Param;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::declared::{GlobalFunction, GlobalLet, GlobalValue};
use super::lowering::A_NUMBER;
use super::scene::SceneBuilder;
use super::sections::plural;

impl<'a> SceneBuilder<'a> {
    /// Records all names before anything is lowered, so that declarations may follow their uses.
    pub(super) fn declare(&mut self, items: &'a [Item]) {
        let mut taken: HashMap<(Section, Symbol), Span> = HashMap::new();
        for item in items {
            match item {
                Item::Param { name, value, range } => self.param(*name, *value, *range),
                Item::Let { name, value } => {
                    if self.may_declare(*name) {
                        let declared = &mut self.lowering.declared;
                        let index = declared.lets.len() as u32;
                        declared.globals[name.symbol.index()].value = GlobalValue::Let(index);
                        declared.lets.push(GlobalLet {
                            name: *name,
                            value: *value,
                            known: None,
                            open: false,
                        });
                    }
                }
                Item::Fn(function) => {
                    let index = function.name.symbol.index();
                    let declared = &mut self.lowering.declared;
                    let known = declared.globals[index].function as usize;
                    if let Some(first) = declared.functions.get(known.wrapping_sub(1)) {
                        let span = first.function.name.span;
                        self.twice("function", function.name, span);
                        continue;
                    }
                    declared.functions.push(GlobalFunction { function, called: false, open: false });
                    declared.globals[index].function = declared.functions.len() as u32;
                }
                Item::Section { section, name: Some(name), .. } => {
                    let first = *taken.entry((*section, name.symbol)).or_insert(name.span);
                    if first != name.span {
                        self.twice(section.word(), *name, first);
                    }
                }
                Item::Broken(name) => self.lowering.declared.globals[name.symbol.index()].broken = true,
                Item::Section { .. } | Item::Bare(_) | Item::Include { .. } => {}
            }
            if self.lowering.reports.stopped {
                return;
            }
        }
    }

    fn twice(&mut self, what: &str, name: Name, first: Span) {
        let message = format!("two {} are called `{}`", plural(what), self.lowering.name(name.symbol));
        let wrong = Diagnostic::new(name.span, message).note(first, "the first one is here");
        self.report(wrong.hint("give one of them another name"));
    }

    /// True if a value of the scene may have this name; otherwise reports the conflict.
    fn may_declare(&mut self, name: Name) -> bool {
        if library::input(name.symbol).is_some_and(|row| !row.may_be_hidden()) {
            let message = format!("the name `{}` is taken by an input", self.lowering.name(name.symbol));
            self.report(Diagnostic::new(name.span, message).hint("choose another name"));
            return false;
        }
        let declared = &self.lowering.declared;
        let first = match declared.globals[name.symbol.index()].value {
            GlobalValue::None => return true,
            GlobalValue::Let(index) => declared.lets.get(index as usize).map(|one| one.name.span),
            GlobalValue::Param(index) => declared.params.get(index as usize).map(|one| one.span),
        };
        self.twice("value", name, first.unwrap_or(name.span));
        false
    }

    fn param(&mut self, name: Name, value: ExprId, range: Option<(ExprId, ExprId)>) {
        if !self.may_declare(name) {
            return;
        }
        let (count, max) = (self.lowering.declared.params.len(), self.lowering.limits.scene_params_max);
        let hint = "declare some of them with `let`";
        if self.lowering.reports.is_full(count, max, "parameters", hint, name.span) {
            return;
        }
        self.lowering.declared.globals[name.symbol.index()].broken = true;
        let Some(default) = self.fixed(value, "a parameter") else { return };
        let (min, max) = match range {
            Some((min, max)) => match (self.fixed(min, "a parameter"), self.fixed(max, "a parameter")) {
                (Some(min), Some(max)) => (min, max),
                _ => return,
            },
            None => (default.min(0.0), default.max(1.0)),
        };
        let name_text = self.lowering.name(name.symbol).to_owned();
        if min >= max {
            let message = format!("the range of `{name_text}` is empty: {min} is not below {max}");
            let span = range
                .map_or(name.span, |(min, max)| self.lowering.ast.span(min).to(self.lowering.ast.span(max)));
            self.report(Diagnostic::new(span, message).hint("write the smaller number first"));
            return;
        }
        if default < min || default > max {
            let message =
                format!("the default of `{name_text}`, {default}, is outside its range {min} .. {max}");
            let span = self.lowering.ast.span(value);
            self.report(Diagnostic::new(span, message).hint("widen the range or change the default"));
            return;
        }
        let global = &mut self.lowering.declared.globals[name.symbol.index()];
        global.value = GlobalValue::Param(self.lowering.declared.params.len() as u32);
        global.broken = false;
        self.lowering.declared.params.push(Param {
            name: name_text,
            default,
            min,
            max,
            is_number: false,
            span: name.span,
        });
    }

    /// Evaluates an expression that must be a constant number. `what` is the expression's name in messages.
    pub(super) fn fixed(&mut self, value: ExprId, what: &'static str) -> Option<f32> {
        let span = self.lowering.ast.span(value);
        let result = self.lowering.within(uses::NOTHING, what, |this| this.expr(value));
        let part = self.lowering.one_number(result, what, A_NUMBER, span)?;
        // If the number is not constant, the use of an input was already reported.
        self.lowering.known(part).filter(|number| number.is_finite())
    }

    /// Lowers functions that the scene never calls, with unknown arguments, to find their mistakes.
    pub(super) fn check_the_unused(&mut self) {
        self.lowering.within(u16::MAX, "", |this| {
            for index in 0..this.declared.functions.len() {
                let called = &mut this.declared.functions[index];
                if this.reports.stopped || std::mem::replace(&mut called.called, true) {
                    continue;
                }
                called.open = true;
                let function = called.function;
                this.reports.calls.push((function.name.symbol, function.name.span));
                let mark = this.arguments.len();
                this.put_in(function, mark);
                this.reports.calls.pop();
                this.declared.functions[index].open = false;
            }
        });
    }
}
