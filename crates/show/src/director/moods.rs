//! The meaning of the words in scenes' `about` blocks: their moods, and what they follow.

use super::character::Character;
use super::character::Trait::{self, Brightness, Density, Energy, Minor, Percussion, Tempo};
use mariana_field::lang::About;

/// The moods of scenes that are not for shows: lessons, and scenes that show a name. The director shows such a scene
/// only if it has no other.
const OUTSIDE_SHOWS: &[&str] = &["lesson", "sign"];

type Weights = &'static [(Trait, f32)];

/// Mood words, and the music that they suit. A weight says how much of a property the mood wants; a negative weight
/// wants the opposite. All other words have no meaning in music: they say what a scene shows.
const MOODS: [(&[&str], Weights); 9] = [
    (&["calm"], &[(Density, -0.5), (Energy, -1.0), (Percussion, -1.0), (Tempo, -0.5)]),
    (&["soft", "love"], &[(Density, -0.5), (Percussion, -1.0), (Minor, -1.0), (Brightness, -0.5)]),
    (&["space"], &[(Density, -0.5), (Percussion, -0.5), (Minor, 1.0)]),
    (&["drive", "flight"], &[(Density, 0.5), (Energy, 1.0), (Percussion, 1.0), (Tempo, 1.0)]),
    (&["wild"], &[(Density, 1.0), (Energy, 1.0), (Brightness, 0.5)]),
    (&["play"], &[(Minor, -1.0), (Tempo, 0.5), (Percussion, 0.5)]),
    (&["day"], &[(Minor, -1.0), (Brightness, 0.5)]),
    (&["warm"], &[(Minor, -1.0), (Brightness, -0.5), (Density, -0.25)]),
    (&["night", "cold", "cave"], &[(Minor, 1.0), (Brightness, -0.25)]),
];

/// What a scene follows, and the music in which this moves most.
const FOLLOWED: [(&[&str], Weights); 4] = [
    (&["onsets"], &[(Percussion, 1.0), (Density, 0.5)]),
    (&["bass"], &[(Percussion, 0.5), (Brightness, -0.5)]),
    (&["level"], &[(Energy, 0.5)]),
    (&["tones"], &[(Percussion, -1.0), (Density, -0.25)]),
];

/// Returns how well a scene's moods suit the music, -1..1; 0 if they suit it neither well nor badly.
pub(super) fn fit(about: &About, music: &Character) -> f32 {
    along(&MOODS, &about.moods, music)
}

/// Returns how much the music moves the scene, -1..1, by what the scene follows; 0 if the scene does not say it.
pub(super) fn moves(about: &About, music: &Character) -> f32 {
    along(&FOLLOWED, &about.follows, music)
}

/// The sum of the words' weights is a direction among the properties of music. Returns how far the music lies in this
/// direction.
fn along(meanings: &[(&[&str], Weights)], words: &[String], music: &Character) -> f32 {
    let meaning = |word: &String| meanings.iter().find(|(names, _)| names.contains(&word.as_str()));
    let mut sum = Character::default();
    for (_, wants) in words.iter().filter_map(meaning) {
        wants.iter().for_each(|(which, weight)| sum.add(*which, *weight));
    }
    sum.along(music)
}

/// True if the scene is not for shows.
pub(super) fn is_outside_shows(about: &About) -> bool {
    about.moods.iter().any(|mood| OUTSIDE_SHOWS.contains(&mood.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_about_shows_lists_the_moods() {
        let page = include_str!("../../../../docs/shows.md");
        let rows: Vec<String> = MOODS
            .iter()
            .map(|(words, _)| words)
            .chain([&OUTSIDE_SHOWS])
            .chain(FOLLOWED.iter().map(|(words, _)| words))
            .map(|words| words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "))
            .collect();
        for row in rows {
            assert!(page.contains(&format!("\n| {row} | ")), "{row}");
        }
    }

    #[test]
    fn percussion_suits_scenes_that_follow_onsets() {
        let about = |follows: &str| About { follows: vec![follows.to_owned()], ..About::default() };
        let mut drums = Character::default();
        drums.add(Percussion, 1.0);
        assert!(moves(&about("onsets"), &drums) > 0.5 && moves(&about("tones"), &drums) < -0.5);
        assert_eq!(moves(&about("rain"), &drums), 0.0);
    }

    #[test]
    fn moods_that_mean_opposites_cancel() {
        let about = |moods: &[&str]| About {
            moods: moods.iter().map(|mood| (*mood).to_owned()).collect(),
            ..About::default()
        };
        let loud = Character::of_energy(1.0);
        assert_eq!(fit(&about(&["city", "glass"]), &loud), 0.0);
        assert!(fit(&about(&["drive"]), &loud) > 0.5 && fit(&about(&["calm"]), &loud) < -0.5);
        assert!(fit(&about(&["drive", "calm"]), &loud).abs() < 0.1);
    }
}
