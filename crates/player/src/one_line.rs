//! Display of texts from files on one line.

use crate::limits;

/// Replaces control characters and runs of spaces by single spaces, because a NUL in a title breaks window systems.
/// Cuts the text at [`limits::NAME_LETTERS_MAX`] letters, because the layout of a title of a megabyte takes seconds.
pub fn one_line(text: &str) -> String {
    let max = limits::NAME_LETTERS_MAX;
    // Twice the maximum, because some of these characters may be spaces that are dropped.
    let plain: String = text.chars().take(2 * max).map(|c| if c.is_control() { ' ' } else { c }).collect();
    let line = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(max) {
        Some((end, _)) => format!("{}…", &line[..end].trim_end()),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::{limits, one_line};

    #[test]
    fn a_title_of_a_megabyte_is_cut() {
        let max = limits::NAME_LETTERS_MAX;
        assert_eq!(one_line(&"ü".repeat(max)), "ü".repeat(max));
        let long = one_line(&"ü".repeat(1 << 20));
        assert_eq!(long, format!("{}…", "ü".repeat(max)));
    }

    #[test]
    fn control_characters_are_removed() {
        assert_eq!(one_line("AAA\0BBBB"), "AAA BBBB");
        assert_eq!(one_line(" \u{1b}[31mred\r\nline "), "[31mred line");
        assert_eq!(one_line("\0\n"), "");
    }
}
