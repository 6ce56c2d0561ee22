//! Composes and synthesises the built-in demo track, "Hadal Lanterns": 40 bars, 85.3 s, 48 kHz stereo.
//!
//! ```sh
//! cargo run --release --example compose_demo -- demo.wav
//! ffmpeg -i demo.wav -map_metadata -1 -metadata title="Hadal Lanterns" -metadata artist="Mariana" \
//!     -c:a libvorbis -q:a 3.5 -fflags +bitexact -flags:a +bitexact -y assets/demo.ogg
//! ```
//!
//! The same bytes at every run on one machine. [`score`] holds the form and every note, [`synth`] and [`drums`]
//! the instruments, [`effects`] the room, the echo and the limiter, [`mix`] the levels, [`wav`] the file.

mod drums;
mod effects;
mod mix;
mod score;
mod synth;
mod wav;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [path] = arguments.as_slice() else {
        eprintln!("usage: compose_demo OUT.wav");
        return ExitCode::from(2);
    };
    match std::fs::write(path, wav::encode(&mix::render())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cannot write {}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}
