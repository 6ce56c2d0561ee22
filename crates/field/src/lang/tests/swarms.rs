//! Mistakes in swarms.

use super::broken;

/// Texts with mistakes, each with its only message, the text that the message underlines, and a part of the hint.
const MISTAKES: &[(&str, &str, &str, &str)] = &[
    (
        "swarm a { count = 10000000 }",
        "the swarms of a scene can have 65536 points together, but these are 10000000",
        "count",
        "lower `count`",
    ),
    (
        "swarm a { count = 60000 }\nswarm b { count = 6000 }",
        "the swarms of a scene can have 65536 points together, but these are 66000",
        "count",
        "lower",
    ),
    (
        "swarm a { count = 0 }",
        "`count` must be a whole number of points, at least 1, but this is 0",
        "count",
        "10000",
    ),
    (
        "swarm a { count = 2.5 }",
        "`count` must be a whole number of points, at least 1, but this is 2.5",
        "count",
        "10000",
    ),
    (
        "swarm a { count = 5 + bass }",
        "`count` is fixed before the music plays, so `bass` has no value here",
        "bass",
        "a number",
    ),
    ("swarm a { let b = index  count = b }", "`count` must be a number that never changes", "count", "10000"),
    (
        "swarm a { position = p }",
        "the points of a swarm have numbers, so `p` has no value here",
        "p",
        "`index`",
    ),
    ("sphere(p, index)", "a shape has no numbered points, so `index` has no value here", "index", "`swarm`"),
    ("swarm { count = 5 }", "expected a name, found `{`", "{", ""),
    (
        "swarm a { position = 5  glow = vec2(1) }",
        "`glow` must be a vec3, but this is a vec2",
        "vec2(1)",
        "vec3",
    ),
    ("swarm a { radius = 5 }", "a swarm has no field `radius`", "radius", "`size`"),
];

#[test]
fn mistakes_in_swarms_are_explained_once() {
    for (text, message, place, hint) in MISTAKES {
        let compiled = broken(text);
        let [found] = &compiled.diagnostics[..] else { panic!("{text}: {}", compiled.render(false)) };
        assert_eq!(found.message, *message, "{text}");
        assert_eq!(compiled.sources.text(found.span), *place, "{text}");
        assert!(found.hint.as_deref().unwrap_or_default().contains(hint), "{text}: {:?}", found.hint);
    }
}
