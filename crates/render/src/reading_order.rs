//! Reorders the words of a line for display by Unicode's bidirectional algorithm (UAX #9). egui joins Arabic letters
//! and writes each Arabic or Hebrew word from right to left, but it places the words from left to right.

use std::borrow::Cow;

use unicode_bidi::{BidiInfo, Level};

/// The lowest code point of the characters that are written from right to left.
const FIRST: char = '\u{590}';
/// The Unicode characters first-strong isolate and pop directional isolate. They delimit a part that is ordered
/// separately.
const ISOLATE: [char; 2] = ['\u{2068}', '\u{2069}'];

/// Isolates a part of a line, such as a title, from the words that follow it.
pub fn isolated(part: &str) -> Cow<'_, str> {
    let [begin, end] = ISOLATE;
    let plain = part.chars().all(|letter| letter < FIRST);
    if plain { Cow::Borrowed(part) } else { Cow::Owned(format!("{begin}{part}{end}")) }
}

/// Reorders the words of `text` for a line that begins at the left. The letters of each word keep their order.
pub fn as_seen(text: &str) -> Cow<'_, str> {
    if text.chars().all(|letter| letter < FIRST) {
        return Cow::Borrowed(text);
    }
    let info = BidiInfo::new(text, Some(Level::ltr()));
    if !info.has_rtl() && !text.contains(ISOLATE) {
        return Cow::Borrowed(text);
    }
    let mut seen = String::with_capacity(text.len());
    for paragraph in &info.paragraphs {
        let (levels, runs) = info.visual_runs(paragraph, paragraph.range.clone());
        for run in runs {
            let turned = levels.get(run.start).is_some_and(|level| level.is_rtl());
            let words = text.get(run).unwrap_or_default();
            match turned {
                true => words.split_inclusive(' ').rev().for_each(|word| push_turned(&mut seen, word)),
                false => seen.push_str(words),
            }
        }
    }
    seen.retain(|letter| !ISOLATE.contains(&letter));
    Cow::Owned(seen)
}

/// Adds a word of a reversed run. The space after the word moves in front of the word.
fn push_turned(seen: &mut String, word: &str) {
    let bare = word.trim_end_matches(' ');
    seen.push_str(word.get(bare.len()..).unwrap_or_default());
    seen.push_str(bare);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn words_from_right_to_left_are_reordered() {
        assert_eq!(as_seen("one two"), "one two");
        assert_eq!(as_seen("Grüße · 日本 🎵"), "Grüße · 日本 🎵");
        assert_eq!(as_seen("שיר של אהבה"), "אהבה של שיר");
        assert_eq!(as_seen("שיר 12 חדש"), "חדש 12 שיר");
        assert_eq!(as_seen("play أغنية جديدة now"), "play جديدة أغنية now");
    }

    #[test]
    fn the_number_after_an_isolated_title_is_no_part_of_it() {
        let line = |title: &str| format!("{} · {} · 1 of 2", isolated(title), isolated("זמר ידוע"));
        assert_eq!(as_seen(&line("שיר חדש")), "חדש שיר · ידוע זמר · 1 of 2");
        assert_eq!(as_seen(&line("Grüße 日本")), "Grüße 日本 · ידוע זמר · 1 of 2");
        assert_eq!(as_seen(&isolated("日本")), "日本");
    }

    proptest! {
        #[test]
        fn no_letter_is_lost(text in "[a-z א-ת0-9ا-ي .·()]{0,40}|\\PC{0,20}") {
            let sorted = |text: &str| {
                let mut letters: Vec<char> = text.chars().collect();
                letters.sort_unstable();
                letters
            };
            prop_assert_eq!(sorted(&as_seen(&text)), sorted(&text));
        }
    }
}
