use std::path::Path;

use proptest::prelude::*;

use super::super::library;
use super::super::pieces::{PieceKind, pieces};
use super::super::tests::mutated;
use super::super::token::Kind;
use super::super::{Scene, compile, no_includes};
use super::formatted;

/// All shipped scenes and the texts of the library.
fn shipped() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|end| end == "scene"));
    let scenes = scenes.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap()));
    let library = library::TEXTS.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    scenes.chain(library).collect()
}

fn scene(text: &str) -> Option<Scene> {
    compile("test", text, &mut no_includes).scene
}

/// Returns each token, and true if it begins a line. The first token always does: blank lines before it are removed.
fn tokens(text: &str) -> Vec<(PieceKind, String, bool)> {
    let tokens = pieces(text).into_iter().filter(|piece| !piece.is_comment()).enumerate();
    tokens.map(|(at, piece)| (piece.kind, piece.text.to_owned(), piece.newline || at == 0)).collect()
}

#[test]
fn blank_lines_before_the_first_token_have_no_meaning() {
    assert!(check("\n\"\"").is_ok());
    assert!(check("\n\nlet a = 1\nlet b = 2").is_ok());
}

fn comments(text: &str) -> Vec<&str> {
    pieces(text).into_iter().filter(|piece| piece.is_comment()).map(|piece| piece.text).collect()
}

/// Formats a text if its grammar is correct, and checks that only blanks have changed.
fn check(text: &str) -> Result<(), TestCaseError> {
    let Some(once) = formatted(text) else { return Ok(()) };
    prop_assert_eq!(tokens(text), tokens(&once));
    prop_assert_eq!(comments(text), comments(&once));
    let twice = formatted(&once);
    prop_assert_eq!(Some(&once), twice.as_ref());
    match (scene(text), scene(&once)) {
        (None, None) => {}
        (Some(before), Some(after)) => prop_assert!(before.draws_the_same(&after), "{}", text),
        (before, after) => {
            prop_assert!(false, "{} before, {} after: {text}", before.is_some(), after.is_some());
        }
    }
    Ok(())
}

#[test]
fn a_text_in_glsl_was_formatted_as_a_scene() {
    let text = "#define R 1.\nfloat map(vec3 p) {\n    int i=0; i++;\n  return length(p)-R;\n}\n";
    assert_eq!(formatted(text).as_deref(), Some(text));
}

#[test]
fn shipped_texts_are_formatted() {
    for (name, text) in shipped() {
        assert_eq!(formatted(&text).as_ref(), Some(&text), "{name}");
    }
}

#[test]
fn a_space_of_another_script_after_a_comment_joined_the_next_line() {
    for comment in ["# a\u{a0}", "let a = 1 # x\u{3000}"] {
        let text = format!("{comment}\nlet b = 1\nlength(p) - b\n");
        let wanted = format!("{}\nlet b = 1\nlength(p) - b\n", comment.trim_end());
        assert_eq!(formatted(&text).unwrap(), wanted);
    }
}

#[test]
fn blanks_and_indentation_become_regular() {
    for (text, expected) in [
        ("let  a=1+2 *x", "let a = 1 + 2 * x\n"),
        ("f( a ,b )\t- -c", "f(a, b) - -c\n"),
        ("let a = x*x+y * y", "let a = x*x + y * y\n"),
        ("object  o{shape=p.y  material=m}", "object o { shape = p.y  material = m }\n"),
        ("fn f (a:vec3,b)  {\na\n}", "fn f(a: vec3, b) {\n  a\n}\n"),
        ("sum( for i in 0..8 :f(i) )", "sum(for i in 0..8: f(i))\n"),
        ("param a=1 in 0  ..2", "param a = 1 in 0 .. 2\n"),
        ("let a = if(b)then-c else(d)", "let a = if (b) then -c else (d)\n"),
        ("fn f(p) {\n    let d = length(p)\n  -d\n   }", "fn f(p) {\n  let d = length(p)\n  -d\n}\n"),
        ("let a = 1\n- b", "let a = 1\n  - b\n"),
        ("let a =\n1", "let a =\n  1\n"),
        ("sky {\ncolor = 1 +\n2\n}\n\n\n\nx", "sky {\n  color = 1 +\n    2\n}\n\nx\n"),
        ("\n\n# a\n   # b\nx#c", "# a\n# b\nx #c\n"),
        ("a /* b */+/*\n c */ d", "a /* b */+/*\n c */ d\n"),
        ("let a = 1\r\nlet b = 2", "let a = 1\r\nlet b = 2\r\n"),
        ("\u{feff}x", "\u{feff}x\n"),
        ("let v = 1 .x", "let v = 1 .x\n"),
        (
            "fn f(p) {\nlet z  =p\nz.xy+=1 ;z *=2\nfor i in 0..8 while z.x<4{\nz = z*z\nif z.x > 3 break\n}\nif z.x>1 {\nz=p\n} else{\n z = -z\n}\n( a=z , b = 1 )\n}",
            "fn f(p) {\n  let z = p\n  z.xy += 1; z *= 2\n  for i in 0..8 while z.x < 4 {\n    z = z*z\n    if z.x > 3 break\n  }\n  if z.x > 1 {\n    z = p\n  } else {\n    z = -z\n  }\n  (a = z, b = 1)\n}\n",
        ),
        ("min(\nx,\n  y\n)", "min(\n  x,\n  y\n)\n"),
        ("", ""),
    ] {
        assert_eq!(formatted(text).as_deref(), Some(expected), "{text}");
    }
}

#[test]
fn tables_are_aligned() {
    for (text, expected) in [
        ("let abc = 1\nlet b   = 2\nlet c =3", "let abc = 1\nlet b   = 2\nlet c   = 3\n"),
        ("let abcde   = 1\nlet b = 2\n  + x", "let abcde = 1\nlet b     = 2\n      + x\n"),
        ("let a   = 1\nlet bcd = 2\nlet longer = 3", "let a   = 1\nlet bcd = 2\nlet longer = 3\n"),
        ("let a = 1      # one\nlet bc  =  22 # two", "let a  = 1     # one\nlet bc = 22 # two\n"),
        ("let a  = 1\n\nlet bcd   = 2", "let a = 1\n\nlet bcd = 2\n"),
    ] {
        assert_eq!(formatted(text).as_deref(), Some(expected), "{text}");
    }
}

#[test]
fn texts_with_mistakes_are_refused() {
    for text in ["let a = (1", "object {", "a b c", "/* open", "2x", "let = 3", "\"open"] {
        assert_eq!(formatted(text), None, "{text}");
    }
    // A name without a meaning is no mistake in the grammar.
    assert_eq!(formatted("nothing( x )").as_deref(), Some("nothing(x)\n"));
}

/// Quadratic work would take minutes.
#[test]
fn long_runs_of_comments_entries_and_brackets_are_formatted() {
    let max = crate::limits::LIMITS.scene_bytes_max;
    let blocks = format!("let a = {}1{}", "{ ".repeat(200), " }".repeat(200));
    for (line, count) in [
        ("#\n", max / 8),
        ("let a  =b\n", 30_000),
        ("let a = b  /* c */\n", 30_000),
        ("f(a)\n", 30_000),
        ("a\n+ b\n", 30_000),
        (&*(blocks + "\n"), 150),
    ] {
        let text = line.repeat(count);
        let once = formatted(&text).unwrap();
        assert_eq!(formatted(&once), Some(once), "{line}");
    }
}

/// Writes a text again with other blanks, indentation and blank lines. `seed` chooses them. No blank is put into `+=`.
fn disarranged(text: &str, mut seed: u64) -> String {
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    let pieces = pieces(text);
    let mut out = String::new();
    let mut after_minus = false;
    for piece in &pieces {
        if piece.breaks > 0 {
            let breaks = 1 + random(4) as usize;
            out.push_str(&"\n".repeat(breaks));
            out.push_str(&" \t"[..random(3) as usize].repeat(random(5) as usize));
        } else if piece.blanks > 0 {
            out.push_str(&" ".repeat(1 + random(4) as usize));
        } else if !after_minus && !piece.is(Kind::Assign) && !out.is_empty() && random(3) == 0 {
            out.push(' ');
        }
        out.push_str(piece.text);
        // The blank behind a first `-` has a meaning.
        after_minus = piece.newline && piece.is(Kind::Minus);
    }
    out
}

proptest! {
    #[test]
    fn formatting_keeps_the_meaning_of_disarranged_scenes(which in any::<prop::sample::Index>(), seed in any::<u64>()) {
        let all = shipped();
        let (name, text) = which.get(&all);
        let disarranged = disarranged(text, seed);
        let before = formatted(&disarranged);
        prop_assert!(before.is_some(), "{} is refused", name);
        check(&disarranged)?;
    }

    #[test]
    fn formatting_keeps_the_meaning_of_mutated_scenes(
        changes in prop::collection::vec(any::<(usize, usize, u8)>(), 1..4),
        seed in any::<u64>(),
    ) {
        let text = mutated(&changes);
        check(&text)?;
        if formatted(&text).is_some() {
            check(&disarranged(&text, seed))?;
        }
    }

    #[test]
    fn any_text_can_be_formatted_or_is_refused(text in "[a-c(){}=,;:.+*/^<!#\" \n\t\r0-9-]{0,60}") {
        check(&text)?;
    }
}
