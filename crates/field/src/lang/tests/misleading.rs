//! Messages that once pointed in a wrong direction, and warnings that were missing.

use super::super::{Compiled, compile, no_includes};
use super::broken;

/// Asserts the only message of a text, the text that it underlines, and a part of its hint.
#[track_caller]
fn explained(text: &str, message: &str, under: &str, hint: &str) {
    let compiled = broken(text);
    let [one] = &compiled.diagnostics[..] else { panic!("{}", compiled.render(false)) };
    assert_eq!((one.message.as_str(), compiled.sources.text(one.span)), (message, under));
    assert!(one.hint.as_deref().unwrap_or_default().contains(hint), "{}", compiled.render(false));
}

/// The message and the hint of each warning.
#[track_caller]
fn warnings(text: &str) -> Vec<(String, String)> {
    let Compiled { scene, warnings, diagnostics, .. } = compile("test.scene", text, &mut no_includes);
    assert!(scene.is_some(), "{text}: {diagnostics:?}");
    warnings.into_iter().map(|one| (one.message, one.hint.unwrap_or_default())).collect()
}

#[test]
fn a_vector_for_a_number_that_is_no_distance_was_told_to_become_a_distance() {
    for (block, field) in
        [("medium a", "density"), ("material a", "glass"), ("sky", "bounce"), ("swarm a", "size")]
    {
        let message = format!("`{field}` must be a number, but this is a vec3");
        explained(&format!("{block} {{ {field} = vec3(1) }}"), &message, "vec3(1)", "write one number");
    }
    explained("medium a { shape = p }", "`shape` must be a number, but this is a vec3", "p", "a distance");
}

#[test]
fn an_input_of_another_field_was_said_to_be_unknown_to_the_whole_block() {
    let only = |names: &str| format!("in this block, only {names} can use it");
    explained(
        "sky { ambient = previous(pixel / resolution) }",
        "`ambient` cannot read images",
        "previous(pixel / resolution)",
        &only("`color`"),
    );
    explained(
        "sky { bounce = direction.y }",
        "`direction` depends on a ray's direction, which has no value in `bounce`",
        "direction",
        &only("`color` and `ambient`"),
    );
    explained(
        "object b { shape = y }\nobject a { shape = x  melt = p.y }",
        "`melt` is the same at all points, so `p` has no value here",
        "p",
        &only("`shape` and `bound`"),
    );
    explained(
        "swarm a { count = index }",
        "`count` has no numbered points, so `index` has no value here",
        "index",
        "`position`",
    );
}

#[test]
fn a_field_that_never_changes_was_taken_for_a_block_that_never_changes() {
    for (text, field, under) in
        [("swarm a { count = 100 * bass }", "count", "bass"), ("picture { memory = t }\nx", "memory", "t")]
    {
        let message = format!("`{field}` is fixed before the music plays, so `{under}` has no value here");
        explained(text, &message, under, "write a number");
    }
}

#[test]
fn a_division_by_zero_without_a_loop_was_explained_by_loops() {
    explained("medium a { density = 1 / 0 }", "this divides by zero", "1 / 0", "write another divisor");
}

#[test]
fn a_long_loop_over_the_points_of_a_swarm_was_told_to_repeat_space() {
    let hint = |text: &str| broken(text).diagnostics[0].hint.clone().unwrap_or_default();
    let sum = "sum(for i in 0..10000: i)";
    assert!(hint(&format!("swarm a {{ position = vec3({sum}) }}")).contains("`index`"));
    assert!(hint(&format!("medium a {{ density = {sum} }}")).contains("`repeat(p, size)`"));
    assert!(hint(&format!("camera {{ fov = {sum} }}\nx")).contains("fewer iterations"));
}

#[test]
fn a_block_without_its_name_got_no_advice() {
    for word in ["object", "material", "light", "medium", "swarm"] {
        let text = format!("{word} {{ }}");
        explained(&text, "expected a name, found `{`", "{", &format!("`{word} first {{ … }}`"));
    }
}

#[test]
fn two_media_were_called_mediums() {
    explained("medium a { }\nmedium a { }", "two media are called `a`", "a", "another name");
}

#[test]
fn a_file_that_includes_itself_was_said_to_declare_its_names_twice() {
    let text = "include \"self.scene\"\nlet a = 1\nsphere(p, a)";
    for name in ["self.scene", "folder/self.scene"] {
        let compiled = compile(name, text, &mut |_| Ok(text.to_owned()));
        let messages: Vec<&str> = compiled.diagnostics.iter().map(|one| one.message.as_str()).collect();
        assert_eq!(messages, ["files include each other in a circle: `self.scene` includes `self.scene`"]);
    }
}

#[test]
fn numbers_that_are_clamped_were_accepted_in_silence() {
    let all = "object ball { shape = sphere(p, 1)  material = m }\nmaterial m { ";
    for (text, message, hint) in [
        (
            "medium a { density = -1  emission = 1 }",
            "`density` cannot be -1: it counts as 0",
            "of at least 0",
        ),
        ("medium a { phase = 1 }", "`phase` cannot be 1: it counts as 0.95", "from -0.95 to 0.95"),
        ("swarm a { size = -1  glow = 1 }", "`size` cannot be -1: it counts as 0", "of at least 0"),
        ("sky { bounce = 2 }", "`bounce` cannot be 2: it counts as 1", "from 0 to 1"),
        ("x\ncamera { fov = 0 }", "`fov` cannot be 0: it counts as 1", "from 1 to 170"),
        ("x\npicture { grain = 20 }", "`grain` cannot be 20: it counts as 16", "from 0 to 16"),
        ("{all}glass = 5 }", "`glass` cannot be 5: it counts as 1", "from 0 to 1"),
        ("{all}glass = 1  ior = -1 }", "`ior` cannot be -1: it counts as 0.3", "from 0.3 to 4"),
        ("{all}color = vec3(255, 0, 0) }", "`color` cannot be 255: it counts as 1", "from 0 to 1"),
        ("{all}roughness = -0.5 }", "`roughness` cannot be -0.5: it counts as 0", "from 0 to 1"),
        (
            "x\nlight a { position = vec3(1)  shadow = 2 }",
            "`shadow` cannot be 2: it counts as 1",
            "from 0 to 1",
        ),
    ] {
        let found = warnings(&text.replace("{all}", all));
        let [(found, advice)] = &found[..] else { panic!("{text}: {found:?}") };
        assert_eq!(found, message, "{text}");
        assert!(advice.starts_with(&format!("write a number {hint}")), "{text}: {advice}");
        assert_eq!(advice.contains("srgb"), text.contains("255"), "{text}: {advice}");
    }
    for text in
        ["medium a { density = 1 }", "medium a { density = bass - 1 }", "swarm a { size = 0  glow = 1 }"]
    {
        assert_eq!(warnings(text), [], "{text}");
    }
}

#[test]
fn a_field_that_shows_nothing_without_another_was_accepted_in_silence() {
    let surface = |fields: &str| {
        warnings(&format!("object a {{ shape = x  material = m }}\nmaterial m {{ {fields} }}"))
    };
    let found = surface("film = 400  ior = 1.3  absorb = 1  reflect = 0");
    let messages: Vec<&str> = found.iter().map(|(message, _)| message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "`film` shows nothing without `reflect` or `metalness` above 0",
            "`ior` shows nothing without `glass` above 0",
            "`absorb` shows nothing without `glass` above 0",
        ]
    );
    assert_eq!(surface("film = 400  metalness = bass"), []);
    assert_eq!(surface("ior = 1.3  absorb = 1  glass = 0.5"), []);
    assert_eq!(warnings("swarm a { glow = 1 }"), []);
    assert_eq!(warnings("swarm a { reach = 1 }")[0].0, "`reach` shows nothing without `glow` above 0");
    assert_eq!(warnings("swarm a { glow = 1  reach = 0 }").len(), 1);
    assert_eq!(warnings("swarm a { size = 0 }")[0].0, "`size` shows nothing without `glow` above 0");
    assert_eq!(
        warnings("medium a { density = 0 }")[0].0,
        "`density` shows nothing without `emission` above 0"
    );
    assert_eq!(warnings("x\ncamera { focus = 3 }")[0].0, "`focus` shows nothing without `aperture` above 0");
}

#[test]
fn trails_that_outlast_the_memory_pulsed_without_a_warning() {
    let picture = |fields: &str| warnings(&format!("x\npicture {{ {fields} }}"));
    assert_eq!(
        picture("decay = 0.99  memory = 0.5"),
        [(
            "trails last longer than the scene's memory of 0.5 s: 74 % is left when it ends, so the brightness changes \
             every 0.5 s"
                .to_owned(),
            "leave `memory` out, because it follows from `decay`, or lower `decay`".to_owned()
        )]
    );
    assert_eq!(picture("decay = 0.9  memory = 1"), []);
    assert_eq!(picture("decay = 0.99"), []);
}

#[test]
fn a_warp_in_pixels_made_trails_vanish_without_a_warning() {
    let message = "`warp` takes all trails from outside of the picture";
    let picture = |warp: &str| warnings(&format!("x\npicture {{ decay = 0.9  warp = {warp} }}"));
    assert_eq!(picture("0.98 * pixel").first().map(|one| one.0.as_str()), Some(message));
    for warp in ["0.98 * pixel / resolution", "vec2(0.5)", "pixel / resolution + vec2(0, 0.9)"] {
        assert_eq!(picture(warp), [], "{warp}");
    }
}

#[test]
fn fields_and_names_in_a_wrong_place_got_no_way_to_the_right_one() {
    for (text, message, under, hint) in [
        (
            "object a { shape = x  glass = 1 }",
            "an object has no field `glass`",
            "glass",
            "a field of `material`; an object has `shape`",
        ),
        (
            "sky { decay = 0.9 }",
            "the sky has no field `decay`",
            "decay",
            "a field of `picture`; the sky has `color`",
        ),
        ("swarm a { position = hash_3(vec3(i)) }", "there is no `i` here", "i", "`index`"),
        ("swarm a { size = random(index) }", "there is no function `random`", "random", "`hash(p)`"),
        (
            "material a { glass = 1 > 0 }\nx",
            "`glass` must be a number, but this is a condition",
            "1 > 0",
            "if a then 1",
        ),
        (
            "material a { ior = \"glass\" }\nx",
            "`ior` must be a number, but this is a text",
            "\"glass\"",
            "a formula",
        ),
    ] {
        explained(text, message, under, hint);
    }
    let open = broken("medium a { density = 0.2\nsphere(p, 1)");
    assert!(
        open.diagnostics[0].hint.as_deref().unwrap_or_default().contains("`}`"),
        "{}",
        open.render(false)
    );
}
