//! A phone as remote control: a headless browser opens the page, and tests simulate touches.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::ffi::OsString;
use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;

use crate::controllers::{wait_for_colour, write_wall};
use crate::support::browser::Page;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::{App, Place};
use mariana::thumbnails::{MOMENT, SIZE};
use mariana_testing::process::{output_of, wait_until};

/// Opens a session with a wall and a song. Returns the session and the page's address.
fn open(place: &Place, options: &[&str]) -> (App, String) {
    open_at(place, "127.0.0.1:0", options)
}

fn open_at(place: &Place, address: &str, options: &[&str]) -> (App, String) {
    let song = place.quiet_song("quiet.wav", 100);
    let scene = write_wall(place);
    let own = ["--midi", "off", "--blackout-fade", "0", "--fade", "0", "--scene"];
    let all = [&own[..], &[scene.to_str().unwrap(), "--remote", address], options].concat();
    let app = place.open(&song, &all);
    app.wait_until_reported("a phone can open http://127.0.0.1:");
    let url = url_in(&app.reported());
    (app, url)
}

fn url_in(reported: &str) -> String {
    let from = reported.find("http://").unwrap();
    reported[from..].split(' ').next().unwrap().to_owned()
}

fn phone(app: &App, url: &str) -> Page {
    app.meanwhile(|| {
        let mut page = Page::open(url);
        page.wait_until("the connection", "document.getElementById('status')?.textContent === ''");
        page
    })
}

fn value_of(name: &str) -> String {
    format!("[data-param=\"{name}\"] .value")
}

fn rail_of(name: &str) -> String {
    format!("[data-param=\"{name}\"] .rail")
}

#[test]
fn a_phone_changes_parameters_and_other_phones_show_it() {
    apart!();
    let place = Place::new();
    let (app, url) = open(&place, &["--size", "160x90"]);
    wait_for_colour(&app, "green", [false, true, false]);
    let (mut page, mut other) = (phone(&app, &url), phone(&app, &url));
    app.meanwhile(|| {
        page.wait_for_text("#scene", "wall");
        page.wait_for_text(&value_of("green"), "1.00");
        // This drag ends beyond the rail's right end.
        page.drag(&rail_of("red"), 0.1, 1.1);
    });
    wait_for_colour(&app, "yellow", [true, true, false]);
    app.meanwhile(|| {
        other.wait_for_text(&value_of("red"), "2.00");
        other.wait_for_text("[data-param=\"red\"] .held", "phone");
        other.drag(&rail_of("green"), 0.9, -0.1);
    });
    wait_for_colour(&app, "red", [true, false, false]);
    app.meanwhile(|| {
        page.wait_for_text(&value_of("green"), "0.00");
        // A vertical drag scrolls the page and does not move the slider. A tap moves the slider.
        page.push(&rail_of("red"), -120.0);
        page.tap(&rail_of("green"));
        other.wait_for_text(&value_of("green"), "0.50");
        let seen = (other.text(&value_of("red")), page.text(&value_of("red")));
        assert_eq!(seen, ("2.00".into(), "2.00".into()));
        page.tap("[data-param=\"red\"] .back");
        other.wait_for_text(&value_of("red"), "0.00");
        page.tap("[data-do=blackout]");
    });
    wait_for_colour(&app, "black", [false, false, false]);
    assert!(app.state().black);
    app.meanwhile(|| {
        other.wait_until("blackout", "document.querySelector('[data-do=blackout]').ariaPressed === 'true'");
        other.tap("[data-do=blackout]");
        page.wait_until("light", "document.querySelector('[data-do=blackout]').ariaPressed === 'false'");
        page.drag("[data-level=brightness] .rail", 0.9, -0.1);
        other.wait_for_text("[data-level=brightness] .value", "0 %");
    });
    wait_for_colour(&app, "no light", [false, false, false]);
    assert_eq!((app.state().black, app.state().brightness), (false, 0.0));
    app.quit_by_key();
    page.wait_until("the end", "document.getElementById('status').textContent.startsWith('Connection lost')");
    assert_eq!(page.value("document.getElementById('hands').inert"), true);
}

#[test]
fn the_phone_follows_the_window_and_controls_scenes_and_song() {
    apart!();
    let place = Place::new();
    let (app, url) = open(&place, &["--size", "160x90"]);
    let mut page = phone(&app, &url);
    app.meanwhile(|| {
        page.wait_for_text("#scene", "wall");
        page.wait_for_text("#track", "quiet.wav");
    });
    app.press(&["space"]);
    app.meanwhile(|| {
        page.wait_until("the pause", "document.querySelector('[data-do=pause]').ariaPressed === 'true'");
    });
    app.press(&["x"]);
    app.meanwhile(|| {
        page.wait_until("blackout", "document.querySelector('[data-do=blackout]').ariaPressed === 'true'");
    });
    app.press(&["x", "n"]);
    app.meanwhile(|| {
        page.wait_for_text("#scene", "wool");
        // Select a scene by its name in the grid, then by the buttons for the next and the previous scene.
        page.wait_until(
            "this scene in the grid",
            "document.querySelector('#scenes [aria-current=true]')?.textContent === 'wool'",
        );
        page.value(
            "[...document.querySelectorAll('#scenes button')].find(b => b.textContent === 'wall').id = 'wanted'",
        );
        page.tap("#wanted");
        page.wait_for_text("#scene", "wall");
    });
    wait_for_colour(&app, "the wall", [false, true, false]);
    app.meanwhile(|| {
        page.tap("[data-do=next]");
        page.wait_for_text("#scene", "wool");
        page.tap("[data-do=previous]");
        page.wait_for_text("#scene", "wall");
        // Set the position and the volume of the song. Later the pause button resumes the song.
        page.drag("[data-level=position] .rail", 0.3, 0.5);
        page.wait_for_text("[data-level=position] .value", "0:50 / 1:40");
        page.drag("[data-level=volume] .rail", 0.9, 0.25);
        page.wait_for_text("[data-level=volume] .value", "25 %");
    });
    // The page shows the new volume before the touch ends, so the session may not have it yet.
    app.wait_until("the volume", |app| app.state().volume == Some(0.25));
    assert!(app.state().paused);
    app.meanwhile(|| {
        page.tap("[data-do=pause]");
        page.wait_until("it plays", "document.querySelector('[data-do=pause]').ariaPressed === 'false'");
        page.wait_until("the song to play", "show.levels.position > 0.505");
    });
    assert!(!app.state().paused);
    app.quit_by_key();
}

#[test]
fn the_qr_code_is_the_address_and_an_outdated_page_asks_only_once() {
    apart!();
    let place = Place::new();
    let (app, url) = open(&place, &["--size", "640x360"]);
    app.press(&["j"]);
    let path = place.path("window.png");
    let mut read = String::new();
    app.wait_until("the code", |app| {
        app.picture().save(&path).unwrap();
        let mut command = Command::new("zbarimg");
        command.args(["--quiet", "--raw"]).arg(&path);
        // zbarimg fails until the window shows the code.
        read = output_of(&mut command, "zbar-tools")
            .map(|text| String::from_utf8_lossy(&text).trim().to_owned())
            .unwrap_or_default();
        !read.is_empty()
    });
    assert_eq!(read, url);
    let mut page = phone(&app, &url);
    // The page stays open while the program restarts with the same port and a new token.
    app.quit_by_key();
    page.wait_until("the end", "document.getElementById('status').textContent.startsWith('Connection lost')");
    let port = url.split(['/', ':']).nth(4).unwrap();
    let (app, newer) = open_at(&place, &format!("127.0.0.1:{port}"), &["--size", "160x90"]);
    assert_ne!(newer, url);
    app.meanwhile(|| {
        page.wait_until(
            "the page to report its outdated address",
            "document.getElementById('status').textContent.startsWith('This address is no longer valid')",
        );
        // The outdated page sends a single request and then stops. Therefore it does not block requests to the new
        // address for long.
        let mut later = Page::open(&newer);
        wait_until("the new page", || {
            later.wait_until("an answer", "document.readyState === 'complete' && document.body !== null");
            let is_answered = later.value("document.querySelector('h1') !== null") == true;
            if !is_answered {
                later.go_to(&newer);
            }
            is_answered
        });
        later.wait_for_text("#scene", "wall");
    });
    app.quit_by_key();
}

#[test]
fn a_port_in_use_is_reported_and_opened_later() {
    apart!();
    let place = Place::new();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let (song, scene) = (place.quiet_song("quiet.wav", 60), write_wall(&place));
    let options = ["--size", "160x90", "--scene", scene.to_str().unwrap(), "--remote", &address];
    let app = place.open(&song, &options);
    app.wait_until_reported(&format!("phone control is off: another program uses {address}"));
    wait_for_colour(&app, "green", [false, true, false]);
    drop(taken);
    app.wait_until_reported(&format!("a phone can open http://{address}/"));
    app.quit_by_key();
}

/// Renders the thumbnails of the walls in advance, and returns a program that delivers them to the session. The session
/// renders thumbnails at the lowest priority, which takes minutes on a busy machine.
fn prepare_pictures(place: &Place) -> PathBuf {
    let (width, height) = SIZE;
    let arguments = format!("still --at {MOMENT} --size {width}x{height} -o");
    write_wall(place);
    for name in ["wall", "wool"] {
        let mut still = command_in(PROGRAM, place.folder(), None);
        still.args(arguments.split(' ')).arg(place.path(&format!("{name}.png")));
        let mut scene = OsString::from("--scene=");
        scene.push(place.path(&format!("{name}.scene")));
        output_of(still.arg(scene), "mariana").unwrap();
    }
    let program = place.save(
        "draw",
        &format!(
            "#!/bin/sh\n[ \"$1 $2 $3 $4 $5 $6 $8\" = '{arguments} --controlled' ] || exit 1\n\
             scene=${{9#--scene=}}\nexec cp \"${{scene%.scene}}.png\" \"$7\"\n"
        ),
    );
    std::fs::set_permissions(&program, Permissions::from_mode(0o755)).unwrap();
    program
}

#[test]
fn a_phone_shows_thumbnails_and_works_without_them() {
    apart!();
    let mut place = Place::new();
    place.draw_by(prepare_pictures(&place));
    place.save("wrong.scene", "object");
    let (app, url) = open(&place, &["--size", "160x90"]);
    wait_for_colour(&app, "green", [false, true, false]);
    app.press(&["n"]);
    let mut page = phone(&app, &url);
    app.meanwhile(|| {
        page.wait_until("the scenes", "document.querySelectorAll('#scenes button').length > 3");
        // Computes the bright channels in the middle of a thumbnail, as true or false for red, green and blue.
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
        page.wait_until("the thumbnail of the wall", "colour('wall') === 'false,true,false'");
        page.wait_until("the thumbnail of the wool", "colour('wool') === 'false,false,true'");
        assert_eq!(page.value("colour('wrong')"), "");
        // Scenes can be selected before all thumbnails are rendered.
        page.value(
            "[...document.querySelectorAll('#scenes button')].find(b => b.textContent === 'wall').id = 'wanted'",
        );
        page.tap("#wanted");
        page.wait_for_text("#scene", "wall");
    });
    // The session has all thumbnails now, so a second phone gets them at once.
    let mut other = phone(&app, &url);
    app.meanwhile(|| {
        other.wait_until(
            "the pictures",
            "[...document.querySelectorAll('#scenes img')].slice(0, 2).every(image => image.naturalWidth === 320)",
        );
    });
    app.quit_by_key();
}
