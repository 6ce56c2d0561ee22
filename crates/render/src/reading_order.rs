//! The order in which the words of a line are seen, by Unicode's bidirectional algorithm (UAX #9).
//!
//! egui joins Arabic letters and writes each word of Arabic and Hebrew from right to left, but sets words side by side
//! from left to right. So it is given the words in the order of their places.

use std::borrow::Cow;

use unicode_bidi::{BidiInfo, Level};

/// Nothing below this is written from right to left.
const FIRST: char = '\u{590}';
/// Begins a part that is ordered by itself, and ends it.
const ISOLATE: [char; 2] = ['\u{2068}', '\u{2069}'];

/// A part of a line, such as a title, that is ordered by itself: what follows it is no part of its words.
pub fn isolated(part: &str) -> Cow<'_, str> {
    let [begin, end] = ISOLATE;
    let plain = part.chars().all(|letter| letter < FIRST);
    if plain { Cow::Borrowed(part) } else { Cow::Owned(format!("{begin}{part}{end}")) }
}

/// `text` with its words in the order in which they stand in a line that begins at the left; each word stays as it is.
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
    // They have no look.
    seen.retain(|letter| !ISOLATE.contains(&letter));
    Cow::Owned(seen)
}

/// Adds a word of a line that is turned around: the space after it comes to stand before it.
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
    fn words_from_right_to_left_stand_in_that_order() {
        assert_eq!(as_seen("one two"), "one two");
        assert_eq!(as_seen("Grüße · 日本 🎵"), "Grüße · 日本 🎵");
        assert_eq!(as_seen("שיר של אהבה"), "אהבה של שיר");
        // A number is read from the left, and what is around it is not.
        assert_eq!(as_seen("שיר 12 חדש"), "חדש 12 שיר");
        assert_eq!(as_seen("play أغنية جديدة now"), "play جديدة أغنية now");
    }

    #[test]
    fn the_number_after_a_title_became_one_of_its_words() {
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
