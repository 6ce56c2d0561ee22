//! Text search.

use std::ops::Range;

/// Finds the next match of `query` at or after `from`. If `forward` is false, finds the previous match. The search
/// wraps around, and ignores case unless `query` has capital letters.
pub fn find(text: &[u8], query: &str, from: usize, forward: bool) -> Option<Range<usize>> {
    let query = query.as_bytes();
    if query.is_empty() || query.len() > text.len() {
        return None;
    }
    let exact = query.iter().any(u8::is_ascii_uppercase);
    let stands = |at: &usize| {
        let part = text.get(*at..*at + query.len()).unwrap_or_default();
        if exact { part == query } else { part.eq_ignore_ascii_case(query) }
    };
    let last = text.len() - query.len() + 1;
    let from = from.min(last);
    let at = if forward {
        (from..last).find(stands).or_else(|| (0..from).find(stands))
    } else {
        (0..from).rev().find(stands).or_else(|| (from..last).rev().find(stands))
    };
    at.map(|at| at..at + query.len())
}

#[cfg(test)]
mod tests {
    use super::find;

    #[test]
    fn matches_are_found_in_both_directions_and_wrap_around() {
        let text = b"Box box\nboxes";
        let starts = |from, forward| find(text, "box", from, forward).map(|range| range.start);
        assert_eq!([0, 1, 5, 9].map(|from| starts(from, true)), [Some(0), Some(4), Some(8), Some(0)]);
        assert_eq!([0, 4, 8, 99].map(|from| starts(from, false)), [Some(8), Some(0), Some(4), Some(8)]);
        assert_eq!(find(text, "Box", 1, true), Some(0..3), "capitals match exactly");
        assert_eq!((find(text, "", 0, true), find(text, "nowhere", 0, true)), (None, None));
    }
}
