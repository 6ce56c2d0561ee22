//! Scenes in two dimensions: the pointer in a formula, and shaders that the user opens.

use crate::support::apart::apart;
use crate::support::session::{App, Place};
use image::RgbaImage;
use mariana::input::Input;

/// A scene whose colour is the pointer's place and button. Nothing moves by itself.
const POINTER: &str = "sky { color = srgb(vec3(mouse.xy / resolution, mouse.z)) }
picture { tone_map = none  bloom = 0  grain = 0 }";

const HALVES: &str = "void mainImage(out vec4 c, in vec2 f) {
    c = f.x < 0.5 * iResolution.x ? vec4(1.0, 0.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0, 1.0);
}";

fn open(place: &Place, scene: &str) -> App {
    let scene = place.save("scenes/first.scene", scene);
    let app = place.open(&place.song(), &["--size", "160x90", "--scene", scene.to_str().unwrap()]);
    app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
    app
}

fn pixel(picture: &RgbaImage, x: u32) -> [u8; 3] {
    let [red, green, blue, _] = picture.get_pixel(x, 45).0;
    [red, green, blue]
}

fn is_near(color: [u8; 3], wanted: [u8; 3]) -> bool {
    color.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 4)
}

#[test]
fn a_formula_follows_the_pointer_over_a_still_picture() {
    apart!();
    let place = Place::with_song();
    let app = open(&place, POINTER);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let shows = |wanted| move |picture: &RgbaImage| is_near(pixel(picture, 5), wanted);
    for (at, wanted) in [([40.0, 22.5], [64, 191, 0]), ([120.0, 67.5], [191, 64, 0])] {
        app.move_pointer(at[0], at[1]);
        app.wait_for(&format!("the pointer at {at:?}"), shows(wanted));
    }
    app.hold_button(true);
    app.wait_for("the held button", shows([191, 64, 255]));
    app.hold_button(false);
    app.wait_for("the released button", shows([191, 64, 0]));
    app.quit();
}

#[test]
fn a_dropped_shader_becomes_a_scene_and_a_broken_one_leaves_the_scene() {
    apart!();
    let place = Place::with_song();
    let app = open(&place, POINTER);
    app.send(Input::Dropped(place.save("halves.glsl", HALVES)));
    let halves = |picture: &RgbaImage| {
        is_near(pixel(picture, 40), [255, 0, 0]) && is_near(pixel(picture, 120), [0, 0, 255])
    };
    app.wait_for("the shader", halves);
    app.wait_until_reported("imported as");
    assert!(place.path("data/scenes/halves.scene").is_file());
    app.send(Input::Dropped(place.save("broken.frag", "void main() {\n gl_FragColor = vec4(nothing); }")));
    app.wait_until_reported("broken.frag cannot become a scene: line 2: there is no `nothing` here");
    app.wait_for("the last scene", halves);
    app.quit();
    assert!(!place.path("data/scenes/broken.scene").exists());
}

#[test]
fn a_shader_on_the_command_line_is_the_scene() {
    apart!();
    let place = Place::with_song();
    let shader = place.save("halves.glsl", HALVES);
    let app = place.open(&place.song(), &["--size", "160x90", shader.to_str().unwrap()]);
    app.wait_for("the shader", |picture| is_near(pixel(picture, 40), [255, 0, 0]));
    app.quit();
}
