//! README says what the program does: its tables are those of the code.

use std::process::Command;

const README: &str = include_str!("../../README.md");

#[test]
fn the_keys_are_those_of_the_program() {
    let table = mariana::commands::markdown_table();
    assert!(README.contains(&table), "README.md's table of keys should read:\n{table}");
}

#[test]
fn the_addresses_of_osc_are_those_of_the_program() {
    use mariana::session::controllers::page::{action_table, address_table, sent_line};
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/osc.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let parts = [address_table(), action_table(), sent_line()];
    let missing: Vec<String> = parts.into_iter().filter(|part| !page.contains(part)).collect();
    assert!(missing.is_empty(), "docs/osc.md should read:\n{}", missing.join("\n"));
}

#[test]
fn every_subcommand_is_named() {
    let output = Command::new(env!("CARGO_BIN_EXE_mariana")).arg("--help").output().unwrap();
    let help = String::from_utf8(output.stdout).unwrap();
    let commands = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let names: Vec<&str> = commands.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"still"), "the help lists no commands: {help}");
    for name in names.into_iter().filter(|name| *name != "help") {
        assert!(README.contains(&format!("`mariana {name}")), "README.md does not name {name}");
    }
}

#[test]
fn files_that_it_points_to_are_there() {
    let links = README.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let mut checked = 0;
    for link in links.filter(|link| !link.starts_with("http")) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(link);
        assert!(path.is_file(), "README.md points to {link}, which is not there");
        checked += 1;
    }
    assert!(checked >= 5, "README.md's links were not found");
}
