//! Lists the shipped scenes with their objects: `cargo run -p mariana-scenes --example shipped_scenes`.

use std::error::Error;

use mariana_scenes::{SceneSource, shipped_names};

fn main() -> Result<(), Box<dyn Error>> {
    for name in shipped_names() {
        let ready = SceneSource::find(&name)?.ready()?;
        let objects: Vec<_> = ready.world.scene.objects.iter().map(|object| object.name.as_str()).collect();
        println!("{name}: {}", objects.join(", "));
    }
    Ok(())
}
