//! Draws a scene to a PNG: `cargo run -p mariana-render --example one_picture -- "sphere(p, 1)" ball.png`. The first
//! argument is the text of a scene or the name of a scene file.

use std::error::Error;

use mariana_field::world::World;
use mariana_music::Features;
use mariana_render::{Headless, SceneRenderer};

const SIZE: (u32, u32) = (640, 360);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let text =
        arguments.next().unwrap_or_else(|| "smooth_union(0.3, sphere(p, 1), box(p, vec3(2, 0.1, 2)))".into());
    let output = arguments.next().unwrap_or_else(|| "picture.png".into());
    let text = std::fs::read_to_string(&text).unwrap_or(text);

    let context = Headless::new(false)?;
    let mut scene = SceneRenderer::new(context.gl(), World::parse("the argument", &text)?)?;
    scene.draw(0.0, Features::SILENCE, SIZE)?;
    image::save_buffer(&output, &scene.read(), SIZE.0, SIZE.1, image::ColorType::Rgba8)?;
    println!("{output}: drawn by {}", context.gl().info().renderer);
    Ok(())
}
