//! Helpers for sessions with the scenes of `tests/support/walls.rs`.

use std::path::PathBuf;

use crate::support::session::{self, App};
pub(crate) use crate::support::walls::*;

pub(crate) struct Place {
    inner: session::Place,
}

impl Place {
    pub(crate) fn new(scenes: &[(&str, &str)]) -> Self {
        let inner = session::Place::new();
        for (name, emission) in scenes {
            inner.save(name, &wall(emission));
        }
        Self { inner }
    }

    /// Opens the scene without an overlay.
    pub(crate) fn open(&self, scene: &str, options: &[&str]) -> App {
        let scene = self.path(scene);
        let own = ["--size", "320x180", "--quality", "best", "--scene", scene.to_str().unwrap()];
        let app = self.inner.listen(&[&own[..], options].concat());
        app.wait_until_reported("first picture after");
        app
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.inner.path(name)
    }

    pub(crate) fn settings(&self) -> PathBuf {
        self.inner.settings()
    }
}

/// Waits until only this channel is bright in most of the frame: 0 is red, 1 green, 2 blue.
pub(crate) fn wait_for_channel(app: &App, channel: usize) {
    app.wait_for("the wall's colour", |picture| {
        let fits = picture.pixels().filter(|pixel| (0..3).all(|at| (pixel.0[at] > 120) == (at == channel)));
        2 * fits.count() > picture.pixels().count()
    });
}
