//! Tests of the inputs of a song's parts: `drums.volume`, `vocals.band(3)`.

use super::super::{compile, part_inputs, parts};
use super::{broken, scene, value};
use crate::graph::{Op, PartInput};

fn place(name: &str) -> f32 {
    PartInput::named(name).unwrap().index() as f32 / 1000.0
}

#[test]
fn each_part_has_the_inputs_of_the_moment_and_its_bands() {
    let at = [0.5, -2.0, 3.0];
    for (text, expected) in [
        ("drums.volume.y", place("drums.volume.y")),
        ("dot(bass.volume, vec2(0, 1))", place("bass.volume.y")),
        ("drums.beat + drums.kick", place("drums.beat") + place("drums.kick")),
        ("vocals.melody", place("vocals.melody")),
        ("other.bass", place("other.bass")),
        ("other.loudness", place("other.loudness")),
        ("bass.band(3)", place("bass.band(3)")),
        ("other.band(31)", place("other.band(31)")),
        // Computed indices are clamped and rounded down, and never read another part.
        ("drums.band(z)", place("drums.band(3)")),
        ("other.band(z - 0.0000003)", place("other.band(2)")),
        ("bass.band(z - 50)", place("bass.band(0)")),
        ("bass.band(z + 50)", place("bass.band(31)")),
        ("drums.band(0 * sqrt(y) + log(y) * 0)", place("drums.band(0)")),
        ("sum(for i in 0..2: vocals.band(i))", place("vocals.band(0)") + place("vocals.band(1)")),
        // `bass` alone and its components are still the low frequencies, which are silent here.
        ("bass + bass.x + dot(bass.xx, vec2(1))", 0.0),
    ] {
        let got = value(text, at);
        assert!((got - expected).abs() < 1e-6, "{text} is {got}, not {expected}");
    }
}

#[test]
fn a_scenes_own_names_hide_the_parts() {
    for text in [
        "let drums = vec2(3, 4)\ndrums.x",
        "param other = 3 in 0 .. 4\nother.x",
        "fn f(vocals) = vocals.y\nf(vec2(4, 3))",
        "{ let drums = vec3(3)  drums.z }",
        // Functions have a separate namespace.
        "fn drums(v) = v\ndrums(3) + drums.band(3) * 0",
    ] {
        assert_eq!(value(text, [0.0; 3]), 3.0, "{text}");
    }
    for (text, reads) in [
        ("length(p) - drums.beat", true),
        ("length(p) - other.band(x)", true),
        ("let other = vec2(1)\nlength(p) - other.x", false),
        ("length(p) - bass - bass.x", false),
    ] {
        let graph = scene(text).graph;
        assert_eq!((graph.reads(&Op::PARTS), graph.moves_by_itself()), (reads, reads), "{text}");
        assert!(!graph.reads_song() && !graph.reads(&Op::CURVES), "{text}");
    }
}

#[test]
fn parts_of_hoisted_expressions_never_reach_the_shaders() {
    use crate::world::World;
    let tables = |text: &str| {
        let world = World::new("test", scene(text), Vec::new()).unwrap();
        world.graph.inputs_used(&world.roots.all().collect::<Vec<_>>()).tables
    };
    assert!(
        tables("length(p) - 1 - drums.volume.x * vocals.band(3) - bass.band(10 * other.beat)").is_empty()
    );
    assert_eq!(tables("length(p) - 1 - drums.band(x)").into_iter().collect::<Vec<_>>(), [Op::Part]);
}

#[test]
fn wrong_names_are_explained() {
    for (text, message, hint) in [
        ("drums.foo", "`drums` has no input `foo`", "volume_mid"),
        ("bass.foo", "`bass` has no input `foo`", "band"),
        ("drums.volum", "`drums` has no input `volum`", "did you mean `drums.volume`?"),
        ("drums.x", "`drums` has no input `x`", "loudness"),
        ("vocals.section", "`vocals` has no input `section`", "read it without `vocals.`"),
        ("drums.band", "`drums` has no input `band`", "`drums.band(3)`"),
        ("drums.band(32)", "there is no band 32", "0 to 31"),
        ("drums.band(p)", "`band` takes a number, not a vec3", ""),
        ("drums.band(x > 0)", "`band` works on numbers and vectors", ""),
        ("drums.chroma(3)", "there is no function `.chroma`", "`drums.band(3)`"),
        ("(drums + 1).band(3)", "there is no function `.band`", "`drums.band(3)`"),
        ("drums.beat.band(3)", "there is no function `.band`", "`drums.band(3)`"),
        ("p.band(3)", "`p` has no function `band`", "`drums`, `bass`"),
        ("let drums = 1\ndrums.band(3)", "`drums` has no function `band`", "uses the name otherwise"),
        ("1 + vocals", "there is no `vocals` here", "`vocals.volume`"),
        ("drums.volume.z", "a vec2 has no component `z`", ""),
        ("param a = 1 in 0 .. 2\nunion(for i in 0..drums.beat: x)", "a loop's bounds must be constants", ""),
    ] {
        let compiled = broken(text);
        let first = &compiled.diagnostics[0];
        assert!(first.message.starts_with(message), "{text}: {}", first.message);
        let found = first.hint.clone().unwrap_or_default();
        assert!(found.contains(hint), "{text}: {found}");
    }
    let compiled = compile("s", "drums.band(3", &mut super::no_includes);
    assert!(compiled.scene.is_none());
}

#[test]
fn documentation_names_every_part_and_its_inputs() {
    let names: Vec<&str> = parts().map(|(name, _)| name).collect();
    assert_eq!(names, ["drums", "bass", "vocals", "other"]);
    let of_parts: Vec<&str> = part_inputs().map(|(name, _)| name).collect();
    assert_eq!(of_parts.first(), Some(&"volume"));
    assert_eq!(of_parts.last(), Some(&"band"));
    for name in of_parts.iter().filter(|name| **name != "band") {
        value(&format!("length(drums.{name})"), [0.0; 3]);
    }
    assert!(!of_parts.contains(&"bar"));
}
