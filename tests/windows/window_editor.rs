//! The editor in a program whose machine is too slow for a changed text, which is a fault of a whole process, and the copies
//! in the folder of whoever runs the program.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;

use crate::support::desktop::App;
use crate::walls::{QuietDesktop, quit};
use mariana_testing::process::wait_until;

/// A ball that fills the right of the picture and shines by itself, in one line.
fn ball(emission: &str) -> String {
    format!(
        "material m {{ color = 0  roughness = 1  emission = {emission} }} \
         object w {{ shape = sphere(p - vec3(0, 0, 30 + 0.1 * sin(t)), 25)  material = m }} \
         light n {{ direction = vec3(0, -1, 0)  color = 0 }} camera {{ position = vec3(0)  target = vec3(0, 0, 5) }} \
         sky {{ color = 0  ambient = 0 }}"
    )
}

/// Whether most of the picture is red at its right, where no editor is.
fn is_red(app: &App) -> bool {
    let picture = app.picture();
    let right = picture.enumerate_pixels().filter(|(x, _, _)| 20 * x > 19 * picture.width());
    let right: Vec<_> = right.map(|(_, _, pixel)| pixel.0).collect();
    let bright = [0, 1, 2].map(|at| 2 * right.iter().filter(|pixel| pixel[at] > 120).count() > right.len());
    bright == [true, false, false]
}

/// Opens the editor, whose text stands where the pixel is.
fn write(app: &App) -> image::Rgba<u8> {
    let plain = *app.picture().get_pixel(20, 200);
    app.press(&["e"]);
    wait_until("the editor", || *app.picture().get_pixel(20, 200) != plain);
    plain
}

#[test]
fn a_changed_text_whose_tree_takes_too_long_gives_the_last_picture_back() {
    let QuietDesktop { desktop, song } = QuietDesktop::new();
    let scene = desktop.folder().join("main.scene");
    fs::write(&scene, ball("vec3(1, 0, 0)")).unwrap();
    // Wide enough that the editor leaves some of the picture.
    let options =
        ["--silent", "--size", "760x420", "--sdf", "interpreted", "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open_with(&[("MARIANA_FAULT", "slow-tree@0")], &song, &options);
    app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
    wait_until("a red ball", || is_red(&app));
    let plain = write(&app);
    app.press(&["ctrl+a"]);
    app.xdotool(&["type", "--delay", "2", &ball("vec3(0, 1, 0)")]);
    app.wait_until_told("main is too much for this machine");
    assert!(is_red(&app));
    app.press(&["Escape"]);
    wait_until("the picture without the editor", || *app.picture().get_pixel(20, 200) == plain);
    quit(app);
}

#[test]
fn a_shipped_scene_is_copied_by_one_key_and_the_copy_is_written() {
    let QuietDesktop { desktop, song } = QuietDesktop::new();
    let options = ["--silent", "--size", "760x420", "--sdf", "interpreted", "--scene", "heart"];
    let mut app = desktop.open(&song, &options);
    app.wait_for_title("a scene", |title| title.contains("(heart"));
    write(&app);
    app.press(&["ctrl+s"]);
    let copy = desktop.folder().join(".local/share/mariana/scenes/heart.scene");
    wait_until("the copy", || copy.is_file());
    app.wait_for_title("its title", |title| title.contains("heart"));
    // As soon as the copy is read, keys are its text.
    wait_until("a letter in the copy", || {
        app.press(&["ctrl+End", "numbersign", "ctrl+s"]);
        fs::read_to_string(&copy).is_ok_and(|text| text.trim_end().ends_with('#'))
    });
    // Q ends the show as soon as the editor is closed.
    app.press(&["Escape"]);
    quit(app);
}
