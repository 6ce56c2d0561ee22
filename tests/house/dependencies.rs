//! Rules for dependencies: allowed licences, one version of each crate, and profiles without rows of unused crates. The
//! lists are in deny.toml, which `cargo deny` also reads.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

fn read(file: &str) -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}")).parse().unwrap()
}

fn texts(value: &toml::Value) -> BTreeSet<String> {
    value.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// Returns the name and licence of each crate, from cargo: the crates for all systems if these are available offline,
/// otherwise only the crates for this system.
fn licences() -> Vec<(String, String)> {
    let ask = |more: &[&str]| {
        let run = Command::new(env!("CARGO"))
            .args(["metadata", "--offline", "--locked", "--format-version", "1"])
            .args(more)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .expect("cargo must run this test");
        if run.status.success() {
            Ok(run.stdout)
        } else {
            Err(String::from_utf8_lossy(&run.stderr).into_owned())
        }
    };
    let about = Command::new("rustc").arg("-vV").output().expect("rustc must be installed").stdout;
    let about = String::from_utf8(about).unwrap();
    let host = about.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc prints its host");
    let output =
        ask(&[]).or_else(|_| ask(&["--filter-platform", host])).unwrap_or_else(|error| panic!("{error}"));
    let metadata: serde_json::Value = serde_json::from_slice(&output).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let of = |package: &serde_json::Value| {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        (format!("{} {}", text("name"), text("version")), text("license"))
    };
    packages.iter().map(of).collect()
}

/// True if an SPDX expression can be satisfied with the allowed licences. AND binds tighter than OR; old manifests
/// write `/` for OR.
fn fits(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut at = 0;
    let fits = either(&words, &mut at, allowed);
    fits && at == words.len()
}

fn either(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut any = both(words, at, allowed);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        any |= both(words, at, allowed);
    }
    any
}

fn both(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut all = one(words, at, allowed);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        all &= one(words, at, allowed);
    }
    all
}

fn one(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let Some(word) = words.get(*at) else { return false };
    *at += 1;
    if *word == "(" {
        let inner = either(words, at, allowed);
        let closed = words.get(*at) == Some(&")");
        *at += 1;
        return inner && closed;
    }
    if words.get(*at) == Some(&"WITH") {
        *at += 2;
        return allowed.contains(&format!("{word} WITH {}", words.get(*at - 1).unwrap_or(&"")));
    }
    allowed.contains(*word)
}

#[test]
fn every_licence_is_allowed() {
    let allowed = texts(&read("deny.toml")["licenses"]["allow"]);
    let licences = licences();
    assert!(licences.len() > 150, "found only {} crates", licences.len());
    let wrong: Vec<String> = licences
        .iter()
        .filter(|(_, licence)| !fits(licence, &allowed))
        .map(|(name, licence)| format!("{name}: {licence}"))
        .collect();
    assert!(wrong.is_empty(), "deny.toml allows none of these licences:\n  {}", wrong.join("\n  "));
}

#[test]
fn spdx_expressions_are_evaluated() {
    let allowed = BTreeSet::from(["MIT".to_owned(), "ISC".to_owned()]);
    for (expression, wanted) in [
        ("MIT", true),
        ("GPL-3.0-only", false),
        ("", false),
        ("GPL-2.0-only OR MIT", true),
        ("GPL-2.0-only/MIT", true),
        ("GPL-2.0-only AND MIT", false),
        ("MIT AND ISC OR GPL-2.0-only", true),
        ("GPL-2.0-only AND (MIT OR ISC)", false),
        ("(MIT OR GPL-2.0-only) AND ISC", true),
        ("MIT AND (ISC", false),
        ("MIT ISC", false),
        ("Apache-2.0 WITH LLVM-exception OR MIT", true),
        ("MIT WITH something", false),
    ] {
        assert_eq!(fits(expression, &allowed), wanted, "{expression}");
    }
}

#[test]
fn duplicate_crates_have_reasons() {
    let deny = read("deny.toml");
    let skipped: BTreeSet<&str> = deny["bans"]["skip"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| {
            assert!(!row["reason"].as_str().unwrap().is_empty());
            row["crate"].as_str().unwrap()
        })
        .collect();
    let lock = read("Cargo.lock");
    let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for package in lock["package"].as_array().unwrap() {
        versions
            .entry(package["name"].as_str().unwrap())
            .or_default()
            .push(package["version"].as_str().unwrap());
    }
    let of = |name: &str, version: &str| format!("{name}@{version}");
    let (mut wrong, mut used) = (Vec::new(), BTreeSet::new());
    for (name, versions) in versions.iter().filter(|(_, versions)| versions.len() > 1) {
        let (known, new): (Vec<String>, Vec<String>) =
            versions.iter().map(|version| of(name, version)).partition(|row| skipped.contains(row.as_str()));
        used.extend(known);
        if new.len() > 1 {
            wrong.push(new.join(" and "));
        }
    }
    assert!(
        wrong.is_empty(),
        "use one version, or add a row with a reason to deny.toml:\n  {}",
        wrong.join("\n  ")
    );
    let idle: Vec<&&str> = skipped.iter().filter(|row| !used.contains(**row)).collect();
    assert!(idle.is_empty(), "delete these unused rows of deny.toml: {idle:?}");
}

#[test]
fn profiles_name_crates_that_are_used() {
    let (manifest, lock) = (read("Cargo.toml"), read("Cargo.lock"));
    let packages = lock["package"].as_array().unwrap();
    let used: BTreeSet<&str> = packages.iter().map(|package| package["name"].as_str().unwrap()).collect();
    for (profile, settings) in manifest["profile"].as_table().unwrap() {
        let Some(crates) = settings.get("package") else { continue };
        for name in crates.as_table().unwrap().keys().filter(|name| *name != "*") {
            assert!(used.contains(name.as_str()), "{name} is not used: delete its row in profile.{profile}");
        }
    }
}
