//! A show: a cue list, facts about its scenes, and the timeline for one song.

use super::cue_list::{CueList, Entry};
use super::director::{direct, for_shows};
use super::parse::{DIAGNOSTICS_MAX, parse};
use super::resolve::{entry_starts, resolve};
use super::scene_card::{NamedScenes, Refusal, SceneCard};
use super::substitutes::with_substitutes;
use super::text::print;
use super::timeline::{Clip, Timeline};
use mariana_field::lang::{Diagnostic, render_all};
use mariana_music::SongStructure;

/// An error in a show file.
#[derive(Debug, thiserror::Error)]
pub enum CueListError {
    /// Mistakes in the text, or cameras and parameters that its scenes lack.
    #[error("the show has mistakes: correct what is underlined\n{}", .report.trim_end())]
    Mistakes {
        /// The rendered mistakes.
        report: String,
    },
    /// Every entry names a moment that the song lacks.
    #[error(
        "no entry of the show fits this song: begin with an entry that fits every song, such as `at start`\n{}",
        .report.trim_end()
    )]
    NothingFits {
        /// The rendered list of entries that were left out.
        report: String,
    },
}

/// A cue list and its timeline for one song.
#[derive(Debug, Clone, Default)]
pub struct Show {
    /// `None` if all entries wait for the cue key.
    timeline: Option<Timeline>,
    cue_list: CueList,
    cards: Vec<SceneCard>,
}

impl Show {
    /// Lets the director create a show of the given scenes; returns `None` if there are no scenes. `recent` are the scenes
    /// that earlier songs have shown, the last one at the end.
    pub fn directed(song: &SongStructure, scenes: Vec<SceneCard>, recent: &[String]) -> Option<Self> {
        let cards = for_shows(scenes);
        let cue_list = direct(song, &cards, recent, seed_of(song));
        let timeline = Some(resolved(&cue_list, song, &[], &cards).0?);
        Some(Self { timeline, cue_list, cards })
    }

    /// Creates a show from the text of a show file. Also returns a report of the entries that do not fit the song.
    /// Messages call the text `name`. Calls `find` once for each scene name.
    ///
    /// # Errors
    /// [`CueListError::Mistakes`] if the text or its scenes have mistakes, or [`CueListError::NothingFits`] if no
    /// entry fits the song.
    pub fn of_text(
        name: &str,
        text: &str,
        song: &SongStructure,
        find: impl FnMut(&str) -> Result<SceneCard, Refusal>,
    ) -> Result<(Self, Option<String>), CueListError> {
        let parsed = parse(name, text);
        let named = NamedScenes::of(&parsed.entries, find);
        let cue_list = match parsed.cue_list {
            Some(cue_list) if named.mistakes.is_empty() => cue_list,
            _ => {
                let mut mistakes = [parsed.diagnostics, named.mistakes].concat();
                mistakes.sort_by_key(|one| one.span.start);
                mistakes.truncate(DIAGNOSTICS_MAX);
                let of_text = render_all(&mistakes, &parsed.sources, false);
                let report = std::iter::once(of_text).chain(named.reports).collect::<Vec<_>>().join("\n");
                return Err(CueListError::Mistakes { report });
            }
        };
        let cards: Vec<SceneCard> = named.cards.into_values().flatten().collect();
        let (timeline, left_out) = resolved(&cue_list, song, &[], &cards);
        let reported = (!left_out.is_empty()).then(|| render_all(&left_out, &parsed.sources, false));
        if timeline.is_none() && cue_list.cues().next().is_none() {
            return Err(CueListError::NothingFits { report: reported.unwrap_or_default() });
        }
        Ok((Self { timeline, cue_list, cards }, reported))
    }

    /// Returns this show with another timeline.
    pub fn with_timeline(&self, timeline: Option<Timeline>) -> Self {
        Self { timeline, ..self.clone() }
    }

    /// Returns this show as it runs if the cue key is pressed at the times `cues`, in seconds.
    pub fn with_cues(&self, song: &SongStructure, cues: &[f64]) -> Self {
        self.with_timeline(resolved(&self.cue_list, song, cues, &self.cards).0)
    }

    /// Replaces refused scenes by other scenes of the show. Returns `None` if all scenes are refused.
    pub fn without(&self, is_refused: impl Fn(&str) -> bool) -> Option<Self> {
        let clips = with_substitutes(self.clips(), &self.cards, is_refused)?;
        Some(self.with_timeline(Timeline::new(clips)))
    }

    /// Returns the timeline; `None` if all entries wait for the cue key.
    pub fn timeline(&self) -> Option<&Timeline> {
        self.timeline.as_ref()
    }

    /// Returns the clips, sorted by start. The list is empty if there is no timeline.
    pub fn clips(&self) -> &[Clip] {
        self.timeline().map_or(&[], Timeline::clips)
    }

    /// Returns all entries with their starts in seconds of the song, with the cue key pressed at the times `cues`. An
    /// entry has no start while it waits, or if the song lacks its moment.
    pub fn entries(&self, song: &SongStructure, cues: &[f64]) -> impl Iterator<Item = (&Entry, Option<f64>)> {
        self.cue_list.entries.iter().zip(entry_starts(&self.cue_list, song, cues))
    }

    /// Returns the scenes that wait for the cue key, in the order of the text.
    pub fn cues(&self) -> Vec<&str> {
        self.cue_list.cues().map(|entry| entry.scene.as_str()).collect()
    }

    /// Returns the cards of the scenes. A directed show has a card for each scene that it may choose.
    pub fn cards(&self) -> &[SceneCard] {
        &self.cards
    }

    /// Returns the text of a show file for this show, with `comments` as its first lines.
    pub fn text(&self, comments: &[String]) -> String {
        print(&self.cue_list, comments)
    }
}

fn resolved(
    cue_list: &CueList,
    song: &SongStructure,
    cues: &[f64],
    cards: &[SceneCard],
) -> (Option<Timeline>, Vec<Diagnostic>) {
    let about = |name: &str| cards.iter().find(|card| card.scene == name).map(|card| &card.about);
    resolve(cue_list, song, cues, |from, to| {
        about(to).and_then(|to| to.enter).or(from.and_then(|from| about(from)?.leave))
    })
}

/// Returns the director's seed for a song. The seed depends only on rounded values, so that every machine computes
/// the same seed.
pub fn seed_of(song: &SongStructure) -> u64 {
    let whole = |number: f64| number.round() as u64;
    let key = song.key.map_or(99, |key| u64::from(key.root));
    let of_sections = song.sections.iter().flat_map(|section| {
        section.letter.bytes().map(u64::from).chain([whole(section.start), whole(section.end)])
    });
    let all = [whole(song.seconds), key, song.beats.len() as u64 / 8].into_iter().chain(of_sections);
    // FNV-1a, but over 64-bit words instead of bytes.
    all.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0100_0000_01b3))
}
