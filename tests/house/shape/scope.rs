//! Reads the modules of a crate from its sources with `syn`: the names that each module defines, imports and
//! re-exports. Finds the module that defines the item of a path. Skips test code.

use std::collections::{BTreeMap, HashMap, HashSet};

use syn::{Attribute, Item, Meta, UseTree};

/// Maximum number of re-exports that are followed one after the other.
const DEPTH_MAX: usize = 24;

/// The index of a module in [`Krate::modules`].
pub(super) type Id = usize;

pub(super) struct Module {
    pub(super) file: String,
    parent: Option<Id>,
    children: HashMap<String, Id>,
    items: HashSet<String>,
    /// Imported names, each with its path.
    imports: HashMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    /// The items of the module, without submodules and test code.
    pub(super) code: Vec<Item>,
}

/// All modules of a crate. The root is the first.
pub(super) struct Krate {
    pub(super) modules: Vec<Module>,
}

/// The item that a path names; `name` is `None` for a module.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Target {
    pub(super) module: Id,
    pub(super) name: Option<String>,
}

impl Krate {
    /// Reads the crate with the root file `root`. `texts` contains all files.
    pub(super) fn read(root: &str, texts: &BTreeMap<String, String>) -> Self {
        let mut krate = Self { modules: Vec::new() };
        let folder = root.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
        let text = texts.get(root).unwrap_or_else(|| panic!("no {root}"));
        krate.add(root, &folder, None, parse(root, text), texts);
        krate
    }

    fn add(
        &mut self,
        file: &str,
        folder: &str,
        parent: Option<Id>,
        items: Vec<Item>,
        texts: &BTreeMap<String, String>,
    ) -> Id {
        let id = self.modules.len();
        self.modules.push(Module {
            file: file.to_owned(),
            parent,
            children: HashMap::new(),
            items: HashSet::new(),
            imports: HashMap::new(),
            globs: Vec::new(),
            code: Vec::new(),
        });
        let mut code = Vec::new();
        for item in items {
            if attributes(&item).iter().any(is_for_tests) {
                continue;
            }
            let Item::Mod(module) = item else {
                code.push(item);
                continue;
            };
            let name = module.ident.to_string();
            let inner = format!("{folder}/{name}");
            let child = if let Some((_, items)) = module.content {
                self.add(file, &inner, Some(id), items, texts)
            } else {
                let (file, folder) = file_of(&module.attrs, file, folder, &name, texts);
                let items = parse(&file, &texts[&file]);
                self.add(&file, &folder, Some(id), items, texts)
            };
            self.modules[id].children.entry(name).or_insert(child);
        }
        let mut scope = Scope { module: &mut self.modules[id] };
        for item in &code {
            scope.note(item);
        }
        self.modules[id].code = code;
        id
    }

    /// Finds the item of this crate that `path` names in module `from`; `None` if it is not in this crate.
    pub(super) fn resolve(&self, from: Id, path: &[String]) -> Option<Target> {
        self.follow(from, path, DEPTH_MAX)
    }

    fn follow(&self, from: Id, path: &[String], depth: usize) -> Option<Target> {
        let depth = depth.checked_sub(1)?;
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Target { module: 0, name: None },
            "self" => Target { module: from, name: None },
            "super" => Target { module: self.modules[from].parent?, name: None },
            name => self.lookup(from, name, rest.is_empty(), depth)?,
        };
        while let Some((next, behind)) = rest.split_first() {
            if at.name.is_some() {
                break;
            }
            rest = behind;
            at = if next == "super" {
                Target { module: self.modules[at.module].parent?, name: None }
            } else {
                // Definitions by macros are not visible here, so the named module is assumed to define the item.
                let unseen = Target { module: at.module, name: Some(next.clone()) };
                self.lookup(at.module, next, rest.is_empty(), depth).unwrap_or(unseen)
            };
        }
        Some(at)
    }

    /// Finds `name` in `module`. At the end of a path, an item takes precedence over a module with the same name.
    fn lookup(&self, module: Id, name: &str, is_last: bool, depth: usize) -> Option<Target> {
        let here = &self.modules[module];
        let item = here.items.contains(name).then(|| Target { module, name: Some(name.to_owned()) });
        let child = here.children.get(name).map(|child| Target { module: *child, name: None });
        let own = if is_last { item.or(child) } else { child.or(item) };
        let imported =
            || here.imports.get(name).and_then(|path| self.follow_import(module, name, path, depth));
        let from_globs = || {
            here.globs.iter().find_map(|path| {
                let depth = depth.checked_sub(1)?;
                let from = self.follow(module, path, depth)?;
                // An enum's variants are in the enum's module, to which there is a dependency already.
                from.name.is_none().then(|| self.lookup(from.module, name, is_last, depth))?
            })
        };
        own.or_else(imported).or_else(from_globs)
    }

    /// In a module without a submodule `error`, both `use error::Error` and `use error` refer to a crate. Following
    /// such imports would recurse endlessly.
    fn follow_import(&self, module: Id, name: &str, path: &[String], depth: usize) -> Option<Target> {
        let is_itself = path.first().is_some_and(|first| first == name);
        if is_itself && !self.modules[module].children.contains_key(name) {
            return None;
        }
        self.follow(module, path, depth)
    }
}

struct Scope<'a> {
    module: &'a mut Module,
}

impl Scope<'_> {
    fn note(&mut self, item: &Item) {
        let name = match item {
            Item::Const(i) => Some(&i.ident),
            Item::Enum(i) => Some(&i.ident),
            Item::Fn(i) => Some(&i.sig.ident),
            Item::Macro(i) => i.ident.as_ref(),
            Item::Static(i) => Some(&i.ident),
            Item::Struct(i) => Some(&i.ident),
            Item::Trait(i) => Some(&i.ident),
            Item::TraitAlias(i) => Some(&i.ident),
            Item::Type(i) => Some(&i.ident),
            Item::Union(i) => Some(&i.ident),
            _ => None,
        };
        self.module.items.extend(name.map(ToString::to_string));
        syn::visit::Visit::visit_item(self, item);
    }
}

impl<'ast> syn::visit::Visit<'ast> for Scope<'_> {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        for import in imports_of(&item.tree) {
            match import.name {
                Some(name) => {
                    self.module.imports.entry(name).or_insert(import.path);
                }
                None => self.module.globs.push(import.path),
            }
        }
    }
}

/// A name imported by a `use`; `None` for a glob import of all names in `path`.
pub(super) struct Import {
    name: Option<String>,
    pub(super) path: Vec<String>,
}

pub(super) fn imports_of(tree: &UseTree) -> Vec<Import> {
    let mut found = Vec::new();
    collect_imports(tree, &mut Vec::new(), &mut found);
    found
}

fn collect_imports(tree: &UseTree, before: &mut Vec<String>, found: &mut Vec<Import>) {
    let with = |last: &str| {
        let mut path = before.clone();
        if last != "self" || path.is_empty() {
            path.push(last.to_owned());
        }
        path
    };
    match tree {
        UseTree::Path(inner) => {
            before.push(inner.ident.to_string());
            collect_imports(&inner.tree, before, found);
            before.pop();
        }
        UseTree::Name(name) => {
            let path = with(&name.ident.to_string());
            found.push(Import { name: path.last().cloned(), path });
        }
        UseTree::Rename(rename) => {
            let path = with(&rename.ident.to_string());
            found.push(Import { name: Some(rename.rename.to_string()), path });
        }
        UseTree::Glob(_) => found.push(Import { name: None, path: before.clone() }),
        UseTree::Group(group) => {
            for inner in &group.items {
                collect_imports(inner, before, found);
            }
        }
    }
}

/// The file of `mod name;`, and the folder of its submodules.
fn file_of(
    attributes: &[Attribute],
    parent: &str,
    folder: &str,
    name: &str,
    texts: &BTreeMap<String, String>,
) -> (String, String) {
    if let Some(path) = attributes.iter().find_map(path_attribute) {
        let beside = parent.rsplit_once('/').map_or("", |(folder, _)| folder);
        let file = format!("{beside}/{path}");
        assert!(
            texts.contains_key(&file),
            "{parent} declares the module {name} in {file}, which does not exist"
        );
        return (file, beside.to_owned());
    }
    let [flat, deep] = [format!("{folder}/{name}.rs"), format!("{folder}/{name}/mod.rs")];
    let file = if texts.contains_key(&flat) { flat } else { deep };
    assert!(texts.contains_key(&file), "{parent} declares the module {name}, which has no file");
    (file, format!("{folder}/{name}"))
}

fn path_attribute(attribute: &Attribute) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else { return None };
    let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &pair.value else { return None };
    pair.path.is_ident("path").then(|| text.value())
}

fn parse(file: &str, text: &str) -> Vec<Item> {
    syn::parse_file(text).unwrap_or_else(|error| panic!("{file}: {error}")).items
}

/// True if an attribute compiles its item for tests only: `test`, `cfg(test)` or `cfg(all(test, ...))`.
pub(super) fn is_for_tests(attribute: &Attribute) -> bool {
    attribute.path().is_ident("test")
        || attribute.path().is_ident("cfg")
            && attribute.parse_args::<Meta>().is_ok_and(|condition| demands_tests(&condition))
}

fn demands_tests(condition: &Meta) -> bool {
    let inner = |list: &syn::MetaList| {
        let conditions =
            list.parse_args_with(syn::punctuated::Punctuated::<Meta, syn::Token![,]>::parse_terminated);
        conditions.map(|all| all.iter().map(demands_tests).collect::<Vec<_>>()).unwrap_or_default()
    };
    match condition {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("all") => inner(list).contains(&true),
        Meta::List(list) if list.path.is_ident("any") => {
            let inner = inner(list);
            !inner.is_empty() && !inner.contains(&false)
        }
        _ => false,
    }
}

pub(super) fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::ExternCrate(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::ForeignMod(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::TraitAlias(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Union(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}
