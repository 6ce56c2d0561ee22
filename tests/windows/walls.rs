//! Scenes whose pictures are known from their texts alone, in a window, and how to look at them.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::desktop::{App, Desktop};
use image::RgbaImage;
use mariana_testing::process::wait_until;

pub(crate) const QUIT_LIMIT: Duration = Duration::from_secs(60);

/// A wall that shines by itself and fills the picture.
pub(crate) fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0  ambient = 0 }}\npicture {{ tone_map = none  bloom = 0 }}\n"
    )
}

/// It never moves, is red on the left and blue on the right.
pub(crate) const TWO_COLOURS: &str = "mix(vec3(0.5, 0.01, 0.01), vec3(0.01, 0.01, 0.5), step(0, p.x))";
/// It becomes brighter and darker, slowly enough to be no flash.
pub(crate) const BREATHES: &str = "vec3(0.3 + 0.2 * sin(2 * t))";

/// A folder with scenes on a desktop.
pub(crate) struct Place {
    pub(crate) desktop: Desktop,
}

impl Place {
    pub(crate) fn new(scenes: &[(&str, &str)]) -> Self {
        let desktop = Desktop::start();
        for (name, emission) in scenes {
            std::fs::write(desktop.folder().join(name), wall(emission)).unwrap();
        }
        Self { desktop }
    }

    /// The window with a scene and no words, when its first picture shows.
    pub(crate) fn open(&self, scene: &str, options: &[&str]) -> App<'_> {
        self.open_with(&[], scene, options)
    }

    /// The same with these variables in the program's environment.
    pub(crate) fn open_with(&self, variables: &[(&str, &str)], scene: &str, options: &[&str]) -> App<'_> {
        let scene = self.path(scene);
        let own = ["-v", "--size", "320x180", "--quality", "best", "--scene", scene.to_str().unwrap()];
        let mut app = self.desktop.open_with(variables, Path::new("--silent"), &[&own[..], options].concat());
        app.wait_until_told("first picture after");
        app
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.desktop.folder().join(name)
    }
}

/// The colour of the window at a place, in shares of it.
pub(crate) fn at(picture: &RgbaImage, x: f32, y: f32) -> [u8; 3] {
    let place = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
    let [red, green, blue, _] = picture.get_pixel(place(x, picture.width()), place(y, picture.height())).0;
    [red, green, blue]
}

pub(crate) fn is_red([red, _, blue]: [u8; 3]) -> bool {
    red > 100 && blue < 60
}

pub(crate) fn is_blue([red, _, blue]: [u8; 3]) -> bool {
    blue > 100 && red < 60
}

/// Whether [`TWO_COLOURS`] fill a whole picture.
pub(crate) fn fills(picture: &RgbaImage) -> bool {
    is_red(at(picture, 0.0, 0.0))
        && is_red(at(picture, 0.49, 1.0))
        && is_blue(at(picture, 0.51, 0.0))
        && is_blue(at(picture, 1.0, 1.0))
}

pub(crate) fn is_black(color: [u8; 3]) -> bool {
    color == [0; 3]
}

/// Waits until the window looks as wanted.
pub(crate) fn wait_for(app: &App, what: &str, wanted: impl Fn(&RgbaImage) -> bool) -> RgbaImage {
    let mut found = None;
    wait_until(what, || {
        let picture = app.picture();
        let is_there = wanted(&picture);
        found = Some(picture);
        is_there
    });
    found.unwrap()
}

pub(crate) fn quit(app: App<'_>) -> String {
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert!(!told.contains("panicked"), "{told}");
    told
}
