//! Scenes in a session: saving scenes, breaking and mending them, switching by keys, interpreting, compiling, and
//! sliders.

use crate::support::apart::apart;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use crate::support::compare::{TIGHT, assert_alike, difference, pixel_difference};
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::{self, App};
use image::RgbaImage;
use mariana::clock;
use mariana::scenes::shipped_names;

/// The window size of most tests. It is small, because there is no graphics card.
const SMALL: &str = "160x90";
const TINY: &str = "32x18";

fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n{AHEAD}"
    )
}

/// The rest of a scene: a camera that looks along z, and a light without strength.
const AHEAD: &str = "light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                     sky { color = 0  ambient = 0 }\n";
const RED: &str = "vec3(1, 0, 0)";
const GREEN: &str = "vec3(0, 1, 0)";
const BLUE: &str = "vec3(0, 0, 1)";

struct Place(session::Place);

impl Place {
    fn new() -> Self {
        Self(session::Place::with_song())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path("scenes").join(name)
    }

    fn save(&self, name: &str, text: &str) {
        self.0.save(&format!("scenes/{name}"), text);
    }

    fn open(&self, name: &str, options: &[&str]) -> App {
        self.open_scene(self.path(name).to_str().unwrap(), SMALL, options)
    }

    fn open_scene(&self, scene: &str, size: &str, options: &[&str]) -> App {
        let app = self.0.open(&self.0.song(), &[&["--size", size, "--scene", scene], options].concat());
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }

    /// Like [`Self::open`], with a tiny frame and a separate thread that compiles shaders.
    fn open_with_compiler(&self, name: &str, options: &[&str]) -> App {
        let scene = self.path(name);
        let own = ["--size", TINY, "--scene", scene.to_str().unwrap()];
        let app = self.0.open_with_compiler(&self.0.song(), &[&own[..], options].concat());
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }

    /// Renders a scene of the folder with `mariana still`, at the song's start.
    fn still(&self, name: &str, size: (u32, u32)) -> RgbaImage {
        let output = self.0.path("still.png");
        let mut command = command_in(PROGRAM, self.0.folder(), None);
        command.arg("still").arg(self.0.song()).arg("--scene").arg(self.path(name)).arg("-o").arg(&output);
        command.args(["--size", &format!("{}x{}", size.0, size.1)]);
        let run = command.output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        image::open(&output).unwrap().to_rgba8()
    }
}

/// The bright channels in most of the upper half of the frame, which error panels do not cover.
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
    app.wait_until(what, |app| color(app) == wanted);
}

fn pause(app: &App) {
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
}

fn wait_for_mode(app: &App, mode: &str) {
    app.wait_for_title(mode, |title| title.contains(&format!(", {mode}")));
}

#[test]
fn a_saved_scene_is_shown_without_restarting_the_song() {
    apart!();
    let place = Place::new();
    // The blue channel is bright from the third second of the song on. If a new scene restarted the song, the channel
    // would be dark again.
    let with_time = |red: u8, green: u8| wall(&format!("vec3({red}, {green}, if t < 2 then 0 else 1)"));
    place.save("own.scene", &with_time(1, 0));
    let app = place.open("own.scene", &[]);
    wait_for_color(&app, "red and blue", [true, false, true]);
    place.save("own.scene", &with_time(0, 1));
    let mut first = None;
    app.wait_until("the saved scene", |app| {
        first = Some(color(app)).filter(|color| color[1]);
        first.is_some()
    });
    assert_eq!(first, Some([false, true, true]), "the song restarted");

    place.save("own.scene~", &wall(RED));
    fs::rename(place.path("own.scene~"), place.path("own.scene")).unwrap();
    wait_for_color(&app, "the renamed scene", SEEN_RED);

    place.save("paint.scene", &format!("fn shine() = {GREEN}"));
    place.save("own.scene", &format!("include \"paint.scene\"\n{}", wall("shine()")));
    wait_for_color(&app, "the colour of the included file", SEEN_GREEN);
    place.save("paint.scene", &format!("fn shine() = {BLUE}"));
    wait_for_color(&app, "another colour of the included file", SEEN_BLUE);
    place.save("paint.scene~", &format!("fn shine() = {RED}"));
    fs::rename(place.path("paint.scene~"), place.path("paint.scene")).unwrap();
    wait_for_color(&app, "the renamed included file", SEEN_RED);

    let picture = |color: [u8; 3]| {
        let side = RgbaImage::from_pixel(4, 4, image::Rgba([color[0], color[1], color[2], 255]));
        side.save(place.path("side.png")).unwrap();
    };
    picture([0, 255, 0]);
    place.save("own.scene", &wall("texture(\"side.png\", p.xy).rgb"));
    wait_for_color(&app, "the texture", SEEN_GREEN);
    picture([0, 0, 255]);
    wait_for_color(&app, "the saved texture", SEEN_BLUE);
    app.wait_for_title("the scene, playing", |title| {
        title.starts_with("quiet.wav - Mariana (own, ") && !title.contains("paused")
    });
    app.quit_content();
}

/// Returns the number of rows at the top that no panel covers: these rows equal the rows of `clear`.
fn clear_rows(picture: &RgbaImage, clear: &RgbaImage) -> u32 {
    let rows = 0..picture.height();
    rows.take_while(|&y| (0..picture.width()).all(|x| picture.get_pixel(x, y) == clear.get_pixel(x, y)))
        .count() as u32
}

/// Dithering may change an even colour by up to this number of steps from pixel to pixel.
const DITHER: u8 = 2;

/// Waits until the frame has one colour, without an overlay.
fn wait_for_one_color(app: &App) -> RgbaImage {
    let mut picture = app.picture();
    app.wait_until("the frame without overlay", |app| {
        picture = app.picture();
        let first = *picture.get_pixel(0, 0);
        picture.pixels().all(|pixel| pixel_difference(pixel, &first) <= DITHER)
    });
    picture
}

#[test]
fn a_broken_save_keeps_the_frame_and_shows_the_error() {
    apart!();
    let place = Place::new();
    place.save("own.scene", &wall(RED));
    let app = place.open("own.scene", &[]);
    wait_for_mode(&app, "compiled");
    wait_for_color(&app, "red", SEEN_RED);
    pause(&app);
    wait_for_one_color(&app);
    let clear = app.wait_until_still();
    let panel_shows = |app: &App| clear_rows(&app.picture(), &clear) < 88;
    let kept = |app: &App| {
        // A panel may cover the whole frame except a margin.
        for (x, y) in [(0, 0), (159, 0), (0, 89), (159, 89)] {
            // While a panel moves, the resolution may be lower, which changes the dither.
            let steps = pixel_difference(app.picture().get_pixel(x, y), clear.get_pixel(x, y));
            assert!(steps <= 2, "{steps} steps at {x}, {y}");
        }
    };

    place.save("own.scene", &wall("vec3(1, 0 0)"));
    app.wait_until_reported("own.scene has mistakes");
    app.wait_until("the error panel", |app| panel_shows(app));
    kept(&app);
    place.save("own.scene", &wall(GREEN));
    wait_for_color(&app, "the mended scene", SEEN_GREEN);
    wait_for_one_color(&app);

    let back = |app: &App| {
        place.save("own.scene", &wall(RED));
        app.wait_until("the mended scene without a panel", |app| app.picture() == clear);
    };
    back(&app);
    place.save("part.scene", "fn shine() = vec3(1, 0");
    place.save("own.scene", &format!("include \"part.scene\"\n{}", wall("shine()")));
    app.wait_until("the error in the include", |app| panel_shows(app));
    kept(&app);
    app.wait_until_reported("part.scene:1");
    place.save("part.scene", "fn shine() = vec3(1, 0, 0)");
    app.wait_until("the mended include", |app| app.picture() == clear);
    place.save("own.scene", &wall("texture(\"none.png\", p.xy).rgb"));
    app.wait_until("the error in the texture", |app| panel_shows(app));
    kept(&app);
    app.wait_until_reported("none.png");
    back(&app);

    fs::remove_file(place.path("own.scene")).unwrap();
    app.wait_until("the error about the missing file", |app| panel_shows(app));
    kept(&app);
    app.wait_until_reported("cannot be read");
    back(&app);
    app.wait_for_title("the scene", |title| title == "quiet.wav - Mariana (own, compiled, paused)");
    app.quit_content();
}

const VARIED_BY_TIME: &str = "
object floor { shape = p.y + 1 }
object balls { shape = smooth_union(for i in 0..3: sphere(p - vec3(i - 1, 0.5 * sin(t + i), 4), 0.6), 0.3) }
light lamp { position = vec3(-3, 5, 0) color = 60 }
camera { position = vec3(0, 0.5, 0) target = vec3(0, 0, 4) }
";

/// Balls, lights and a texture. This scene is complex enough for two ways of computing the frame to differ.
const VARIED: &str = "
material wood { color = triplanar(\"wood.png\", p * 0.5, n) roughness = 0.4 }
material ball { color = vec3(0.2, 0.5, 0.8) roughness = 0.3 }
object floor { shape = p.y + 1 material = wood }
object balls { shape = smooth_union(for i in 0..3: sphere(p - vec3(i - 1, 0.3 * i, 4), 0.6), 0.3) material = ball }
light lamp { position = vec3(-3, 5, 0) color = 60 }
camera { position = vec3(0, 0.5, 0) target = vec3(0, 0, 4) }
";

#[test]
fn c_changes_the_mode_but_not_the_frame() {
    apart!();
    let place = Place::new();
    place.save("own.scene", VARIED);
    for (first, other) in [("interpreted", "compiled"), ("compiled", "interpreted")] {
        let app = place.open("own.scene", &["--sdf", first, "--quality", "best"]);
        let modes = |app: &App| app.title();
        assert!(modes(&app).starts_with(&format!("quiet.wav - Mariana (own, {first}")), "{}", app.title());
        pause(&app);
        app.press(&["Left"]);
        let before = app.wait_until_still();
        app.press(&["c"]);
        wait_for_mode(&app, other);
        let after = app.wait_until_still();
        assert_alike(&format!("window-{other}"), &after, &before, TIGHT);
        app.press(&["c"]);
        wait_for_mode(&app, first);
        app.wait_until("the previous frame", |app| app.picture() == before);
        app.quit_content();
    }
}

#[test]
fn r_switches_regions_without_changing_the_frame() {
    apart!();
    let place = Place::new();
    place.save("own.scene", VARIED);
    for (mode, first) in [("interpreted", "on"), ("compiled", "off")] {
        let app = place.open("own.scene", &["--sdf", mode, "--regions", first, "-vv"]);
        wait_for_mode(&app, mode);
        pause(&app);
        app.press(&["Left"]);
        let before = app.wait_until_still();
        app.press(&["r"]);
        app.wait_until_reported(if first == "on" { "message: no regions" } else { "message: regions" });
        if first == "off" {
            // The first compiled program cannot look up cells.
            app.wait_until_reported("own is requested, compiled, with cells");
        }
        let after = app.wait_until_still();
        assert_alike(&format!("window-{mode}-regions-not-{first}"), &after, &before, TIGHT);
        let back = if first == "on" { "message: regions" } else { "message: no regions" };
        app.wait_until(back, |app| {
            // The tree may be ready too late to be used. Then another press switches the regions on again.
            app.press(&["r"]);
            app.reported().contains(back)
        });
        app.wait_until("the previous frame", |app| app.picture() == before);
        app.quit_content();
    }
}

#[test]
fn fast_changes_end_with_the_last_request() {
    apart!();
    let place = Place::new();
    place.save("own.scene", VARIED_BY_TIME);
    let app = place.open("own.scene", &["--sdf", "interpreted"]);
    pause(&app);
    for key in ["Right", "Right", "Left", "r", "Right", "r", "Left", "Left", "Left"] {
        app.press(&[key]);
    }
    app.resize((200, 100));
    let wanted = place.still("own.scene", (200, 100));
    app.wait_until("the frame of the song's start", |app| {
        let seen = app.picture();
        seen.dimensions() == (200, 100)
            && difference(&seen, &wanted, TIGHT.visible).fraction <= TIGHT.fraction_max
    });
    app.quit_content();
}

/// The time by which the simulated clock advances between two checks.
const STEP: Duration = Duration::from_millis(100);

#[test]
fn changing_a_number_again_does_not_compile() {
    apart!();
    let place = Place::new();
    let save = |green: &str| place.save("own.scene", &wall(&format!("vec3({green}, 0, 0.9 - {green})")));
    save("0");
    let app = place.open("own.scene", &["-v"]);
    let requests = |app: &App| app.reported().matches("own is requested, compiled").count();
    let is_compiled = |app: &App, times: usize| {
        app.wait_until("a compiled scene", |app| {
            app.reported().matches("own is shown, compiled").count() >= times
        });
    };
    is_compiled(&app, 1);
    wait_for_color(&app, "blue", SEEN_BLUE);
    // After the first change, the session compiles a program that reads the numbers as inputs. The other changes reuse
    // that program.
    for (shown, (number, color)) in
        [("0.9", SEEN_RED), ("0.0", SEEN_BLUE), ("0.91", SEEN_RED)].into_iter().enumerate()
    {
        save(number);
        wait_for_color(&app, number, color);
        is_compiled(&app, 2 + shown);
        assert_eq!(requests(&app), 2, "{}", app.reported());
    }
    // When the text has not changed for a while, the session compiles the numbers as constants again.
    app.wait_until("another program", |app| {
        clock::advance(STEP);
        requests(app) == 3
    });
    app.wait_until("a compiled scene", |app| {
        clock::advance(STEP);
        app.reported().matches("own is shown, compiled").count() >= 5
    });
    assert_eq!(color(&app), SEEN_RED);
    app.quit_content();
}

#[test]
fn n_and_p_step_through_the_folder_and_the_shipped_scenes() {
    apart!();
    let place = Place::new();
    for (name, emission) in [("a.scene", RED), ("b.scene", GREEN), ("broken.scene", "vec3(")] {
        place.save(name, &wall(emission));
    }
    let app = place.open("a.scene", &[]);
    wait_for_color(&app, "a", SEEN_RED);
    let shows = |app: &App, name: &str| {
        app.wait_for_title(name, |title| title.contains(&format!("Mariana ({name}, ")));
    };
    app.press(&["n"]);
    shows(&app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    // A broken scene is skipped by the next key press.
    app.press(&["n"]);
    app.wait_until_reported("broken.scene has mistakes");
    app.press(&["n"]);
    shows(&app, &shipped_names()[0]);
    app.press(&["p", "p"]);
    shows(&app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    app.press(&["p"]);
    shows(&app, "a");
    wait_for_color(&app, "a", SEEN_RED);
    // Press the key faster than scenes load: once through all scenes, and one step further.
    app.press(&vec!["n"; 4 + shipped_names().len()]);
    shows(&app, "b");
    wait_for_color(&app, "b", SEEN_GREEN);
    app.quit_content();
}

#[test]
fn a_formula_is_a_scene() {
    apart!();
    let place = Place::new();
    let app = place.open_scene("sqrt(x*x + y*y + z*z) - 1", SMALL, &[]);
    app.wait_for_title("the formula", |title| title.contains("Mariana (formula, "));
    app.wait_until("a ball in front of another colour", |app| {
        let picture = app.picture();
        let [middle, corner] = [(80, 45), (2, 2)].map(|(x, y)| *picture.get_pixel(x, y));
        pixel_difference(&middle, &corner) > 30
    });
    app.quit_content();
}

#[test]
fn a_slider_changes_the_frame_and_survives_a_reload() {
    apart!();
    let place = Place::new();
    let text =
        |blue: u8| format!("param level = 0 in 0 .. 1\n{}", wall(&format!("vec3(level, 1 - level, {blue})")));
    place.save("own.scene", &text(0));
    let app = place.open_scene(place.path("own.scene").to_str().unwrap(), "320x180", &[]);
    wait_for_color(&app, "green", SEEN_GREEN);
    let before = app.picture();
    app.press(&["Tab"]);
    app.wait_until("the slider", |app| app.picture() != before);
    wait_for_mode(&app, "compiled");
    // The drag ends beyond the rail's right end. The test tries rows until it finds the rail.
    let mut rows = (26..46).step_by(4).cycle();
    app.wait_until("the value of the dragged slider", |app| {
        let row = rows.next().unwrap();
        app.drag((230, row), (318, row));
        let [red, green, ..] = app.picture().get_pixel(20, 150).0;
        red > 150 && green < 90
    });
    app.press(&["Tab"]);
    wait_for_color(&app, "the value of the slider", SEEN_RED);
    place.save("own.scene", &text(1));
    app.wait_until("the saved scene", |app| color(app)[2]);
    assert_eq!(color(&app), [true, false, true], "the slider was reset");
    place.save("own.scene", &wall(GREEN));
    wait_for_color(&app, "a scene without sliders", SEEN_GREEN);
    place.save("own.scene", &text(0));
    wait_for_color(&app, "the previous value of the slider", SEEN_RED);
    app.quit_content();
}

/// Returns a scene in the colour `emission` that a driver compiles for a second or more.
fn heavy(balls: u32, emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = smooth_union(5 - p.z, union(for i in 0..{balls}: \
         sphere(p - vec3(sin(i), cos(1.7 * i), 9 + i), 0.3 + 0.1 * sin(t + i))), 0.1)  material = paint }}\n{AHEAD}"
    )
}

#[test]
fn fifty_quick_saves_show_the_last_one() {
    apart!();
    let place = Place::new();
    place.save("own.scene", &heavy(20, RED));
    let app = place.open_scene(place.path("own.scene").to_str().unwrap(), TINY, &[]);
    wait_for_color(&app, "the first", SEEN_RED);
    for n in 0..50 {
        place.save("own.scene", &if n % 3 == 1 { wall("vec3(") } else { heavy(20 + n, RED) });
        app.run_for(Duration::from_millis(20));
    }
    place.save("own.scene", &heavy(21, GREEN));
    wait_for_color(&app, "the last", SEEN_GREEN);
    wait_for_mode(&app, "compiled");
    wait_for_color(&app, "the last", SEEN_GREEN);
    wait_for_one_color(&app);
    app.quit_content();
}

#[test]
fn a_scene_is_interpreted_until_it_is_compiled() {
    apart!("EGL_PLATFORM" = "surfaceless", "MESA_SHADER_CACHE_DISABLE" = "true");
    let place = Place::new();
    // The first scene's interpreter can also draw the other scenes. They are short, because on a software renderer long
    // scenes wait for separate programs.
    place.save("own.scene", &heavy(2, RED));
    let others = 2..7;
    for number in others.clone() {
        place.save(&format!("own{number}.scene"), &heavy(2, &format!("{GREEN} * (1 - 0.01 * {number})")));
    }
    // The test disables the shader cache. Otherwise the driver would load compiled programs of an earlier run, and the
    // session would not use the interpreter.
    let app = place.open_with_compiler("own.scene", &[]);
    app.wait_until_reported("an interpreter is ready");
    // A driver may be fast enough to compile one short scene without interpretation, but not to compile all.
    let mut was_interpreted = false;
    for number in others {
        app.press(&["n"]);
        app.wait_until_reported(&format!("own{number} is shown, compiled"));
        app.wait_for_title("the new scene, compiled", |title| {
            title.contains(&format!("(own{number}, compiled)"))
        });
        wait_for_color(&app, "the new scene", SEEN_GREEN);
        let reported = app.reported();
        let [first, second] =
            ["interpreted", "compiled"].map(|mode| reported.find(&format!("own{number} is shown, {mode}")));
        assert!(first.is_none_or(|first| Some(first) < second), "{reported}");
        was_interpreted |= first.is_some();
    }
    assert!(was_interpreted, "{}", app.reported());
    app.quit_content();
}

#[test]
fn pressing_c_while_a_scene_loads_still_shows_it() {
    apart!("EGL_PLATFORM" = "surfaceless");
    let place = Place::new();
    place.save("own.scene", &wall(RED));
    place.save("own2.scene", &heavy(60, GREEN));
    for (sdf, change) in [("interpreted", "compiled"), ("compiled", "interpreted")] {
        let app = place.open_with_compiler("own.scene", &["--sdf", sdf]);
        wait_for_color(&app, "the first scene", SEEN_RED);
        // The second scene needs a new program in either mode. Change the mode while that program is compiled.
        app.press(&["n"]);
        app.wait_until_reported(&format!("own2 is requested, {sdf}"));
        app.press(&["c"]);
        app.wait_for_title("the second scene in the new mode", |title| {
            title.contains(&format!("(own2, {change})"))
        });
        wait_for_color(&app, "the second scene", SEEN_GREEN);
        app.quit_content();
    }
}

#[test]
fn pressing_c_twice_cancels_the_waiting_change() {
    apart!("EGL_PLATFORM" = "surfaceless");
    let place = Place::new();
    place.save("own.scene", &heavy(60, RED));
    let app = place.open_with_compiler("own.scene", &["--sdf", "interpreted"]);
    app.press(&["c", "c"]);
    place.save("own.scene", &heavy(61, GREEN));
    wait_for_color(&app, "the saved scene", SEEN_GREEN);
    assert!(app.title().contains("(own, interpreted)"), "{}", app.title());
    app.quit_content();
}
