//! Suggestions for misspelt names.

/// Returns the name that differs from `typed` by the fewest edits (insert, delete, replace, swap neighbours). Returns
/// `None` if every name needs too many edits.
pub fn nearest<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = typed.chars().count();
    if length > LONGEST {
        return None;
    }
    let allowed = (length / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for name in names {
        if name.len().abs_diff(typed.len()) > 4 * allowed || name.len() > 4 * LONGEST {
            continue;
        }
        let distance = edits(&typed.to_lowercase(), &name.to_lowercase());
        if distance <= allowed && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, name));
        }
    }
    best.map(|(_, name)| name)
}

/// Maximum length of a name that gets a suggestion. Longer names are rare and take long to compare.
const LONGEST: usize = 40;

/// Returns the optimal string alignment distance.
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = [vec![0; b.len() + 1], (0..=b.len()).collect::<Vec<usize>>(), vec![0; b.len() + 1]];
    for i in 1..=a.len() {
        rows[2][0] = i;
        for j in 1..=b.len() {
            let replace = rows[1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replace.min(rows[1][j] + 1).min(rows[2][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[0][j - 2] + 1);
            }
            rows[2][j] = least;
        }
        rows.rotate_left(1);
    }
    rows[1][b.len()]
}

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
        assert_eq!(edits("abcd", "abdc"), 1);
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "abc"), 3);
    }
}
