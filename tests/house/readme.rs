//! Checks that the README and the book in `docs/` match the program, and that their links work.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mariana::commands::{Group, bindings_of};
use mariana::session::controllers::sent_addresses;
use mariana_control::action::ValueType;
use mariana_control::osc::fixed_addresses;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn page(name: &str) -> String {
    read(&root().join("docs").join(name))
}

fn pages() -> Vec<PathBuf> {
    let files = fs::read_dir(root().join("docs")).into_iter().flatten().flatten().map(|entry| entry.path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect()
}

fn links(text: &str) -> impl Iterator<Item = &str> {
    text.split("](").skip(1).filter_map(|rest| rest.split(')').next())
}

fn anchors(text: &str) -> Vec<String> {
    let anchor = |heading: &str| {
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
        kept.collect::<String>().to_lowercase().replace(' ', "-")
    };
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#').trim())).collect()
}

/// The keys of each group as Markdown rows.
fn key_table() -> String {
    let of_group = |group: Group| {
        let rows = bindings_of(group).map(|binding| format!("| {} | {} |\n", binding.written, binding.help));
        format!("### {}\n\n| key | what it does |\n|---|---|\n{}", group.name(), rows.collect::<String>())
    };
    Group::ALL.map(of_group).join("\n")
}

#[test]
fn keys_match_the_program() {
    let table = key_table();
    assert!(page("reference.md").contains(&table), "docs/reference.md should have this table:\n{table}");
}

/// The addresses of parameters, scenes and queries as Markdown rows.
fn address_table() -> String {
    let mut text = String::from("| address | arguments | what it does |\n|---|---|---|\n");
    for (address, arguments, meaning) in fixed_addresses() {
        text.push_str(&format!("| `{address}` | {arguments} | {meaning} |\n"));
    }
    text
}

/// The actions as Markdown rows.
fn action_table() -> String {
    let mut text = String::from("| address | arguments | what it does |\n|---|---|---|\n");
    for row in mariana::commands::for_controllers() {
        let arguments = match row.takes {
            ValueType::Press => "",
            ValueType::Switch => "1 on, 0 off; toggles without an argument",
            ValueType::Level => "0..1",
            ValueType::Number => "a number",
            ValueType::Choice => "a name, or a number from 1",
            ValueType::Index(_) => "a number from 1",
        };
        text.push_str(&format!("| `/{}` | {arguments} | {} |\n", row.name, row.meaning));
    }
    text
}

#[test]
fn osc_addresses_match_the_program() {
    let page = page("osc.md");
    let sent: Vec<String> = sent_addresses().map(|address| format!("`{address}`")).collect();
    let parts = [address_table(), action_table(), sent.join(", ")];
    let missing: Vec<String> = parts.into_iter().filter(|part| !page.contains(part)).collect();
    assert!(missing.is_empty(), "docs/osc.md should have this:\n{}", missing.join("\n"));
}

#[test]
fn reference_names_every_subcommand() {
    let output = Command::new(env!("CARGO_BIN_EXE_mariana")).arg("--help").output().unwrap();
    let help = String::from_utf8(output.stdout).unwrap();
    let commands = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let names: Vec<&str> = commands.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"still"), "the help lists no commands: {help}");
    let reference = page("reference.md");
    for name in names.into_iter().filter(|name| *name != "help") {
        assert!(reference.contains(&format!("`mariana {name}")), "docs/reference.md does not name {name}");
    }
}

#[test]
fn links_have_targets() {
    let mut checked = 0;
    for file in pages().into_iter().chain([root().join("README.md")]) {
        let text = read(&file);
        for link in links(&text).filter(|link| !link.starts_with("http")) {
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            assert!(target.exists(), "{} links to {link}, which does not exist", file.display());
            let exists = anchor.is_empty() || anchors(&read(&target)).iter().any(|known| known == anchor);
            assert!(exists, "{} links to {link}, but there is no such heading", file.display());
            checked += 1;
        }
    }
    assert!(checked >= 50, "only {checked} links were found");
}

#[test]
fn the_book_has_every_page() {
    let summary = page("SUMMARY.md");
    for path in pages() {
        let name = path.file_name().unwrap().to_str().unwrap();
        let is_listed = links(&summary).any(|link| link == name);
        assert!(is_listed || name == "SUMMARY.md", "docs/SUMMARY.md does not list {name}");
    }
}

/// Skipped if mdbook is not installed, because not every distribution packages it.
#[test]
fn mdbook_builds_the_book() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new("mdbook");
    command.arg("build").arg("--dest-dir").arg(folder.path()).arg(root().join("docs"));
    let output = match command.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("mdbook is not installed: skipping the book");
            return;
        }
        result => result.unwrap(),
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.path().join("reference.html").is_file(), "mdbook wrote no reference.html");
}
