//! Puts the texts of `#include` in their places.

use crate::lang::Span;
use crate::limits::LIMITS;

/// A text with all that it includes.
#[derive(Debug, Default)]
pub struct Whole {
    /// The text.
    pub text: String,
    /// Paths of the included files, relative to the folder of the text.
    pub files: Vec<String>,
    /// Where the lines of the text come from.
    lines: Vec<Line>,
    /// Number of files that were asked for.
    reads: usize,
}

/// A line of a [`Whole`] and its place in the text that includes: the line that includes it, or for a line of the text
/// itself an empty range at its start.
#[derive(Debug)]
struct Line {
    start: u32,
    place: Span,
}

/// Puts the texts of `#include` in their places. `read` returns the text of a file by its path relative to the folder
/// of `text`. A line whose file cannot be read stays, and each file is included once.
pub fn whole(text: &str, read: &mut ReadText<'_>) -> Whole {
    let mut whole = Whole::default();
    whole.paste(text, "", None, read, 0);
    whole
}

type ReadText<'r> = dyn FnMut(&str) -> Option<String> + 'r;

impl Whole {
    fn paste(
        &mut self,
        text: &str,
        folder: &str,
        included: Option<Span>,
        read: &mut ReadText<'_>,
        depth: usize,
    ) {
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            let own = Span::new(at as u32, (at + line.trim_end().len()) as u32);
            let place = included.unwrap_or(own);
            at += line.len();
            let is_free = depth < LIMITS.include_depth_max && self.reads < LIMITS.scene_includes_max;
            let path = named(line).and_then(|name| joined(folder, name));
            let path = path.filter(|path| is_free || self.files.contains(path));
            if let Some(path) = path {
                let left = LIMITS.scene_bytes_max.saturating_sub(self.text.len());
                let mut is_there = self.files.contains(&path);
                if !is_there {
                    self.reads += 1;
                    if let Some(other) = read(&path).filter(|other| other.len() <= left) {
                        let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
                        self.files.push(path);
                        self.paste(&other, &folder, Some(place), read, depth + 1);
                        is_there = true;
                    }
                }
                if is_there {
                    self.text.push('\n');
                    continue;
                }
            }
            let place = included.unwrap_or(Span::new(own.start, own.start));
            self.lines.push(Line { start: self.text.len() as u32, place });
            self.text.push_str(line);
        }
    }

    /// Maps a range of the whole text to the including text.
    pub fn place(&self, range: Span) -> Span {
        let of = |offset: u32| {
            let after = self.lines.partition_point(|line| line.start <= offset);
            let line = after.checked_sub(1).and_then(|index| self.lines.get(index));
            line.map_or(Span::new(offset, offset), |Line { start, place }| {
                let on = if place.is_empty() { offset - start } else { 0 };
                Span::new(place.start + on, place.end + on)
            })
        };
        Span::new(of(range.start).start, of(range.end).end)
    }
}

/// The file that a line includes.
fn named(line: &str) -> Option<&str> {
    let line = line.trim_start().strip_prefix('#')?.trim_start();
    let rest = line.strip_prefix("include").or_else(|| {
        let pragma = line.strip_prefix("pragma")?.trim_start();
        pragma
            .strip_prefix("include")
            .or_else(|| pragma.strip_prefix("glslify:")?.trim_start().strip_prefix("import"))
    })?;
    let rest = rest.trim_start_matches([' ', '\t', '(']);
    let close = match rest.chars().next()? {
        '<' => '>',
        quote @ ('"' | '\'') => quote,
        _ => return None,
    };
    rest.get(1..)?.split_once(close).map(|(name, _)| name)
}

/// A path from a folder. `None` if it leaves the outermost folder. A name without an ending means a `.glsl` file.
fn joined(folder: &str, name: &str) -> Option<String> {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    let path = parts.join("/");
    let file = parts.last()?;
    Some(if file.contains('.') { path } else { path + ".glsl" })
}
