//! Natural order: "track 2" before "track 10".

use std::cmp::Ordering;
use std::iter::Peekable;
use std::str::Chars;

/// Compares digits as numbers, and letters without case. If two names are then equal, compares them by characters.
pub fn compare(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.chars().peekable(), b.chars().peekable());
    loop {
        let (Some(x), Some(y)) = (left.peek().copied(), right.peek().copied()) else {
            let lengths = left.peek().is_some().cmp(&right.peek().is_some());
            return lengths.then_with(|| a.cmp(b));
        };
        let order = if x.is_ascii_digit() && y.is_ascii_digit() {
            let (x, y) = (number(&mut left), number(&mut right));
            // Without leading zeros, the number with more digits is larger.
            x.len().cmp(&y.len()).then_with(|| x.cmp(&y))
        } else {
            left.next();
            right.next();
            x.to_lowercase().cmp(y.to_lowercase())
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

fn number(characters: &mut Peekable<Chars<'_>>) -> String {
    let mut digits = String::new();
    while let Some(digit) = characters.next_if(char::is_ascii_digit) {
        if digit != '0' || !digits.is_empty() {
            digits.push(digit);
        }
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_compared_by_value() {
        let wanted = ["1 a", "1 B", "2", "10", "010b", "A1", "a2", "a10", "a10x", "b", "é"];
        let mut names = wanted;
        names.reverse();
        names.sort_by(|a, b| compare(a, b));
        assert_eq!(names, wanted);
        let long = format!("{}1", "9".repeat(500));
        assert_eq!(compare(&long, &format!("{}2", "9".repeat(500))), Ordering::Less);
    }

    proptest! {
        #[test]
        fn it_is_a_total_order(names in prop::collection::vec("[aB0-2 é.]{0,6}", 3)) {
            let order = |x: usize, y: usize| compare(&names[x], &names[y]);
            for (x, y, z) in [(0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)] {
                prop_assert_eq!(order(x, y), order(y, x).reverse());
                prop_assert_eq!(order(x, y) == Ordering::Equal, names[x] == names[y]);
                if order(x, y) != Ordering::Greater && order(y, z) != Ordering::Greater {
                    prop_assert_ne!(order(x, z), Ordering::Greater);
                }
            }
        }
    }
}
