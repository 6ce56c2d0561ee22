//! Runs each session test in a separate process.
//!
//! In Mesa 22.3, llvmpipe reads all contexts of a display while other threads change them, so two sessions in one
//! process can crash. In a separate process, each test can also have separate environment variables and a separate log.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};

#[cfg(unix)]
use mariana_testing::process::{private_folder, session_environment};

const TEST: &str = "MARIANA_TEST_APART";

/// Runs the calling test in a separate process, with environment variables: `apart!("NAME" = "value");`. Must be the
/// first statement of the test.
macro_rules! apart {
    ($($name:literal = $value:expr),*) => {
        fn here() {}
        if $crate::support::apart::runs_elsewhere(std::any::type_name_of_val(&here), &[$(($name, $value)),*]) {
            return;
        }
    };
}
pub(crate) use apart;

/// Like [`apart!`], but in a separate user session with the home folder [`home`]. That session has no sound server
/// unless the test starts one.
#[cfg(unix)]
macro_rules! apart_at_home {
    () => {
        fn here() {}
        if $crate::support::apart::runs_at_another_home(std::any::type_name_of_val(&here)) {
            return;
        }
    };
}
#[cfg(unix)]
pub(crate) use apart_at_home;

/// Like [`runs_elsewhere`], for [`apart_at_home!`].
#[cfg(unix)]
pub(crate) fn runs_at_another_home(path: &str) -> bool {
    if is_apart() {
        return false;
    }
    let folder = private_folder();
    let session = session_environment(folder.path());
    let variables: Vec<(&str, &str)> = session.iter().map(|(name, value)| (*name, value.as_str())).collect();
    // Drivers store compiled shaders in the user's home. A shared folder saves each test from compiling all shaders.
    let kept = [("MESA_SHADER_CACHE_DIR", env!("CARGO_TARGET_TMPDIR"))];
    runs_elsewhere(path, &[&variables[..], &kept].concat())
}

/// The home folder of the test's user session.
pub(crate) fn home() -> PathBuf {
    std::env::var_os("HOME").unwrap().into()
}

/// Runs the test that contains the function `path` in a separate process. Returns false in that process, and true in
/// the calling process. Panics if the test fails.
pub(crate) fn runs_elsewhere(path: &str, variables: &[(&str, &str)]) -> bool {
    if is_apart() {
        return false;
    }
    let test = path.split("::").skip(1).collect::<Vec<_>>();
    let test = test[..test.len() - 1].join("::");
    let output = process_of(&test).envs(variables.iter().copied()).output().unwrap();
    let (reported, failed) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{test}: {}\n{reported}\n{failed}", output.status);
    assert!(reported.contains("1 passed"), "{test} did not run: {reported}");
    // A thread may have panicked without failing the test.
    assert!(!failed.contains("panicked"), "{test}: {failed}");
    true
}

/// Runs the test of this process once more, in a second process with additional variables.
pub(crate) fn run_again(variables: &[(&str, &OsStr)]) -> ExitStatus {
    let mut again = process_of(&std::env::var(TEST).unwrap());
    again.envs(variables.iter().copied()).stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap()
}

fn process_of(test: &str) -> Command {
    let mut process = Command::new(std::env::current_exe().unwrap());
    process.args([test, "--exact", "--nocapture", "--test-threads=1"]).env(TEST, test);
    process
}

pub(crate) fn is_apart() -> bool {
    std::env::var_os(TEST).is_some()
}
