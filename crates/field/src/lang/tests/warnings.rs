//! Warnings of scenes without mistakes.

use super::super::{Compiled, Fault, compile, no_includes};
use super::{scene, value};
use crate::world::World;

fn compiled(text: &str) -> Compiled {
    let compiled = compile("test.scene", text, &mut no_includes);
    assert!(compiled.scene.is_some(), "{}", compiled.render(false));
    compiled
}

/// The warned text and the message of each warning.
fn warnings(text: &str) -> Vec<(String, String)> {
    let Compiled { warnings, sources, .. } = compiled(text);
    assert!(warnings.iter().all(|one| one.fault == Fault::Warning && one.hint.is_some()));
    warnings.into_iter().map(|one| (sources.text(one.span).to_owned(), one.message)).collect()
}

fn warned(text: &str) -> Vec<String> {
    warnings(text).into_iter().map(|(at, _)| at).collect()
}

#[test]
fn unused_names_are_warned_of() {
    let text = "\
param speed = 1
param used = 2 in 1 .. 3
let far = 3
let near = used
fn helper(a) = a + near
fn ball(q) { let r = 1  sphere(q, r) }
material red { color = vec3(1, 0, 0) }
material blue { let deep = 0.5  let lost = 1  color = vec3(0, 0, deep) }
object one { let q = p  let rest = 2  shape = ball(q)  material = blue }";
    let expected = [
        ("speed", "the parameter `speed` is never used"),
        ("far", "the value `far` is never used"),
        ("helper", "the function `helper` is never used"),
        ("red", "the material `red` is never used"),
        ("lost", "the value `lost` is never used"),
        ("rest", "the value `rest` is never used"),
    ];
    assert_eq!(warnings(text), expected.map(|(at, message)| (at.to_owned(), message.to_owned())));
}

#[test]
fn a_local_name_that_another_block_uses_is_warned_of_too() {
    let text = "object a { let q = p  shape = sphere(p, 1) }\nobject b { let q = p  shape = sphere(q, 1) }";
    let Compiled { warnings, .. } = compiled(text);
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].span.start, 15);
}

#[test]
fn unused_names_of_included_files_are_not_warned_of() {
    let mut shapes = |_: &str| Ok("fn ball(q) = sphere(q, 1)\nfn other(q) = q".to_owned());
    let text = "include \"shapes.scene\"\nlet lost = 1\nball(p)";
    let compiled = compile("test.scene", text, &mut shapes);
    let messages: Vec<&str> = compiled.warnings.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(messages, ["the value `lost` is never used"]);
}

#[test]
fn a_warning_names_itself_and_shows_its_hint() {
    let Compiled { warnings, sources, .. } = compiled("let lost = 1\nlength(p) - 1");
    let text = warnings[0].render(&sources, false);
    assert!(text.starts_with("warning: the value `lost` is never used"), "{text}");
    assert!(text.contains("test.scene:1:5") && text.contains("help: use it, or delete it"), "{text}");
}

#[test]
fn a_sun_from_below_is_warned_of_unless_another_light_shines() {
    let up = "light sun { direction = vec3(1, 2, 1) }\nsphere(p, 1)";
    assert_eq!(warned(up), ["direction"]);
    for text in [
        "light sun { direction = -vec3(1, 2, 1) }\nsphere(p, 1)",
        "light sun { direction = vec3(1, sin(t), 1) }\nsphere(p, 1)",
        "light sun { direction = -vec3(1, 2, 1) }\nlight rim { direction = vec3(0, 1, 0) }\nsphere(p, 1)",
        "light lamp { position = vec3(1, 2, 1) }\nlight rim { direction = vec3(0, 1, 0) }\nsphere(p, 1)",
    ] {
        assert!(warned(text).is_empty(), "{text}");
    }
}

#[test]
fn a_sum_of_nothing_is_0_and_a_product_of_nothing_is_1() {
    let at = [3.0, 0.0, 0.0];
    assert_eq!(value("x - sum(for i in 0..0: i)", at), 3.0);
    assert_eq!(value("x - product(for i in 2..2: i)", at), 2.0);
    assert_eq!(value("x - sum(for i in 0..0: i, 2)", at), 1.0);
}

#[test]
fn a_scene_of_sky_alone_is_a_scene() {
    let text = "sky { color = vec3(0.2, 0.4, direction.y) }";
    let sky = scene(text);
    assert!(sky.objects.is_empty() && sky.has_own_sky && !sky.materials.is_empty());
    let world = World::new("sky", sky, Vec::new()).unwrap();
    assert!(!world.has_rest && world.planes.is_empty());
    world.compiled_glsl().unwrap();
    world.tape_buffers();
}

#[test]
fn trails_that_last_too_long_or_never_begin_are_warned_of() {
    let picture = |fields: &str| {
        warnings(&format!("param held = 0 in -1 .. 2\nsphere(p, held)\npicture {{ {fields} }}"))
    };
    let too_long = "`decay` may be above 0.9908, so trails would last too long";
    for decay in ["1", "9 * held", "t", "0.99 + bass", "1 / volume.x"] {
        assert_eq!(
            picture(&format!("decay = {decay}")),
            [("decay".to_owned(), too_long.to_owned())],
            "{decay}"
        );
    }
    for decay in ["0.9", "0.9 + 0.05 * bass", "min(9 * held, 0.97)", "clamp(t, 0, 0.9)"] {
        assert_eq!(
            picture(&format!("decay = {decay}  blur = 0.001  warp = pixel / resolution")),
            [],
            "{decay}"
        );
    }
    for decay in ["0", "-1", "0.5 * held - 2"] {
        let message = "`decay` is never above 0, so there are no trails";
        assert_eq!(
            picture(&format!("decay = {decay}")),
            [("decay".to_owned(), message.to_owned())],
            "{decay}"
        );
    }
    assert_eq!(
        picture("warp = vec2(0.5)  blur = 0.01  memory = 60")
            .into_iter()
            .map(|(_, message)| message)
            .collect::<Vec<_>>(),
        [
            "`warp` has no effect without trails",
            "`blur` has no effect without trails",
            "a `memory` of 60 s would delay each still and each jump",
        ]
    );
}

#[test]
fn a_memory_without_anything_to_remember_is_warned_of() {
    let message = "`memory` has no effect without trails and `previous`".to_owned();
    let scene = |picture: &str| warnings(&format!("sphere(p, 1)\npicture {{ {picture} }}"));
    assert_eq!(scene("memory = 5"), [("memory".to_owned(), message)]);
    for rest in ["memory = 5  decay = 0.9", "memory = 5 }\nsky { color = 0.5 * previous(pixel / resolution)"]
    {
        assert_eq!(scene(rest), [], "{rest}");
    }
}
