//! Random edits of a shipped scene, and random texts. Each text must compile to a scene or to messages.
//! `PROPTEST_CASES` sets the number of cases.

use proptest::prelude::*;

use super::super::{compile, no_includes};

const SPEAKERS: &str = include_str!("../../../../../assets/scenes/speakers.scene");
const PIECES: &[&str] = &[
    "(",
    ")",
    "{",
    "}",
    ",",
    ";",
    "..",
    "=",
    "for i in 0..9: ",
    "let a = ",
    "fn f(p) ",
    "if ",
    "then ",
    "else ",
    "\"",
    "\n",
    "-",
    "^",
    ".xyz",
    "band(",
    "drums.",
    "bass.band(",
    "union(",
    "1e39",
    "9999",
    "object a ",
    "material ",
    "é",
    "\0",
    "#",
    "/*",
    "p",
    "speakers(p)",
];

pub(in crate::lang) fn mutated(changes: &[(usize, usize, u8)]) -> String {
    let mut text: Vec<char> = SPEAKERS.chars().collect();
    for &(at, length, what) in changes {
        let at = at % (text.len() + 1);
        let end = (at + length % 40).min(text.len());
        let cut: Vec<char> = text[at..end].to_vec();
        match what % 4 {
            0 => drop(text.drain(at..end)),
            1 => drop(text.splice(at..at, cut)),
            2 => {
                text.drain(at..end);
                let to = (at * 7919 + length) % (text.len() + 1);
                text.splice(to..to, cut);
            }
            _ => drop(text.splice(at..at, PIECES[length % PIECES.len()].chars())),
        }
    }
    text.into_iter().collect()
}

fn check(text: &str) -> Result<(), TestCaseError> {
    let compiled = compile("s", text, &mut no_includes);
    prop_assert_eq!(compiled.scene.is_some(), compiled.diagnostics.is_empty());
    prop_assert!(compiled.diagnostics.len() <= 21);
    for diagnostic in &compiled.diagnostics {
        prop_assert!(compiled.sources.place(diagnostic.span.start).is_some());
        prop_assert!(diagnostic.span.end as usize <= text.len());
    }
    prop_assert_eq!(compiled.render(false).is_empty(), compiled.diagnostics.is_empty());
    Ok(())
}

proptest! {
    #[test]
    fn mutated_scenes_give_scenes_or_messages(changes in prop::collection::vec(any::<(usize, usize, u8)>(), 1..6)) {
        check(&mutated(&changes))?;
    }

    #[test]
    fn any_text_gives_a_scene_or_messages(text in "\\PC{0,200}") {
        check(&text)?;
    }

    #[test]
    fn any_words_give_a_scene_or_messages(words in prop::collection::vec(prop::sample::select(PIECES), 0..60)) {
        check(&words.concat())?;
    }
}
