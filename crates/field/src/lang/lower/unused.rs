//! Warns about names that a scene declares and never uses.
//!
//! A name counts as used if any expression mentions it, also one in a function that is never called. Names of included
//! files are not reported, because a file with functions for several scenes is useful.

use super::super::ast::{Ast, Expr, Item, Name, Section};
use super::super::diagnostic::{Diagnostic, Diagnostics};
use super::super::source::{Sources, Span};
use super::super::symbol::{Interner, Symbol};
use std::collections::{HashMap, HashSet};

pub(super) fn warn(
    ast: &Ast,
    names: &Interner,
    items: &[Item],
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) {
    let mut calls: HashSet<Symbol> = HashSet::new();
    let mut uses: HashMap<Symbol, Vec<u32>> = HashMap::new();
    for (expr, span) in ast.nodes() {
        match expr {
            Expr::Name(symbol) => uses.entry(symbol).or_default().push(span.start),
            Expr::Call(symbol, ..) => _ = calls.insert(symbol),
            _ => {}
        }
    }
    uses.values_mut().for_each(|starts| starts.sort_unstable());
    let end = sources.files().first().map_or(0, |file| file.text.len() as u32);
    let is_used = |name: &Name| uses.contains_key(&name.symbol);
    let mut warn = |what: &str, name: &Name, hint: &str| {
        if name.span.start <= end {
            let message = format!("the {what} `{}` is never used", names.name(name.symbol));
            diagnostics.warn(Diagnostic::warning(name.span, message).hint(hint));
        }
    };
    for item in items {
        match item {
            Item::Param { name, .. } if !is_used(name) => {
                warn("parameter", name, "its slider changes nothing: use it in a formula, or delete it");
            }
            Item::Let { name, .. } if !is_used(name) => warn("value", name, "use it, or delete it"),
            Item::Fn(function) if !calls.contains(&function.name.symbol) => {
                warn("function", &function.name, "call it, or delete it");
            }
            Item::Section { section: Section::Material, name: Some(name), .. } if !is_used(name) => {
                let hint = format!("write `material = {}` in an object", names.name(name.symbol));
                warn("material", name, &hint);
            }
            Item::Section { entries, .. } => {
                let last = entries.last().map_or(Span::default(), |last| ast.span(last.value));
                for entry in entries.iter().filter(|entry| entry.is_let) {
                    let later = |starts: &Vec<u32>| {
                        let next = starts.partition_point(|start| *start <= entry.name.span.start);
                        starts.get(next).is_some_and(|start| *start < last.end)
                    };
                    if !uses.get(&entry.name.symbol).is_some_and(later) {
                        warn("value", &entry.name, "use it in this block, or delete it");
                    }
                }
            }
            _ => {}
        }
    }
}
