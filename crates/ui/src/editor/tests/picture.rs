//! Tests of probes, highlights, colours and positions.

use super::*;
use mariana_music::Features;
use mariana_render::frame::Frame;
use mariana_render::placement::Placement;
use mariana_scenes::probing::{Answer, Probed, Scenery, ray_statistics_of};

const SCENE: &str = "\
material red { color = vec3(0.9, 0.3, 0.1)  emission = vec3(2, 1, 0.5) }
object near {
  shape = sphere(p - vec3(0, 0, 5), 1)
  material = red
}
object floor { shape = y + 1 }
camera { position = vec3(0)  target = vec3(0, 0, 5)  fov = 90 }";

fn line_of_cursor(setup: &TestEditor) -> usize {
    let document = setup.editor.document().unwrap();
    document.editing.buffer().line_of(document.editing.cursor()) + 1
}

fn scenery_of(source: SceneSource) -> Scenery {
    let ready = source.ready().unwrap();
    let frame = Frame::new(&ready.world, 1.0, Features::SILENCE, (200, 100));
    Scenery::new(source, ready, frame)
}

fn probe_of(scenery: &Scenery, at: [f64; 2]) -> Probed {
    mariana_scenes::probing::probe(scenery, at, &|| true).unwrap()
}

fn probe(setup: &mut TestEditor, at: [f64; 2]) {
    let answer = probe_of(&scenery_of(setup.source()), at);
    setup.editor.show_probe_answer(Answer::Point(answer));
}

#[test]
fn the_card_of_a_point_leads_to_its_source_line() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    assert!(setup.load());
    probe(&mut setup, [0.5, 0.5]);
    assert_eq!((line_of_cursor(&setup), setup.editor.probed_line()), (1, Some(2)), "the cursor stays");
    setup.editor.set_focus(false);
    setup.editor.jump_to_probed();
    assert_eq!((line_of_cursor(&setup), setup.editor.has_focus()), (3, true));
    let surface = setup.editor.picture.probed.as_ref().unwrap().surface.clone().unwrap();
    assert_eq!((surface.object.as_str(), surface.material.as_str()), ("near", "red"));
    probe(&mut setup, [0.5, 0.9]);
    setup.editor.jump_to_probed();
    assert_eq!(line_of_cursor(&setup), 6);
    // The user has added a line above the object since the scene was loaded.
    let scenery = scenery_of(setup.source());
    setup.go_to("object near");
    setup.type_text("# far\n");
    setup.editor.show_probe_answer(Answer::Point(probe_of(&scenery, [0.5, 0.5])));
    setup.editor.jump_to_probed();
    assert_eq!(line_of_cursor(&setup), 4);
    let surface = setup.editor.picture.probed.as_ref().unwrap().surface.clone().unwrap();
    let (file, range) = surface.written.unwrap();
    let (name, line, words) = setup.editor.texts.line_at(file, range).unwrap();
    assert_eq!(
        (name.as_str(), line, words.as_str()),
        ("main.scene", 4, "shape = sphere(p - vec3(0, 0, 5), 1)")
    );
    // No line of the text draws the sky. Esc closes the card and leaves the editor open.
    probe(&mut setup, [0.5, 0.1]);
    setup.editor.jump_to_probed();
    assert_eq!(
        (line_of_cursor(&setup), setup.editor.picture.probed.as_ref().unwrap().surface.as_ref()),
        (4, None)
    );
    let _ = setup.commands();
    setup.named(NamedKey::Escape);
    assert!(setup.editor.picture.probed.as_ref().is_none() && setup.commands().is_empty());
}

#[test]
fn a_point_drawn_by_an_included_text_leads_there() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.scene"), "# a part\nfn ball(q) = sphere(q, 1)\n").unwrap();
    let main = "include \"part.scene\"\nobject o { shape = ball(p - vec3(0, 0, 5)) }\n\
                camera { position = vec3(0)  target = vec3(0, 0, 5) }";
    fs::write(folder.path().join("main.scene"), main).unwrap();
    let mut setup = TestEditor::in_folder(folder);
    assert!(setup.load());
    probe(&mut setup, [0.5, 0.5]);
    assert_eq!(setup.editor.probed_line(), None, "it is in another text");
    setup.editor.jump_to_probed();
    setup.wait("the included text", |editor| {
        editor.document().is_some_and(|document| document.disk.is_some() && document.name() == "part.scene")
    });
    assert_eq!(line_of_cursor(&setup), 2);
    setup.editor.show_text(0);
    probe(&mut setup, [0.5, 0.5]);
    setup.editor.jump_to_probed();
    assert_eq!((setup.editor.document().unwrap().name().as_str(), line_of_cursor(&setup)), ("part.scene", 2));
}

#[test]
fn the_line_at_the_cursor_highlights_what_it_draws() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    assert!(setup.load());
    setup.ctrl("l");
    assert!(setup.editor.wants_ray_statistics() && setup.editor.light().is_none());
    let ray_statistics = ray_statistics_of(&scenery_of(setup.source()), &|| true).unwrap();
    setup.editor.show_probe_answer(Answer::RayStatistics(setup.source(), ray_statistics.into()));
    let mut lit = |part: &str| {
        setup.go_to(part);
        let light = setup.editor.light().unwrap();
        let rows = light.cells.len() / light.columns;
        let at = |x: usize, y: usize| light.cells[y * rows / 10 * light.columns + x * light.columns / 10];
        // The ball in the middle, the floor below, the sky above.
        [at(5, 5), at(5, 9), at(5, 1)]
    };
    assert_eq!(lit("sphere"), [true, false, false]);
    assert_eq!(lit("object near"), [true, false, false]);
    assert_eq!(lit("material red"), [true, false, false]);
    assert_eq!(lit("object floor"), [false, true, false]);
    assert_eq!(lit("camera"), [false; 3]);
    setup.ctrl("a");
    assert_eq!(setup.editor.light().unwrap().cells.iter().filter(|lit| **lit).count(), {
        let ray_statistics = ray_statistics_of(&scenery_of(setup.source()), &|| true).unwrap();
        ray_statistics.cells.iter().filter(|cell| **cell > 0).count()
    });
    setup.ctrl("l");
    assert!(setup.editor.light().is_none() && !setup.editor.wants_ray_statistics());
}

#[test]
fn the_most_expensive_object_comes_first() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    assert!(setup.load());
    setup.ctrl("k");
    let ray_statistics = ray_statistics_of(&scenery_of(setup.source()), &|| true).unwrap();
    setup.editor.show_probe_answer(Answer::RayStatistics(setup.source(), ray_statistics.into()));
    let (ray_statistics, objects) = setup.editor.picture.profile().unwrap();
    assert!(objects[0].run >= objects[1].run, "{objects:?}");
    assert_eq!(ray_statistics.run(), ray_statistics.sky.1 + objects[0].run + objects[1].run);
    let (text, byte) = objects.iter().find(|object| object.name == "floor").unwrap().place.unwrap();
    setup.editor.jump_to(text, byte);
    assert_eq!(line_of_cursor(&setup), 6);
    setup.named(NamedKey::Escape);
    assert!(setup.editor.picture.profile().is_none() && !setup.editor.wants_ray_statistics());
    assert!(!setup.commands().contains(&CLOSE), "the profile is closed before the editor");
    setup.named(NamedKey::Escape);
    assert!(setup.commands().contains(&CLOSE));
}

#[test]
fn lines_that_draw_parts_of_an_object_are_listed_below_it() {
    let text = "object two { shape = smooth_union(sphere(p - vec3(1, 0, 0), 0.8),\n  \
                sphere(p + vec3(1, 0, 0), 0.8), sphere(p + vec3(1, 1, 0), 0.5),\n  0.3) }\n\
                object one { shape = union(sphere(p - vec3(0, 2, 0), 0.4), sphere(p + vec3(0, 2, 0), 0.4)) }\n\
                camera { position = vec3(0, 0, -6)  target = vec3(0) }\n";
    let mut setup = TestEditor::new(text.as_bytes());
    assert!(setup.load());
    setup.ctrl("k");
    let ray_statistics = ray_statistics_of(&scenery_of(setup.source()), &|| true).unwrap();
    setup.editor.show_probe_answer(Answer::RayStatistics(setup.source(), ray_statistics.into()));
    let (_, objects) = setup.editor.picture.profile().unwrap();
    let named = |name: &str| objects.iter().find(|object| object.name == name).unwrap();
    let parts = parts_of(named("two"), &setup.editor.texts);
    let mut lines: Vec<usize> = parts.iter().map(|(line, ..)| *line).collect();
    assert!(parts[0].2.run >= parts[1].2.run, "{parts:?}");
    assert_eq!(named("two").run, parts.iter().map(|(_, _, part)| part.run).sum::<u64>());
    lines.sort_unstable();
    assert_eq!(lines, [1, 2], "{parts:?}");
    assert!(named("one").parts.len() == 2 && parts_of(named("one"), &setup.editor.texts).is_empty());
}

/// The number of reloads, and the values sent to the frame.
fn turned(setup: &mut TestEditor) -> (usize, Vec<Vec<f32>>) {
    let (mut reads, mut all) = (0, Vec::new());
    for command in setup.commands() {
        match command {
            Command::ReloadScene => reads += 1,
            Command::TurnNumbers(TurnedNumbers { values, .. }) => {
                all.push(values.into_iter().map(|(_, value)| value).collect())
            }
            other => panic!("{other:?}"),
        }
    }
    (reads, all)
}

#[test]
fn picking_a_colour_does_not_parse_the_text_and_is_one_undo_step() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    assert!(setup.load());
    setup.editor.pick_color(SCENE.find("vec3(0.9").unwrap());
    assert_eq!(setup.picked_color().unwrap().1, [0.9, 0.3, 0.1]);
    assert_eq!(turned(&mut setup), (0, vec![]));
    setup.editor.set_color([0.8, 0.3, 0.1]);
    assert_eq!(turned(&mut setup), (1, vec![vec![0.8, 0.3, 0.1]]), "one load makes it three inputs");
    assert!(setup.load());
    assert_eq!(setup.editor.texts.findings.as_ref().unwrap().numbers.len(), 3);
    for step in 1..=20 {
        setup.editor.set_color([0.8, 0.02 * f64::from(step), 0.0]);
    }
    let (reads, values) = turned(&mut setup);
    assert_eq!((reads, values.len(), &values[19][..]), (0, 20, &[0.8, 0.4, 0.0][..]));
    setup.editor.let_go();
    assert_eq!(turned(&mut setup), (1, vec![]), "the text defines the colour again");
    assert_eq!(setup.text(), SCENE.replace("vec3(0.9, 0.3, 0.1)", "vec3(0.8, 0.4, 0)"));
    assert!(setup.load());
    setup.editor.pick_color(setup.text().find("vec3(2").unwrap());
    setup.editor.set_color([2.0, 1.5, 0.25]);
    setup.named(NamedKey::Escape);
    assert!(setup.picked_color().is_none());
    assert!(setup.text().contains("emission = vec3(2, 1.5, 0.25)"), "{}", setup.text());
    setup.ctrl("z");
    setup.ctrl("z");
    assert_eq!(setup.text(), SCENE, "each is one undo step");
}

#[test]
fn moving_a_position_across_zero_does_not_parse_the_text() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    assert!(setup.load());
    setup.go_to("0, 0, 5), 1)");
    assert_eq!(setup.place(), Some([0.0, 0.0, 5.0]));
    setup.editor.move_place([0.25, 0.0, 0.0]);
    assert_eq!(turned(&mut setup).0, 1);
    assert!(setup.load());
    for _ in 0..10 {
        setup.editor.move_place([-0.1, 0.05, 0.0]);
    }
    let (reads, values) = turned(&mut setup);
    assert_eq!((reads, values.len()), (0, 10));
    assert_eq!(setup.place(), Some([-0.75, 0.5, 5.0]));
    setup.editor.let_go();
    assert_eq!(setup.text(), SCENE.replace("p - vec3(0, 0, 5)", "p - vec3(-0.75, 0.5, 5)"));
    assert!(setup.load());
    setup.ctrl("z");
    assert_eq!(setup.text(), SCENE);
    // `p + v` puts the object at -v.
    let text = SCENE.replace("p - vec3(0, 0, 5)", "p + vec3(1, 2, -5)");
    let mut setup = TestEditor::new(text.as_bytes());
    setup.go_to("vec3(1, 2");
    assert_eq!(setup.place(), Some([-1.0, -2.0, 5.0]));
    setup.editor.move_place([1.0, 0.0, 0.0]);
    assert!(setup.text().contains("p + vec3(0, 2, -5)"), "{}", setup.text());
    setup.go_to("0.9, 0.3");
    assert_eq!(setup.place(), None);
}

#[test]
fn colours_of_a_shipped_scene_cannot_be_picked() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    let orb = SceneSource::Shipped("first_steps".into());
    setup.editor.show_scene(&orb);
    let text = setup.text();
    setup.editor.pick_color(text.find("vec3(0.9, 0.25").unwrap());
    setup.editor.set_color([0.0; 3]);
    assert!(setup.picked_color().is_none() && setup.text() == text);
    assert!(setup.said().contains("Ctrl+S"), "{}", setup.said());
}

#[test]
fn a_moving_camera_redraws_only_a_cross() {
    let mut setup = TestEditor::new(SCENE.as_bytes());
    let scenery = scenery_of(setup.source());
    let (map, mut camera) = (Placement::default().map(), scenery.frame.camera);
    let mut moves = |setup: &mut TestEditor| {
        camera.position.x += 1.0;
        let before = setup.editor.revision;
        setup.editor.set_view(map, Some(camera));
        setup.editor.revision > before
    };
    assert!(moves(&mut setup), "the map is new");
    assert!(!moves(&mut setup));
    setup.go_to("0, 0, 5), 1)");
    assert!(moves(&mut setup));
}

#[test]
fn a_proposed_shape_has_a_preview() {
    let mut setup = TestEditor::new(b"object o { shape =  }");
    setup.go_to(" }");
    setup.type_text("toru");
    assert_eq!(setup.editor.proposals.shown.as_ref().unwrap().list[0].name, "torus");
    setup.wait("its preview", |editor| editor.proposals.object_preview().is_some());
    let picture = setup.editor.proposals.object_preview().unwrap();
    assert_eq!(picture.dimensions(), (48, 48));
    let covered = picture.pixels().filter(|pixel| pixel[3] == 255).count();
    assert!((200..2000).contains(&covered), "{covered}");
    let mut setup = TestEditor::new(b"fn torus_of_mine(p) = length(p) - 1\nobject o { shape =  }");
    setup.go_to(" }");
    setup.type_text("torus_of");
    assert_eq!(setup.editor.proposals.shown.as_ref().unwrap().list[0].name, "torus_of_mine");
    setup.editor.update();
    assert!(setup.editor.proposals.object_preview().is_none());
}

#[test]
fn composed_letters_are_not_in_the_text_before_they_are_typed() {
    let mut setup = TestEditor::new(b"# ");
    setup.editor.press(2, 1, false);
    setup.editor.set_preedit("\u{304b}\n");
    assert_eq!((setup.editor.preedit(), setup.text().as_str()), ("\u{304b}", "# "));
    setup.editor.type_text("\u{5bb6}");
    assert_eq!((setup.editor.preedit(), setup.text().as_str()), ("", "# \u{5bb6}"));
    setup.editor.set_preedit("\u{304b}");
    setup.editor.set_focus(false);
    assert_eq!(setup.editor.preedit(), "", "keys belong to the show");
}
