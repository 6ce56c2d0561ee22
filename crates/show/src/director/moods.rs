//! The meaning of the mood words in scenes' `about` blocks.

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

/// Returns how well a scene's moods suit the music, -1..1; 0 if they suit it neither well nor badly. The sum of the
/// moods' weights is a direction among the properties of music, and the music should lie in this direction.
pub(super) fn fit(about: &About, music: &Character) -> f32 {
    let meaning = |mood: &String| MOODS.iter().find(|(words, _)| words.contains(&mood.as_str()));
    let mut sum = Character::default();
    for (_, wants) in about.moods.iter().filter_map(meaning) {
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
            .map(|words| words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "))
            .collect();
        for row in rows {
            assert!(page.contains(&format!("\n| {row} | ")), "{row}");
        }
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
