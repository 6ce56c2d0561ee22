//! Draws a thumbnail in a separate process.

use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mariana_files::child::{ChildLimits, ChildProcess};

use super::{MOMENT, SIZE};
use crate::SceneSource;
use crate::limits::LIMITS;

const INTERVAL: Duration = Duration::from_millis(20);
/// A driver's cache of programs may be a large file.
const CHILD_LIMITS: ChildLimits =
    ChildLimits { memory: Some(4 << 30), cpu_seconds: Some(300), file: Some(1 << 30) };

#[derive(Debug, thiserror::Error)]
pub(super) enum NotDrawn {
    #[error("the thumbnail cannot be drawn ({0})")]
    System(#[from] io::Error),
    #[error("the thumbnail cannot be drawn")]
    Failed,
    #[error("drawing the thumbnail takes more than {} s", LIMITS.thumbnail_seconds_max)]
    TooSlow,
    #[error("")]
    Stopped,
}

/// Draws the thumbnail of a scene in a separate process and returns the bytes of a PNG. The process runs `program`,
/// or the running executable if that is `None`. Polls `is_stopped` and ends the process when it returns true.
///
/// # Errors
/// Fails with a [`NotDrawn`].
pub(super) fn draw(
    program: Option<&Path>,
    source: &SceneSource,
    mut is_stopped: impl FnMut() -> bool,
) -> Result<Vec<u8>, NotDrawn> {
    let place = tempfile::tempdir()?;
    let file = place.path().join("picture.png");
    let scene = match source {
        SceneSource::Blend(blend) => return draw(program, &blend.to.source, is_stopped),
        SceneSource::Shipped(name) => name.into(),
        SceneSource::File(path) => path.clone().into_os_string(),
        SceneSource::Formula(text) => text.into(),
    };
    let mut option = std::ffi::OsString::from("--scene=");
    option.push(scene);
    let program = program.map_or_else(std::env::current_exe, |program| Ok(program.to_owned()))?;
    let mut command = Command::new(program);
    let size = format!("{}x{}", SIZE.0, SIZE.1);
    command.args(["still", "--at", &MOMENT.to_string(), "--size", &size, "-o"]).arg(&file);
    // The process ends when its input closes, so it never outlives this process.
    command.args(["--controlled"]).arg(option).env("LP_NUM_THREADS", "1");
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = ChildProcess::start(&mut command, CHILD_LIMITS)?;
    let until = Instant::now() + Duration::from_secs_f64(LIMITS.thumbnail_seconds_max);
    loop {
        match child.ended()? {
            Some(status) if status.success() => return Ok(fs::read(&file)?),
            Some(_) => return Err(NotDrawn::Failed),
            None if is_stopped() => return Err(NotDrawn::Stopped),
            None if Instant::now() > until => return Err(NotDrawn::TooSlow),
            None => std::thread::sleep(INTERVAL),
        }
    }
}
