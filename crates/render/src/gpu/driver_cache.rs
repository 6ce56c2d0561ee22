//! Disables Mesa's shader cache when the cache's disk is full. Mesa up to 22.3 maps its index into memory without
//! reserving disk space. If a later write finds the disk full, a bus error kills the process.

#![expect(unsafe_code, reason = "sets an environment variable before other threads start")]

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Free bytes below which the cache is disabled. Its index takes 1.25 MiB.
const ROOM_MIN: u64 = 16 << 20;

const OFF: &str = "MESA_SHADER_CACHE_DISABLE";

/// Disables Mesa's cache for this process and its children if the disk is almost full. Call before starting threads.
pub fn leave_where_full() {
    let folder = folder(|name| std::env::var_os(name).filter(|value| !value.is_empty()));
    let room = folder.and_then(|folder| room_in(&folder));
    let wanted = room.is_some_and(|room| room < ROOM_MIN) && std::env::var_os(OFF).is_none();
    if wanted && std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1) {
        // SAFETY: this is the only thread, as checked above, so no other code reads the environment meanwhile.
        unsafe { std::env::set_var(OFF, "true") }
    }
}

fn folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let place = |name: &str| variable(name).map(PathBuf::from);
    place("MESA_SHADER_CACHE_DIR")
        .or_else(|| place("XDG_CACHE_HOME"))
        .or_else(|| Some(place("HOME")?.join(".cache")))
}

/// Free bytes on the disk of a folder, which need not exist yet. `None` if the number is unknown.
fn room_in(folder: &Path) -> Option<u64> {
    let reported = folder.ancestors().find_map(|place| rustix::fs::statvfs(place).ok())?;
    Some(reported.f_bavail.saturating_mul(reported.f_frsize))
}

#[cfg(test)]
mod tests {
    use super::{folder, room_in};
    use std::path::Path;

    #[test]
    fn the_free_space_of_a_missing_folder_is_its_parents() {
        let place = tempfile::tempdir().unwrap();
        assert!(room_in(&place.path().join("not/there")).is_some_and(|room| room > 0));
        // File systems of the kernel, such as /proc, have no free space.
        assert_eq!(room_in(Path::new("/proc/self")), Some(0));
    }

    #[test]
    fn the_folder_is_the_one_that_mesa_uses() {
        let all = ["MESA_SHADER_CACHE_DIR", "XDG_CACHE_HOME", "HOME"];
        for (known, wanted) in [(0, "MESA_SHADER_CACHE_DIR"), (1, "XDG_CACHE_HOME"), (2, "HOME/.cache")] {
            let reported = |name: &str| all[known..].contains(&name).then(|| name.into());
            assert_eq!(folder(reported).as_deref(), Some(Path::new(wanted)));
        }
    }
}
