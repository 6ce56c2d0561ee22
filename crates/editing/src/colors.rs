//! Syntax colours: finds the kind of each word of a line. Only visible lines are examined.

use mariana_field::lang::{Word, words};

use crate::buffer::Buffer;

/// A cache of the lexer's state at the start of each line: true if the line begins inside a block comment.
#[derive(Debug, Clone, Default)]
pub struct Colors {
    /// One entry per line from the top. The list is shorter than the text if later lines have not been lexed.
    open: Vec<bool>,
}

impl Colors {
    /// Discards the cached states below `line`, which has changed.
    pub fn forget_behind(&mut self, line: usize) {
        self.open.truncate(line + 1);
    }

    /// Returns the words of `line`. First lexes all lines above `line` whose state is not cached.
    pub fn words(&mut self, buffer: &Buffer, line: usize) -> Vec<Word> {
        while self.open.len() <= line {
            let open = match self.open.len().checked_sub(1) {
                None => false,
                Some(before) => read(buffer, before, self.open.last() == Some(&true)).1,
            };
            self.open.push(open);
        }
        read(buffer, line, self.open.get(line) == Some(&true)).0
    }
}

fn read(buffer: &Buffer, line: usize, open: bool) -> (Vec<Word>, bool) {
    let bytes = buffer.line(line);
    match std::str::from_utf8(bytes) {
        Ok(text) => words(text, open),
        // Each invalid byte becomes a control character, so that the byte offsets of the words stay correct.
        Err(_) => {
            let mut text = String::with_capacity(bytes.len());
            for chunk in bytes.utf8_chunks() {
                text.push_str(chunk.valid());
                text.extend(std::iter::repeat_n('\u{1}', chunk.invalid().len()));
            }
            words(&text, open)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::WordKind;

    #[test]
    fn a_comment_opened_far_above_colours_the_lines_below() {
        let text = format!("let a = 1\n{}b */ c", "let x = 2\n".repeat(50));
        let mut buffer = Buffer::new(text.into_bytes());
        let mut colors = Colors::default();
        let first = |colors: &mut Colors, buffer: &Buffer, line| {
            colors.words(buffer, line).first().map(|word| word.kind)
        };
        assert_eq!(first(&mut colors, &buffer, 50), Some(WordKind::Keyword));
        buffer.replace(9..9, b" /*");
        colors.forget_behind(0);
        assert_eq!(first(&mut colors, &buffer, 50), Some(WordKind::Comment));
        assert_eq!(colors.words(&buffer, 51).last().map(|word| word.kind), Some(WordKind::Name));
        buffer.replace(9..12, b"");
        colors.forget_behind(0);
        assert_eq!(first(&mut colors, &buffer, 50), Some(WordKind::Keyword));
    }

    #[test]
    fn invalid_bytes_keep_the_offsets_of_the_words_around_them() {
        let buffer = Buffer::new(b"a \xff\xfe 5".to_vec());
        let words = Colors::default().words(&buffer, 0);
        assert_eq!(words.last().map(|word| (word.kind, word.start)), Some((WordKind::Number, 5)));
    }
}
