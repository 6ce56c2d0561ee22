//! Lyrics with times, from an `.lrc` file in a song's folder or from the song's tags.
//!
//! Each line of the text begins with the times at which it is sung: `[01:23.45]`. Words can have times, too:
//! `<01:23.90>`. `[offset:500]` shows all lines 500 ms earlier. A line without words ends the line before it. Lines
//! without a time are ignored.

use std::path::{Path, PathBuf};

use mariana_files::reading::read_at_most;
use mariana_music::SongMoment;

use crate::decode::DecodeError;
use crate::limits;
use crate::playlist::text::Lines;
use crate::song::{Song, one_line};

/// A line is shown for at most this many seconds.
const LINE_SECONDS_MAX: f64 = 10.0;

/// A line of lyrics.
#[derive(Debug, Clone, PartialEq)]
pub struct LyricLine {
    /// The moment at which the line begins, in seconds.
    pub start: f64,
    /// The moment at which the line ends, in seconds.
    pub end: f64,
    /// The words, on one line.
    pub words: String,
    /// The moment at which each word begins, in seconds, in order. Times that the text does not contain are estimated
    /// from the lengths of the words.
    pub word_starts: Vec<f64>,
}

/// Lines of lyrics, sorted by time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lyrics {
    lines: Vec<LyricLine>,
}

/// Reasons why lyrics cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum LyricsError {
    /// The song has no lyrics with times, in a file or in its tags.
    #[error("{song} has no lyrics with times: write them into {}, or name a file with --lyrics=FILE", beside.display())]
    None {
        /// The song's name.
        song: String,
        /// The file that was looked for.
        beside: PathBuf,
    },
    /// The file cannot be read, is too large, or has no line with a time.
    #[error("{0}")]
    File(String),
    /// The song cannot be opened.
    #[error(transparent)]
    Song(#[from] DecodeError),
}

impl Lyrics {
    /// Reads the lyrics of a song from the `.lrc` file in its folder. Without such a file, reads its tags.
    ///
    /// # Errors
    /// Fails if the song has no lyrics, or for the reasons of [`Lyrics::read`].
    pub fn of_song(song: &Song) -> Result<Self, LyricsError> {
        let beside = match song {
            Song::File(path) => path.with_extension("lrc"),
            Song::Embedded { name, .. } => Path::new(name).with_extension("lrc"),
        };
        if matches!(song, Song::File(_)) && beside.is_file() {
            return Self::read(&beside);
        }
        let decoder = song.open()?;
        let info = decoder.info();
        let tagged = info.lyrics.as_deref().map(Self::parse).filter(|lyrics| !lyrics.lines.is_empty());
        tagged.ok_or_else(|| LyricsError::None { song: one_line(&info.name), beside })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Fails if the file is not regular, cannot be read, exceeds the limit, or has no line with a time.
    pub fn read(path: &Path) -> Result<Self, LyricsError> {
        let (most, file) = (limits::LYRICS_BYTES_MAX, path.display());
        let refused = |what: &str| LyricsError::File(format!("the lyrics {file} {what}"));
        let bytes = read_at_most(path, most as usize).map_err(|error| {
            LyricsError::File(format!("cannot read the lyrics {file} ({error}): check the file's name"))
        })?;
        let remedy = "name a text file with times, such as song.lrc";
        let bytes = bytes.ok_or_else(|| refused(&format!("have more than {most} bytes: {remedy}")))?;
        let text = Lines::of(&bytes);
        let lines: Vec<String> =
            text.iter().flat_map(|text| text.lines.iter().map(|line| text.decode(line))).collect();
        let lyrics = Self::parse(&lines.join("\n"));
        if lyrics.lines.is_empty() {
            return Err(refused(
                "have no line with a time: write a time such as [01:23.45] before each line",
            ));
        }
        Ok(lyrics)
    }

    /// Reads a text. Lines without a time are ignored.
    pub fn parse(text: &str) -> Self {
        let mut earlier = 0.0;
        let mut sung: Vec<(f64, &str)> = Vec::new();
        for line in text.lines() {
            let mut rest = line.trim_start_matches('\u{feff}').trim();
            let first = sung.len();
            while let Some((inside, after)) = rest.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
                match (seconds(inside), inside.split_once(':')) {
                    (Some(start), _) if sung.len() < limits::LYRICS_LINES_MAX => sung.push((start, "")),
                    (Some(_), _) => {}
                    (None, Some((name, value))) if name.trim().eq_ignore_ascii_case("offset") => {
                        earlier = value.trim().parse().map_or(earlier, |ms: f64| ms / 1000.0);
                    }
                    _ => break,
                }
                rest = after.trim_start();
            }
            // Many times before one line must not multiply its words.
            let most = limits::LYRICS_LINE_BYTES_MAX;
            let words = rest.get(..rest.floor_char_boundary(most)).unwrap_or_default();
            sung.iter_mut().skip(first).for_each(|(_, sung)| *sung = words);
        }
        let earlier = if earlier.is_finite() { earlier } else { 0.0 };
        sung.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let next = sung.iter().skip(1).map(|(start, _)| *start).chain([f64::INFINITY]);
        let ends: Vec<f64> = next.collect();
        let lines = sung.into_iter().zip(ends).map(|((start, words), next)| {
            LyricLine::parse(words, start, next.min(start + LINE_SECONDS_MAX), earlier)
        });
        Self { lines: lines.filter(|line| !line.words.is_empty()).collect() }
    }

    /// Writes the line and the word that are sung at `time` seconds into the moment of the song.
    pub fn mark(&self, time: f64, moment: &mut SongMoment) {
        let Some((number, line)) = self.at(time) else { return };
        moment.line = number as f32 + 1.0;
        moment.word = line.word_starts.partition_point(|start| *start <= time).max(1) as f32;
        moment.line_phase = ((time - line.start) / (line.end - line.start)).clamp(0.0, 1.0) as f32;
    }

    /// Returns the line that is sung at a moment in seconds, and its number.
    pub fn at(&self, time: f64) -> Option<(usize, &LyricLine)> {
        let number = self.lines.partition_point(|line| line.start <= time).checked_sub(1)?;
        self.lines.get(number).filter(|line| time < line.end).map(|line| (number, line))
    }

    /// Returns the line with this number, from 0.
    pub fn line(&self, number: usize) -> Option<&LyricLine> {
        self.lines.get(number)
    }
}

/// Reads a time such as `01:23.45`, `1:23` or `01:23:45`, or with hours such as `1:02:03.40`.
fn seconds(text: &str) -> Option<f64> {
    let (minutes, rest) = text.trim().split_once(':')?;
    if rest.contains(':') && rest.contains(['.', ',']) {
        let hours: u32 = minutes.parse().ok()?;
        return Some(3600.0 * f64::from(hours) + seconds(rest)?);
    }
    let rest = rest.replace([':', ','], ".");
    let is_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    if !is_number(minutes) || !is_number(&rest) {
        return None;
    }
    let (minutes, seconds): (u32, f64) = (minutes.parse().ok()?, rest.parse().ok()?);
    Some(60.0 * f64::from(minutes) + seconds).filter(|time| time.is_finite())
}

impl LyricLine {
    /// Reads a line's text, which may contain times of words. The line is sung from `start` to `end` and is
    /// shown `earlier` seconds earlier.
    fn parse(text: &str, start: f64, end: f64, earlier: f64) -> Self {
        let mut words = String::with_capacity(text.len());
        // Numbers of bytes, and the times at which the words behind these bytes begin. Times increase.
        let mut known = vec![(0, start)];
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('<') {
            words.push_str(before);
            rest = after;
            match after.split_once('>').and_then(|(inside, after)| Some((seconds(inside)?, after))) {
                Some((time, after)) => {
                    rest = after;
                    if known.last().is_some_and(|(_, last)| *last <= time) && time < end {
                        known.push((words.len(), time));
                    }
                }
                None => words.push('<'),
            }
        }
        words.push_str(rest);
        known.push((words.len(), end));
        let begins = |at: usize| {
            let before = words.get(..at).is_none_or(|before| before.ends_with(char::is_whitespace));
            at == 0 || before
        };
        let starts = words.char_indices().filter(|(at, c)| !c.is_whitespace() && begins(*at));
        let word_starts = starts.map(|(at, _)| time_at(&known, at) - earlier).collect();
        Self { start: start - earlier, end: end - earlier, words: one_line(&words), word_starts }
    }
}

/// Returns the time at a position of a text, linear between the known positions.
fn time_at(known: &[(usize, f64)], position: usize) -> f64 {
    let after = known.partition_point(|(at, _)| *at <= position);
    match (after.checked_sub(1).and_then(|before| known.get(before)), known.get(after)) {
        (Some(&(from, start)), Some(&(to, end))) => {
            start + (end - start) * (position - from) as f64 / (to - from) as f64
        }
        (Some(&(_, time)), None) | (None, Some(&(_, time))) => time,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn heard(lyrics: &Lyrics, time: f64) -> Option<&str> {
        lyrics.at(time).map(|(_, line)| line.words.as_str())
    }

    #[test]
    fn lines_are_sorted_and_end_with_the_next_line() {
        let text = "\u{feff}[ar: Nobody]\r\n[00:10.50][00:30]Again\r\n[00:12.00]<00:12.10>two <00:12.90>words\r\n\
                    [00:14:50]\r\nno time\r\n[01:00.5] last < line";
        let lyrics = Lyrics::parse(text);
        let moments =
            [(10.4, None), (10.5, Some("Again")), (12.0, Some("two words")), (14.49, Some("two words"))];
        for (time, words) in moments {
            assert_eq!(heard(&lyrics, time), words, "at {time}");
        }
        assert_eq!(heard(&lyrics, 14.5), None, "a line without words ends the line before it");
        assert_eq!(heard(&lyrics, 39.9), Some("Again"));
        assert_eq!(heard(&lyrics, 40.1), None, "a line is shown for at most ten seconds");
        assert_eq!(lyrics.at(61.0).map(|(number, _)| number), Some(3));
        assert_eq!(heard(&lyrics, 61.0), Some("last < line"));
    }

    #[test]
    fn words_have_their_own_times_or_times_by_their_lengths() {
        let lyrics = Lyrics::parse("[00:02.00]<00:02.50>Tell <00:03.00>me now\n[00:04.00]aa bb\n[00:08.00]");
        let places = [1.9, 2.0, 2.9, 3.0, 3.5, 4.0, 6.0, 6.5, 8.0].map(|time| {
            let mut moment = SongMoment::UNKNOWN;
            lyrics.mark(time, &mut moment);
            (moment.line, moment.word, moment.line_phase)
        });
        let wanted = [
            (0.0, 0.0, 0.0),
            (1.0, 1.0, 0.0),
            (1.0, 1.0, 0.45),
            (1.0, 2.0, 0.5),
            (1.0, 3.0, 0.75),
            (2.0, 1.0, 0.0),
            (2.0, 1.0, 0.5),
            (2.0, 2.0, 0.625),
            (0.0, 0.0, 0.0),
        ];
        assert_eq!(places, wanted);
    }

    #[test]
    fn times_with_hours_are_read() {
        let lyrics = Lyrics::parse("[1:02:03.40]late\n[00:59:50.00]earlier\n[00:14:50]hundredths");
        assert_eq!(heard(&lyrics, 3723.5), Some("late"));
        assert_eq!(heard(&lyrics, 3590.0), Some("earlier"));
        assert_eq!(heard(&lyrics, 14.5), Some("hundredths"));
    }

    #[test]
    fn many_times_before_one_line_multiplied_its_words_to_gigabytes() {
        let lyrics = Lyrics::parse(&("[00:01]".repeat(70_000) + &"wörd ".repeat(80_000)));
        assert!(lyrics.lines.len() == limits::LYRICS_LINES_MAX && lyrics.lines[0].words.len() < 1_001);
        // Each `<` looked for its `>` in the rest of the file.
        let lyrics = Lyrics::parse(&(String::from("[00:01]") + &"<".repeat(1 << 20)));
        assert!(lyrics.line(0).is_some_and(|line| line.words.starts_with("<<<")));
    }

    #[test]
    fn an_offset_shows_all_lines_earlier() {
        let lyrics = Lyrics::parse("[offset:+500]\n[00:02.00]a\n[00:03.00]b");
        assert_eq!(
            [1.4, 1.5, 2.4, 2.5].map(|time| heard(&lyrics, time)),
            [None, Some("a"), Some("a"), Some("b")]
        );
    }

    #[test]
    fn a_file_beside_the_song_is_found_and_each_failure_has_its_message() {
        let folder = tempfile::tempdir().unwrap();
        let song = Song::File(folder.path().join("song.wav"));
        let beside = folder.path().join("song.lrc");
        std::fs::write(&beside, "[00:01.00]Grüße").unwrap();
        assert_eq!(heard(&Lyrics::of_song(&song).unwrap(), 1.5), Some("Grüße"));
        let failure = |read: Result<Lyrics, LyricsError>| read.unwrap_err().to_string();
        std::fs::write(&beside, "just words").unwrap();
        assert!(failure(Lyrics::of_song(&song)).contains("have no line with a time"));
        std::fs::write(&beside, vec![b' '; limits::LYRICS_BYTES_MAX as usize + 1]).unwrap();
        assert!(failure(Lyrics::of_song(&song)).contains("have more than"));
        assert!(failure(Lyrics::read(folder.path())).contains("cannot read the lyrics"));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "(\\[[0-9:.]{0,9}\\]?|<[0-9:.]{0,8}>?|[a-z\\[\\]<>: \n]{0,6}){0,20}", time in -9.0..999.0) {
            let lyrics = Lyrics::parse(&text);
            if let Some((_, line)) = lyrics.at(time) {
                prop_assert!(line.start <= time && time < line.end && !line.words.is_empty());
                let mut moment = SongMoment::UNKNOWN;
                lyrics.mark(time, &mut moment);
                prop_assert!((1.0..=line.word_starts.len() as f32).contains(&moment.word), "{moment:?} {line:?}");
                prop_assert!((0.0..=1.0).contains(&moment.line_phase));
                prop_assert!(line.word_starts.is_sorted());
            }
        }
    }
}
