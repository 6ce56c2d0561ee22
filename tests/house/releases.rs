//! Rules for releases: workflows, addresses, and packages for crates.io.

#![allow(clippy::unwrap_used)]

use std::path::{Component, Path, PathBuf};
use std::process::Command;

use mariana_testing::process::output_of;
use serde_json::Value;

use crate::architecture::{assert_none, files_under, read, root, sources};

/// Reads a YAML file with Ruby, whose parser reads YAML 1.1 like GitHub's.
fn yaml(file: &str) -> Value {
    let script = "puts JSON.generate(YAML.load_file(ARGV[0]))";
    let mut command = Command::new("ruby");
    command.args(["-ryaml", "-rjson", "-e", script]).arg(root().join(file));
    let json = output_of(&mut command, "ruby").unwrap_or_else(|error| panic!("{file}: {error}"));
    serde_json::from_slice(&json).unwrap()
}

fn steps(workflow: &Value) -> Vec<(String, &Value)> {
    let jobs = workflow["jobs"].as_object().unwrap();
    let steps = jobs.iter().flat_map(|(name, job)| {
        job["steps"].as_array().unwrap().iter().map(move |step| (name.clone(), step))
    });
    steps.collect()
}

/// Returns the reason why a step may not be in a workflow.
fn fault(step: &Value, text: &str) -> Option<String> {
    if let Some(action) = step["uses"].as_str() {
        let Some((name, commit)) = action.split_once('@') else {
            return Some(format!("{action} has no version"));
        };
        let is_commit = commit.len() == 40 && commit.bytes().all(|byte| byte.is_ascii_hexdigit());
        let uses = format!("uses: {action}");
        if !is_commit || text.matches(&uses).count() != text.matches(&format!("{uses} # v")).count() {
            return Some(format!("{action}: name the commit, and the version in a comment"));
        }
        // Only GitHub's own actions, so that there is one publisher to trust.
        return (!name.starts_with("actions/")).then(|| format!("{action} is not an action of GitHub"));
    }
    let run = step["run"].as_str().unwrap_or_default();
    let script = run.split(' ').next().unwrap_or_default();
    let is_script =
        (script.starts_with(".ci/") || script.starts_with("scripts/")) && root().join(script).is_file();
    if !is_script || run.contains(['\n', ';', '&', '|', '`']) || run.contains("$(") {
        return Some(format!("'{run}' is not one call of a script"));
    }
    // An expression is pasted into the command line. Only values of the workflow itself are safe there.
    let pasted = run.split("${{").skip(1).find(|rest| !rest.trim_start().starts_with("matrix."));
    pasted.map(|_| format!("'{run}' contains an expression: give it as an environment variable"))
}

#[test]
fn workflows_call_scripts_and_pin_actions() {
    let files = files_under(".github/workflows");
    assert!(files.len() >= 2, "{files:?}");
    let mut found = Vec::new();
    for file in files {
        let (workflow, text) = (yaml(&file), read(&file));
        // Each job has only the permissions that it requests.
        if workflow["permissions"] != serde_json::json!({}) {
            found.push(format!("{file}: write 'permissions: {{}}' at its top"));
        }
        for (name, job) in workflow["jobs"].as_object().unwrap() {
            let permissions = job["permissions"].as_object();
            let writes = permissions.is_some_and(|all| all.values().any(|access| access != "read"));
            if permissions.is_none() || writes && name != "publish" {
                found.push(format!("{file}: {name} needs permissions, and only publish may write"));
            }
            if job["timeout-minutes"].as_u64().is_none() {
                found.push(format!("{file}: {name} needs timeout-minutes"));
            }
        }
        let steps = steps(&workflow);
        let faults = steps.iter().filter_map(|(job, step)| Some((job, fault(step, &text)?)));
        found.extend(faults.map(|(job, fault)| format!("{file}: {job}: {fault}")));
    }
    assert_none(&found, "change these workflows");

    let commit = "0".repeat(40);
    let text = format!("uses: actions/cache@v5 # v5\nuses: actions/cache@{commit}\n");
    for wrong in [
        serde_json::json!({"uses": "actions/cache@v5"}),
        serde_json::json!({"uses": format!("actions/cache@{commit}")}),
        serde_json::json!({"run": "make"}),
        serde_json::json!({"run": "scripts/test && true"}),
        serde_json::json!({"run": "scripts/nothing"}),
        serde_json::json!({"run": "scripts/test ${{ github.head_ref }}"}),
    ] {
        assert!(fault(&wrong, &text).is_some(), "{wrong} passes");
    }
}

#[test]
fn forms_and_update_settings_can_be_read() {
    for file in files_under(".github/ISSUE_TEMPLATE") {
        let form = yaml(&file);
        let fields = form["body"].as_array();
        let is_complete = |fields: &Vec<Value>| {
            form["name"].is_string()
                && form["description"].is_string()
                && fields
                    .iter()
                    .all(|field| field["type"] == "markdown" || field["attributes"]["label"].is_string())
        };
        assert!(file.ends_with("config.yml") || fields.is_some_and(is_complete), "{file}: {form}");
    }
    let bug = read(".github/ISSUE_TEMPLATE/bug.yml");
    assert!(bug.contains("mariana --gl-info"));
    let updates = yaml(".github/dependabot.yml");
    let kinds: Vec<&Value> =
        updates["updates"].as_array().unwrap().iter().map(|update| &update["package-ecosystem"]).collect();
    assert_eq!(kinds, ["cargo", "github-actions"]);
}

#[test]
fn addresses_come_from_one_place() {
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    let facts = &manifest["workspace"]["package"];
    let [repository, homepage, documentation] =
        ["repository", "homepage", "documentation"].map(|key| facts[key].as_str().unwrap());
    assert_eq!(documentation, format!("{repository}/tree/main/docs"));
    let metainfo = read("assets/desktop/org.mariana.Mariana.metainfo.xml");
    for (kind, address) in [
        ("homepage", homepage.to_owned()),
        ("bugtracker", format!("{repository}/issues")),
        ("help", documentation.to_owned()),
        ("vcs-browser", repository.to_owned()),
        ("contribute", format!("{repository}/blob/main/CONTRIBUTING.md")),
    ] {
        let url = format!("<url type=\"{kind}\">{address}</url>");
        assert!(metainfo.contains(&url), "metainfo.xml has no {url}");
    }
    let folders = ["packaging", "scripts", ".ci", ".github"];
    let places = folders.into_iter().flat_map(files_under).filter(|file| read(file).contains(repository));
    assert_none(&places.collect::<Vec<_>>(), "take the repository's address from Cargo.toml in these files");
    let start = read("docs/start.md");
    let facts = read("scripts/lib/package/facts.sh");
    let glibc = facts.lines().find_map(|line| line.strip_prefix("newest_glibc=")).unwrap();
    assert!(start.contains(&format!("glibc {glibc}")), "docs/start.md does not name glibc {glibc}");
}

/// The members of the workspace: folder and manifest.
fn members() -> Vec<(PathBuf, toml::Table)> {
    let manifests = files_under("crates").into_iter().filter(|file| file.matches('/').count() == 2);
    let manifests = manifests.filter(|file| file.ends_with("/Cargo.toml"));
    let more = ["Cargo.toml", "assets/Cargo.toml", "shaders/Cargo.toml"].map(str::to_owned);
    let members = manifests.chain(more).map(|file| {
        (Path::new(&file).parent().unwrap().to_owned(), read(&file).parse::<toml::Table>().unwrap())
    });
    members.collect()
}

fn is_published(manifest: &toml::Table) -> bool {
    manifest["package"].get("publish").is_none_or(|publish| publish.as_bool() != Some(false))
}

/// Resolves `..` without the file system.
fn resolved(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut resolved, part| {
        match part {
            Component::ParentDir => {
                resolved.pop();
            }
            Component::CurDir => {}
            part => resolved.push(part),
        }
        resolved
    })
}

/// Returns the lines before the first inline module for tests.
fn without_tests(text: &str) -> impl Iterator<Item = &str> {
    let mut after = text.lines().skip(1);
    text.lines().take_while(move |line| {
        let next = after.next().unwrap_or_default();
        !(*line == "#[cfg(test)]" && next.contains("mod ") && next.ends_with('{'))
    })
}

/// Returns the paths in `include_str!` and its relatives, from the root.
fn included<'a>(package: &'a Path, file: &'a str, text: &'a str) -> impl Iterator<Item = PathBuf> + 'a {
    let macros = without_tests(text).flat_map(|line| {
        let names = ["include_str!(\"", "include_bytes!(\"", "include_dir!(\""];
        names.into_iter().filter_map(move |name| line.split(name).nth(1))
    });
    macros.filter_map(move |rest| {
        let path = rest.split('"').next()?;
        Some(match path.strip_prefix("$CARGO_MANIFEST_DIR") {
            Some(inner) => resolved(&package.join(inner.trim_start_matches('/'))),
            None => resolved(&Path::new(file).parent()?.join(path)),
        })
    })
}

#[test]
fn packages_contain_all_files_that_they_embed() {
    let members = members();
    let mut found = Vec::new();
    for (folder, manifest) in members.iter().filter(|(_, manifest)| is_published(manifest)) {
        let root_package = folder.as_os_str().is_empty();
        let code = if root_package { folder.join("src") } else { folder.clone() };
        for (file, text) in sources(code.to_str().unwrap()) {
            if ["/tests/", "/testing", "/tests.rs", "/benches/", "/examples/"]
                .iter()
                .any(|part| file.contains(part))
            {
                continue;
            }
            // The innermost package that contains the path.
            let owner = |path: &Path| {
                let owners = members.iter().map(|(owner, _)| owner).filter(|owner| path.starts_with(owner));
                owners.max_by_key(|owner| owner.as_os_str().len()).cloned()
            };
            let outside = included(folder, &file, &text).filter(|path| owner(path).as_ref() != Some(folder));
            found.extend(outside.map(|path| format!("{file}: {}", path.display())));
        }
        let facts = &manifest["package"];
        for key in ["repository", "homepage", "documentation", "description", "license"] {
            if facts.get(key).is_none() {
                found.push(format!("{}: package.{key} is missing", folder.display()));
            }
        }
    }
    assert_none(
        &found,
        "a package for crates.io contains only files of its own folder, and states its facts",
    );
    let names: Vec<&str> = members
        .iter()
        .filter(|(_, manifest)| !is_published(manifest))
        .map(|(_, manifest)| manifest["package"]["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["mariana-page", "mariana-testing", "xtask"],
        "only crates for developers stay unpublished"
    );
    let text = "const A: &str = include_str!(\"../../x/a\");";
    assert_eq!(
        included(Path::new("crates/a"), "crates/a/src/b.rs", text).collect::<Vec<_>>(),
        [Path::new("crates/x/a")]
    );
}
