//! Helpers for windows with the scenes of `tests/support/walls.rs`.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};

use crate::support::desktop::{App, Desktop};
pub(crate) use crate::support::walls::*;
use image::RgbaImage;
use mariana_testing::process::wait_until;

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

    /// Opens the scene without an overlay.
    pub(crate) fn open(&self, scene: &str, options: &[&str]) -> App<'_> {
        self.open_with(&[], scene, options)
    }

    pub(crate) fn open_with(&self, variables: &[(&str, &str)], scene: &str, options: &[&str]) -> App<'_> {
        let scene = self.path(scene);
        let own = ["-v", "--size", "320x180", "--quality", "best", "--scene", scene.to_str().unwrap()];
        let mut app = self.desktop.open_with(variables, Path::new("--silent"), &[&own[..], options].concat());
        app.wait_until_reported("first picture after");
        app
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.desktop.folder().join(name)
    }
}

/// True if [`TWO_COLOURS`] fill the whole image.
pub(crate) fn fills(picture: &RgbaImage) -> bool {
    is_red(at(picture, 0.0, 0.0))
        && is_red(at(picture, 0.49, 1.0))
        && is_blue(at(picture, 0.51, 0.0))
        && is_blue(at(picture, 1.0, 1.0))
}

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
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
    assert!(!reported.contains("panicked"), "{reported}");
    reported
}
