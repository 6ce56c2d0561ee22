//! The cookie that PulseAudio's server wants from each client. Clients of the same user are accepted with any cookie, but
//! without one the server closes the connection. cpal's client finds neither a cookie in `$XDG_CONFIG_HOME` nor makes one,
//! unlike PulseAudio's own client, so Mariana provides the file that cpal's client reads.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _, symlink};
use std::path::{Path, PathBuf};

/// The size of a cookie, in bytes.
const COOKIE_BYTES: u64 = 256;

/// Makes `~/.config/pulse/cookie` if cpal's client finds no cookie. If this fails, the connection fails too.
pub(crate) fn provide() {
    if pulseaudio::cookie_path_from_env().is_some() {
        return;
    }
    let configuration = std::env::var_os("XDG_CONFIG_HOME").map(PathBuf::from);
    if let Some(home) = std::env::home_dir()
        && let Err(error) = provide_in(&home, configuration.as_deref())
    {
        tracing::debug!("a cookie for PulseAudio cannot be written: {error}");
    }
}

fn provide_in(home: &Path, configuration: Option<&Path>) -> io::Result<()> {
    let folder = home.join(".config/pulse");
    let path = folder.join("cookie");
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let known = configuration.map(|folder| folder.join("pulse/cookie"));
    let is_cookie = |path: &PathBuf| fs::metadata(path).is_ok_and(|about| about.len() == COOKIE_BYTES);
    if let Some(known) = known.filter(is_cookie) {
        return symlink(known, path);
    }
    // A server that starts later takes this file for its own cookie, so it must be a secret.
    let mut cookie = Vec::new();
    File::open("/dev/urandom")?.take(COOKIE_BYTES).read_to_end(&mut cookie)?;
    OpenOptions::new().write(true).create_new(true).mode(0o600).open(path)?.write_all(&cookie)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt as _;

    #[test]
    fn a_cookie_elsewhere_is_found_and_a_missing_one_is_made() {
        let (home, configuration) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let path = home.path().join(".config/pulse/cookie");
        let elsewhere = configuration.path().join("pulse/cookie");
        fs::create_dir(configuration.path().join("pulse")).unwrap();
        fs::write(&elsewhere, [7; 256]).unwrap();
        provide_in(home.path(), Some(configuration.path())).unwrap();
        assert_eq!(fs::read(&path).unwrap(), [7; 256]);
        fs::remove_file(&path).unwrap();
        fs::write(&elsewhere, "").unwrap();
        provide_in(home.path(), Some(configuration.path())).unwrap();
        let made = fs::read(&path).unwrap();
        assert!(made.len() == 256 && made.iter().any(|byte| *byte != made[0]));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        assert!(provide_in(home.path(), None).is_err(), "a cookie was replaced");
        assert_eq!(fs::read(&path).unwrap(), made);
    }
}
