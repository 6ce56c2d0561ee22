//! Draws the moving image of the README: a melt from one scene to another at the first drop of the demo track.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, ensure};

const SHOW: &str = "at start heart\nat drop 1 - 1 bar metaballs melt over 2 bars\n";
/// Start of the rendered part of the song, in seconds.
const START: &str = "24";
const DURATION: &str = "5.6";

/// Renders the part with `PROGRAM`, the `mariana` binary, and encodes it with ffmpeg as an animated WebP.
pub fn run(arguments: &[String]) -> anyhow::Result<()> {
    let [program] = arguments else { anyhow::bail!("name the program: target/release/mariana") };
    let folder = tempfile::tempdir()?;
    let (show, video) = (folder.path().join("melt.show"), folder.path().join("melt.mp4"));
    fs::write(&show, SHOW)?;
    let mut render = Command::new(program);
    render.arg("video").arg("--show").arg(&show).args(["--start", START, "--duration", DURATION]);
    render.args(["--size", "640x360", "--fps", "20", "--quality", "best", "-o"]).arg(&video);
    let images = Path::new("docs/images");
    let mut encode = Command::new("ffmpeg");
    encode.args(["-v", "error", "-y", "-i"]).arg(&video);
    encode.args(["-an", "-c:v", "libwebp_anim", "-q:v", "70", "-loop", "0"]).arg(images.join("melt.webp"));
    for mut command in [render, encode] {
        let status = command.status().with_context(|| format!("starting {:?}", command.get_program()))?;
        ensure!(status.success(), "{:?} failed: {status}", command.get_program());
    }
    Ok(())
}
