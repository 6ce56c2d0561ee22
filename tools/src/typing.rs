//! Measures typing in the editor: the time from a key press to the letter on screen, and to a frame of the edited text.
//!
//! The tool starts the program in a window of this desktop with a scene of 300 lines, opens the editor, edits a
//! number again and again with `xdotool`, and reads the program's log after it ends.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, ensure};

use crate::controllers;

/// Number of objects in the scene. Each object takes five lines.
const OBJECTS: usize = 59;
/// Pause between keys. It is longer than a frame on a slow machine, and not a multiple of the frame time on a fast
/// machine.
const PAUSE: Duration = Duration::from_millis(437);

/// Presses the given number of keys.
pub fn run(arguments: &[String]) -> anyhow::Result<()> {
    let program = arguments.first().context("expected a program: target/release/mariana")?;
    let keys: usize = arguments
        .get(1)
        .map_or(Ok(200), |text| text.parse())
        .context("the number of keys is not a number")?;
    let folder = std::env::temp_dir().join(format!("mariana-typing-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let scene = folder.join("sixty.scene");
    fs::write(&scene, text_of_scene())?;
    for mode in ["interpreted", "compiled"] {
        let log = folder.join(format!("{mode}.txt"));
        let mut child = Command::new(program)
            .args(["--silent", "--new", "--clean", "-v", "--prepare-ahead", "off", "--size", "640x360"])
            .args(["--sdf", mode, "--scene"])
            .arg(&scene)
            .env("HOME", &folder)
            .env_remove("XDG_CONFIG_HOME")
            .stdout(Stdio::null())
            .stderr(fs::File::create(&log)?)
            .spawn()?;
        let pressed =
            controllers::wait_for(&log, &format!("is shown, {mode}")).and_then(|()| press_keys(keys));
        Command::new("kill").arg(child.id().to_string()).status()?;
        child.wait()?;
        pressed?;
        let said = fs::read_to_string(&log)?;
        println!("{mode}, {keys} keys");
        for part in ["frames: ", "work for a key"] {
            let line = said.lines().rfind(|line| line.contains(part)).unwrap_or("the log has no such line");
            println!("  {}", line.rsplit_once("session::running: ").map_or(line, |(_, words)| words));
        }
    }
    Ok(fs::remove_dir_all(&folder)?)
}

/// Opens the editor, moves to the number at the end of the third line, and alternately inserts and deletes a digit.
fn press_keys(keys: usize) -> anyhow::Result<()> {
    // Wait until drivers and caches have settled.
    std::thread::sleep(Duration::from_secs(3));
    let press = |names: &[&str]| -> anyhow::Result<()> {
        let status =
            Command::new("xdotool").arg("key").args(names).status().context("xdotool cannot be run")?;
        ensure!(status.success(), "xdotool cannot press {names:?}");
        Ok(())
    };
    press(&["e"])?;
    std::thread::sleep(Duration::from_secs(2));
    press(&["ctrl+Home", "Down", "Down", "End", "Left"])?;
    for number in 0..keys {
        press(&[if number % 2 == 0 { "1" } else { "BackSpace" }])?;
        std::thread::sleep(PAUSE);
    }
    Ok(())
}

fn text_of_scene() -> String {
    let mut text = "material paint { color = vec3(0.6, 0.3, 0.2)  roughness = 0.6 }\n".to_owned();
    for number in 0..OBJECTS {
        let (x, z) = ((number % 10) as f32 * 1.2 - 5.4, (number / 10) as f32 * 1.2 - 3.0);
        let shape = [
            "sphere(q, 0.4)",
            "box(q, vec3(0.3, 0.3, 0.3))",
            "torus(q, 0.3, 0.1)",
            "capsule(q, vec3(0, -0.2, 0), vec3(0, 0.2, 0), 0.15)",
        ][number % 4];
        text += &format!(
            "object thing{number} {{\n    let q = p - vec3({x:.2}, 0.5 + 0.2 * sin(t + {number}), {z:.2})\n    \
             shape = {shape}\n    material = paint\n}}\n"
        );
    }
    text + "object floor { shape = p.y  material = paint }\n\
            camera { position = vec3(6, 5, 9)  target = vec3(0, 0, 0) }\n"
}
