use std::collections::HashMap;

use super::super::changing::ChangingNumbers;
use super::super::{Compiled, Fault, compile, compile_all, no_includes};
use super::scene;
use crate::limits::{LIMITS, Limits};

/// Compiles on the test's thread, whose stack is small: 2 MiB, or the value of `RUST_MIN_STACK`.
fn on_a_small_stack(text: String) -> Compiled {
    compile("s", &text, &mut no_includes)
}

#[test]
fn deep_nesting_of_every_form_gives_a_message_and_no_overflow() {
    let deep = 100_000;
    for text in [
        "(".repeat(deep) + "1" + &")".repeat(deep),
        "(".repeat(deep),
        "-".repeat(deep) + "x",
        "!".repeat(deep) + "x",
        "x^".repeat(deep) + "x",
        "abs(".repeat(deep) + "1" + &")".repeat(deep),
        "drums.band(".repeat(deep / 2) + "1" + &")".repeat(deep / 2),
        "{".repeat(deep) + "1" + &"}".repeat(deep),
        "(a = ".repeat(deep) + "1" + &")".repeat(deep),
        "{ let a = 1 ".to_owned() + &"for i in 0..1 { ".repeat(deep / 4) + &"}".repeat(deep / 4) + "a }",
        "{ let a = 1 ".to_owned() + &"if x > 0 { ".repeat(deep / 4) + &"}".repeat(deep / 4) + "a }",
        "{ let a = 1 ".to_owned() + &"if x > 0 { a = 2 } else ".repeat(deep / 8) + "{ a = 3 } a }",
        "if x > 0 then 1 else ".repeat(deep / 4) + "1",
        "union(for i in 0..1: ".repeat(deep / 4) + "x" + &")".repeat(deep / 4),
        "union(".to_owned() + &"for i in 0..1: ".repeat(deep / 4) + "x)",
    ] {
        let compiled = on_a_small_stack(text);
        let over = compiled.diagnostics.iter().find(|one| one.fault == Fault::OverLimit);
        let over = over.unwrap_or_else(|| panic!("{}", compiled.render(false)));
        assert_eq!(over.message, "expressions are nested deeper than 256 levels");
        assert!(compiled.diagnostics.len() <= 3, "{}", compiled.render(false));
    }
}

#[test]
fn chains_do_not_count_as_nesting() {
    let long = 90_000;
    for text in ["x".to_owned() + &" + y".repeat(long), "p".to_owned() + &".zyx".repeat(long) + ".x"] {
        let compiled = on_a_small_stack(text);
        assert!(compiled.scene.is_some(), "{}", compiled.render(false));
    }
    for (open, depth) in [("(x+", 120), ("min(x, ", 250)] {
        assert!(on_a_small_stack(open.repeat(depth) + "1" + &")".repeat(depth)).scene.is_some(), "{open}");
    }
    let calls: String = (1..180).map(|index| format!("fn f{index}(a) = f{}(a) + 1\n", index - 1)).collect();
    let compiled = on_a_small_stack(format!("fn f0(a) = a\n{calls}f179(x)"));
    assert!(compiled.scene.is_some(), "{}", compiled.render(false));
}

fn message(text: &str, limits: Limits) -> String {
    let compiled = compile_all("s", text, &mut no_includes, &limits, ChangingNumbers::default());
    assert!(compiled.scene.is_none(), "no limit was exceeded: {}", &text[..text.len().min(80)]);
    let over = compiled.diagnostics.iter().find(|one| one.fault == Fault::OverLimit);
    over.unwrap_or_else(|| panic!("{}", compiled.render(false))).message.clone()
}

#[test]
fn every_limit_has_its_message() {
    let all = LIMITS;
    assert_eq!(
        message(&" ".repeat((1 << 20) + 1), all),
        "the scene is larger than 1048576 bytes, counting its includes"
    );
    assert_eq!(message(&"x ".repeat(500_000), all), "the scene has more than 400000 words and signs");
    let calls: String = (1..500).map(|index| format!("fn f{index}(a) = f{}(a) + 1\n", index - 1)).collect();
    assert!(message(&format!("fn f0(a) = a\n{calls}f499(x)"), all).contains("nested deeper than 400 levels"));
    let doubling: String =
        (1..60).map(|index| format!("fn f{index}(a) = f{0}(a) + f{0}(a + 1)\n", index - 1)).collect();
    let doubling = format!("fn f0(a) = sin(a)\n{doubling}f59(x)");
    assert_eq!(message(&doubling, all), "the scene expands to more than 4194304 operations");
    assert_eq!(
        message("sum(for i in 0..4000: for j in 0..4000: i * j)", all),
        "the scene expands to more than 4194304 operations"
    );
    assert_eq!(
        message("sum(for i in 0..5000: i)", all),
        "this loop has 5000 iterations; the maximum is 4096"
    );
    let nodes = Limits { graph_nodes_max: 100, ..all };
    assert!(message("sum(for i in 0..200: sin(x + i))", nodes).contains("more than 100 distinct operations"));
    let names = |count: usize, text: &str| {
        (0..count).map(|index| text.replace('#', &index.to_string())).collect::<String>()
    };
    assert_eq!(message(&(names(65, "param a# = 1\n") + "x"), all), "the scene has more than 64 parameters");
    assert_eq!(message(&names(257, "object a# { shape = x }\n"), all), "the scene has more than 256 objects");
    assert_eq!(message(&(names(65, "material a# { }\n") + "x"), all), "the scene has more than 64 materials");
    assert_eq!(
        message(&(names(17, "light a# { position = 1 }\n") + "x"), all),
        "the scene has more than 16 lights"
    );
    let pictures = names(13, "+ texture(\"#.png\", p.xy).rgb");
    assert_eq!(
        message(&format!("material a {{ color = 0 {pictures} }}\nx"), all),
        "the scene reads more than 12 images; the last frame counts as one"
    );
    let many = compile("s", &names(100, "let a# = zz#\n"), &mut no_includes);
    assert_eq!(many.diagnostics.len(), 21);
    assert_eq!(many.diagnostics[20].message, "there are more mistakes: only the first 20 are shown");
}

#[test]
fn includes_have_limits() {
    let mut files: HashMap<String, String> = HashMap::new();
    files.insert("a".to_owned(), "include \"b\"\nfn a(p) = 1".to_owned());
    files.insert("b".to_owned(), "include \"a\"\nfn b(p) = 1".to_owned());
    files.insert("bad".to_owned(), "fn bad(p) = zz".to_owned());
    for index in 0..100 {
        files.insert(format!("deep{index}"), format!("include \"deep{}\"", index + 1));
        files.insert(format!("flat{index}"), String::new());
    }
    files.insert("large".to_owned(), " ".repeat(1 << 20));
    let first = |text: &str| {
        let mut resolve = |name: &str| files.get(name).cloned().ok_or("there is no such file".to_owned());
        let compiled = compile("main", text, &mut resolve);
        let first = compiled.diagnostics.first().unwrap_or_else(|| panic!("{text}"));
        let place = compiled.sources.place(first.span.start).unwrap();
        (first.message.clone(), place.file.name.clone())
    };
    let circle = "files include each other in a circle: `a` includes `b` includes `a`".to_owned();
    assert_eq!(first("include \"a\"\nx"), (circle, "b".to_owned()));
    assert_eq!(first("include \"deep0\"\nx").0, "files include each other more than 16 deep");
    let flat: String = (0..100).map(|index| format!("include \"flat{index}\"\n")).collect();
    assert_eq!(first(&(flat + "x")).0, "the scene includes more than 64 files");
    assert_eq!(first("include \"none\"\nx").0, "`none` cannot be included: there is no such file");
    assert_eq!(first("include \"bad\"\nx"), ("there is no `zz` here".to_owned(), "bad".to_owned()));
    assert_eq!(
        first("include \"large\"\nx").0,
        "the scene is larger than 1048576 bytes, counting its includes"
    );
}

#[test]
fn failing_includes_are_reported_up_to_the_limit_of_mistakes() {
    let failing: String = (0..1000).map(|index| format!("include \"none{index}\"\n")).collect();
    let mut asked = 0;
    let mut resolve = |_: &str| {
        asked += 1;
        Err("there is no such file".to_owned())
    };
    let compiled = compile("main", &(failing + "x"), &mut resolve);
    assert!(asked < 30, "the resolver was called {asked} times");
    assert_eq!(compiled.includes_asked.len(), asked);
    assert_eq!(compiled.includes_asked.first().map(String::as_str), Some("none0"));
}

#[test]
fn rubbish_gives_messages() {
    let bytes: Vec<u8> =
        (0..200_000_u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let latin: String = bytes.iter().map(|&byte| char::from(byte)).collect();
    for text in
        [latin, String::from_utf8_lossy(&bytes).into_owned(), "}".repeat(100_000), "\"".repeat(100_000)]
    {
        let compiled = on_a_small_stack(text);
        assert!(compiled.scene.is_none() && compiled.diagnostics.len() <= 21);
        assert!(compiled.render(true).len() < 100_000);
    }
}

#[test]
fn constants_that_are_not_finite_compile() {
    for text in
        ["sqrt(-1) + x", "log(0) + x", "exp(1000) * x", "normalize(vec3(0)).x", "3e38 * 10 - 3e38 * 10"]
    {
        scene(text);
    }
}
