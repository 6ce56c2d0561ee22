//! Filters of the scene list: by mood, and by the energy of the music that a scene suits.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use mariana_scenes::thumbnails::Description;

/// Names of the energies, each with an energy that suits a scene of this name, from 0 to 1.
pub const ENERGIES: [(&str, f32); 3] = [("quiet music", 0.2), ("lively", 0.5), ("intense", 0.85)];
/// Minimum number of scenes with a mood that is offered.
const SCENES_MIN: usize = 2;
/// Maximum number of offered moods: more do not fit into a small window.
const MOODS_MAX: usize = 9;

/// A filter by its index among the offered moods or in [`ENERGIES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SceneFilter {
    /// Only scenes with this mood.
    Mood(usize),
    /// Only scenes for music of this energy.
    Energy(usize),
}

/// The offered moods and the chosen filters.
#[derive(Debug, Default)]
pub struct Filters {
    /// The offered moods.
    pub moods: Vec<String>,
    mood: Option<String>,
    energy: Option<usize>,
}

impl Filters {
    /// True if a filter is chosen.
    pub fn is_on(&self, filter: SceneFilter) -> bool {
        match filter {
            SceneFilter::Mood(at) => self.mood.is_some() && self.mood.as_ref() == self.moods.get(at),
            SceneFilter::Energy(at) => self.energy == Some(at),
        }
    }

    /// True if any filter is chosen.
    pub fn are_any(&self) -> bool {
        self.mood.is_some() || self.energy.is_some()
    }

    /// Offers the moods that several scenes have: the most frequent ones, in the order of the alphabet.
    pub(super) fn offer_moods<'a>(&mut self, scenes: impl Iterator<Item = &'a Description>) {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for mood in scenes.flat_map(|about| &about.moods) {
            *counts.entry(mood).or_default() += 1;
        }
        let mut moods: Vec<_> = counts.into_iter().filter(|(_, count)| *count >= SCENES_MIN).collect();
        moods.sort_by_key(|(_, count)| Reverse(*count));
        moods.truncate(MOODS_MAX);
        self.moods = moods.into_iter().map(|(mood, _)| mood.to_owned()).collect();
        self.moods.sort();
    }

    pub(super) fn toggle(&mut self, filter: SceneFilter) {
        let is_on = self.is_on(filter);
        match filter {
            SceneFilter::Mood(at) => self.mood = self.moods.get(at).filter(|_| !is_on).cloned(),
            SceneFilter::Energy(at) => self.energy = Some(at).filter(|at| !is_on && *at < ENERGIES.len()),
        }
    }

    /// Chooses the next mood or energy; after the last, none.
    pub(super) fn step(&mut self, mood: bool) {
        if mood {
            let place = self.mood.as_ref().and_then(|mood| self.moods.iter().position(|known| known == mood));
            self.mood = self.moods.get(place.map_or(0, |place| place + 1)).cloned();
        } else {
            let next = self.energy.map_or(0, |energy| energy + 1);
            self.energy = Some(next).filter(|next| *next < ENERGIES.len());
        }
    }

    /// Ends all filters. Returns false if there was none.
    pub(super) fn clear(&mut self) -> bool {
        let were_any = self.are_any();
        (self.mood, self.energy) = (None, None);
        were_any
    }

    /// True if a scene matches the filters. A scene that says nothing about energy suits all music.
    pub(super) fn fit(&self, about: &Description) -> bool {
        let wanted = self.energy.and_then(|energy| ENERGIES.get(energy)).map(|(_, energy)| *energy);
        let suits = |wanted: f32| about.energy.is_none_or(|(least, most)| (least..=most).contains(&wanted));
        self.mood.as_ref().is_none_or(|mood| about.moods.contains(mood)) && wanted.is_none_or(suits)
    }
}
