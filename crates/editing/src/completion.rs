//! Completion of names, and documentation of the name or call at the cursor. Both come from the language's own tables
//! and from the declarations in the text.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::LazyLock;

use mariana_field::lang::{
    Accuracy, DefaultValue, Entry, WordKind, entries, inputs, is_part, keywords, part_inputs, parts,
    section_fields,
};

use crate::buffer::Buffer;
use crate::colors::Colors;
use crate::limits;

/// Documentation of a name.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct About {
    /// The name. For a function, the name with its parameters.
    pub head: String,
    /// One-sentence description. It may be empty.
    pub text: String,
    /// Accuracy and source, as in "exact · Quilez". It may be empty.
    pub facts: String,
    /// True for a function.
    pub is_function: bool,
}

/// A completion candidate.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Proposal {
    /// The name.
    pub name: String,
    /// The documentation of the name.
    pub about: About,
}

/// Keywords that declare a name at the start of a line.
const DECLARING: [&str; 7] = ["fn", "let", "param", "material", "object", "light", "camera"];
/// Maximum length of a declaration's head, in bytes.
const HEAD_MAX: usize = 110;

fn plain(name: &str, head: String, text: &str) -> Proposal {
    Proposal {
        name: name.to_owned(),
        about: About { head, text: text.to_owned(), facts: String::new(), is_function: false },
    }
}

static LANGUAGE: LazyLock<Vec<Proposal>> = LazyLock::new(|| {
    let functions =
        entries().iter().map(|entry| Proposal { name: entry.name.to_owned(), about: of_entry(entry) });
    let inputs = inputs().chain(parts()).map(|(name, doc)| plain(name, name.to_owned(), doc));
    let fields = section_fields().flat_map(|(section, fields)| {
        fields.iter().map(move |field| {
            let default = match (field.doc, field.default) {
                (_, DefaultValue::Each(0.0)) | ("", _) => String::new(),
                (_, default) => format!("; {default} by default"),
            };
            let text = format!("{}{default}", field.doc);
            plain(field.name, head_of_field(section, field.name), &text)
        })
    });
    let words = keywords().map(|word| plain(word, word.to_owned(), ""));
    let mut all: Vec<Proposal> = functions.chain(inputs).chain(fields).chain(words).collect();
    all.sort_by(|a, b| (&a.name, a.about.text.is_empty()).cmp(&(&b.name, b.about.text.is_empty())));
    all
});

/// The inputs of a part of the song, for the names behind `drums.`.
static OF_PARTS: LazyLock<Vec<Proposal>> =
    LazyLock::new(|| part_inputs().map(|(name, doc)| plain(name, format!("part.{name}"), doc)).collect());

fn of_entry(entry: &Entry) -> About {
    let accuracy = match entry.accuracy {
        Some(Accuracy::Exact) => "exact",
        Some(Accuracy::Bound) => "a bound",
        None => "",
    };
    let facts = [accuracy, &entry.source].into_iter().filter(|fact| !fact.is_empty()).collect::<Vec<_>>();
    About {
        head: entry.signature.clone(),
        text: entry.doc.clone(),
        facts: facts.join(" · "),
        is_function: true,
    }
}

/// Returns candidates for the name that ends at `offset`, best first, and the byte range that a candidate replaces.
/// Requires two typed letters, unless the user `asked` with Ctrl+Space or the name follows a part of the song. `own`
/// returns the names of the scene for a name that begins at an offset.
pub fn proposals(
    buffer: &Buffer,
    colors: &mut Colors,
    offset: usize,
    asked: bool,
    own: impl FnOnce(usize) -> Vec<Proposal>,
) -> (Range<usize>, Vec<Proposal>) {
    let line = buffer.line_of(offset);
    let start = buffer.line_start(line);
    let before = buffer.slice(start..offset);
    let is_letter = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    let from = before.iter().rposition(|byte| !is_letter(byte)).map_or(0, |at| at + 1);
    let typed = before.get(from..).unwrap_or_default();
    let range = start + from..offset;
    let words = colors.words(buffer, line);
    let inside = words.iter().find(|word| word.start <= from && from < word.end);
    let is_no_name =
        inside.is_some_and(|word| matches!(word.kind, WordKind::Comment | WordKind::Text | WordKind::Number));
    let behind_point = from.checked_sub(1).and_then(|at| before.get(at)) == Some(&b'.');
    let part = before.get(..from.saturating_sub(1)).filter(|_| behind_point).map(|before| {
        let first = before.iter().rposition(|byte| !is_letter(byte)).map_or(0, |at| at + 1);
        String::from_utf8_lossy(before.get(first..).unwrap_or_default()).into_owned()
    });
    let is_of_part = part.is_some_and(|name| is_part(&name) && line_of_declaration(buffer, &name).is_none());
    if is_no_name || (behind_point && !is_of_part) || (!asked && !is_of_part && typed.len() < 2) {
        return (range, Vec::new());
    }
    let typed = String::from_utf8_lossy(typed).to_lowercase();
    let rank = |name: &str| {
        let lower = name.to_lowercase();
        if lower.starts_with(&typed) {
            Some(0)
        } else if typed.len() >= 2 && lower.contains(&typed) {
            Some(1)
        } else {
            None
        }
    };
    let own = if is_of_part { Vec::new() } else { own(range.start) };
    let language = if is_of_part { &OF_PARTS } else { &LANGUAGE };
    let mut found: Vec<(usize, usize, &Proposal)> = own
        .iter()
        .map(|one| (0, one))
        .chain(language.iter().map(|one| (1, one)))
        .filter_map(|(whose, one)| Some((rank(&one.name)?, whose, one)))
        .collect();
    found.sort_by_key(|(rank, whose, one)| (*rank, one.name.len(), *whose));
    let mut seen = BTreeSet::new();
    let mut best: Vec<Proposal> = found
        .into_iter()
        .map(|(_, _, one)| one.clone())
        .filter(|one| seen.insert(one.name.clone()))
        .take(limits::PROPOSALS_MAX)
        .collect();
    // A completely typed name needs no proposal.
    if !asked && best.first().is_some_and(|one| one.name.to_lowercase() == typed) && best.len() == 1 {
        best.clear();
    }
    (range, best)
}

/// Returns the names declared in the text, without the declaration at `besides`, which the user is typing.
pub fn own_names(buffer: &Buffer, besides: usize) -> Vec<Proposal> {
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for line in 0..buffer.line_count() {
        let Some((name, at)) = declared(buffer.line(line)) else { continue };
        if buffer.line_start(line) + at != besides && seen.insert(name) {
            found.push(Proposal { name: name.to_owned(), about: declaration(buffer, line) });
        }
    }
    found
}

fn declared(line: &[u8]) -> Option<(&str, usize)> {
    let indent = line.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let text = line.get(indent..)?;
    let word = DECLARING.iter().find(|word| {
        text.starts_with(word.as_bytes()) && text.get(word.len()).is_some_and(u8::is_ascii_whitespace)
    })?;
    let rest = text.get(word.len()..)?;
    let blanks = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let name = rest.get(blanks..)?;
    let length =
        name.iter().position(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_').unwrap_or(name.len());
    let name = std::str::from_utf8(name.get(..length)?).ok().filter(|name| !name.is_empty())?;
    Some((name, indent + word.len() + blanks))
}

/// Returns the documentation of the name that `line` declares: the line itself, and the comment above it.
pub fn declaration(buffer: &Buffer, line: usize) -> About {
    let text = String::from_utf8_lossy(buffer.line(line)).trim().to_owned();
    let is_function = text.starts_with("fn ");
    let end = if is_function { text.find(')').map_or(text.len(), |end| end + 1) } else { text.len() };
    let mut head = text.get(..end).unwrap_or_default().trim_end_matches('{').trim_end().to_owned();
    if head.len() > HEAD_MAX {
        let cut = (0..=HEAD_MAX).rev().find(|at| head.is_char_boundary(*at)).unwrap_or(0);
        head.truncate(cut);
        head.push('…');
    }
    let mut comment = Vec::new();
    for above in (0..line).rev().take(4) {
        let text = String::from_utf8_lossy(buffer.line(above)).trim().to_owned();
        let Some(words) = text.strip_prefix('#') else { break };
        comment.insert(0, words.trim_start_matches('#').trim().to_owned());
    }
    About { head, text: comment.join(" "), facts: "declared in this scene".to_owned(), is_function }
}

/// Returns the line that declares `name`.
fn line_of_declaration(buffer: &Buffer, name: &str) -> Option<usize> {
    let declares = |line: &usize| declared(buffer.line(*line)).is_some_and(|(own, _)| own == name);
    (0..buffer.line_count()).find(declares)
}

/// Returns the documentation of `name`: its declaration in the text or, without a declaration, the language's entry.
pub fn documentation(buffer: &Buffer, name: &str) -> Option<About> {
    match line_of_declaration(buffer, name) {
        Some(line) => Some(declaration(buffer, line)),
        None => about_language(name),
    }
}

/// Returns the documentation of a name of the language.
pub fn about_language(name: &str) -> Option<About> {
    let place = LANGUAGE.partition_point(|one| one.name.as_str() < name);
    LANGUAGE.get(place).filter(|one| one.name == name).map(|one| one.about.clone())
}

/// Returns the documentation of a field of the section that begins with this keyword.
pub fn about_field(section: &str, name: &str) -> Option<About> {
    let head = head_of_field(section, name);
    LANGUAGE.iter().find(|one| one.name == name && one.about.head == head).map(|one| one.about.clone())
}

/// Returns the documentation of an input of a part of the song, such as `volume` in `drums.volume`.
pub fn about_part_input(name: &str) -> Option<About> {
    OF_PARTS.iter().find(|one| one.name == name).map(|one| one.about.clone())
}

fn head_of_field(section: &str, name: &str) -> String {
    format!("{section} {{ {name} = }}")
}

/// Returns the documentation and byte range of the name at `offset`. If that name has no documentation, returns those
/// of the function whose arguments contain `offset`.
pub fn about(buffer: &Buffer, colors: &mut Colors, offset: usize) -> Option<(Range<usize>, About)> {
    let line = buffer.line_of(offset);
    let start = buffer.line_start(line);
    let of = |range: Range<usize>| {
        let name = std::str::from_utf8(buffer.slice(range.clone())).ok()?;
        let about =
            documentation(buffer, name).filter(|about| !(about.text.is_empty() && about.facts.is_empty()))?;
        Some((range, about))
    };
    let names = colors.words(buffer, line).into_iter().filter(|word| is_name(word.kind));
    let mut names = names.map(|word| start + word.start..start + word.end);
    let here = names.find(|range| range.start <= offset && offset <= range.end);
    if let Some(found) = here.and_then(of) {
        return Some(found);
    }
    let (name, _) = call_around(buffer, colors, offset, 0)?;
    of(name).filter(|(_, about)| about.is_function)
}

/// Returns the byte range of the name of the function whose arguments contain `offset`, and the number of the argument.
/// The name is searched in this line and up to `lines_above` lines above it.
pub fn call_around(
    buffer: &Buffer,
    colors: &mut Colors,
    offset: usize,
    lines_above: usize,
) -> Option<(Range<usize>, usize)> {
    let (mut closed, mut argument, mut opening) = (0_usize, 0, false);
    let last = buffer.line_of(offset);
    for line in (last.saturating_sub(lines_above)..=last).rev() {
        let start = buffer.line_start(line);
        for word in colors.words(buffer, line).iter().rev() {
            let range = start + word.start..start + word.end;
            if range.end > offset {
                continue;
            }
            if opening {
                return is_name(word.kind).then_some((range, argument));
            }
            match buffer.slice(range) {
                b")" | b"}" => closed += 1,
                b"(" | b"{" if closed > 0 => closed -= 1,
                b"(" => opening = true,
                b"{" => return None,
                b"," if closed == 0 => argument += 1,
                _ => {}
            }
        }
    }
    None
}

fn is_name(kind: WordKind) -> bool {
    matches!(kind, WordKind::Name | WordKind::Function | WordKind::Input | WordKind::Keyword)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str, asked: bool) -> Vec<String> {
        let buffer = Buffer::new(text.as_bytes().to_vec());
        let own = |from| own_names(&buffer, from);
        let (range, found) = proposals(&buffer, &mut Colors::default(), text.len(), asked, own);
        assert!(range.end == text.len() && range.start <= range.end);
        found.into_iter().map(|one| one.name).collect()
    }

    #[test]
    fn names_that_begin_with_the_typed_letters_come_first() {
        let found = names("object o { shape = smooth_u", false);
        assert_eq!(found.first().map(String::as_str), Some("smooth_union"));
        let found = names("object o { shape = box", false);
        assert_eq!(found.first().map(String::as_str), Some("box"));
        assert!(found.contains(&"round_box".to_owned()), "{found:?}");
        assert_eq!(names("material m { rough", false), ["roughness"]);
        assert_eq!(names("x", false), [""; 0], "one letter opens the list only on request");
        assert!(names("x", true).contains(&"x".to_owned()));
        assert_eq!(names("", true).len(), limits::PROPOSALS_MAX);
    }

    #[test]
    fn comments_strings_numbers_and_components_get_no_proposals() {
        for text in ["# sph", "include \"sph", "1e", "p.xy", "/* sph"] {
            assert_eq!(names(text, false), [""; 0], "{text}");
        }
    }

    #[test]
    fn the_inputs_of_a_part_are_proposed_behind_its_point() {
        let found = names("object o { shape = box(p, drums.", false);
        assert!(found.len() == limits::PROPOSALS_MAX || found.contains(&"volume".to_owned()), "{found:?}");
        assert_eq!(names("bass.mel", false), ["melody", "melody_certainty"]);
        assert_eq!(names("vocals.ban", false), ["band"]);
        assert_eq!(names("vocals.sphere", false), [""; 0]);
        assert_eq!(names("let drums = vec2(1)\ndrums.mel", false), [""; 0]);
        assert!(names("voca", false).contains(&"vocals".to_owned()));
    }

    #[test]
    fn own_names_come_first_with_their_line_and_comment() {
        let text = "# How large it is.\nparam spread = 1 in 0 .. 2\nfn spray(p, amount: number) {\n}\nspr";
        assert_eq!(names(text, false), ["spray", "spread", "spring"]);
        let buffer = Buffer::new(text.as_bytes().to_vec());
        let about = documentation(&buffer, "spread").unwrap();
        assert_eq!(
            (about.head.as_str(), about.text.as_str()),
            ("param spread = 1 in 0 .. 2", "How large it is.")
        );
        assert_eq!(documentation(&buffer, "spray").unwrap().head, "fn spray(p, amount: number)");
        assert_eq!(documentation(&buffer, "nowhere"), None);
        assert_eq!(names("fn own", false), [""; 0], "a name that is being declared is not proposed");
    }

    #[test]
    fn documentation_of_a_name_or_of_the_call_around_it_is_found() {
        let text = "object o { shape = sphere(p - vec3(0, 1, 0), 0.5) }";
        let buffer = Buffer::new(text.as_bytes().to_vec());
        let at = |part: &str| {
            let found = about(&buffer, &mut Colors::default(), text.find(part).unwrap() + 1);
            found.map(|(_, about)| about.head)
        };
        assert_eq!(at("phere").as_deref(), Some("sphere(p, radius: number)"));
        assert_eq!(at("0.5").as_deref(), Some("sphere(p, radius: number)"));
        assert!(at(" 1, 0").is_some_and(|head| head.starts_with("vec3(")));
        let exact = documentation(&buffer, "sphere").unwrap();
        assert!(exact.facts.starts_with("exact · "), "{}", exact.facts);
        assert!(documentation(&buffer, "roughness").is_some_and(|about| !about.text.is_empty()));
    }

    #[test]
    fn every_function_and_field_has_documentation() {
        for one in LANGUAGE.iter().filter(|one| one.about.is_function || one.about.head.contains('{')) {
            assert!(!one.about.text.is_empty(), "{} has no documentation", one.name);
        }
    }
}
