//! The scene editor: typing changes the frame, a mistake keeps the last frame, texts are saved and recovered, and
//! numbers can be dragged.

use crate::support::apart::apart;
use std::fs;
use std::path::PathBuf;

use image::RgbaImage;

use crate::support::session::{self, App};

const SCENE: &str = "scenes/main.scene";
/// In this window, the editor leaves a part of the frame uncovered.
const SIZE: &str = "760x420";
/// Overlay colours of errors and of numbers in a text.
const ERROR: [u8; 3] = [255, 128, 112];
const NUMBER: [u8; 3] = [244, 190, 120];
/// The overlay colour of handles under the pointer.
const GRIP: [u8; 3] = [130, 204, 232];

fn wall(emission: &str) -> String {
    format!(
        "material m {{ color = 0  roughness = 1  emission = {emission} }} object w {{ shape = 5 - p.z  material = m }} \
         light n {{ direction = vec3(0, -1, 0)  color = 0 }} camera {{ position = vec3(0)  target = vec3(0, 0, 5) }} \
         sky {{ color = 0  ambient = 0 }}"
    )
}

struct Place {
    inner: session::Place,
    song: PathBuf,
}

impl Place {
    fn new(text: &str) -> Self {
        let inner = session::Place::new();
        let song = inner.quiet_song("quiet.wav", 60);
        inner.save(SCENE, text);
        Self { inner, song }
    }

    fn file(&self) -> PathBuf {
        self.inner.path(SCENE)
    }

    fn saved(&self) -> String {
        fs::read_to_string(self.file()).unwrap_or_default()
    }

    fn open(&self, options: &[&str]) -> App {
        let scene = self.file();
        let own = ["--size", SIZE, "--sdf", "interpreted", "--scene", scene.to_str().unwrap()];
        let all = [&own[..], options].concat();
        let app = self.inner.open(&self.song, &all);
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }
}

/// Returns the bright channels at the right edge of the frame, which the editor does not cover.
fn color(app: &App) -> [bool; 3] {
    let picture = app.picture();
    let right = picture.enumerate_pixels().filter(|(x, _, _)| 20 * x > 19 * picture.width());
    let right: Vec<_> = right.map(|(_, _, pixel)| pixel.0).collect();
    [0, 1, 2].map(|channel| 2 * right.iter().filter(|pixel| pixel[channel] > 120).count() > right.len())
}

const RED: [bool; 3] = [true, false, false];
const GREEN: [bool; 3] = [false, true, false];

fn wait_for_color(app: &App, what: &str, wanted: [bool; 3]) {
    app.wait_until(what, |app| color(app) == wanted);
}

/// The bounds (left, top, right, bottom) of the topmost group of pixels of a colour; `None` if no pixel has the colour.
fn group(picture: &RgbaImage, wanted: [u8; 3]) -> Option<(u32, u32, u32, u32)> {
    let is = |x: u32, y: u32| {
        let pixel = picture.get_pixel(x, y).0;
        (0..3).all(|channel| pixel[channel].abs_diff(wanted[channel]) < 24)
    };
    let row = |y: u32| (0..picture.width()).filter(move |x| is(*x, y));
    let top = (0..picture.height()).find(|y| row(*y).next().is_some())?;
    let bottom = (top..picture.height()).take_while(|y| row(*y).next().is_some()).last()?;
    let xs = (top..=bottom).flat_map(row);
    let (left, right) = xs.fold((u32::MAX, 0), |(left, right), x| (left.min(x), right.max(x)));
    Some((left, top, right, bottom))
}

fn wait_for_group(app: &App, what: &str, wanted: [u8; 3]) -> (u32, u32, u32, u32) {
    group(&app.wait_for(what, |picture| group(picture, wanted).is_some()), wanted).unwrap()
}

fn wait_until_gone(app: &App, what: &str, wanted: [u8; 3]) {
    app.wait_for(what, |picture| group(picture, wanted).is_none());
}

/// Opens the editor and waits for the highlighted numbers in the text.
fn write(app: &App) {
    app.press(&["e"]);
    wait_for_group(app, "the highlighted text", NUMBER);
}

fn replace_by_green(app: &App) {
    write(app);
    app.press(&["ctrl+a"]);
    app.type_text(&wall("vec3(0, 1, 0)"));
    wait_for_color(app, "a green wall", GREEN);
}

fn quit(app: App) {
    app.press(&["Escape"]);
    wait_until_gone(&app, "the frame without the editor", NUMBER);
    app.quit_by_key();
}

#[test]
fn typing_changes_the_frame_and_a_mistake_keeps_it() {
    apart!();
    let place = Place::new(&wall("vec3(1, 0, 0)"));
    let app = place.open(&[]);
    wait_for_color(&app, "a red wall", RED);
    replace_by_green(&app);
    assert_eq!(place.saved(), wall("vec3(1, 0, 0)"), "the file was saved without a command");
    app.type_text(" $");
    wait_for_group(&app, "a mark at the mistake", ERROR);
    assert_eq!(color(&app), GREEN);
    app.press(&["BackSpace", "BackSpace"]);
    wait_until_gone(&app, "the text without a mark", ERROR);
    app.press(&["ctrl+s"]);
    app.wait_until("the saved file", |_| place.saved() == wall("vec3(0, 1, 0)"));
    quit(app);
}

#[test]
fn keys_type_text_in_the_editor_and_control_the_show_outside() {
    apart!();
    let place = Place::new(&wall("vec3(1, 0, 0)"));
    let app = place.open(&[]);
    write(&app);
    app.press(&["ctrl+End"]);
    app.type_text(" # quit, not");
    app.press(&["ctrl+s"]);
    app.wait_until("the letters in the file", |_| place.saved().ends_with(" # quit, not"));
    assert!(app.runs(), "a typed letter ended the session");
    // After a click outside the editor, keys control the show again.
    app.click_at(745, 400);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    assert!(place.saved().ends_with(" # quit, not"));
    app.press(&["e"]);
    app.press(&["x", "ctrl+s"]);
    app.wait_until("another letter in the file", |_| place.saved().ends_with(" # quit, notx"));
    // The click also opened the object's card. Esc closes the card first.
    app.press(&["Escape"]);
    quit(app);
}

#[test]
fn a_save_by_another_program_asks_before_overwriting() {
    apart!();
    let place = Place::new(&wall("vec3(1, 0, 0)"));
    let app = place.open(&[]);
    replace_by_green(&app);
    let theirs = wall("vec3(0, 0, 1)");
    fs::write(place.file(), &theirs).unwrap();
    app.press(&["ctrl+s"]);
    wait_for_group(&app, "the question", ERROR);
    assert_eq!((place.saved(), color(&app)), (theirs, GREEN));
    app.press(&["ctrl+1"]);
    app.wait_until("the editor's text in the file", |_| place.saved() == wall("vec3(0, 1, 0)"));
    quit(app);
}

#[test]
fn unsaved_text_is_recovered_after_a_crash() {
    apart!();
    let place = Place::new(&wall("vec3(1, 0, 0)"));
    let app = place.open(&[]);
    replace_by_green(&app);
    let kept = place.inner.path("state/unsaved");
    app.wait_until("the recovery file", |_| {
        // Temporary files are incomplete.
        let files = fs::read_dir(&kept).into_iter().flatten().flatten();
        let files = files.filter(|file| !file.file_name().as_encoded_bytes().starts_with(b"."));
        files
            .map(|file| fs::read(file.path()).unwrap_or_default())
            .any(|text| String::from_utf8_lossy(&text).ends_with(&wall("vec3(0, 1, 0)")))
    });
    place.inner.cut_off(app);
    assert_eq!(place.saved(), wall("vec3(1, 0, 0)"));
    let app = place.open(&[]);
    wait_for_color(&app, "the saved wall", RED);
    write(&app);
    wait_for_group(&app, "the question", ERROR);
    app.press(&["ctrl+1"]);
    wait_until_gone(&app, "the text without a question", ERROR);
    wait_for_color(&app, "the recovered text in the frame", GREEN);
    quit(app);
}

#[test]
fn dragging_a_number_does_not_reload_the_text() {
    apart!();
    let place = Place::new(&format!("let level = 1\n{}", wall("level * vec3(0, 0.1, 0)")));
    let app = place.open(&["-vv"]);
    app.wait_until("a dark wall", |_| color(&app) == [false; 3]);
    write(&app);
    let (left, _, right, bottom) = wait_for_group(&app, "the number", NUMBER);
    let loads = |app: &App| app.reported().matches("is loaded again for its draft").count();
    let before = loads(&app);
    let (grip_x, grip_y) = ((left + right) / 2, bottom + 7);
    app.point_at(grip_x, grip_y);
    app.wait_for("the grip", |picture| group(&part(picture, grip_x - 6, grip_y - 4, 12, 8), GRIP).is_some());
    app.hold_button(true);
    app.wait_until("the number to become an input", |app| loads(app) == before + 1);
    let mut moved = 0;
    app.wait_until("a bright wall", |app| {
        // Drag in several steps, and stop before the end of the number's range.
        if moved < 100 {
            moved += 4;
            app.point_at(grip_x + moved, grip_y);
        }
        color(app) == GREEN
    });
    assert_eq!(loads(&app), before + 1, "the frame needed a reload of the text");
    app.hold_button(false);
    app.wait_until("the reload after the drag", |app| loads(app) == before + 2);
    app.press(&["ctrl+s"]);
    app.wait_until("the number in the file", |_| {
        !place.saved().is_empty() && !place.saved().starts_with("let level = 1\n")
    });
    assert!(place.saved().starts_with("let level = "), "{}", place.saved());
    assert_eq!(color(&app), GREEN);
    app.wait_for_title("the scene", |title| title.contains("main"));
    quit(app);
}

/// A glowing ball in front of a black sky, at the right of the frame, which the editor does not cover.
const BALL: &str = "\
material m { color = 0  roughness = 1
  emission = vec3(1, 0, 0) }
object ball {
  shape = sphere(p - vec3(3.5, 0, 5), 0.7)
  material = m
}
light n { direction = vec3(0, -1, 0)  color = 0 }
camera { position = vec3(0)  target = vec3(0, 0, 5)  fov = 60 }
sky { color = 0  ambient = 0 }
";
/// The position of the ball in a window of [`SIZE`].
const BALL_AT: (u32, u32) = (634, 210);

fn part(picture: &RgbaImage, left: u32, top: u32, width: u32, height: u32) -> RgbaImage {
    image::imageops::crop_imm(picture, left, top, width, height).to_image()
}

fn is_ball(app: &App, wanted: [bool; 3]) -> bool {
    let pixel = app.picture().get_pixel(BALL_AT.0, BALL_AT.1).0;
    [0, 1, 2].map(|channel| pixel[channel] > 120) == wanted
}

#[test]
fn a_click_on_the_frame_identifies_the_object_and_its_line() {
    apart!();
    let place = Place::new(BALL);
    let app = place.open(&["-vv"]);
    write(&app);
    app.wait_until("the ball", |_| is_ball(&app, RED));
    app.click_at(BALL_AT.0, BALL_AT.1);
    app.wait_until_reported("probed:");
    let reported = app.reported();
    let probed = reported.lines().find(|line| line.contains("probed:")).unwrap_or_default();
    assert!(probed.contains("object: \"ball\", material: \"m\""), "{probed}");
    // A click on the card's line focuses the editor and moves the cursor to the object's text.
    app.wait_until("the card", |_| {
        let right = part(&app.picture(), 510, 200, 250, 200);
        group(&right, GRIP).is_some()
    });
    app.click_at(600, 343);
    app.type_text("1 * ");
    app.press(&["ctrl+s"]);
    app.wait_until("the letters in the file", |_| place.saved() == BALL.replace("sphere(", "1 * sphere("));
    // A click on the sky probes the sky.
    app.click_at(740, 20);
    app.wait_until_reported("surface: None");
    assert!(app.runs());
    // Esc closes the card, then the editor.
    app.press(&["e", "Escape"]);
    quit(app);
}

#[test]
fn the_object_of_the_line_at_the_cursor_is_highlighted() {
    apart!();
    let place = Place::new(BALL);
    let app = place.open(&[]);
    write(&app);
    app.wait_until("the ball", |_| is_ball(&app, RED));
    let blue = |app: &App| app.picture().get_pixel(BALL_AT.0, BALL_AT.1).0[2];
    let before = blue(&app);
    app.press(&["ctrl+Home", "ctrl+l"]);
    let is_lit = |app: &App| blue(app) > before + 20;
    // The cursor is in the first line, which belongs to the ball's material.
    app.wait_until("the ball in another colour", |_| is_lit(&app));
    app.press(&["ctrl+End"]);
    app.wait_until("the ball in its own colour", |_| !is_lit(&app));
    assert_eq!(place.saved(), BALL);
    quit(app);
}

#[test]
fn a_colour_in_the_text_is_picked_and_saved() {
    apart!();
    let place = Place::new(BALL);
    let app = place.open(&[]);
    write(&app);
    app.wait_until("the ball", |_| is_ball(&app, RED));
    let mut swatch = None;
    app.wait_until("the swatch", |_| {
        swatch = group(&part(&app.picture(), 0, 0, 480, 200), [255, 0, 0]);
        swatch.is_some()
    });
    let (left, top, right, _) = swatch.unwrap();
    app.click_at((left + right) / 2, top - 5);
    // The row of hues contains green. The test looks for green pixels in it.
    let mut green = None;
    app.wait_until("the colours", |_| {
        green = group(&part(&app.picture(), 0, top + 4, 500, 420 - top - 4), [0, 255, 0]);
        green.is_some()
    });
    let (left, upper, right, _) = green.unwrap();
    app.click_at((left + right) / 2, top + 4 + upper + 2);
    app.wait_until("a green ball", |_| is_ball(&app, GREEN));
    app.press(&["Escape", "ctrl+s"]);
    app.wait_until("the colour in the file", |_| !place.saved().is_empty() && place.saved() != BALL);
    let saved = place.saved();
    let numbers = saved.split("emission = vec3(").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
    let numbers: Vec<f64> = numbers.split(", ").map(|number| number.parse().unwrap()).collect();
    assert!(numbers[0] < 0.1 && numbers[1] > 0.9 && numbers[2] < 0.1, "{saved}");
    app.press(&["ctrl+z", "ctrl+s"]);
    app.wait_until("the original colour in the file", |_| place.saved() == BALL);
    quit(app);
}

#[test]
fn a_position_is_dragged_in_the_frame_and_saved() {
    apart!();
    /// The colour of the x axis of the handle.
    const ARM: [u8; 3] = [236, 96, 84];
    let place = Place::new(&BALL.replace("vec3(1, 0, 0)", "vec3(0, 0, 1)"));
    let app = place.open(&[]);
    write(&app);
    app.wait_until("the ball", |_| is_ball(&app, [false, false, true]));
    app.press(&["ctrl+f"]);
    app.type_text("3.5");
    app.press(&["Return", "Escape"]);
    let mut arm = None;
    app.wait_until("the cross", |_| {
        arm = group(&part(&app.picture(), 510, 0, 250, 420), ARM);
        arm.is_some()
    });
    let (_, top, right, bottom) = arm.unwrap();
    let (mut x, y) = (510 + right - 5, (top + bottom) / 2);
    app.point_at(x, y);
    app.hold_button(true);
    app.wait_until("the ball to leave its position", |app| {
        x -= 4;
        app.point_at(x, y);
        is_ball(app, [false; 3])
    });
    app.hold_button(false);
    app.press(&["ctrl+s"]);
    app.wait_until("the position in the file", |_| {
        !place.saved().is_empty() && !place.saved().contains("3.5, 0, 5")
    });
    let saved = place.saved();
    let numbers = saved.split("p - vec3(").nth(1).and_then(|rest| rest.split(", ").next()).unwrap();
    let x: f64 = numbers.parse().unwrap();
    assert!(x < 3.0 && saved.contains(&format!("p - vec3({numbers}, 0, 5)")), "{saved}");
    quit(app);
}

/// A red ball that fills the right of the frame. A green ball in front of it is commented out.
const BALLS: &str = "\
material red { color = 0  roughness = 1  emission = vec3(1, 0, 0) }
material green { color = 0  roughness = 1  emission = vec3(0, 1, 0) }
light none { direction = vec3(0, -1, 0)  color = 0 }
camera { position = vec3(0)  target = vec3(0, 0, 5) }
sky { color = 0  ambient = 0 }
object far { shape = sphere(p - vec3(0, 0, 30 + 0.1 * sin(t)), 25)  material = red }
#object near { shape = sphere(p - vec3(0, 0, 20 + 0.1 * sin(t)), 16)  material = green }";

/// A single key makes the change. Typing letter by letter would also show the intermediate texts.
#[test]
fn a_scene_whose_tree_takes_too_long_keeps_the_last_frame() {
    apart!("MARIANA_FAULT" = "slow-tree@0");
    let place = Place::new(BALLS);
    let app = place.open(&[]);
    wait_for_color(&app, "a red ball", RED);
    write(&app);
    app.press(&["ctrl+End", "Home", "Delete"]);
    app.wait_until_reported("main is too much for this machine");
    assert_eq!(color(&app), RED);
    quit(app);
}

#[test]
fn a_shipped_scene_is_copied_by_one_key_and_the_copy_is_edited() {
    apart!();
    let place = session::Place::new();
    let song = place.quiet_song("quiet.wav", 60);
    let app = place.open(&song, &["--size", SIZE, "--sdf", "interpreted", "--scene", "heart"]);
    app.wait_for_title("a scene", |title| title.contains("(heart"));
    write(&app);
    app.press(&["ctrl+s"]);
    let copy = place.path("data/scenes/heart.scene");
    app.wait_until("the copy", |_| copy.is_file());
    app.wait_for_title("its title", |title| title.contains("heart"));
    // Keys edit the copy only after the session has loaded it.
    app.wait_until("a letter in the copy", |app| {
        app.press(&["ctrl+End", "#", "ctrl+s"]);
        fs::read_to_string(&copy).is_ok_and(|text| text.trim_end().ends_with('#'))
    });
    quit(app);
}
