//! Suggestions for misspelt names.

use strsim::osa_distance;

/// Returns the name that differs from `typed` by the fewest edits (insert, delete, replace, swap neighbours). Returns
/// `None` if every name needs too many edits.
pub fn nearest<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = typed.chars().count();
    if length > LONGEST {
        return None;
    }
    let allowed = (length / 3).max(1);
    let is_comparable =
        |name: &&str| name.len().abs_diff(typed.len()) <= 4 * allowed && name.len() <= 4 * LONGEST;
    let edits = |name: &'a str| (osa_distance(&typed.to_lowercase(), &name.to_lowercase()), name);
    let near = names.into_iter().filter(is_comparable).map(edits).filter(|(edits, _)| *edits <= allowed);
    near.min_by_key(|(edits, _)| *edits).map(|(_, name)| name)
}

/// Maximum length of a name that gets a suggestion. Longer names are rare and take long to compare.
const LONGEST: usize = 40;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_similar_names_are_suggested() {
        let names = ["sphere", "smooth_union", "union", "box"];
        assert_eq!(nearest("smoth_union", names), Some("smooth_union"));
        assert_eq!(nearest("shpere", names), Some("sphere"));
        assert_eq!(nearest("Box", names), Some("box"));
        assert_eq!(nearest("zebra", names), None);
        assert_eq!(nearest(&"a".repeat(1000), names), None);
    }

    #[test]
    fn a_swap_is_one_edit() {
        assert_eq!(osa_distance("abcd", "abdc"), 1);
        assert_eq!(nearest("abdc", ["abcd"]), Some("abcd"));
        assert_eq!(nearest("badc", ["abcd"]), None);
    }
}
