//! Checks `scripts/install`: the files that it installs, their validation by the desktop's tools, and their removal.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::desktop::PROGRAM;
use clap::CommandFactory;
use mariana::cli::Arguments;
use mariana::shell::identity::APP_ID;
use mariana_player::playlist::AUDIO_EXTENSIONS;
use mariana_testing::process::output_of;

fn install(arguments: &[&str], variables: &[(&str, &Path)]) -> String {
    let mut command = Command::new("bash");
    command.arg(script()).args(arguments).env_remove("DESTDIR").envs(variables.iter().copied());
    let output = command.output().unwrap();
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {reported}");
    reported
}

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/install")
}

fn install_into(prefix: &Path) -> String {
    install(&["--prefix", prefix.to_str().unwrap(), "--binary", PROGRAM], &[])
}

/// Returns the contents of all files in `folder` by path. The path of a folder has a trailing slash.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inner) = folders.pop() {
        for entry in std::fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                found.insert(format!("{name}/"), Vec::new());
                folders.push(path);
            } else {
                found.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

fn subcommands() -> Vec<String> {
    Arguments::command().get_subcommands().map(|command| command.get_name().to_owned()).collect()
}

fn text(prefix: &Path, file: &str) -> String {
    std::fs::read_to_string(prefix.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn installed_files_are_in_the_standard_places() {
    let place = tempfile::tempdir().unwrap();
    // Home folders may contain a space, so the prefix contains one.
    let prefix = place.path().join("a prefix");
    let reported = install_into(&prefix);
    assert!(reported.contains("Installed ") && reported.contains("is not in your PATH"), "{reported}");
    let first = contents(&prefix);
    let mut wanted = vec!["bin/mariana".to_owned(), "share/man/man1/mariana.1".to_owned()];
    wanted.extend(subcommands().iter().map(|name| format!("share/man/man1/mariana-{name}.1")));
    wanted.extend(
        ["16x16", "48x48", "512x512"].map(|size| format!("share/icons/hicolor/{size}/apps/{APP_ID}.png")),
    );
    wanted.push(format!("share/icons/hicolor/scalable/apps/{APP_ID}.svg"));
    for file in wanted {
        assert!(first.contains_key(&file), "{file} is missing in {:?}", first.keys());
    }
    let version =
        output_of(Command::new(prefix.join("bin/mariana")).arg("--version"), "the program").unwrap();
    assert_eq!(String::from_utf8(version).unwrap().trim(), concat!("mariana ", env!("CARGO_PKG_VERSION")));

    let entry = prefix.join(format!("share/applications/{APP_ID}.desktop"));
    let started = format!("Exec=\"{}/bin/mariana\" %F", prefix.display());
    assert!(text(&prefix, entry.to_str().unwrap()).lines().any(|line| line == started), "no {started}");
    output_of(Command::new("desktop-file-validate").arg(&entry), "desktop-file-utils").unwrap();

    let metainfo = prefix.join(format!("share/metainfo/{APP_ID}.metainfo.xml"));
    output_of(Command::new("appstreamcli").args(["validate", "--no-net"]).arg(&metainfo), "appstream")
        .unwrap();
    let release = format!("<release version=\"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(text(&prefix, metainfo.to_str().unwrap()).contains(&release), "metainfo.xml has no {release}");

    assert!(text(&prefix, "share/mime/globs2").contains("50:text/x-mariana-scene:*.scene"));
    assert!(text(&prefix, "share/applications/mimeinfo.cache").contains("text/x-mariana-scene"));

    install_into(&prefix);
    assert!(contents(&prefix) == first, "installing again changed a file");
}

#[test]
fn removal_keeps_only_files_of_others() {
    let place = tempfile::tempdir().unwrap();
    let prefix = place.path();
    let others = ["bin/other", "share/applications/other.desktop", "share/man/man1/other.1"];
    for file in others {
        std::fs::create_dir_all(prefix.join(file).parent().unwrap()).unwrap();
        std::fs::write(prefix.join(file), "[Desktop Entry]\n").unwrap();
    }
    let before: Vec<String> = contents(prefix).into_keys().collect();
    install_into(prefix);
    // A file of an earlier version, which the current version does not install.
    let old = "share/man/man1/mariana-old.1";
    std::fs::write(prefix.join(old), "").unwrap();
    let manifest = prefix.join("share/mariana/installed.txt");
    // A path outside of the prefix. The script must not delete it, even if the list of installed files contains it.
    let outside = place.path().with_extension("kept");
    std::fs::write(&outside, "").unwrap();
    let upward = format!("../{}", outside.file_name().unwrap().to_str().unwrap());
    let list = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, format!("{list}{old}\n{upward}\n{}\n", outside.display())).unwrap();
    install_into(prefix);
    assert!(!prefix.join(old).exists(), "{old} stayed");
    std::fs::write(&manifest, format!("{list}{upward}\n{}\n", outside.display())).unwrap();
    let remove = ["--remove", "--prefix", prefix.to_str().unwrap()];
    assert!(install(&remove, &[]).contains("Removed the "));
    let left: Vec<String> =
        contents(prefix).into_keys().filter(|name| name != "share/applications/mimeinfo.cache").collect();
    assert_eq!(left, before);
    assert!(outside.exists(), "a file outside of the prefix was removed");
    std::fs::remove_file(&outside).unwrap();
    assert!(install(&remove, &[]).contains("Nothing to remove"));

    let empty = tempfile::tempdir().unwrap();
    install_into(empty.path());
    install(&["--remove", "--prefix", empty.path().to_str().unwrap()], &[]);
    assert!(contents(empty.path()).is_empty(), "{:?} stayed", contents(empty.path()).keys());
}

#[test]
fn staged_and_default_installations_work() {
    let place = tempfile::tempdir().unwrap();
    let (package, home) = (place.path().join("package"), place.path().join("home"));
    install(&["--prefix", "/usr", "--binary", PROGRAM], &[("DESTDIR", &package)]);
    let entry = text(&package, &format!("usr/share/applications/{APP_ID}.desktop"));
    assert!(entry.contains("\nExec=mariana %F\n"), "{entry}");
    // The script leaves the databases to the package manager, which updates them.
    assert!(!contents(&package).keys().any(|name| name.contains("cache") || name.contains("globs")));
    install(&["--remove", "--prefix", "/usr"], &[("DESTDIR", &package)]);
    assert_eq!(contents(&package).into_keys().collect::<Vec<_>>(), ["usr/"]);

    install(&["--binary", PROGRAM], &[("HOME", &home)]);
    assert!(home.join(".local/bin/mariana").exists());
    install(&["--remove", "--user"], &[("HOME", &home)]);
    assert_eq!(contents(&home).into_keys().collect::<Vec<_>>(), [".local/"]);

    for wrong in [&["--prefix"][..], &["--binary", "/nowhere/mariana"], &["--everywhere"]] {
        let output = Command::new("bash").arg(script()).args(wrong).env("HOME", &home).output().unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(1) && reported.contains(wrong[wrong.len() - 1]),
            "{wrong:?}: {reported}"
        );
    }
    assert_eq!(contents(&home).into_keys().collect::<Vec<_>>(), [".local/"]);
}

#[test]
fn completions_know_every_subcommand() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/desktop/completions");
    output_of(Command::new("bash").arg("-n").arg(folder.join("mariana.bash")), "bash").unwrap();
    let ask = "source \"$1\"; COMP_WORDS=(mariana ''); COMP_CWORD=1; COMPREPLY=()
               _mariana mariana '' mariana; printf '%s\\n' \"${COMPREPLY[@]}\"";
    let offered =
        output_of(Command::new("bash").args(["-c", ask, "ask"]).arg(folder.join("mariana.bash")), "bash")
            .unwrap();
    let offered = String::from_utf8(offered).unwrap();
    let [zsh, fish] = ["_mariana", "mariana.fish"].map(|file| text(&folder, file));
    for name in subcommands() {
        assert!(offered.lines().any(|word| word == name), "bash does not complete {name}: {offered}");
        assert!(zsh.contains(&format!("'{name}:")), "zsh does not complete {name}");
        assert!(fish.contains(&format!("-a \"{name}\"")), "fish does not complete {name}");
    }
}

fn types_of(extension: &str) -> Vec<String> {
    let globs = std::fs::read_to_string("/usr/share/mime/globs2").expect("install shared-mime-info");
    let rows = globs.lines().map(|line| line.splitn(4, ':').collect::<Vec<_>>());
    let of_it = rows.filter(|row| row.get(2) == Some(&format!("*.{extension}").as_str()));
    of_it.map(|row| row[1].to_owned()).collect()
}

#[test]
fn the_desktop_entry_lists_all_playable_types() {
    let entry = text(Path::new(env!("CARGO_MANIFEST_DIR")), &format!("assets/desktop/{APP_ID}.desktop"));
    let named: Vec<&str> =
        entry.lines().find_map(|line| line.strip_prefix("MimeType=")).unwrap().split(';').collect();
    assert!(named.contains(&"text/x-mariana-scene"), "{named:?}");
    let mut known = 0;
    for extension in AUDIO_EXTENSIONS.iter().chain(&["m3u", "m3u8", "pls", "cue"]) {
        let types = types_of(extension);
        known += usize::from(!types.is_empty());
        // Check only audio types. Videos and object files (`.mod`) can have the same extensions as sounds.
        for of_sound in types.iter().filter(|name| name.starts_with("audio/")) {
            assert!(
                named.contains(&of_sound.as_str()),
                "*.{extension} files have the type {of_sound}: add it to MimeType"
            );
        }
    }
    assert!(known > 15, "the system's database knows only {known} of the extensions");
    let videos: Vec<&&str> = named.iter().filter(|name| name.starts_with("video/")).collect();
    assert!(videos.is_empty(), "the entry must not list video types: {videos:?}");
}
