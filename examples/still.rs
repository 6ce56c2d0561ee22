//! Draws one moment of the demo track as a picture, by a library call: `cargo run --release --example still -- out.png`.

use mariana::demo_track::DEMO_TRACK;
use mariana::export::still::{StillRequest, write_still};
use mariana::scenes::SceneSource;
use mariana_music::Gain;

fn main() -> anyhow::Result<()> {
    let output = std::env::args_os().nth(1).unwrap_or_else(|| "still.png".into());
    write_still(&StillRequest {
        song: DEMO_TRACK,
        at: 62.0,
        size: (640, 360),
        gain: Gain::Auto,
        output: output.into(),
        scene: SceneSource::Shipped("speakers".into()).into(),
        show: None,
        blend: None,
        set: Vec::new(),
    })?;
    Ok(())
}
