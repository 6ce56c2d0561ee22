//! A show: a script, facts about its scenes, and the plan for one song.

use std::collections::BTreeMap;

use super::cue_list::CueList;
use super::director::{SceneCard, direct};
use super::parse::{DIAGNOSTICS_MAX, parse};
use super::resolve::resolve;
use super::scene_facts::{NamedScenes, Refusal, SceneFacts};
use super::substitutes::with_substitutes;
use super::text::print;
use super::timeline::{Clip, Timeline};
use mariana_field::lang::{Diagnostic, Way, render_all};
use mariana_music::SongStructure;

/// An error in a show file.
#[derive(Debug, thiserror::Error)]
pub enum CueListError {
    /// Mistakes in the text, or cameras and parameters that its scenes lack.
    #[error("the show has mistakes: correct what is underlined\n{}", .report.trim_end())]
    Mistakes {
        /// The mistakes with their places.
        report: String,
    },
    /// Every entry names a moment that the song lacks.
    #[error(
        "nothing of the show is in this song: give its first entry a moment that every song has, such as `at start`\n{}",
        .report.trim_end()
    )]
    NothingFits {
        /// The entries that are left out, with their places.
        report: String,
    },
}

/// How a scene likes to come and to go.
type Liked = (Option<Way>, Option<Way>);

/// A script with its plan for one song.
#[derive(Debug, Clone, Default)]
pub struct Show {
    /// `None` as long as every entry waits for a key.
    timeline: Option<Timeline>,
    cue_list: CueList,
    /// How scenes like to come and to go.
    ways: BTreeMap<String, Liked>,
    cards: Vec<SceneCard>,
}

impl Show {
    /// The director's show of scenes, given by name; `None` without scenes.
    pub fn directed(song: &SongStructure, scenes: &BTreeMap<String, SceneFacts>) -> Option<Self> {
        let (ways, cards) = (ways_of(scenes), cards_of(scenes));
        let cue_list = direct(song, &cards, seed_of(song));
        let timeline = Some(resolved(&cue_list, song, &[], &ways).0?);
        Some(Self { timeline, cue_list, ways, cards })
    }

    /// The show that a text describes for a song, and a report of the entries that do not fit the song. Messages call the
    /// text `name`. `find` finds scenes by their names in the text, each once.
    ///
    /// # Errors
    /// [`CueListError::Mistakes`] with all mistakes of the text and of its scenes, and [`CueListError::NothingFits`].
    pub fn of_text(
        name: &str,
        text: &str,
        song: &SongStructure,
        find: impl FnMut(&str) -> Result<SceneFacts, Refusal>,
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
        let (ways, cards) = (ways_of(&named.facts), cards_of(&named.facts));
        let (timeline, left_out) = resolved(&cue_list, song, &[], &ways);
        let reported = (!left_out.is_empty()).then(|| render_all(&left_out, &parsed.sources, false));
        if timeline.is_none() && cue_list.cues().next().is_none() {
            return Err(CueListError::NothingFits { report: reported.unwrap_or_default() });
        }
        Ok((Self { timeline, cue_list, ways, cards }, reported))
    }

    /// The same show with another plan.
    pub fn with_timeline(&self, timeline: Option<Timeline>) -> Self {
        Self { timeline, ..self.clone() }
    }

    /// The same show where the key was pressed at these moments, in seconds, for which entries wait.
    pub fn with_cues(&self, song: &SongStructure, cues: &[f64]) -> Self {
        self.with_timeline(resolved(&self.cue_list, song, cues, &self.ways).0)
    }

    /// Replaces refused scenes by other scenes of the show. `None` if all are refused.
    pub fn without(&self, is_refused: impl Fn(&str) -> bool) -> Option<Self> {
        let clips = with_substitutes(self.clips(), &self.cards, is_refused)?;
        Some(self.with_timeline(Timeline::new(clips)))
    }

    /// What is on when; `None` as long as every entry waits for a key.
    pub fn timeline(&self) -> Option<&Timeline> {
        self.timeline.as_ref()
    }

    /// The stays in their order; none without a plan.
    pub fn clips(&self) -> &[Clip] {
        self.timeline().map_or(&[], Timeline::clips)
    }

    /// The scenes that wait for a key, in their order.
    pub fn cues(&self) -> Vec<&str> {
        self.cue_list.cues().map(|entry| entry.scene.as_str()).collect()
    }

    /// Descriptions of the scenes; for the director, of all that it may choose.
    pub fn cards(&self) -> &[SceneCard] {
        &self.cards
    }

    /// The text of a show file that is this show, below lines of comment.
    pub fn text(&self, comments: &[String]) -> String {
        print(&self.cue_list, comments)
    }
}

fn ways_of(known: &BTreeMap<String, SceneFacts>) -> BTreeMap<String, Liked> {
    known.iter().map(|(name, scene)| (name.clone(), scene.ways())).collect()
}

fn cards_of(known: &BTreeMap<String, SceneFacts>) -> Vec<SceneCard> {
    known.iter().map(|(name, scene)| scene.card(name)).collect()
}

fn resolved(
    cue_list: &CueList,
    song: &SongStructure,
    cues: &[f64],
    ways: &BTreeMap<String, Liked>,
) -> (Option<Timeline>, Vec<Diagnostic>) {
    resolve(cue_list, song, cues, |from, to| {
        let liked = |name: &str| ways.get(name).copied().unwrap_or_default();
        liked(to).0.or(from.and_then(|from| liked(from).1))
    })
}

/// The seed of a song's show. It follows from the song's content, but not from anything that the arithmetic of another
/// machine might round in another way.
pub fn seed_of(song: &SongStructure) -> u64 {
    let whole = |number: f64| number.round() as u64;
    let key = song.key.map_or(99, |key| u64::from(key.root));
    let of_sections = song.sections.iter().flat_map(|section| {
        section.letter.bytes().map(u64::from).chain([whole(section.start), whole(section.end)])
    });
    let all = [whole(song.seconds), key, song.beats.len() as u64 / 8].into_iter().chain(of_sections);
    // FNV-1a, by words.
    all.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0100_0000_01b3))
}
