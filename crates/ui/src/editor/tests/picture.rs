//! What the editor knows of the picture, and what is turned there: probes, lit lines, colours, positions.

use super::*;
use mariana_music::Features;
use mariana_render::frame::Frame;
use mariana_render::placement::Placement;
use mariana_scenes::probing::{Answer, Probed, Scenery, survey_of};

const SCENE: &str = "\
material red { color = vec3(0.9, 0.3, 0.1)  emission = vec3(2, 1, 0.5) }
object near {
  shape = sphere(p - vec3(0, 0, 5), 1)
  material = red
}
object floor { shape = y + 1 }
camera { position = vec3(0)  target = vec3(0, 0, 5)  fov = 90 }";

fn line_of_cursor(desk: &Desk) -> usize {
    let document = desk.editor.document().unwrap();
    document.editing.buffer().line_of(document.editing.cursor()) + 1
}

/// A picture of a scene after a second of silence, twice as wide as it is high.
fn scenery_of(source: SceneSource) -> Scenery {
    let ready = source.ready().unwrap();
    let frame = Frame::new(&ready.world, 1.0, Features::SILENCE, (200, 100));
    Scenery::new(source, ready, frame)
}

fn probe_of(scenery: &Scenery, at: [f64; 2]) -> Probed {
    mariana_scenes::probing::probe(scenery, at, &|| true).unwrap()
}

fn probe(desk: &mut Desk, at: [f64; 2]) {
    let answer = probe_of(&scenery_of(desk.source()), at);
    desk.editor.take_answer_about_the_picture(Answer::Point(answer));
}

#[test]
fn the_card_of_a_point_brings_the_cursor_to_what_made_it() {
    let mut desk = Desk::new(SCENE.as_bytes());
    assert!(desk.load());
    probe(&mut desk, [0.5, 0.5]);
    assert_eq!((line_of_cursor(&desk), desk.editor.probed_line()), (1, Some(2)), "one goes on writing");
    desk.editor.set_focus(false);
    desk.editor.obey(EditorEvent::GoToProbed);
    assert_eq!((line_of_cursor(&desk), desk.editor.has_focus()), (3, true));
    let surface = desk.editor.picture.probed().unwrap().surface.clone().unwrap();
    assert_eq!((surface.object.as_str(), surface.material.as_str()), ("near", "red"));
    probe(&mut desk, [0.5, 0.9]);
    desk.editor.obey(EditorEvent::GoToProbed);
    assert_eq!(line_of_cursor(&desk), 6);
    // The picture knows the text that was loaded; meanwhile a line was put in above.
    let scenery = scenery_of(desk.source());
    desk.go_to("object near");
    desk.type_text("# far\n");
    desk.editor.take_answer_about_the_picture(Answer::Point(probe_of(&scenery, [0.5, 0.5])));
    desk.editor.obey(EditorEvent::GoToProbed);
    assert_eq!(line_of_cursor(&desk), 4);
    let surface = desk.editor.picture.probed().unwrap().surface.clone().unwrap();
    let (file, range) = surface.written.unwrap();
    let (name, line, words) = desk.editor.texts.line_at(file, range).unwrap();
    assert_eq!(
        (name.as_str(), line, words.as_str()),
        ("main.scene", 4, "shape = sphere(p - vec3(0, 0, 5), 1)")
    );
    // The sky has no line, and Esc closes what is told before it closes the editor.
    probe(&mut desk, [0.5, 0.1]);
    desk.editor.obey(EditorEvent::GoToProbed);
    assert_eq!((line_of_cursor(&desk), desk.editor.picture.probed().unwrap().surface.as_ref()), (4, None));
    let _ = desk.commands();
    desk.named(NamedKey::Escape);
    assert!(desk.editor.picture.probed().is_none() && desk.commands().is_empty());
}

#[test]
fn a_point_that_an_included_text_made_shows_that_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.scene"), "# a part\nfn ball(q) = sphere(q, 1)\n").unwrap();
    let main = "include \"part.scene\"\nobject o { shape = ball(p - vec3(0, 0, 5)) }\n\
                camera { position = vec3(0)  target = vec3(0, 0, 5) }";
    fs::write(folder.path().join("main.scene"), main).unwrap();
    let mut desk = Desk::in_folder(folder);
    assert!(desk.load());
    probe(&mut desk, [0.5, 0.5]);
    assert_eq!(desk.editor.probed_line(), None, "it stands in another text");
    desk.editor.obey(EditorEvent::GoToProbed);
    desk.wait("the included text", |editor| {
        editor.document().is_some_and(|document| document.disk.is_some() && document.name() == "part.scene")
    });
    assert_eq!(line_of_cursor(&desk), 2);
    // It is there already.
    desk.editor.show_text(0);
    probe(&mut desk, [0.5, 0.5]);
    desk.editor.obey(EditorEvent::GoToProbed);
    assert_eq!((desk.editor.document().unwrap().name().as_str(), line_of_cursor(&desk)), ("part.scene", 2));
}

#[test]
fn what_the_line_at_the_cursor_makes_is_lit_up() {
    let mut desk = Desk::new(SCENE.as_bytes());
    assert!(desk.load());
    desk.ctrl("l");
    assert!(desk.editor.wants_survey() && desk.editor.light().is_none());
    let survey = survey_of(&scenery_of(desk.source()), &|| true).unwrap();
    desk.editor.take_answer_about_the_picture(Answer::Survey(desk.source(), survey.into()));
    let mut lit = |part: &str| {
        desk.go_to(part);
        let light = desk.editor.light().unwrap();
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
    desk.ctrl("a");
    assert_eq!(desk.editor.light().unwrap().cells.iter().filter(|lit| **lit).count(), {
        let survey = survey_of(&scenery_of(desk.source()), &|| true).unwrap();
        survey.cells.iter().filter(|cell| **cell > 0).count()
    });
    desk.ctrl("l");
    assert!(desk.editor.light().is_none() && !desk.editor.wants_survey());
}

#[test]
fn the_dearest_object_is_told_first() {
    let mut desk = Desk::new(SCENE.as_bytes());
    assert!(desk.load());
    desk.ctrl("k");
    let survey = survey_of(&scenery_of(desk.source()), &|| true).unwrap();
    desk.editor.take_answer_about_the_picture(Answer::Survey(desk.source(), survey.into()));
    let (survey, objects) = desk.editor.picture.profile().unwrap();
    assert!(objects[0].run >= objects[1].run, "{objects:?}");
    assert_eq!(survey.run(), survey.sky.1 + objects[0].run + objects[1].run);
    let (text, byte) = objects.iter().find(|object| object.name == "floor").unwrap().place.unwrap();
    desk.editor.obey(EditorEvent::GoTo { text, byte });
    assert_eq!(line_of_cursor(&desk), 6);
}

#[test]
fn lines_that_make_parts_of_an_object_are_told_with_it() {
    let text = "object two { shape = smooth_union(sphere(p - vec3(1, 0, 0), 0.8),\n  \
                sphere(p + vec3(1, 0, 0), 0.8), sphere(p + vec3(1, 1, 0), 0.5),\n  0.3) }\n\
                object one { shape = union(sphere(p - vec3(0, 2, 0), 0.4), sphere(p + vec3(0, 2, 0), 0.4)) }\n\
                camera { position = vec3(0, 0, -6)  target = vec3(0) }\n";
    let mut desk = Desk::new(text.as_bytes());
    assert!(desk.load());
    desk.ctrl("k");
    let survey = survey_of(&scenery_of(desk.source()), &|| true).unwrap();
    desk.editor.take_answer_about_the_picture(Answer::Survey(desk.source(), survey.into()));
    let (_, objects) = desk.editor.picture.profile().unwrap();
    let named = |name: &str| objects.iter().find(|object| object.name == name).unwrap();
    let parts = parts_of(named("two"), &desk.editor.texts);
    let mut lines: Vec<usize> = parts.iter().map(|(line, ..)| *line).collect();
    assert!(parts[0].2.run >= parts[1].2.run, "{parts:?}");
    assert_eq!(named("two").run, parts.iter().map(|(_, _, part)| part.run).sum::<u64>());
    lines.sort_unstable();
    assert_eq!(lines, [1, 2], "{parts:?}");
    // Both balls of the other one stand on one line.
    assert!(named("one").parts.len() == 2 && parts_of(named("one"), &desk.editor.texts).is_empty());
}

/// What the commands of a hand were: how often the text was read, and the values that went into the frame.
fn turned(desk: &mut Desk) -> (usize, Vec<Vec<f32>>) {
    let (mut reads, mut all) = (0, Vec::new());
    for command in desk.commands() {
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
fn a_colour_is_picked_without_a_reading_of_the_text_and_is_one_step() {
    let mut desk = Desk::new(SCENE.as_bytes());
    assert!(desk.load());
    desk.editor.obey(EditorEvent::PickColor(SCENE.find("vec3(0.9").unwrap()));
    assert_eq!(desk.picked_color().unwrap().1, [0.9, 0.3, 0.1]);
    assert_eq!(turned(&mut desk), (0, vec![]));
    desk.editor.obey(EditorEvent::SetColor([0.8, 0.3, 0.1]));
    assert_eq!(turned(&mut desk), (1, vec![vec![0.8, 0.3, 0.1]]), "once, to make it three inputs");
    assert!(desk.load());
    assert_eq!(desk.editor.texts.findings().unwrap().numbers.len(), 3);
    for step in 1..=20 {
        desk.editor.obey(EditorEvent::SetColor([0.8, 0.02 * f64::from(step), 0.0]));
    }
    let (reads, values) = turned(&mut desk);
    assert_eq!((reads, values.len(), &values[19][..]), (0, 20, &[0.8, 0.4, 0.0][..]));
    desk.editor.obey(EditorEvent::LetGo);
    assert_eq!(turned(&mut desk), (1, vec![]), "the text holds again");
    assert_eq!(desk.text(), SCENE.replace("vec3(0.9, 0.3, 0.1)", "vec3(0.8, 0.4, 0)"));
    assert!(desk.load());
    // It goes on being picked, brighter than white, too.
    desk.editor.obey(EditorEvent::PickColor(desk.text().find("vec3(2").unwrap()));
    desk.editor.obey(EditorEvent::SetColor([2.0, 1.5, 0.25]));
    desk.named(NamedKey::Escape);
    assert!(desk.picked_color().is_none());
    assert!(desk.text().contains("emission = vec3(2, 1.5, 0.25)"), "{}", desk.text());
    desk.ctrl("z");
    desk.ctrl("z");
    assert_eq!(desk.text(), SCENE, "each is taken back at once");
}

#[test]
fn a_position_is_moved_through_nothing_without_a_reading_of_the_text() {
    let mut desk = Desk::new(SCENE.as_bytes());
    assert!(desk.load());
    desk.go_to("0, 0, 5), 1)");
    assert_eq!(desk.place(), Some([0.0, 0.0, 5.0]));
    desk.editor.obey(EditorEvent::MovePlace([0.25, 0.0, 0.0]));
    assert_eq!(turned(&mut desk).0, 1);
    assert!(desk.load());
    for _ in 0..10 {
        desk.editor.obey(EditorEvent::MovePlace([-0.1, 0.05, 0.0]));
    }
    let (reads, values) = turned(&mut desk);
    assert_eq!((reads, values.len()), (0, 10));
    assert_eq!(desk.place(), Some([-0.75, 0.5, 5.0]));
    desk.editor.obey(EditorEvent::LetGo);
    assert_eq!(desk.text(), SCENE.replace("p - vec3(0, 0, 5)", "p - vec3(-0.75, 0.5, 5)"));
    assert!(desk.load());
    desk.ctrl("z");
    assert_eq!(desk.text(), SCENE);
    // What is added to a point lies on the other side of the origin.
    let text = SCENE.replace("p - vec3(0, 0, 5)", "p + vec3(1, 2, -5)");
    let mut desk = Desk::new(text.as_bytes());
    desk.go_to("vec3(1, 2");
    assert_eq!(desk.place(), Some([-1.0, -2.0, 5.0]));
    desk.editor.obey(EditorEvent::MovePlace([1.0, 0.0, 0.0]));
    assert!(desk.text().contains("p + vec3(0, 2, -5)"), "{}", desk.text());
    // A colour is no place.
    desk.go_to("0.9, 0.3");
    assert_eq!(desk.place(), None);
}

#[test]
fn colours_of_a_shipped_scene_are_not_picked() {
    let mut desk = Desk::new(SCENE.as_bytes());
    let orb = SceneSource::Shipped("first_steps".into());
    desk.editor.show_scene(&orb);
    let text = desk.text();
    desk.editor.obey(EditorEvent::PickColor(text.find("vec3(0.9, 0.25").unwrap()));
    desk.editor.obey(EditorEvent::SetColor([0.0; 3]));
    assert!(desk.picked_color().is_none() && desk.text() == text);
    assert!(desk.said().contains("Ctrl+S"), "{}", desk.said());
}

#[test]
fn only_a_cross_in_the_picture_is_drawn_again_when_the_camera_moves() {
    let mut desk = Desk::new(SCENE.as_bytes());
    let scenery = scenery_of(desk.source());
    let (map, mut camera) = (Placement::default().map(), scenery.frame.camera);
    let mut moves = |desk: &mut Desk| {
        camera.position.x += 1.0;
        let before = desk.editor.revision();
        desk.editor.set_view(map, Some(camera));
        desk.editor.revision() > before
    };
    assert!(moves(&mut desk), "the map is new");
    assert!(!moves(&mut desk));
    desk.go_to("0, 0, 5), 1)");
    assert!(moves(&mut desk));
}

#[test]
fn a_shape_that_is_proposed_has_a_small_picture() {
    let mut desk = Desk::new(b"object o { shape =  }");
    desk.go_to(" }");
    desk.type_text("toru");
    assert_eq!(desk.editor.proposals.shown().unwrap().list[0].name, "torus");
    desk.wait("its picture", |editor| editor.proposals.portrait().is_some());
    let picture = desk.editor.proposals.portrait().unwrap();
    assert_eq!(picture.len(), super::super::PORTRAIT_SIDE * super::super::PORTRAIT_SIDE);
    let covered = picture.iter().filter(|pixel| pixel[3] == 255).count();
    assert!((200..2000).contains(&covered), "{covered}");
    // What one has written oneself has none.
    let mut desk = Desk::new(b"fn torus_of_mine(p) = length(p) - 1\nobject o { shape =  }");
    desk.go_to(" }");
    desk.type_text("torus_of");
    assert_eq!(desk.editor.proposals.shown().unwrap().list[0].name, "torus_of_mine");
    desk.editor.update();
    assert!(desk.editor.proposals.portrait().is_none());
}

#[test]
fn letters_that_are_put_together_are_not_in_the_text_before_they_are_typed() {
    let mut desk = Desk::new(b"# ");
    desk.editor.obey(EditorEvent::Press { at: 2, clicks: 1, select: false });
    desk.editor.set_preedit("\u{304b}\n");
    assert_eq!((desk.editor.preedit(), desk.text().as_str()), ("\u{304b}", "# "));
    desk.editor.type_text("\u{5bb6}");
    assert_eq!((desk.editor.preedit(), desk.text().as_str()), ("", "# \u{5bb6}"));
    desk.editor.set_preedit("\u{304b}");
    desk.editor.set_focus(false);
    assert_eq!(desk.editor.preedit(), "", "keys are the show's");
}
