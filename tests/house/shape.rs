//! Limits on the structure of crates: the number of modules in a dependency cycle, the size of types and the length of
//! functions. [`OVER`] lists the current violations; its numbers may only shrink.
//!
//! A module is a file with its inline modules. A module depends on the modules that define the names in its paths;
//! re-exports are followed. Declaring or re-exporting a module is no dependency. Test code counts only for the length
//! of functions.

mod measure;
mod scope;

use std::collections::{BTreeMap, BTreeSet};

use super::architecture::{assert_none, sources};
use measure::{Measure, Size, functions, knots};
use scope::Krate;

/// Maximum number of modules in a dependency cycle.
const KNOT_MAX: usize = 5;
const FIELDS_MAX: usize = 15;
/// Maximum number of methods in all inherent `impl` blocks of a type, in all files.
const METHODS_MAX: usize = 60;
/// Maximum number of lines of a function, from its signature to its closing brace.
const FUNCTION_MAX: usize = 80;

/// Current violations, one line each: the kind, the type, and the size. A cycle has the name of one of its files, given
/// by the end of the file's path. Lower a number when the size shrinks. Delete the line when the size is within the
/// limit.
const OVER: &[(Kind, &str, usize)] = &[];

/// The number of functions with more than [`FUNCTION_MAX`] lines. Lower the number when you split such a function.
const LONG_FUNCTIONS: usize = 1;

/// Plain records with more than [`FIELDS_MAX`] fields, each with a description. A record has only readable fields or
/// no methods.
const RECORDS: &[(&str, &str)] = &[
    ("OverlayContent", "the contents of the overlay in one frame"),
    ("PlayArguments", "the command line of `play`"),
    ("PlaySettings", "the settings of a run"),
    ("Scene", "a checked scene"),
    ("ShowState", "the state of the show, for controllers"),
    ("SongMoment", "the place of a moment in a song"),
    ("SongStructure", "the analysis of a song"),
    ("StillArguments", "the command line of `still`"),
    ("VideoArguments", "the command line of `video`"),
    ("VideoRequest", "the settings of a video"),
];
/// A record may have up to this many methods that read its fields.
const RECORD_METHODS_MAX: usize = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Modules,
    Fields,
    Methods,
}
use Kind::{Fields, Methods, Modules};

type Found = BTreeMap<(Kind, String), usize>;

fn texts() -> BTreeMap<String, String> {
    ["src", "crates", "tests", "benches"].into_iter().flat_map(sources).collect()
}

fn measures(texts: &BTreeMap<String, String>) -> Vec<Measure> {
    let is_root = |file: &str| {
        let inner =
            file.strip_prefix("crates/").and_then(|rest| rest.split_once('/')).map_or(file, |(_, rest)| rest);
        ["src/lib.rs", "src/main.rs"].contains(&inner)
    };
    let roots: Vec<&String> = texts.keys().filter(|file| is_root(file)).collect();
    assert!(roots.len() > 8, "found only {roots:?}");
    roots.into_iter().map(|root| Krate::read(root, texts).measure()).collect()
}

/// The name of a cycle is the entry of `rows` that names one of the cycle's files, or else the cycle's first file.
fn large_knots(measure: &Measure, rows: &[(Kind, &str, usize)]) -> Found {
    let large = knots(&measure.edges).into_iter().filter(|knot| knot.len() > KNOT_MAX);
    large
        .map(|knot| {
            let is_in_it = |name: &str| knot.iter().any(|file| file.ends_with(&format!("/{name}")));
            let row = rows.iter().find(|(kind, name, _)| *kind == Modules && is_in_it(name));
            let first = knot.first().map_or("", String::as_str);
            ((Modules, row.map_or(first, |(_, name, _)| name).to_owned()), knot.len())
        })
        .collect()
}

fn is_record(size: &Size) -> bool {
    size.methods.is_empty() || size.is_open && size.methods.len() <= RECORD_METHODS_MAX
}

/// If several types have the same name, the largest counts.
fn large_types(measure: &Measure) -> Found {
    let mut found = Found::new();
    for ((_, name), size) in &measure.types {
        let is_excused = RECORDS.iter().any(|(record, _)| record == name) && is_record(size);
        let sizes = [(Fields, size.fields.len(), FIELDS_MAX), (Methods, size.methods.len(), METHODS_MAX)];
        for (kind, count, most) in sizes {
            if count > most && !(kind == Fields && is_excused) {
                let largest = found.entry((kind, name.clone())).or_default();
                *largest = count.max(*largest);
            }
        }
    }
    found
}

fn differences(found: &Found, rows: &[(Kind, &str, usize)]) -> Vec<String> {
    let mut table = Found::new();
    for (kind, name, size) in rows {
        assert!(table.insert((*kind, (*name).to_owned()), *size).is_none(), "{name} has two rows");
    }
    let keys: BTreeSet<&(Kind, String)> = found.keys().chain(table.keys()).collect();
    let say = |key: &(Kind, String)| {
        let (kind, name) = key;
        let what = match kind {
            Modules => format!("the cycle of modules around {name}"),
            Fields => format!("the fields of {name}"),
            Methods => format!("the methods of {name}"),
        };
        match (found.get(key), table.get(key)) {
            (Some(now), None) => Some(format!("{what}: {now} are too many, split it")),
            (Some(now), Some(before)) if now > before => {
                Some(format!("{what}: {now} are more than the {before} of the table, remove the added ones"))
            }
            (Some(now), Some(before)) if now < before => {
                Some(format!("{what}: {now} are fewer than the {before} of the table, lower its number"))
            }
            (None, Some(_)) => Some(format!("{what}: now within the limit (or renamed), delete its row")),
            _ => None,
        }
    };
    keys.into_iter().filter_map(say).collect()
}

#[test]
fn cycles_and_types_stay_small() {
    let mut found = Found::new();
    let mut records = BTreeSet::new();
    for measure in measures(&texts()) {
        for (key, size) in large_knots(&measure, OVER).into_iter().chain(large_types(&measure)) {
            let largest = found.entry(key).or_default();
            *largest = size.max(*largest);
        }
        let large = measure.types.iter().filter(|(_, size)| size.fields.len() > FIELDS_MAX);
        records.extend(large.map(|((_, name), _)| name.clone()));
    }
    let advice = format!(
        "a cycle has at most {KNOT_MAX} modules, a type at most {FIELDS_MAX} fields and {METHODS_MAX} \
         methods (see OVER and RECORDS in tests/house/shape.rs)"
    );
    assert_none(&differences(&found, OVER), &advice);
    let stale: Vec<String> =
        RECORDS.iter().map(|(name, _)| (*name).to_owned()).filter(|name| !records.contains(name)).collect();
    assert_none(&stale, "these types are small enough now, delete their rows in RECORDS");
}

#[test]
fn functions_stay_short() {
    let mut long = Vec::new();
    for (file, text) in texts() {
        let of_file = functions(&file, &text).into_iter().filter(|(_, _, lines)| *lines > FUNCTION_MAX);
        long.extend(of_file.map(|(name, line, lines)| format!("{file}:{line}: {name} has {lines} lines")));
    }
    assert!(
        long.len() <= LONG_FUNCTIONS,
        "more than {LONG_FUNCTIONS} functions have over {FUNCTION_MAX} lines, split one of them:\n  {}",
        long.join("\n  ")
    );
    let count = long.len();
    assert!(count == LONG_FUNCTIONS, "only {count} functions are too long now: lower LONG_FUNCTIONS to that");
}

fn made_up(files: &[(&str, &str)]) -> Measure {
    let texts = files.iter().map(|(file, text)| (format!("src/{file}"), (*text).to_owned())).collect();
    Krate::read("src/lib.rs", &texts).measure()
}

#[test]
fn a_cycle_of_six_is_found_and_one_of_five_is_not() {
    let files = |declared: &'static str, last: &'static str| {
        made_up(&[
            ("lib.rs", declared),
            ("a.rs", "use crate::b::B; pub struct A;"),
            ("b.rs", "pub struct B(super::c::C);"),
            ("c.rs", "pub struct C; fn f() { let d = crate::d::D {}; }"),
            ("d.rs", "pub struct D; fn f() -> u8 { std::cmp::max(0, super::e::VALUE) }"),
            ("e.rs", "pub const VALUE: u8 = 0; fn f() { assert_eq!(1, super::f::one()); }"),
            ("f.rs", last),
        ])
    };
    let declared = "mod a; mod b; mod c; mod d; mod e; mod f; pub use a::A; use f::one;";
    let six = large_knots(&files(declared, "pub fn one() { let _ = crate::A; }"), &[]);
    assert_eq!(six, Found::from([((Modules, "src/a.rs".to_owned()), 6)]));
    let five = large_knots(&files(declared, "pub fn one() { let _ = crate::b::B; }"), &[]);
    assert_eq!(five, Found::new());
    // Neither imports of tests nor names in string literals count.
    let open = "pub fn one() { let _ = \"crate::A\"; } #[cfg(test)] mod tests { use crate::a::A; }";
    assert_eq!(large_knots(&files(declared, open), &[]), Found::new());
}

#[test]
fn edges_lead_to_the_defining_module() {
    let edges = made_up(&[
        ("lib.rs", "mod deep; mod user; mod other; pub use deep::*;"),
        ("deep/mod.rs", "mod inner; mod glob; pub use inner::{Thing as Renamed}; pub use glob::*;"),
        ("deep/inner.rs", "pub struct Thing; impl super::super::other::Other { fn two(&self) {} }"),
        ("deep/glob.rs", "pub fn of_glob() {}"),
        ("other.rs", "pub struct Other { pub a: u8, pub(crate) b: u8 } impl Other { fn one(&self) {} }"),
        ("user.rs", "mod inline { use super::super::deep::Renamed; } fn f() { crate::of_glob(); }"),
    ]);
    let of = |file: &str| edges.edges[file].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(of("src/user.rs"), ["src/deep/glob.rs", "src/deep/inner.rs"]);
    assert_eq!(of("src/lib.rs"), [""; 0]);
    assert_eq!(of("src/deep/mod.rs"), [""; 0]);
    let size = &edges.types[&("src/other.rs".to_owned(), "Other".to_owned())];
    assert_eq!((size.fields.len(), size.methods.len(), size.is_open), (2, 2, true));
}

#[test]
fn methods_of_a_type_are_counted_in_all_files() {
    let methods = |from: usize, to: usize| -> String {
        let all: Vec<String> = (from..to).map(|i| format!("fn m{i}(&self) {{}}")).collect();
        format!("{} #[cfg(test)] fn only_for_tests() {{}}", all.join(" "))
    };
    let with = |fields: usize, count: usize| {
        let fields: Vec<String> = (0..fields).map(|i| format!("f{i}: u8")).collect();
        let lib = format!(
            "mod far; pub struct Large {{ {} }} impl Large {{ {} }}",
            fields.join(", "),
            methods(0, 30)
        );
        let far = format!("use super::Large; impl Large {{ {} }}", methods(30, count));
        large_types(&made_up(&[("lib.rs", &lib), ("far.rs", &far)]))
    };
    assert_eq!(with(15, 60), Found::new());
    assert_eq!(with(16, 60), Found::from([((Fields, "Large".to_owned()), 16)]));
    assert_eq!(with(15, 61), Found::from([((Methods, "Large".to_owned()), 61)]));
}

#[test]
fn the_table_must_match() {
    let found = Found::from([((Fields, "Large".to_owned()), 20), ((Modules, "src/a.rs".to_owned()), 7)]);
    assert_eq!(differences(&found, &[(Fields, "Large", 20), (Modules, "src/a.rs", 7)]), [""; 0]);
    let wrong = |rows: &[(Kind, &str, usize)]| differences(&found, rows).join("; ");
    let knot = (Modules, "src/a.rs", 7);
    assert!(wrong(&[knot]).contains("the fields of Large: 20 are too many"));
    assert!(wrong(&[knot, (Fields, "Large", 19)]).contains("more than the 19 of the table"));
    assert!(wrong(&[knot, (Fields, "Large", 21)]).contains("lower its number"));
    assert!(wrong(&[knot, (Fields, "Large", 20), (Fields, "Gone", 20)]).contains("delete its row"));
}

#[test]
fn lines_of_functions_are_counted() {
    let text = "struct A;\nimpl A {\n    /// A comment.\n    fn one(\n        &self,\n    ) {\n    }\n}\nfn two() {}\n";
    let expected = [("one".to_owned(), 4, 4), ("two".to_owned(), 9, 1)];
    assert_eq!(functions("a.rs", text), expected);
}
