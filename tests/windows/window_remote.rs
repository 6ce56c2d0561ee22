//! A phone that steers the show: the page in a browser without a window, touched by fingers.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::browser::Page;
use crate::support::desktop::{App, Desktop};
use crate::walls::quit;
use mariana_testing::wave::write_wav;

/// A wall that shines in a colour.
fn wall(emission: &str) -> String {
    format!("param red = 0 in 0 .. 2\nparam green = 1 in 0 .. 1\n{}", crate::walls::wall(emission))
}

/// Writes a green wall and a blue one; returns where the green one is.
fn write_walls(folder: &Path) -> PathBuf {
    fs::write(folder.join("wool.scene"), wall("vec3(0, 0, 1)")).unwrap();
    let path = folder.join("wall.scene");
    fs::write(&path, wall("vec3(red, green, 0)")).unwrap();
    path
}

/// The program with a wall, a song and a page for phones; and the page's address.
fn open<'d>(desktop: &'d Desktop, options: &[&str]) -> (App<'d>, String) {
    open_at(desktop, "127.0.0.1:0", options)
}

/// The same with the page at a place.
fn open_at<'d>(desktop: &'d Desktop, place: &str, options: &[&str]) -> (App<'d>, String) {
    let song = desktop.folder().join("quiet.wav");
    write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * 100));
    let scene = write_walls(desktop.folder());
    let own = ["--silent", "--midi", "off", "--blackout-fade", "0", "--fade", "0", "--scene"];
    let all = [&own[..], &[scene.to_str().unwrap(), "--remote", place], options].concat();
    let mut app = desktop.open(&song, &all);
    app.wait_until_told("a phone can open http://127.0.0.1:");
    let url = url_in(&app.told());
    (app, url)
}

fn url_in(told: &str) -> String {
    let from = told.find("http://").unwrap();
    told[from..].split(' ').next().unwrap().to_owned()
}

/// A phone that is connected.
fn phone(url: &str) -> Page {
    let mut page = Page::open(url);
    page.wait_until("the connection", "document.getElementById('status')?.textContent === ''");
    page
}

#[test]
fn a_phone_sees_small_pictures_of_the_scenes_and_does_without_them() {
    let desktop = Desktop::start();
    let (app, url) = open(&desktop, &["--size", "160x90"]);
    // A scene with a mistake has none.
    fs::write(desktop.folder().join("wrong.scene"), "object").unwrap();
    app.press(&["n"]);
    let mut page = phone(&url);
    page.wait_until("the scenes", "document.querySelectorAll('#scenes button').length > 3");
    // What stands in the middle of a picture: red, green and blue.
    page.value(
        "window.colour = (name) => { \
           const button = [...document.querySelectorAll('#scenes button')].find(b => b.textContent === name); \
           const image = button.querySelector('img'); \
           if (!image.complete || image.naturalWidth !== 320) return ''; \
           const canvas = document.createElement('canvas').getContext('2d'); \
           canvas.drawImage(image, 0, 0); \
           return [...canvas.getImageData(160, 90, 1, 1).data].slice(0, 3).map(part => part > 100).join(); \
         }; 1",
    );
    page.wait_until("the wall's picture", "colour('wall') === 'false,true,false'");
    page.wait_until("the wool's picture", "colour('wool') === 'false,false,true'");
    assert_eq!(page.value("colour('wrong')"), "");
    // The scene without one is asked for like the others: nothing of the page waits for pictures.
    page.value(
        "[...document.querySelectorAll('#scenes button')].find(b => b.textContent === 'wall').id = 'wanted'",
    );
    page.tap("#wanted");
    page.wait_for_text("#scene", "wall");
    // Who comes later has them at once.
    let mut other = phone(&url);
    other.wait_until(
        "the pictures",
        "[...document.querySelectorAll('#scenes img')].slice(0, 2).every(image => image.naturalWidth === 320)",
    );
    quit(app);
}
