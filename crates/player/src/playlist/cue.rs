//! Cue sheets contain the tracks of files that hold a whole disc. The parser understands `FILE "name" TYPE`,
//! `TRACK n AUDIO`, `INDEX 01 minutes:seconds:frames`, `TITLE` and `PERFORMER`. A track extends from its index 01 to
//! the next track's index 01. So the gap before a track (index 00) is heard at the end of the previous track, as on a
//! disc.

use std::path::Path;

use super::lists::{Cut, Item};
use super::text::Lines;
use crate::decode::TrackTags;

/// Compact disc frames per second.
pub(super) const DISC_FRAMES: u64 = 75;

const MINUTES_MAX: u64 = 100_000;

pub(super) fn read(base: &Path, sheet: &Lines) -> Option<Vec<Item>> {
    let mut items: Vec<Item> = Vec::new();
    let (mut file, mut track) = (None, TrackTags::default());
    let mut disc_artist = None;
    let mut within_track = false;
    for line in &sheet.lines {
        let (word, rest) = split_word(line);
        match word.to_ascii_uppercase().as_slice() {
            b"FILE" => {
                // The name is the text in quotes, or else everything except the type.
                let name =
                    quoted(rest).or_else(|| Some(rest.rsplitn(2, |byte| *byte == b' ').last()?.to_vec()));
                file = Some(sheet.resolve(base, name?.trim_ascii()));
            }
            b"TRACK" => {
                within_track = rest.to_ascii_uppercase().ends_with(b"AUDIO");
                track = TrackTags::default();
            }
            b"TITLE" if within_track => track.title = text(sheet, rest),
            b"PERFORMER" if within_track => track.artist = text(sheet, rest),
            b"PERFORMER" if file.is_none() => disc_artist = text(sheet, rest),
            b"INDEX" if within_track => {
                let (number, time) = split_word(rest);
                let start = disc_time(time)
                    .filter(|_| str::from_utf8(number).is_ok_and(|number| number.parse() == Ok(1_u32)));
                let (Some(start), Some(reference)) = (start, file.clone()) else { continue };
                if let Some(before) = items.last_mut().filter(|item| item.reference == reference)
                    && let Some(cut) = before.cut.as_mut()
                {
                    cut.end = Some(start.max(cut.start));
                }
                let artist = track.artist.take().or_else(|| disc_artist.clone());
                let tags = TrackTags { artist, ..std::mem::take(&mut track) };
                items.push(Item { reference, cut: Some(Cut { start, end: None }), tags });
            }
            _ => {}
        }
    }
    file.is_some().then_some(items)
}

fn split_word(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    let (word, rest) = line.split_at(end);
    (word, rest.trim_ascii())
}

fn quoted(text: &[u8]) -> Option<Vec<u8>> {
    let rest = text.strip_prefix(b"\"")?;
    let end = rest.iter().position(|byte| *byte == b'"').unwrap_or(rest.len());
    Some(rest.get(..end)?.to_vec())
}

fn text(sheet: &Lines, bytes: &[u8]) -> Option<String> {
    let text = sheet.decode(&quoted(bytes).unwrap_or_else(|| bytes.to_vec()));
    (!text.is_empty()).then_some(text)
}

/// Parses `minutes:seconds:frames` to compact disc frames.
fn disc_time(text: &[u8]) -> Option<u64> {
    let text = str::from_utf8(text).ok()?;
    let mut parts = text.split(':').map(|part| part.parse::<u64>().ok());
    let (minutes, seconds, frames) = (parts.next()??, parts.next()??, parts.next()??);
    let sound = parts.next().is_none() && minutes <= MINUTES_MAX && seconds < 60 && frames < DISC_FRAMES;
    // Compute the sum only for valid times, because other numbers may overflow.
    sound.then(|| (minutes * 60 + seconds) * DISC_FRAMES + frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_follow_each_other_within_their_files() {
        let sheet =
            b"REM made by hand\nPERFORMER \"The Band\"\nTITLE \"The Disc\"\nFILE \"disc 1.flac\" WAVE\n\
            TRACK 01 AUDIO\nTITLE \"One\"\nINDEX 01 00:00:00\nTRACK 02 AUDIO\nTITLE \"Two\"\n\
            PERFORMER \"Guest\"\nINDEX 00 03:59:00\nINDEX 01 04:01:30\n\
            FILE b.wav WAVE\nTRACK 03 AUDIO\nINDEX 01 99:99:99\nINDEX 01 00:00:01\n";
        let sheet = Lines::of(sheet).unwrap();
        let items = read(Path::new("/m"), &sheet).unwrap();
        let reported: Vec<_> = items
            .iter()
            .map(|item| (item.cut.unwrap(), item.tags.title.as_deref(), item.tags.artist.as_deref()))
            .collect();
        let second = (4 * 60 + 1) * 75 + 30;
        assert_eq!(
            reported,
            [
                (Cut { start: 0, end: Some(second) }, Some("One"), Some("The Band")),
                (Cut { start: second, end: None }, Some("Two"), Some("Guest")),
                (Cut { start: 1, end: None }, None, Some("The Band")),
            ]
        );
        assert_eq!(items[2].reference, sheet.resolve(Path::new("/m"), b"b.wav"));
        assert_eq!(items[0].reference, sheet.resolve(Path::new("/m"), b"disc 1.flac"));
    }

    #[test]
    fn a_time_with_too_many_minutes_is_none() {
        assert_eq!(disc_time(b"9999555555555555555:50:0"), None);
        assert_eq!(disc_time(format!("{}:59:74", u64::MAX).as_bytes()), None);
        assert_eq!(disc_time(b"100001:0:0"), None);
        assert_eq!(disc_time(b"100000:0:1"), Some(100_000 * 60 * 75 + 1));
    }
}
