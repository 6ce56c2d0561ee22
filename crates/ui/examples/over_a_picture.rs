//! Draws the table of keys over an empty frame and saves the image: `cargo run -p mariana-ui --example over_a_picture
//! -- keys.png`.

use std::error::Error;
use std::time::Instant;

use mariana_render::Headless;
use mariana_render::gpu::target::{Target, Texel};
use mariana_ui::help_panel::HelpPanel;
use mariana_ui::overlay::{Overlay, OverlayContent};

const SIZE: (u32, u32) = (1280, 720);

fn main() -> Result<(), Box<dyn Error>> {
    let output = std::env::args().nth(1).unwrap_or_else(|| "keys.png".into());
    let context = Headless::new(false)?;
    let target = Target::new(context.gl(), SIZE, &[Texel::Rgba8], None)?;
    context.gl().replace_window(Some(&target));

    let mut overlay = Overlay::new(context.gl(), || {});
    let help = HelpPanel::default();
    let content = OverlayContent { help: Some(&help), ..OverlayContent::default() };
    overlay.paint(1.0, SIZE, content, Instant::now())?;

    image::save_buffer(&output, &target.read_rgba8(0), SIZE.0, SIZE.1, image::ColorType::Rgba8)?;
    println!("{output}: {} x {} pixels", SIZE.0, SIZE.1);
    Ok(())
}
