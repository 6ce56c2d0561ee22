//! Checks `scripts/package`: the contents of the downloads, made of this build, and the files for package managers.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::desktop::PROGRAM;
use mariana::shell::identity::APP_ID;
use mariana_testing::process::output_of;

const VERSION: &str = env!("CARGO_PKG_VERSION");

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn package(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new("bash");
    command.arg(root().join("scripts/package"));
    // Any file can stand in for the web page, whose build takes minutes.
    command.arg("--page").arg(root().join("crates/page/web/index.html"));
    command.args(arguments).arg("--fast").arg("--out").arg(out);
    command.output().unwrap()
}

/// Makes packages and returns the paths that the script prints.
fn made(arguments: &[&str], out: &Path) -> Vec<PathBuf> {
    let output = package(arguments, out);
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {reported}");
    String::from_utf8(output.stdout).unwrap().lines().map(PathBuf::from).collect()
}

/// Returns the script's refusal.
fn refusal(arguments: &[&str], out: &Path) -> String {
    let output = package(arguments, out);
    let reported = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {reported}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed something");
    reported
}

fn ran(program: &str, arguments: &[&str], files: &[&Path]) -> String {
    let output = output_of(Command::new(program).args(arguments).args(files), program);
    String::from_utf8(output.unwrap_or_else(|error| panic!("{error}"))).unwrap()
}

/// The checksum and mode of each file in `folder`, by its path.
fn files_in(folder: &Path) -> BTreeMap<String, String> {
    let script = "cd \"$1\" && find . -type f -exec stat -c '%a %n' {} + | while read -r mode name; do
                  echo \"$(sha256sum <\"$name\" | cut -c 1-64) $mode ${name#./}\"; done";
    let rows = output_of(Command::new("bash").args(["-c", script, "files"]).arg(folder), "bash").unwrap();
    rows_by_path(&String::from_utf8(rows).unwrap())
}

fn rows_by_path(rows: &str) -> BTreeMap<String, String> {
    let row = |line: &str| {
        let mut parts = line.splitn(3, ' ');
        let facts = [parts.next().unwrap(), parts.next().unwrap()].join(" ");
        (parts.next().unwrap().to_owned(), facts)
    };
    rows.lines().map(row).collect()
}

fn unpacked(place: &Path, program: &str, arguments: &[&str], package: &Path, to: &str) -> PathBuf {
    let folder = place.join(to);
    std::fs::create_dir(&folder).unwrap();
    let mut command = Command::new(program);
    command.args(arguments).arg(package).current_dir(&folder);
    if program == "dpkg-deb" {
        command.arg(".");
    }
    output_of(&mut command, program).unwrap();
    folder
}

#[test]
fn linux_packages_contain_the_installed_files() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("the downloads");
    let files = made(&["linux", "--binary", PROGRAM], &out);
    let [tar, deb, rpm] = files.as_slice() else { panic!("{files:?}") };

    let archive = unpacked(place.path(), "tar", &["-xzf"], tar, "archive");
    let archived = files_in(&archive.join(format!("mariana-{VERSION}-linux-{}", std::env::consts::ARCH)));
    for (file, mode) in [
        ("bin/mariana", "755"),
        ("share/man/man1/mariana.1.gz", "644"),
        ("share/mariana/page.html", "644"),
        ("share/doc/mariana/changelog.gz", "644"),
        ("share/doc/mariana/third-party-notices.gz", "644"),
        ("share/zsh/site-functions/_mariana", "644"),
    ] {
        let facts = archived.get(file).unwrap_or_else(|| panic!("{file} is missing in {archived:?}"));
        assert!(facts.ends_with(&format!(" {mode}")), "{file}: {facts}");
    }
    assert!(!archived.keys().any(|file| file.contains("installed.txt")), "{:?}", archived.keys());

    let debian = unpacked(place.path(), "dpkg-deb", &["-x"], deb, "debian");
    let mut debian = files_in(&debian.join("usr"));
    // Debian has its own folder for zsh, changelog and file of licences.
    let completion = debian.remove("share/zsh/vendor-completions/_mariana").unwrap();
    debian.insert("share/zsh/site-functions/_mariana".to_owned(), completion);
    for own in ["doc/mariana/changelog.Debian.gz", "doc/mariana/copyright", "lintian/overrides/mariana"] {
        assert!(debian.remove(&format!("share/{own}")).is_some(), "{own} is missing in {deb:?}");
    }
    let mut expected = archived.clone();
    expected.retain(|file, _| !file.contains("/LICENSE-"));
    assert_eq!(debian, expected);

    let query = "[%{FILEDIGESTS} %{FILEMODES:octal} %{FILENAMES}\n]";
    let listed = ran("rpm", &["-qp", "--qf", query], &[rpm]);
    // Folders have no checksum. The mode begins with the kind of the file.
    let listed: String = listed
        .lines()
        .filter(|line| !line.starts_with(' '))
        .fold(String::new(), |all, line| all + &line.replace(" 100", " ").replace(" /usr/", " ") + "\n");
    assert_eq!(rows_by_path(&listed), archived);

    let dependencies = ran("dpkg-deb", &["-f"], &[deb]);
    for field in ["Depends: libasound2t64 | libasound2, libc6 (>= 2.", "Recommends: libgl1, libgl1-mesa-dri,"]
    {
        assert!(dependencies.contains(field), "{field} is missing in:\n{dependencies}");
    }
    let recommended = ran("rpm", &["-qp", "--recommends"], &[rpm]);
    assert!(recommended.contains("libEGL.so.1()(64bit)"), "{recommended}");
    if Path::new("/etc/debian_version").exists() {
        // Without errors and warnings, lintian prints at most notes.
        let checked = Command::new("lintian").arg("--allow-root").arg(deb).output().expect("install lintian");
        let found = [checked.stdout, checked.stderr].concat();
        let found = String::from_utf8_lossy(&found);
        assert!(found.lines().all(|line| line.starts_with("N:")), "{found}");
    }
}

/// A file that starts like a program of another system.
fn pretended(place: &Path, start: &[u8]) -> String {
    let path = place.join("program");
    std::fs::write(&path, [start, &[0; 100]].concat()).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn archives_for_windows_and_macos_are_complete() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    let windows = pretended(place.path(), b"MZ");
    let zip = made(&["zip", "--binary", &windows], &out);
    let listed = ran("zip", &["-sf"], &[&zip[0]]);
    for file in ["mariana.exe", "page.html", "LICENSE-MIT", "third-party-notices.txt"] {
        let file = format!("mariana-{VERSION}-windows-x86_64/{file}");
        assert!(listed.contains(&file), "{file} is missing in {listed}");
    }

    let mac = pretended(place.path(), &[0xcf, 0xfa, 0xed, 0xfe]);
    let app = &made(&["app", "--binary", &mac], &out)[0];
    let files = files_in(app);
    assert!(files["Contents/MacOS/mariana"].ends_with(" 755"), "{files:?}");
    assert!(files.contains_key("Contents/Resources/page.html"), "{files:?}");
    let properties = std::fs::read_to_string(app.join("Contents/Info.plist")).unwrap();
    for text in [VERSION, APP_ID, "NSMicrophoneUsageDescription"] {
        assert!(properties.contains(&format!("<string>{text}</string>")) || properties.contains(text));
    }
    let icons = std::fs::read(app.join("Contents/Resources/mariana.icns")).unwrap();
    let number = |at: usize| u32::from_be_bytes(icons[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&icons[..4], number(4)), (&b"icns"[..], icons.len()));
    let mut sizes = Vec::new();
    let mut at = 8;
    while at < icons.len() {
        let picture = image::load_from_memory(&icons[at + 8..at + number(at + 4)]).unwrap();
        sizes.push((String::from_utf8(icons[at..at + 4].to_vec()).unwrap(), picture.width()));
        at += number(at + 4);
    }
    for size in [("icp4", 16), ("ic07", 128), ("ic14", 512)] {
        assert!(sizes.contains(&(size.0.to_owned(), size.1)), "{size:?} is missing in {sizes:?}");
    }
}

#[test]
fn wrong_requests_are_refused_with_advice() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    std::fs::write(place.path().join("file"), "").unwrap();
    let text = place.path().join("text");
    std::fs::write(&text, "no program").unwrap();
    let text = text.to_str().unwrap();
    for (arguments, expected) in [
        (&[][..], "Name what to make"),
        (&["msi"], "Unknown argument 'msi'"),
        (&["deb", "--binary"], "--binary"),
        (&["deb", "--binary", "/nowhere/mariana"], "/nowhere/mariana is not a file"),
        (&["deb", "--binary", PROGRAM, "--page", "/nowhere/page.html"], "/nowhere/page.html is not a file"),
        (&["tar", "--binary", text], "not a program for Linux"),
        (&["zip", "--binary", PROGRAM], "not a program for Windows"),
        (&["app", "--binary", PROGRAM], "not a program for macOS"),
        (&["dmg", "--binary", PROGRAM], "on macOS only"),
        (&["sums"], "has no downloads"),
        (&["manifests"], "SHA256SUMS has no"),
        (&["notes", "--tag", "v9.9.9"], "no section '## 9.9.9'"),
        (&["check"], "--tag"),
        (&["check", "--tag", "v9.9.9"], &format!("Cargo.toml has the version {VERSION}")),
    ] {
        let refusal = refusal(arguments, &out);
        assert!(refusal.contains(expected), "{arguments:?}: {refusal}");
    }
    let refusal = refusal(&["tar", "--binary", PROGRAM], &place.path().join("file/out"));
    assert!(refusal.contains("Choose another with --out"), "{refusal}");

    for (script, arguments, expected) in [
        ("scripts/try-package", &[][..], "Name a release and a package"),
        ("scripts/try-package", &["trixie", "/nowhere/mariana.deb"], "/nowhere/mariana.deb is not a file"),
        (".ci/publish", &["v9.9.9"], "Name the tag and the folder"),
        (".ci/publish", &["v9.9.9", "/nowhere"], "/nowhere has no SHA256SUMS"),
    ] {
        let output = Command::new("bash").arg(root().join(script)).args(arguments).output().unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{script} {arguments:?}: {reported}");
        assert!(reported.contains(expected), "{script} {arguments:?}: {reported}");
    }
}

#[test]
fn notes_and_files_for_package_managers_are_filled() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path();
    let notes = package(&["notes"], out).stdout;
    let notes = String::from_utf8(notes).unwrap();
    assert!(notes.contains("### Added") && !notes.contains("\n## "), "{notes}");

    let downloads = ["source.tar.gz", "windows-x86_64.zip", "macos-aarch64.dmg"]
        .map(|end| format!("mariana-{VERSION}-{end}"));
    for (number, name) in downloads.iter().enumerate() {
        std::fs::write(out.join(name), number.to_string()).unwrap();
    }
    let files = made(&["sums", "manifests"], out);
    ran(
        "bash",
        &["-c", "cd \"$(dirname \"$1\")\" && sha256sum --check --quiet SHA256SUMS", "sums"],
        &[&files[0]],
    );
    let sums = std::fs::read_to_string(&files[0]).unwrap();
    assert_eq!(sums.lines().count(), downloads.len());
    let folder =
        unpacked(out, "tar", &["-xzf"], &files[1], "unpacked").join(format!("mariana-{VERSION}-manifests"));
    let json = |file: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(folder.join(file)).unwrap()).unwrap()
    };
    let flatpak = json(&format!("flatpak/{APP_ID}.json"));
    let source = &flatpak["modules"][0]["sources"][0];
    assert!(sums.contains(&format!("{}  {}", source["sha256"].as_str().unwrap(), downloads[0])), "{source}");
    let locked = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let crates = locked.lines().filter(|line| line.starts_with("checksum = ")).count();
    // An archive and a checksum for each crate, and the settings of cargo.
    assert_eq!(json("flatpak/cargo-sources.json").as_array().unwrap().len(), 2 * crates + 1);

    ran("ruby", &["-c"], &[&folder.join("homebrew/mariana.rb")]);
    let read = "ARGV.each { |file| puts YAML.load_file(file).fetch('PackageVersion') }";
    let [version, installer, locale] = ["", ".installer", ".locale.en-US"]
        .map(|kind| folder.join(format!("winget/Mariana.Mariana{kind}.yaml")));
    let versions = ran("ruby", &["-ryaml", "-e", read], &[&version, &installer, &locale]);
    assert_eq!(versions, format!("{VERSION}\n").repeat(3));
}
