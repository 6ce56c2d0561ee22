//! Scenes in the window as a user meets them: saved while they are shown, broken and mended, gone through by keys,
//! interpreted and compiled, turned by sliders.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use mariana::scenes::shipped_names;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::compare::{TIGHT, assert_alike, pixel_difference};
use crate::support::desktop::{App, PROGRAM, command_in};
use crate::walls::{QuietDesktop, quit_content as quit};
use image::RgbaImage;
use mariana_testing::process::wait_until;

/// Longest time from the wish to quit to the end, whatever the drivers are at.
const QUIT_LIMIT: Duration = Duration::from_secs(60);
/// The window of most tests: small, because it is drawn without a graphics card.
const SMALL: &str = "160x90";
const TINY: &str = "32x18";

/// A wall that fills the picture and shines by itself.
fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n{AHEAD}"
    )
}

/// A camera that looks along z, and nothing that shines.
const AHEAD: &str = "light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                     sky { color = 0  ambient = 0 }\n";
const RED: &str = "vec3(1, 0, 0)";
const GREEN: &str = "vec3(0, 1, 0)";
const BLUE: &str = "vec3(0, 0, 1)";

impl QuietDesktop {
    fn with_folder() -> Self {
        let place = Self::new();
        fs::create_dir(place.desktop.folder().join("scenes")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.desktop.folder().join("scenes").join(name)
    }

    fn save(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// The program with a file of the folder, when its scene shows.
    fn open(&self, name: &str, options: &[&str]) -> App<'_> {
        self.open_scene(self.path(name).to_str().unwrap(), SMALL, options)
    }

    /// The same in a window for scenes that take long to draw.
    fn open_tiny(&self, name: &str, options: &[&str]) -> App<'_> {
        self.open_scene(self.path(name).to_str().unwrap(), TINY, options)
    }

    /// The picture of a scene of the folder at the song's start, without a window.
    fn still(&self, name: &str, size: (u32, u32)) -> RgbaImage {
        let output = self.path("still.png");
        let mut command = command_in(PROGRAM, self.desktop.folder(), None);
        command.arg("still").arg(&self.song).arg("--scene").arg(self.path(name)).arg("-o").arg(&output);
        command.args(["--size", &format!("{}x{}", size.0, size.1)]);
        let run = command.output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        image::open(&output).unwrap().to_rgba8()
    }

    fn open_scene(&self, scene: &str, size: &str, options: &[&str]) -> App<'_> {
        let all = [&["--silent", "--size", size, "--scene", scene], options].concat();
        let mut app = self.desktop.open(&self.song, &all);
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }
}

/// The colour that most of the upper half has, where no panel for mistakes is: which channels are there.
fn color(app: &App) -> [bool; 3] {
    let picture = app.picture();
    let upper = picture.enumerate_pixels().filter(|(_, y, _)| 2 * y < picture.height());
    let upper: Vec<_> = upper.map(|(_, _, pixel)| pixel.0).collect();
    [0, 1, 2].map(|channel| 2 * upper.iter().filter(|pixel| pixel[channel] > 120).count() > upper.len())
}

const SEEN_RED: [bool; 3] = [true, false, false];
const SEEN_GREEN: [bool; 3] = [false, true, false];
const SEEN_BLUE: [bool; 3] = [false, false, true];

fn wait_for_color(app: &App, what: &str, wanted: [bool; 3]) {
    wait_until(what, || color(app) == wanted);
}

fn pause(app: &mut App) {
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
}

/// A picture that does not change any more: notices have faded, and what stands still is drawn as well as possible,
/// which takes a loaded machine more than one look.
fn settled(app: &App) -> RgbaImage {
    let mut last = app.picture();
    let mut alike = 0;
    wait_until("a picture that stands still", || {
        std::thread::sleep(Duration::from_millis(700));
        let newest = app.picture();
        alike = if newest == last { alike + 1 } else { 0 };
        last = newest;
        alike >= 4
    });
    last
}

fn wait_for_mode(app: &mut App, mode: &str) {
    app.wait_for_title(mode, |title| title.contains(&format!(", {mode}")));
}

#[test]
fn a_saved_scene_shows_and_the_song_goes_on() {
    let place = QuietDesktop::with_folder();
    // Blue comes in the third second of the song: not again if a new scene does not begin it anew.
    let with_time = |red: u8, green: u8| wall(&format!("vec3({red}, {green}, if t < 2 then 0 else 1)"));
    place.save("own.scene", &with_time(1, 0));
    let mut app = place.open("own.scene", &[]);
    wait_for_color(&app, "red and blue", [true, false, true]);
    place.save("own.scene", &with_time(0, 1));
    let mut first = None;
    wait_until("the saved scene", || {
        first = Some(color(&app)).filter(|color| color[1]);
        first.is_some()
    });
    assert_eq!(first, Some([false, true, true]), "the song began anew");

    // Beside, then moved over it.
    place.save("own.scene~", &wall(RED));
    fs::rename(place.path("own.scene~"), place.path("own.scene")).unwrap();
    wait_for_color(&app, "the scene that was moved in place of the other", SEEN_RED);

    // What it includes, in both ways.
    place.save("paint.scene", &format!("fn shine() = {GREEN}"));
    place.save("own.scene", &format!("include \"paint.scene\"\n{}", wall("shine()")));
    wait_for_color(&app, "the colour of the included file", SEEN_GREEN);
    place.save("paint.scene", &format!("fn shine() = {BLUE}"));
    wait_for_color(&app, "another colour of the included file", SEEN_BLUE);
    place.save("paint.scene~", &format!("fn shine() = {RED}"));
    fs::rename(place.path("paint.scene~"), place.path("paint.scene")).unwrap();
    wait_for_color(&app, "the included file that was moved in place of the other", SEEN_RED);

    // A picture that it shows.
    let picture = |color: [u8; 3]| {
        let side = RgbaImage::from_pixel(4, 4, image::Rgba([color[0], color[1], color[2], 255]));
        side.save(place.path("side.png")).unwrap();
    };
    picture([0, 255, 0]);
    place.save("own.scene", &wall("texture(\"side.png\", p.xy).rgb"));
    wait_for_color(&app, "the texture", SEEN_GREEN);
    picture([0, 0, 255]);
    wait_for_color(&app, "the saved texture", SEEN_BLUE);
    app.wait_for_title("the scene, played", |title| {
        title.starts_with("quiet.wav - Mariana (own, ") && !title.contains("paused")
    });
    quit(app);
}

/// The lowest row of a picture of one colour that is still in it; above a panel at the bottom.
fn clear_rows(picture: &RgbaImage, clear: &RgbaImage) -> u32 {
    let rows = 0..picture.height();
    rows.take_while(|&y| (0..picture.width()).all(|x| picture.get_pixel(x, y) == clear.get_pixel(x, y)))
        .count() as u32
}

/// What one colour may differ from pixel to pixel.
const DITHER: u8 = 2;

/// Waits until nothing is over a picture of one colour.
fn wait_for_one_color(app: &App) -> RgbaImage {
    let mut picture = app.picture();
    wait_until("nothing over the picture", || {
        picture = app.picture();
        let first = *picture.get_pixel(0, 0);
        picture.pixels().all(|pixel| pixel_difference(pixel, &first) <= DITHER)
    });
    picture
}

/// The same once a show that stands still is drawn as well as it can be, which is after 0.4 s.
fn wait_for_one_color_at_rest(app: &App) -> RgbaImage {
    let mut rested = wait_for_one_color(app);
    wait_until("a picture that stays", || {
        std::thread::sleep(Duration::from_millis(800));
        std::mem::replace(&mut rested, wait_for_one_color(app)) == rested
    });
    rested
}

#[test]
fn a_broken_save_keeps_the_picture_and_says_what_is_wrong_until_it_is_mended() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", &wall(RED));
    let mut app = place.open("own.scene", &[]);
    wait_for_mode(&mut app, "compiled");
    wait_for_color(&app, "red", SEEN_RED);
    pause(&mut app);
    let clear = wait_for_one_color_at_rest(&app);
    let panel_shows = |app: &App| clear_rows(&app.picture(), &clear) < 88;
    let kept = |app: &App| {
        // The panel may need all the room but a margin.
        for (x, y) in [(0, 0), (159, 0), (0, 89), (159, 89)] {
            // While something moves, fewer pixels may be drawn: their grain is another.
            let steps = pixel_difference(app.picture().get_pixel(x, y), clear.get_pixel(x, y));
            assert!(steps <= 2, "{steps} steps at {x}, {y}");
        }
    };

    place.save("own.scene", &wall("vec3(1, 0 0)"));
    app.wait_until_told("own.scene has mistakes");
    wait_until("what is wrong", || panel_shows(&app));
    kept(&app);
    place.save("own.scene", &wall(GREEN));
    wait_for_color(&app, "the mended scene", SEEN_GREEN);
    wait_for_one_color(&app);

    // A mistake in an included file, and a picture that is not there.
    let back = |app: &App| {
        place.save("own.scene", &wall(RED));
        wait_until("the mended scene alone", || app.picture() == clear);
    };
    back(&app);
    place.save("part.scene", "fn shine() = vec3(1, 0");
    place.save("own.scene", &format!("include \"part.scene\"\n{}", wall("shine()")));
    wait_until("what is wrong with the include", || panel_shows(&app));
    kept(&app);
    app.wait_until_told("part.scene:1");
    place.save("part.scene", "fn shine() = vec3(1, 0, 0)");
    wait_until("the mended include", || app.picture() == clear);
    place.save("own.scene", &wall("texture(\"none.png\", p.xy).rgb"));
    wait_until("what is wrong with the picture", || panel_shows(&app));
    kept(&app);
    app.wait_until_told("none.png");
    back(&app);

    // The file itself is gone, then there again.
    fs::remove_file(place.path("own.scene")).unwrap();
    wait_until("that the file is gone", || panel_shows(&app));
    kept(&app);
    app.wait_until_told("cannot be read");
    back(&app);
    app.wait_for_title("the scene", |title| title == "quiet.wav - Mariana (own, compiled, paused)");
    quit(app);
}

/// Balls that move.
const VARIED_BY_TIME: &str = "
object floor { shape = p.y + 1 }
object balls { shape = smooth_union(for i in 0..3: sphere(p - vec3(i - 1, 0.5 * sin(t + i), 4), 0.6), 0.3) }
light lamp { position = vec3(-3, 5, 0) color = 60 }
camera { position = vec3(0, 0.5, 0) target = vec3(0, 0, 4) }
";

/// Balls, lights and a picture, enough for two ways of computing it to differ.
const VARIED: &str = "
material wood { color = triplanar(\"wood.png\", p * 0.5, n) roughness = 0.4 }
material ball { color = vec3(0.2, 0.5, 0.8) roughness = 0.3 }
object floor { shape = p.y + 1 material = wood }
object balls { shape = smooth_union(for i in 0..3: sphere(p - vec3(i - 1, 0.3 * i, 4), 0.6), 0.3) material = ball }
light lamp { position = vec3(-3, 5, 0) color = 60 }
camera { position = vec3(0, 0.5, 0) target = vec3(0, 0, 4) }
";

#[test]
fn the_mode_is_as_told_and_c_changes_it_but_not_the_picture() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", VARIED);
    for (first, other) in [("interpreted", "compiled"), ("compiled", "interpreted")] {
        let mut app = place.open("own.scene", &["--sdf", first, "--quality", "best"]);
        let modes = |app: &App| app.title();
        assert!(modes(&app).starts_with(&format!("quiet.wav - Mariana (own, {first}")), "{}", app.title());
        pause(&mut app);
        app.press(&["Left"]);
        let before = settled(&app);
        app.press(&["c"]);
        wait_for_mode(&mut app, other);
        let after = settled(&app);
        assert_alike(&format!("window-{other}"), &after, &before, TIGHT);
        app.press(&["c"]);
        wait_for_mode(&mut app, first);
        wait_until("the picture of before", || app.picture() == before);
        quit(app);
    }
}

#[test]
fn r_changes_whether_regions_are_used_but_not_the_picture() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", VARIED);
    for (mode, first) in [("interpreted", "on"), ("compiled", "off")] {
        let mut app = place.open("own.scene", &["--sdf", mode, "--regions", first, "-vv"]);
        wait_for_mode(&mut app, mode);
        pause(&mut app);
        app.press(&["Left"]);
        let before = settled(&app);
        app.press(&["r"]);
        app.wait_until_told(if first == "on" { "told: no regions" } else { "told: regions" });
        if first == "off" {
            // The compiled program was made without code for cells.
            app.wait_until_told("own is requested, compiled, with cells");
        }
        let after = settled(&app);
        assert_alike(&format!("window-{mode}-regions-not-{first}"), &after, &before, TIGHT);
        app.press(&["r"]);
        app.wait_until_told(if first == "on" { "told: regions" } else { "told: no regions" });
        wait_until("the picture of before", || app.picture() == before);
        quit(app);
    }
}

#[test]
fn what_is_shown_in_the_end_is_what_is_asked_for_however_fast_that_changes() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", VARIED_BY_TIME);
    let mut app = place.open("own.scene", &["--sdf", "interpreted"]);
    pause(&mut app);
    for key in ["Right", "Right", "Left", "r", "Right", "r", "Left", "Left", "Left"] {
        app.press(&[key]);
    }
    app.xdotool(&["windowsize", app.window(), "200", "100"]);
    app.wait_for_size((200, 100));
    // The song's start.
    let wanted = place.still("own.scene", (200, 100));
    wait_until("the picture of the start", || {
        let seen = app.picture();
        seen.dimensions() == (200, 100)
            && crate::support::compare::difference(&seen, &wanted, TIGHT.visible).share <= TIGHT.share_max
    });
    quit(app);
}

/// A scene that takes a driver a second or more to compile: its colour is `emission`.
fn heavy(balls: u32, emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = smooth_union(5 - p.z, union(for i in 0..{balls}: \
         sphere(p - vec3(sin(i), cos(1.7 * i), 9 + i), 0.3 + 0.1 * sin(t + i))), 0.1)  material = paint }}\n{AHEAD}"
    )
}

#[test]
fn a_scene_is_shown_interpreted_until_it_is_compiled_without_being_asked() {
    let place = QuietDesktop::with_folder();
    // The interpreter that is there for the first serves the second, too.
    // Short ones: on a software renderer long ones wait for their own programs.
    place.save("own.scene", &heavy(2, RED));
    let others = 2..7;
    for number in others.clone() {
        place.save(&format!("own{number}.scene"), &heavy(2, &format!("{GREEN} * (1 - 0.01 * {number})")));
    }
    let scene = place.path("own.scene");
    let options = ["--silent", "--size", TINY, "--scene", scene.to_str().unwrap(), "-v"];
    // What an earlier run compiled would be there before the interpreter's turn comes.
    let mut app = place.desktop.open_with(&[("MESA_SHADER_CACHE_DISABLE", "true")], &place.song, &options);
    app.wait_until_told("an interpreter is ready");
    // A driver may be quicker than that with a short scene; not with all of them.
    let mut was_interpreted = false;
    for number in others {
        app.press(&["n"]);
        app.wait_until_told(&format!("own{number} is shown, compiled"));
        app.wait_for_title("the new scene, compiled", |title| {
            title.contains(&format!("(own{number}, compiled)"))
        });
        wait_for_color(&app, "the new scene", SEEN_GREEN);
        let told = app.told();
        let [first, second] =
            ["interpreted", "compiled"].map(|mode| told.find(&format!("own{number} is shown, {mode}")));
        assert!(first.is_none_or(|first| Some(first) < second), "{told}");
        was_interpreted |= first.is_some();
    }
    assert!(was_interpreted, "{}", app.told());
    quit(app);
}

#[test]
fn a_number_that_is_changed_again_waits_for_no_compiler() {
    let place = QuietDesktop::with_folder();
    let save = |green: &str| place.save("own.scene", &wall(&format!("vec3({green}, 0, 0.9 - {green})")));
    save("0");
    let mut app = place.open("own.scene", &["-v"]);
    let requests = |app: &mut App| app.told().matches("own is requested, compiled").count();
    let is_compiled = |app: &mut App, times: usize| {
        wait_until("a compiled scene", || app.told().matches("own is shown, compiled").count() >= times);
    };
    is_compiled(&mut app, 1);
    wait_for_color(&app, "blue", SEEN_BLUE);
    // The first change makes a program that reads the numbers, the others find it.
    for (shown, (number, color)) in
        [("0.9", SEEN_RED), ("0.0", SEEN_BLUE), ("0.91", SEEN_RED)].into_iter().enumerate()
    {
        save(number);
        wait_for_color(&app, number, color);
        is_compiled(&mut app, 2 + shown);
        assert_eq!(requests(&mut app), 2, "{}", app.told());
    }
    // At rest they become constants again.
    wait_until("another program", || requests(&mut app) == 3);
    is_compiled(&mut app, 5);
    assert_eq!(color(&app), SEEN_RED);
    quit(app);
}

#[test]
fn n_and_p_go_through_the_folder_and_the_shipped_scenes_and_back() {
    let place = QuietDesktop::with_folder();
    for (name, emission) in [("a.scene", RED), ("b.scene", GREEN), ("broken.scene", "vec3(")] {
        place.save(name, &wall(emission));
    }
    let mut app = place.open("a.scene", &[]);
    wait_for_color(&app, "a", SEEN_RED);
    let shows = |app: &mut App, name: &str| {
        app.wait_for_title(name, |title| title.contains(&format!("Mariana ({name}, ")));
    };
    app.press(&["n"]);
    shows(&mut app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    // One that cannot be shown is no dead end.
    app.press(&["n"]);
    app.wait_until_told("broken.scene has mistakes");
    app.press(&["n"]);
    shows(&mut app, &shipped_names()[0]);
    app.press(&["p", "p"]);
    shows(&mut app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    app.press(&["p"]);
    shows(&mut app, "a");
    wait_for_color(&app, "a", SEEN_RED);
    // Once round, faster than scenes are loaded, and one further.
    app.press(&vec!["n"; 4 + shipped_names().len()]);
    shows(&mut app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    quit(app);
}

#[test]
fn a_scene_that_cannot_be_shown_at_the_start_ends_the_program_with_what_is_wrong() {
    let place = QuietDesktop::with_folder();
    place.save("broken.scene", &wall("vec3(1, 0 0)"));
    let ended = |scene: &Path, expected: &str| {
        let mut command = place.desktop.command(PROGRAM);
        command.arg(&place.song).args(["--silent", "--size", SMALL, "--scene"]).arg(scene);
        let run = command.output().unwrap();
        let told = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(1), "{told}");
        assert!(told.contains(expected) && !told.contains("panicked"), "no '{expected}' in {told}");
    };
    ended(&place.path("broken.scene"), "broken.scene:1:");
    ended(&place.path("missing.scene"), "missing.scene");
    ended(Path::new("speekers"), "speekers");
    ended(Path::new("length(p) - "), "error");
}

#[test]
fn a_formula_is_a_scene() {
    let place = QuietDesktop::with_folder();
    let mut app = place.open_scene("sqrt(x*x + y*y + z*z) - 1", SMALL, &[]);
    app.wait_for_title("the formula", |title| title.contains("Mariana (formula, "));
    wait_until("a ball in the middle that is not what is in the corner", || {
        let picture = app.picture();
        let [middle, corner] = [(80, 45), (2, 2)].map(|(x, y)| *picture.get_pixel(x, y));
        pixel_difference(&middle, &corner) > 30
    });
    quit(app);
}

#[test]
fn a_moved_slider_changes_the_picture_and_outlives_a_reload() {
    let place = QuietDesktop::with_folder();
    let text =
        |blue: u8| format!("param level = 0 in 0 .. 1\n{}", wall(&format!("vec3(level, 1 - level, {blue})")));
    place.save("own.scene", &text(0));
    let mut app = place.open_scene(place.path("own.scene").to_str().unwrap(), "320x180", &[]);
    wait_for_color(&app, "green", SEEN_GREEN);
    let before = app.picture();
    app.press(&["Tab"]);
    wait_until("the slider", || app.picture() != before);
    wait_for_mode(&mut app, "compiled");
    // To the right end of the rail, which is somewhere in the panel's rows, and beyond.
    let mut rows = (26..46).step_by(4).cycle();
    wait_until("what the slider is moved to", || {
        let row = rows.next().unwrap().to_string();
        app.xdotool(&["mousemove", "--window", app.window(), "230", &row, "mousedown", "1"]);
        app.xdotool(&["mousemove", "--window", app.window(), "318", &row]);
        std::thread::sleep(Duration::from_millis(100));
        app.xdotool(&["mouseup", "1"]);
        let [red, green, ..] = app.picture().get_pixel(20, 150).0;
        red > 150 && green < 90
    });
    app.press(&["Tab"]);
    wait_for_color(&app, "what the slider was moved to", SEEN_RED);
    place.save("own.scene", &text(1));
    wait_until("the saved scene", || color(&app)[2]);
    assert_eq!(color(&app), [true, false, true], "the slider went back");
    // Gone from the text and there again.
    place.save("own.scene", &wall(GREEN));
    wait_for_color(&app, "a scene without sliders", SEEN_GREEN);
    place.save("own.scene", &text(0));
    wait_for_color(&app, "the slider as it was", SEEN_RED);
    quit(app);
}

#[test]
fn c_pressed_while_a_scene_is_coming_does_not_keep_it_away() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", &wall(RED));
    place.save("own2.scene", &heavy(60, GREEN));
    for (sdf, wish) in [("interpreted", "compiled"), ("compiled", "interpreted")] {
        let mut app = place.open_tiny("own.scene", &["--sdf", sdf, "-v"]);
        wait_for_color(&app, "the first scene", SEEN_RED);
        // The second needs a program of its own in either mode, and while that is made the wish changes.
        app.press(&["n"]);
        app.wait_until_told(&format!("own2 is requested, {sdf}"));
        app.press(&["c"]);
        app.wait_for_title("the second scene as wished", |title| title.contains(&format!("(own2, {wish})")));
        wait_for_color(&app, "the second scene", SEEN_GREEN);
        quit(app);
    }
}

#[test]
fn a_second_c_takes_back_the_first_that_is_still_waiting() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", &heavy(60, RED));
    let app = place.open_tiny("own.scene", &["--sdf", "interpreted"]);
    app.press(&["c", "c"]);
    place.save("own.scene", &heavy(61, GREEN));
    wait_for_color(&app, "the saved scene", SEEN_GREEN);
    assert!(app.title().contains("(own, interpreted)"), "{}", app.title());
    quit(app);
}

#[test]
fn fifty_saves_in_a_row_show_the_last_and_nothing_waits_for_the_others() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", &heavy(20, RED));
    let mut app = place.open_tiny("own.scene", &[]);
    wait_for_color(&app, "the first", SEEN_RED);
    for n in 0..50 {
        place.save("own.scene", &if n % 3 == 1 { wall("vec3(") } else { heavy(20 + n, RED) });
        std::thread::sleep(Duration::from_millis(20));
    }
    place.save("own.scene", &heavy(21, GREEN));
    wait_for_color(&app, "the last", SEEN_GREEN);
    wait_for_mode(&mut app, "compiled");
    wait_for_color(&app, "the last", SEEN_GREEN);
    wait_for_one_color(&app);
    quit(app);
}

#[test]
fn the_window_closes_while_a_driver_is_still_compiling() {
    let place = QuietDesktop::with_folder();
    place.save("own.scene", &wall(RED));
    // Of twice as many the text would be refused as too long.
    place.save("own2.scene", &heavy(600, GREEN));
    let scene = place.path("own.scene");
    let options = ["--silent", "--size", TINY, "--scene", scene.to_str().unwrap(), "--sdf", "compiled", "-v"];
    let stuck = [("MARIANA_FAULT", "endless-compiler@0")];
    let mut app = place.desktop.open_with(&stuck, &place.song, &options);
    wait_for_color(&app, "the first scene", SEEN_RED);
    app.press(&["n"]);
    app.wait_until_told("own2 is requested, compiled");
    // Meanwhile it draws in another size, as before, beside the words that say what is being prepared.
    app.xdotool(&["windowsize", app.window(), "160", "240"]);
    app.wait_for_size((160, 240));
    wait_until("the first scene in another size", || {
        app.picture().dimensions() == (160, 240) && color(&app) == SEEN_RED
    });
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert!(told.contains("still compiling") && !told.contains("own2 is shown"), "{told}");
}
