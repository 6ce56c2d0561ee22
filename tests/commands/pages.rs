//! Web pages that play a song.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use crate::support::program::Workplace;

const OWN: &str = r#"<script id="own" type="application/json">"#;
const SONG: &str = r#"<script id="song" type="text/plain">"#;

/// A page without a song, as `scripts/site` builds it, but without what draws.
fn template() -> String {
    format!("<!doctype html>\n<!-- A page of Mariana -->\n{OWN}{{}}</script>\n{SONG}</script>\n")
}

fn element<'a>(page: &'a str, start: &str) -> &'a str {
    page.split_once(start).unwrap().1.split_once("</script>").unwrap().0
}

#[test]
fn a_page_holds_the_song_its_title_and_the_scene() {
    let place = Workplace::new();
    place.write("template.html", template());
    place.write("my.scene", "# Its text says </script>\nsphere(p, 1)\n");
    place.write("song.ogg", mariana_assets::DEMO_TRACK);
    let page = ["page", "--template", "template.html", "song.ogg", "my.scene", "-o", "song.html"];
    place.run(&page).done();
    let page = String::from_utf8(place.read("song.html")).unwrap();
    let own: serde_json::Value = serde_json::from_str(element(&page, OWN)).unwrap();
    assert_eq!(own["text"], "# Its text says </script>\nsphere(p, 1)\n");
    assert_eq!(
        (own["title"].as_str(), own["scene"].as_str()),
        (Some("Mariana - Hadal Lanterns"), Some("orb"))
    );
    let song = element(&page, SONG);
    assert_eq!((song.len(), &song[..6]), (mariana_assets::DEMO_TRACK.len().div_ceil(3) * 4, "T2dnUw"));

    // A page may be written again, but a song is in a page only once.
    place.run(&["page", "--template", "template.html", "--scene", "metaballs", "-o", "song.html"]).done();
    let again = place.run(&["page", "--template", "song.html", "-o", "other.html"]);
    again.refused(&["the template already has a song"]);
}

#[test]
fn a_page_holds_a_show_with_the_texts_of_its_own_scenes_and_the_structure_of_the_song() {
    let place = Workplace::new();
    place.write("template.html", template());
    place.write("own.scene", "sphere(p, 1)\n");
    place.write("my.show", "at start orb\nat 0:10 own.scene fade over 2 s\n");
    let page = |arguments: &[&str]| {
        let always = ["page", "--template", "template.html", "-o", "song.html"];
        place.run(&[&always, arguments].concat()).done();
        let page = String::from_utf8(place.read("song.html")).unwrap();
        serde_json::from_str::<serde_json::Value>(element(&page, OWN)).unwrap()
    };
    let own = page(&["--show", "my.show", "--loop", "--embed"]);
    let show = own["show"].as_str().unwrap();
    assert!(show.contains("at 0:10") && show.contains("\"own.scene\"  fade over 2 s"), "{show}");
    assert_eq!(own["scenes"], serde_json::json!({ "own.scene": "sphere(p, 1)\n" }));
    assert_eq!((&own["loop"], &own["embed"]), (&true.into(), &true.into()));
    let structure: mariana_music::SongStructure = serde_json::from_value(own["structure"].clone()).unwrap();
    assert!(structure.beats.len() > 100 && structure.seconds > 80.0);
    let poster = own["poster"].as_str().unwrap();
    assert!(poster.starts_with("data:image/jpeg;base64,/9j/") && poster.len() > 5_000);

    let own = page(&[]);
    let clips = own["show"].as_str().unwrap().lines().filter(|line| line.starts_with("at ")).count();
    assert!(clips > 3 && own["scene"].is_null(), "the director's show");
}

#[test]
fn pages_that_cannot_work_are_refused() {
    let place = Workplace::new();
    place.write("template.html", template());
    place.write("notes.html", "my notes");
    place.write("song.wma", mariana_assets::DEMO_TRACK);
    place.write("whole.scene", "include \"part.scene\"\nball(p)\n");
    place.write("part.scene", "fn ball(p) = sphere(p, 1)\n");
    let page =
        |arguments: &[&str]| place.run(&[&["page", "--template", "template.html"], arguments].concat());
    page(&["-o", "notes.html"]).refused(&["notes.html exists"]);
    page(&["song.wma", "-o", "song.html"]).refused(&["browsers do not play song.wma"]);
    page(&["missing.mp3", "-o", "song.html"]).refused(&["missing.mp3 does not exist"]);
    page(&["whole.scene", "--show", "auto", "-o", "song.html"])
        .refused(&["a show and the scene whole.scene were given"]);
    place.write("waits.show", "at cue orb\n");
    page(&["--show", "waits.show", "-o", "song.html"]).refused(&["every entry of the show waits for a key"]);
    place.write("whole.show", "at start orb\nat cue whole.scene\n");
    page(&["--show", "whole.show", "-o", "song.html"])
        .refused_with_details(&["a page holds only the text of", "whole.scene"]);
    page(&["whole.scene", "-o", "song.html"])
        .refused_with_details(&["a page holds only the text of whole.scene"]);
    let none = place.run(&["page", "--template", "none.html", "-o", "song.html"]);
    none.refused(&["none.html cannot be read: give the page.html"]);
    assert_eq!(place.read("notes.html"), b"my notes");
}
