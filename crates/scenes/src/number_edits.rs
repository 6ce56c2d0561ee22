//! Which numbers of a scene's text somebody is changing, found by comparing its versions.
//!
//! A program that is compiled for a text reads such numbers as inputs ([`lang::compile_while_changing`]): the first
//! change of a number makes another program, all further ones need none. A text that is loaded again as it was has
//! come to rest, and its numbers are constants again, because a driver makes the best of those.

use std::collections::BTreeSet;

use super::SceneSource;
use mariana_field::lang;

/// The last version of a text, and the places of the numbers in which its versions differ.
#[derive(Debug, Default)]
pub struct NumberEdits {
    last: Option<(SceneSource, String)>,
    changing: BTreeSet<usize>,
    settled: bool,
}

impl NumberEdits {
    /// Takes the text of a source as it is now and returns the places of the numbers that are being changed. While one
    /// of them `is_turned`, a text that is as it was has not come to rest.
    pub(super) fn follow(&mut self, source: &SceneSource, text: &str, is_turned: bool) -> &BTreeSet<usize> {
        let before = self.last.take().filter(|(of, _)| of == source).map(|(_, text)| text);
        let is_as_it_was = before.as_deref() == Some(text);
        self.settled = is_as_it_was && !self.changing.is_empty() && !is_turned;
        if is_as_it_was && is_turned {
            self.last = before.map(|text| (source.clone(), text));
            return &self.changing;
        }
        match before.filter(|_| !is_as_it_was).and_then(|before| lang::changed_numbers(&before, text)) {
            Some(changed) => self.changing.extend(changed),
            None => self.changing.clear(),
        }
        self.last = Some((source.clone(), text.to_owned()));
        &self.changing
    }

    /// Whether the text has just come to rest.
    pub(super) fn has_settled(&self) -> bool {
        self.settled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_change_until_the_text_rests_or_becomes_another_one() {
        let (one, other) = (SceneSource::Formula("one".into()), SceneSource::Formula("other".into()));
        let mut edits = NumberEdits::default();
        let mut follow = |source: &SceneSource, text: &str| {
            let changing: Vec<usize> = edits.follow(source, text, false).iter().copied().collect();
            (changing, edits.has_settled())
        };
        assert_eq!(follow(&one, "sphere(p, 1) - 0.5"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.5"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25"), (vec![0, 1], false));
        // A comment changes no number, and the others are still being changed.
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![0, 1], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], true));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) - 0.25"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.25"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.5"), (vec![1], false));
        assert_eq!(follow(&other, "sphere(p, 3) + 0.75"), (vec![], false));
    }
}
