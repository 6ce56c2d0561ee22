//! Parser of show files.
//!
//! ```text
//! # a comment
//! at start            speakers
//! at section B        tunnel  camera inside  melt over 2 bars
//!   set swell = 0.2 -> 0.5 over 8 bars after 1 bar
//!     -> 0.1 over 2 bars
//! at drop 1 - 1 beat  city    cut
//! at 2:31.5           "my own/orb.scene"  portal plane over 3 s
//! at cue              letters  fade over 1 bar
//! at 3:00             orb  melt by fader
//!   set deck fader = 0 -> 0.7 over 2 bars -> 0.3 over 1 bar
//! ```
//!
//! Each line is parsed separately, so that a mistake does not hide later mistakes. A line that begins with `->` adds
//! steps to the `set` above it.

mod words;

use super::cue_list::{
    Anchor, CueList, Entry, FADER, Length, PICTURE_NUMBERS, Setting, Step, Transition, TransitionKind, When,
    is_of_no_scene, plain_settings,
};
use crate::limits;
use mariana_field::lang::{Diagnostic, Sources, Span, TransitionStyle, nearest, render_all};
use mariana_field::world::{BlendKind, PortalShape};
use words::{Kind, Word, lines};

/// The result of parsing.
#[derive(Debug, Clone, Default)]
pub struct Parsed {
    /// The cue list; `None` if there are mistakes.
    pub cue_list: Option<CueList>,
    /// The entries without mistakes.
    pub entries: Vec<Entry>,
    /// The mistakes.
    pub diagnostics: Vec<Diagnostic>,
    /// The text, for rendering positions.
    pub sources: Sources,
}

impl Parsed {
    /// Renders the mistakes as text, with terminal colours if `color` is set.
    pub fn render(&self, color: bool) -> String {
        render_all(&self.diagnostics, &self.sources, color)
    }
}

/// Maximum absolute value of a parameter. It is small enough for the difference of two values to be finite.
const VALUE_MAX: f32 = 1e30;

pub(super) const DIAGNOSTICS_MAX: usize = 20;

/// Parses the `text` of a show file, which messages call `name`.
pub fn parse(name: &str, text: &str) -> Parsed {
    let mut sources = Sources::default();
    let too_long = text.len() > limits::BYTES_MAX || sources.add(name, text).is_none();
    if too_long {
        let max = limits::BYTES_MAX;
        let refusal = Diagnostic::over_limit(Span::default(), format!("{name} is longer than {max} bytes"));
        return Parsed { diagnostics: vec![refusal], sources, ..Parsed::default() };
    }
    let mut diagnostics = Vec::new();
    let mut cue_list = CueList::default();
    let mut was_wrong = false;
    for line in lines(text) {
        if diagnostics.len() >= DIAGNOSTICS_MAX {
            break;
        }
        let first = line.first().map_or("", |word| word.text);
        if first == "->" && was_wrong {
            // These steps continue a `set` line that has a mistake.
            continue;
        }
        let is_entry = !["set", "->"].contains(&first);
        let read = Reader { words: &line, at: 0 }.line(&mut cue_list);
        was_wrong = read.is_err();
        if is_entry && was_wrong {
            // The settings of an entry with a mistake must not be added to the previous entry.
            let when = When { anchor: Anchor::Start, offset: Length::ZERO };
            cue_list.entries.push(Entry::new(when, "", None, None));
        }
        diagnostics.extend(read.err().map(|mistake| *mistake));
        if cue_list.entries.len() > limits::ENTRIES_MAX {
            let max = limits::ENTRIES_MAX;
            let span = cue_list.entries.last().map_or(Span::default(), |entry| entry.span);
            let many = Diagnostic::over_limit(span, format!("the show has more than {max} entries"));
            diagnostics.push(many.hint("split it into several shows"));
            break;
        }
    }
    if cue_list.entries.is_empty() && diagnostics.is_empty() {
        let end = Span::new(text.len() as u32, text.len() as u32);
        let empty = Diagnostic::new(end, "the show has no entries");
        diagnostics.push(empty.hint("add an entry, such as `at start speakers`"));
    }
    if let Some(first) = cue_list.entries.first()
        && first.when.anchor == Anchor::Previous
        && diagnostics.is_empty()
    {
        let above = Diagnostic::new(first.span, "`previous` needs an entry above it");
        diagnostics.push(above.hint("begin with another moment, such as `at start`"));
    }
    let entries = cue_list.entries.iter().filter(|entry| !entry.scene.is_empty()).cloned().collect();
    let cue_list = diagnostics.is_empty().then_some(cue_list);
    Parsed { cue_list, entries, diagnostics, sources }
}

type Read<T> = Result<T, Box<Diagnostic>>;

struct Reader<'a> {
    words: &'a [Word<'a>],
    at: usize,
}

impl<'a> Reader<'a> {
    fn line(&mut self, cue_list: &mut CueList) -> Read<()> {
        let Some(first) = self.next() else { return Ok(()) };
        match first.text {
            "at" if first.kind == Kind::Name => {
                let entry = self.entry(first)?;
                cue_list.entries.push(entry);
            }
            "set" if first.kind == Kind::Name => {
                let setting = self.setting()?;
                let Some(entry) = cue_list.entries.last_mut() else {
                    let hint = "write `at start` and a scene above it";
                    return Err(wrong(first.span, "`set` needs an entry above it", hint));
                };
                if entry.settings.len() >= limits::SETTINGS_MAX {
                    let max = limits::SETTINGS_MAX;
                    let many = format!("the entry has more than {max} `set` lines");
                    return Err(Box::new(Diagnostic::over_limit(first.span, many)));
                }
                entry.settings.push(setting);
            }
            "->" if first.kind == Kind::Sign => {
                self.at -= 1;
                let moving = cue_list.entries.last_mut().and_then(|entry| entry.settings.last_mut());
                let Some(Setting { param, steps, .. }) = moving else {
                    let hint = "write `set`, a parameter and its value above it";
                    return Err(wrong(first.span, "there is no `set` line above to continue", hint));
                };
                self.steps(steps, is_fraction(param), first.span)?;
            }
            _ => {
                let unknown = format!("a line cannot begin with {}", first.shown());
                let hint = "begin the line with `at`, as in `at bar 17 tunnel`, or with `set`";
                return Err(near(wrong(first.span, unknown, hint), nearest(first.text, ["at", "set"])));
            }
        }
        match self.next() {
            None => Ok(()),
            Some(word) => Err(wrong(
                word.span,
                format!("{} is not expected here", word.shown()),
                "an entry is `at WHEN SCENE`, then `camera NAME`, then `cut`, `fade`, `melt` or `portal` \
                 with `over` and a length, or with `by fader`",
            )),
        }
    }

    fn entry(&mut self, at: Word<'_>) -> Read<Entry> {
        let when = self.when()?;
        let scene = self.named("a scene's name")?;
        let camera = if self.eat("camera") { Some(self.named("a camera's name")?) } else { None };
        let transition = self.transition()?;
        Ok(Entry {
            span: at.span.to(scene.span),
            scene_span: scene.span,
            camera_span: camera.map_or(Span::default(), |camera| camera.span),
            ..Entry::new(when, scene.text, camera.map(|camera| camera.text.to_owned()), transition)
        })
    }

    fn when(&mut self) -> Read<When> {
        const ANCHORS: [&str; 8] = ["start", "end", "bar", "section", "drop", "build", "cue", "previous"];
        let word = self.expect("a moment", "such as `start`, `1:30`, `bar 17`, `section B` or `drop 1`")?;
        let anchor = match (word.kind, word.text) {
            (Kind::Number, _) => Anchor::Time(self.clock(word)?),
            (Kind::Name, "start") => Anchor::Start,
            (Kind::Name, "end") => Anchor::End,
            (Kind::Name, "cue") => Anchor::Cue,
            (Kind::Name, "previous") => Anchor::Previous,
            (Kind::Name, "bar") => Anchor::Bar(self.count("a bar's number")?),
            (Kind::Name, "drop") => Anchor::Drop(self.count_or_first()?),
            (Kind::Name, "build") => Anchor::Build(self.count_or_first()?),
            (Kind::Name, "section") => {
                let letter =
                    self.expect("a section's letter", "as `mariana analyze --structure` prints it")?;
                let is_letter =
                    letter.kind == Kind::Name && letter.text.bytes().all(|b| b.is_ascii_alphabetic());
                if !is_letter {
                    let what = format!("a section's name is a letter, not {}", letter.shown());
                    return Err(wrong(letter.span, what, "write `section B` or `section B 2`"));
                }
                Anchor::Section(letter.text.to_ascii_uppercase(), self.count_or_first()?)
            }
            _ => {
                let unknown = format!("{} is not a moment of a song", word.shown());
                let hint = "a moment is `start`, `end`, `1:30`, `12 s`, `bar 17`, `section B 2`, `drop 1`, \
                            `build 1`, `cue` or `previous + 4 bars`";
                return Err(near(wrong(word.span, unknown, hint), nearest(word.text, ANCHORS)));
            }
        };
        let sign = if self.eat("+") {
            1.0
        } else if self.eat("-") {
            -1.0
        } else {
            return Ok(When { anchor, offset: Length::ZERO });
        };
        let offset = match self.length()? {
            Length::Seconds(number) => Length::Seconds(sign * number),
            Length::Beats(number) => Length::Beats(sign * number),
            Length::Bars(number) => Length::Bars(sign * number),
        };
        Ok(When { anchor, offset })
    }

    /// Reads `12`, `12 s` or `1:23.5`. `first` is the first number.
    fn clock(&mut self, first: Word<'_>) -> Read<f64> {
        let mut seconds = self.value(first)?;
        let mut span = first.span;
        if self.eat(":") {
            let rest = self.expect("seconds", "as in `1:23.5`")?;
            let number = self.value(rest)?;
            span = span.to(rest.span);
            if number >= 60.0 || rest.kind != Kind::Number {
                let hint = "write `1:23.5` for a minute and 23.5 seconds";
                return Err(wrong(rest.span, "the seconds after the colon must be below 60", hint));
            }
            // Round to the `f64` nearest to the written time.
            let all = 60.0 * seconds + number;
            let whole = (all * 1e3).round() / 1e3;
            seconds = if (all - whole).abs() < 1e-9 { whole } else { all };
        } else {
            self.eat("s");
        }
        if seconds > limits::SECONDS_MAX {
            let late = format!("a time must not exceed {:.0} s", limits::SECONDS_MAX);
            return Err(Box::new(Diagnostic::over_limit(span, late)));
        }
        Ok(seconds)
    }

    fn transition(&mut self) -> Read<Option<Transition>> {
        let Some(word) = self.peek() else { return Ok(None) };
        let Some(style) = TransitionStyle::named(word.text).filter(|_| word.kind == Kind::Name) else {
            let styles = TransitionStyle::ALL.map(TransitionStyle::name);
            let hint = format!("the transitions are {}", quoted(styles.into_iter()));
            let unknown = wrong(word.span, format!("{} is not a transition", word.shown()), hint);
            return Err(near(unknown, nearest(word.text, styles.into_iter().chain(["camera"]))));
        };
        self.at += 1;
        if style == TransitionStyle::Cut {
            return Ok(Some(Transition::CUT));
        }
        let kind = match style {
            TransitionStyle::Portal => TransitionKind::Blend(BlendKind::Portal(self.portal_shape()?)),
            style => style.into(),
        };
        if self.eat("by") {
            let what = self.named("`fader`")?;
            if what.text != "fader" {
                let unable = format!("{} cannot move a transition", what.shown());
                return Err(wrong(what.span, unable, "write `by fader`, or `over` and a length"));
            }
            return Ok(Some(Transition { kind, by_fader: true, ..Transition::CUT }));
        }
        let length = if self.eat("over") { self.length()? } else { Length::Bars(1.0) };
        let unfinished = self.eat("unfinished");
        Ok(Some(Transition { kind, length, unfinished, by_fader: false }))
    }

    fn portal_shape(&mut self) -> Read<PortalShape> {
        let Some(word) = self.peek() else { return Ok(PortalShape::default()) };
        match BlendKind::named(word.text) {
            Some(BlendKind::Portal(shape)) => {
                self.at += 1;
                Ok(shape)
            }
            _ if word.kind == Kind::Name && !["over", "by"].contains(&word.text) => Err(no_shape(word)),
            _ => Ok(PortalShape::default()),
        }
    }

    fn setting(&mut self) -> Read<Setting> {
        let named = self.named("a parameter's name")?;
        let both = self.peek().map(|next| format!("{} {}", named.text, next.text));
        let param = match both.filter(|both| is_of_no_scene(both)) {
            Some(both) => {
                self.at += 1;
                both
            }
            None => named.text.to_owned(),
        };
        let span = named.span;
        if !self.eat("=") {
            let next = self.peek().filter(|next| next.kind == Kind::Name);
            return Err(match next.and_then(|next| no_second_word(named, next)) {
                Some(unknown) => unknown,
                None => self.missing("`=` and a value", "as in `set swell = 0.2 -> 0.5 over 8 bars`"),
            });
        }
        let from = self.number(is_fraction(&param))?;
        let mut steps = Vec::new();
        self.steps(&mut steps, is_fraction(&param), span)?;
        let after = if self.eat("after") { self.length()? } else { Length::ZERO };
        Ok(Setting { param, from, steps, after, span })
    }

    /// Reads the steps of an animation. A message about too many steps points to `place`.
    fn steps(&mut self, steps: &mut Vec<Step>, is_fraction: bool, place: Span) -> Read<()> {
        while self.eat("->") {
            let to = self.number(is_fraction)?;
            if !self.eat("over") {
                return Err(self.missing("`over` and a duration", "as in `0.2 -> 0.5 over 8 bars`"));
            }
            steps.push(Step { to, over: self.length()? });
            if steps.len() > limits::STEPS_MAX {
                let many = format!("the parameter has more than {} steps", limits::STEPS_MAX);
                let many = Diagnostic::over_limit(place, many);
                return Err(Box::new(many.hint("continue in another entry with the same scene and `cut`")));
            }
        }
        Ok(())
    }

    /// Reads the value of a parameter. If `is_fraction` is true, the value must be in 0..1.
    fn number(&mut self, is_fraction: bool) -> Read<f32> {
        let sign = if self.eat("-") { -1.0 } else { 1.0 };
        let word = self.expect("a number", "the value of the parameter")?;
        let number = (sign * self.value(word)?) as f32;
        if number.abs() > VALUE_MAX {
            let large = format!("the number {} is too large", word.shown());
            return Err(Box::new(Diagnostic::over_limit(word.span, large)));
        }
        if is_fraction && !(0.0..=1.0).contains(&number) {
            let beyond = format!("{number} is not between 0 and 1");
            return Err(wrong(word.span, beyond, "write a number from 0 to 1"));
        }
        Ok(number)
    }

    fn length(&mut self) -> Read<Length> {
        let word = self.expect("a length", "as in `2 bars`, `4 beats` or `1.5 s`")?;
        let number = self.value(word)?;
        let unit = self.expect("`bars`, `beats` or `s`", "as in `2 bars`")?;
        let known = Length::UNITS.iter().find(|known| known.names.contains(&unit.text));
        let Some(known) = known else {
            let unknown = format!("{} is not a unit of time", unit.shown());
            return Err(wrong(unit.span, unknown, "the units are `bars`, `beats` and `s`"));
        };
        if number > limits::SECONDS_MAX {
            let long = format!("a length must not exceed {:.0}", limits::SECONDS_MAX);
            return Err(Box::new(Diagnostic::over_limit(word.span, long)));
        }
        Ok((known.of)(number))
    }

    fn count(&mut self, what: &str) -> Read<u32> {
        let word = self.expect(what, "counted from 1")?;
        let number = self.value(word)?;
        if number.fract() != 0.0 || !(1.0..=1e6).contains(&number) {
            let what = format!("{} is not a whole number from 1 to 1000000", word.shown());
            return Err(wrong(word.span, what, "count from 1"));
        }
        Ok(number as u32)
    }

    fn count_or_first(&mut self) -> Read<u32> {
        match self.peek() {
            Some(word) if word.kind == Kind::Number => self.count("a number"),
            _ => Ok(1),
        }
    }

    /// Parses `word` as a finite number that is not negative.
    fn value(&self, word: Word<'_>) -> Read<f64> {
        let number = (word.kind == Kind::Number).then(|| word.text.parse::<f64>().ok()).flatten();
        number.filter(|number| number.is_finite()).ok_or_else(|| {
            Box::new(Diagnostic::new(word.span, format!("a number is expected here, not {}", word.shown())))
        })
    }

    fn named(&mut self, what: &str) -> Read<Word<'a>> {
        let hint = "put names with spaces or slashes in quotes";
        let word = self.expect(what, hint)?;
        if !matches!(word.kind, Kind::Name | Kind::Quoted) || word.text.is_empty() {
            let what = format!("{what} is expected here, not {}", word.shown());
            return Err(wrong(word.span, what, hint));
        }
        Ok(word)
    }

    fn peek(&self) -> Option<Word<'a>> {
        self.words.get(self.at).copied()
    }

    fn next(&mut self) -> Option<Word<'a>> {
        let word = self.peek();
        self.at += usize::from(word.is_some());
        word
    }

    /// Consumes this word or sign if it is next.
    fn eat(&mut self, text: &str) -> bool {
        let is_next = self.peek().is_some_and(|word| word.text == text && word.kind != Kind::Quoted);
        self.at += usize::from(is_next);
        is_next
    }

    fn expect(&mut self, what: &str, hint: &str) -> Read<Word<'a>> {
        self.next().ok_or_else(|| self.missing(what, hint))
    }

    fn missing(&self, what: &str, hint: &str) -> Box<Diagnostic> {
        let (span, found) = match self.peek() {
            Some(word) => (word.span, word.shown()),
            None => {
                let end = self.words.last().map_or(0, |word| word.span.end);
                (Span::new(end, end), "the end of the line".to_owned())
            }
        };
        wrong(span, format!("expected {what}, found {found}"), hint)
    }
}

fn wrong(span: Span, what: impl Into<String>, hint: impl Into<String>) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(span, what).hint(hint))
}

/// Replaces the hint by a similar word, if there is one.
fn near(mut unknown: Box<Diagnostic>, similar: Option<&str>) -> Box<Diagnostic> {
    *unknown = unknown.did_you_mean(similar);
    unknown
}

/// True if the values of `param` are in 0..1.
fn is_fraction(param: &str) -> bool {
    PICTURE_NUMBERS.contains(&param) || param == FADER
}

fn no_shape(word: Word<'_>) -> Box<Diagnostic> {
    let is_portal = |kind: &BlendKind| matches!(kind, BlendKind::Portal(_));
    let shapes = || BlendKind::ALL.into_iter().filter(|(kind, ..)| is_portal(kind)).map(|(_, name, _)| name);
    let hint = format!("the shapes are {}", quoted(shapes()));
    let unknown = wrong(word.span, format!("{} is not a portal shape", word.shown()), hint);
    near(unknown, nearest(word.text, shapes().chain(["over", "by"])))
}

/// Returns the mistake in `set first second` if the second word is unknown; `None` if the line resembles no setting
/// of two words.
fn no_second_word(first: Word<'_>, second: Word<'_>) -> Option<Box<Diagnostic>> {
    let pairs = || plain_settings().filter_map(|name| name.split_once(' '));
    let words = || pairs().filter(|(group, _)| *group == first.text).map(|(_, word)| word);
    if words().next().is_none() {
        let both = format!("{} {}", first.text, second.text);
        let similar = nearest(&both, plain_settings())?;
        let unknown = Diagnostic::new(first.span.to(second.span), format!("there is no `{both}`"));
        return Some(near(Box::new(unknown), Some(similar)));
    }
    let unknown = format!("there is no {} in `set {}`", second.shown(), first.text);
    let unknown = wrong(second.span, unknown, format!("choose one of {}", quoted(words())));
    Some(near(unknown, nearest(second.text, words())))
}

fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
