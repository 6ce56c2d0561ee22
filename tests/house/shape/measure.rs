//! Measures a crate: the dependencies between modules, the cycles of these dependencies, and the sizes of types.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use super::scope::{Id, Krate, attributes, imports_of, is_for_tests};

/// The size of a type: the number of its fields (0 for an enum), and of its methods in all inherent `impl` blocks of
/// the crate.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) fields: BTreeSet<String>,
    pub(super) methods: BTreeSet<String>,
    /// True if every field can be read from outside the module.
    pub(super) is_open: bool,
}

#[derive(Debug, Default)]
pub(super) struct Measure {
    /// The files on which each file depends, by path.
    pub(super) edges: BTreeMap<String, BTreeSet<String>>,
    /// The sizes of types, by file and name.
    pub(super) types: BTreeMap<(String, String), Size>,
}

impl Krate {
    pub(super) fn measure(&self) -> Measure {
        let mut measure = Measure::default();
        for (id, module) in self.modules.iter().enumerate() {
            measure.edges.entry(module.file.clone()).or_default();
            let mut walk = Walk { krate: self, module: id, measure: &mut measure };
            for item in &module.code {
                walk.visit_item(item);
            }
        }
        measure
    }
}

struct Walk<'a> {
    krate: &'a Krate,
    module: Id,
    measure: &'a mut Measure,
}

impl Walk<'_> {
    fn file(&self) -> &str {
        &self.krate.modules[self.module].file
    }

    fn name(&mut self, path: &[String]) {
        let Some(target) = self.krate.resolve(self.module, path) else { return };
        // A path of one word that equals a module's name is a variable: a module alone is neither a value nor a type.
        if path.len() == 1 && target.name.is_none() {
            return;
        }
        let to = &self.krate.modules[target.module].file;
        if to != self.file() {
            self.measure.edges.entry(self.file().to_owned()).or_default().insert(to.clone());
        }
    }

    /// Finds the paths in a macro's arguments, which are tokens without a syntax tree.
    fn name_tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let word = |at: usize| match tokens.get(at) {
            Some(TokenTree::Ident(word)) => Some(word.to_string()),
            _ => None,
        };
        let is = |at: usize, mark: char| matches!(tokens.get(at), Some(TokenTree::Punct(p)) if p.as_char() == mark);
        let mut at = 0;
        while at < tokens.len() {
            if let TokenTree::Group(group) = &tokens[at] {
                self.name_tokens(group.stream());
            }
            let before = at.checked_sub(1);
            let is_member = before.is_some_and(|before| is(before, '.') || is(before, ':'));
            let mut path: Vec<String> = word(at).into_iter().collect();
            at += 1;
            while !path.is_empty() && is(at, ':') && is(at + 1, ':') {
                let Some(next) = word(at + 2) else { break };
                path.push(next);
                at += 3;
            }
            // A word after a single dot is a field or a method. A word after `name:` or `0..` is a path.
            let is_range = before.is_some_and(|before| before > 0 && is(before, '.') && is(before - 1, '.'));
            let is_typed =
                before.is_some_and(|before| is(before, ':') && (before == 0 || !is(before - 1, ':')));
            if !path.is_empty() && (!is_member || is_range || is_typed) {
                self.name(&path);
            }
        }
    }

    fn size(&mut self, name: &str) -> &mut Size {
        let key = (self.file().to_owned(), name.to_owned());
        self.measure.types.entry(key).or_default()
    }
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !attributes(item).iter().any(is_for_tests) {
            visit::visit_item(self, item);
        }
    }

    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        // A re-export adds no dependency. The module that uses the name gets one.
        if !matches!(item.vis, syn::Visibility::Inherited) {
            return;
        }
        for import in imports_of(&item.tree) {
            if let Some(target) = self.krate.resolve(self.module, &import.path) {
                let to = &self.krate.modules[target.module].file;
                if to != self.file() {
                    self.measure.edges.entry(self.file().to_owned()).or_default().insert(to.clone());
                }
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let words: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.name(&words);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        visit::visit_macro(self, invocation);
        self.name_tokens(invocation.tokens.clone());
    }

    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        let fields = item.fields.iter().enumerate().map(|(place, field)| {
            field.ident.as_ref().map_or_else(|| place.to_string(), ToString::to_string)
        });
        let fields: Vec<String> = fields.collect();
        let is_open = item.fields.iter().all(|field| !matches!(field.vis, syn::Visibility::Inherited));
        let size = self.size(&item.ident.to_string());
        size.fields.extend(fields);
        size.is_open = is_open;
        visit::visit_item_struct(self, item);
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if let (None, syn::Type::Path(of)) = (&item.trait_, &*item.self_ty) {
            let words: Vec<String> =
                of.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            if let Some((module, name)) =
                self.krate.resolve(self.module, &words).and_then(|target| Some((target.module, target.name?)))
            {
                let methods = item.items.iter().filter_map(|inner| match inner {
                    syn::ImplItem::Fn(method) if !method.attrs.iter().any(is_for_tests) => {
                        Some(method.sig.ident.to_string())
                    }
                    _ => None,
                });
                let key = (self.krate.modules[module].file.clone(), name);
                self.measure.types.entry(key).or_default().methods.extend(methods);
            }
        }
        visit::visit_item_impl(self, item);
    }

    fn visit_impl_item_fn(&mut self, method: &'ast syn::ImplItemFn) {
        if !method.attrs.iter().any(is_for_tests) {
            visit::visit_impl_item_fn(self, method);
        }
    }
}

/// Cycles: sets of two or more files that depend on each other, the largest first.
pub(super) fn knots(edges: &BTreeMap<String, BTreeSet<String>>) -> Vec<BTreeSet<String>> {
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        edges.keys().map(|from| (from.as_str(), reachable(edges, from))).collect();
    let mut knots: Vec<BTreeSet<String>> = Vec::new();
    for (from, reached) in &reach {
        let knot: BTreeSet<String> =
            reached.iter().filter(|to| reach[*to].contains(from)).map(|to| (*to).to_owned()).collect();
        if knot.len() > 1 && !knots.contains(&knot) {
            knots.push(knot);
        }
    }
    knots.sort_by_key(|knot| std::cmp::Reverse(knot.len()));
    knots
}

fn reachable<'a>(edges: &'a BTreeMap<String, BTreeSet<String>>, from: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut ahead: Vec<&'a str> = edges[from].iter().map(String::as_str).collect();
    while let Some(file) = ahead.pop() {
        if reached.insert(file) {
            ahead.extend(edges[file].iter().map(String::as_str));
        }
    }
    reached
}

/// The functions of a file, including tests: the name, the line of the signature, and the number of lines from the
/// signature to the closing brace.
pub(super) fn functions(file: &str, text: &str) -> Vec<(String, usize, usize)> {
    let parsed = syn::parse_file(text).unwrap_or_else(|error| panic!("{file}: {error}"));
    let mut lengths = Lengths(Vec::new());
    lengths.visit_file(&parsed);
    lengths.0
}

struct Lengths(Vec<(String, usize, usize)>);

impl Lengths {
    fn note(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let first = signature.fn_token.span().start().line;
        let last = block.brace_token.span.close().end().line;
        self.0.push((signature.ident.to_string(), first, last + 1 - first));
    }
}

impl<'ast> Visit<'ast> for Lengths {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.note(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, method: &'ast syn::ImplItemFn) {
        self.note(&method.sig, &method.block);
        visit::visit_impl_item_fn(self, method);
    }

    fn visit_trait_item_fn(&mut self, method: &'ast syn::TraitItemFn) {
        if let Some(block) = &method.default {
            self.note(&method.sig, block);
        }
        visit::visit_trait_item_fn(self, method);
    }
}
