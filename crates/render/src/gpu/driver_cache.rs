//! Keeps Mesa from its own cache of programs where the disk is full.
//!
//! Mesa up to 22.3 maps the index of that cache into memory without having room for it, and the process is killed by a
//! bus error when an entry is written and there is none.

#![expect(unsafe_code, reason = "a variable of the environment is set before there are threads")]

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Below so many bytes the cache is left alone. Its index has 1.25 MiB.
const ROOM_MIN: u64 = 16 << 20;

/// What switches the cache off.
const OFF: &str = "MESA_SHADER_CACHE_DISABLE";

/// Switches Mesa's cache off if there is hardly any room where it is, for this process and those that it starts. It has
/// no effect once there are threads, so it comes first.
pub fn leave_where_full() {
    let folder = folder(|name| std::env::var_os(name).filter(|value| !value.is_empty()));
    let room = folder.and_then(|folder| room_in(&folder));
    let wanted = room.is_some_and(|room| room < ROOM_MIN) && std::env::var_os(OFF).is_none();
    if wanted && std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1) {
        // SAFETY: this is the only thread, so nobody reads the environment meanwhile.
        unsafe { std::env::set_var(OFF, "true") }
    }
}

/// Where Mesa keeps programs, by the variables that it reads.
fn folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let place = |name: &str| variable(name).map(PathBuf::from);
    place("MESA_SHADER_CACHE_DIR")
        .or_else(|| place("XDG_CACHE_HOME"))
        .or_else(|| Some(place("HOME")?.join(".cache")))
}

/// How many bytes can be written in a folder, which need not be there yet; none if nobody tells.
fn room_in(folder: &Path) -> Option<u64> {
    let reported = folder.ancestors().find_map(|place| rustix::fs::statvfs(place).ok())?;
    Some(reported.f_bavail.saturating_mul(reported.f_frsize))
}

#[cfg(test)]
mod tests {
    use super::{folder, room_in};
    use std::path::Path;

    #[test]
    fn room_is_that_of_the_folder_above_one_that_is_not_there() {
        let place = tempfile::tempdir().unwrap();
        assert!(room_in(&place.path().join("not/there")).is_some_and(|room| room > 0));
        // The kernel's own files are on no disk.
        assert_eq!(room_in(Path::new("/proc/self")), Some(0));
    }

    #[test]
    fn the_folder_is_the_one_that_mesa_takes() {
        let all = ["MESA_SHADER_CACHE_DIR", "XDG_CACHE_HOME", "HOME"];
        for (known, wanted) in [(0, "MESA_SHADER_CACHE_DIR"), (1, "XDG_CACHE_HOME"), (2, "HOME/.cache")] {
            let reported = |name: &str| all[known..].contains(&name).then(|| name.into());
            assert_eq!(folder(reported).as_deref(), Some(Path::new(wanted)));
        }
    }
}
