//! Texts of files, for one line of a screen.

use crate::limits::LIMITS;

/// The text without the control characters that files may hold: a title with a NUL stops window systems. A title of a
/// megabyte, which takes seconds to lay out, ends after as many letters as the limits allow.
pub fn one_line(text: &str) -> String {
    let max = LIMITS.name_letters_max;
    // Twice as many, because some are spaces that are left out.
    let plain: String = text.chars().take(2 * max).map(|c| if c.is_control() { ' ' } else { c }).collect();
    let line = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(max) {
        Some((end, _)) => format!("{}…", &line[..end].trim_end()),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::LIMITS;
    use super::one_line;

    #[test]
    fn a_title_could_be_a_megabyte_long() {
        let max = LIMITS.name_letters_max;
        assert_eq!(one_line(&"ü".repeat(max)), "ü".repeat(max));
        let long = one_line(&"ü".repeat(1 << 20));
        assert_eq!(long, format!("{}…", "ü".repeat(max)));
    }

    #[test]
    fn a_nul_or_an_escape_in_a_tag_reaches_no_title() {
        assert_eq!(one_line("AAA\0BBBB"), "AAA BBBB");
        assert_eq!(one_line(" \u{1b}[31mred\r\nline "), "[31mred line");
        assert_eq!(one_line("\0\n"), "");
    }
}
