//! The block `about`, and named cameras.

use super::super::{About, TransitionStyle, compile, no_includes};
use crate::graph::FrameInputs;
use crate::world::World;

fn about(text: &str) -> About {
    let compiled = compile("test", text, &mut no_includes);
    assert!(compiled.scene.is_some(), "{}", compiled.render(false));
    compiled.scene.unwrap().about
}

#[test]
fn about_describes_the_scene() {
    let said = about(
        "let low = 0.125\nabout { title = \"The sea\" author = \"A. N. Other\" license = \"CC0\"\n\
         energy = low .. 2 * 0.25; moods = \" calm, Wet,,\"\n follows = \"Bass\" enter = melt leave = cut }\ny",
    );
    let wanted = About {
        title: Some("The sea".to_owned()),
        author: Some("A. N. Other".to_owned()),
        license: Some("CC0".to_owned()),
        energy: (0.125, 0.5),
        moods: vec!["calm".to_owned(), "wet".to_owned()],
        follows: vec!["bass".to_owned()],
        enter: Some(TransitionStyle::Melt),
        leave: Some(TransitionStyle::Cut),
        portal: None,
    };
    assert_eq!(said, wanted);
    assert_eq!(about("y"), About::default());
    assert_eq!(about("let about = 1\ny + about"), About::default());
}

#[test]
fn cameras_have_names_and_move() {
    let text =
        "camera far { position = vec3(0, 1, -9 - t) }\ncamera { fov = 30 }\ncamera near { fov = 60 }\ny";
    let world = World::parse("test", text).unwrap();
    let names: Vec<&str> = world.scene.cameras.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["far", "near"]);
    let values = world.frame_tape.values(&FrameInputs { time: 2.0, ..FrameInputs::default() });
    assert_eq!(values.camera.fov, 30.0);
    assert_eq!(values.cameras[0].position, [0.0, 1.0, -11.0]);
    assert_eq!(values.cameras.iter().map(|camera| camera.fov).collect::<Vec<_>>(), [45.0, 60.0]);
}
