//! Finds the numbers in a scene's text that are being edited, by comparing versions of the text.
//!
//! A program compiled with [`lang::compile_while_changing`] reads these numbers as inputs. The first edit of a number
//! compiles a new program; further edits need no compilation. When the same text is loaded twice, editing has ended
//! and the numbers become constants again, because drivers optimize constants better than inputs.

use std::collections::BTreeSet;

use super::SceneSource;
use mariana_field::lang;

/// The last version of a text, and the indices of the numbers that differ between versions.
#[derive(Debug, Default)]
pub struct NumberEdits {
    last: Option<(SceneSource, String)>,
    changing: BTreeSet<usize>,
    pub(super) settled: bool,
}

impl NumberEdits {
    /// Compares `text` with the previous version and returns the indices of the numbers being edited. An unchanged text
    /// ends the edit, unless `is_turned` says that the user is turning one of the numbers.
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_inputs_until_the_text_repeats_or_changes_otherwise() {
        let (one, other) = (SceneSource::Formula("one".into()), SceneSource::Formula("other".into()));
        let mut edits = NumberEdits::default();
        let mut follow = |source: &SceneSource, text: &str| {
            let changing: Vec<usize> = edits.follow(source, text, false).iter().copied().collect();
            (changing, edits.settled)
        };
        assert_eq!(follow(&one, "sphere(p, 1) - 0.5"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.5"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25"), (vec![0, 1], false));
        // An edited comment changes no number and does not end the edit.
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![0, 1], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], true));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) - 0.25"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.25"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.5"), (vec![1], false));
        assert_eq!(follow(&other, "sphere(p, 3) + 0.75"), (vec![], false));
    }
}
