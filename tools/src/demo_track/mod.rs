//! Composes and synthesises the built-in demo track, "Hadal Lanterns": 40 bars, 85.3 s, 48 kHz stereo.
//!
//! ```sh
//! cargo run --manifest-path tools/Cargo.toml -- demo-track demo.wav
//! ffmpeg -i demo.wav -map_metadata -1 -metadata title="Hadal Lanterns" -metadata artist="Mariana" \
//!     -c:a libvorbis -q:a 3.5 -fflags +bitexact -flags:a +bitexact -y assets/demo.ogg
//! ```
//!
//! Every run on one machine gives the same bytes. [`score`] contains every note. [`synth`] and [`drums`] play the
//! instruments. [`effects`] contains the reverb, the delay and the limiter. [`mix`] sets the levels.

mod drums;
mod effects;
mod mix;
mod score;
mod synth;
mod wav;

use anyhow::Context as _;

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let [path] = arguments else {
        anyhow::bail!("expected one argument: the file to write, such as OUT.wav")
    };
    std::fs::write(path, wav::encode(&mix::render())).with_context(|| format!("cannot write {path}"))
}
