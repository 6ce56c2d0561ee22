//! Replaces scenes of a show that this machine cannot draw.
//!
//! A substitute suits music of about the same energy as the refused scene, and is not the previous or next scene. The
//! cameras change at the same moments as before.

use super::cue_list::is_of_no_scene;
use super::scene_card::SceneCard;
use super::timeline::Clip;

/// Replaces the scenes of refused clips. Returns `None` if all scenes are refused.
pub(super) fn with_substitutes(
    clips: &[Clip],
    cards: &[SceneCard],
    is_refused: impl Fn(&str) -> bool,
) -> Option<Vec<Clip>> {
    let usable: Vec<&SceneCard> = cards.iter().filter(|card| !is_refused(&card.scene)).collect();
    let mut found: Vec<Clip> = Vec::with_capacity(clips.len());
    // The refused scene of the previous clip, and its substitute.
    let mut last: Option<(&str, &SceneCard)> = None;
    for (index, clip) in clips.iter().enumerate() {
        if !is_refused(&clip.scene) {
            last = None;
            found.push(clip.clone());
            continue;
        }
        let refused = cards.iter().find(|card| card.scene == clip.scene)?;
        let substitute = match last {
            Some((scene, substitute)) if scene == clip.scene => substitute,
            _ => {
                let later = clips.iter().skip(index).map(|later| later.scene.as_str());
                let next = later.into_iter().find(|scene| *scene != clip.scene);
                let before = found.last().map(|clip| clip.scene.as_str());
                let neighbours = [before, next];
                let rank = |card: &SceneCard| {
                    let is_neighbour = neighbours.contains(&Some(card.scene.as_str()));
                    (is_neighbour, (energy(card) - energy(refused)).abs())
                };
                let order = |a: &&&SceneCard, b: &&&SceneCard| {
                    let (a, b) = (rank(a), rank(b));
                    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
                };
                usable.iter().min_by(order)?
            }
        };
        last = Some((&clip.scene, substitute));
        found.push(substituted(clip, refused, substitute));
    }
    Some(found)
}

fn energy(card: &SceneCard) -> f32 {
    0.5 * (card.about.energy.0 + card.about.energy.1)
}

fn substituted(clip: &Clip, refused: &SceneCard, substitute: &SceneCard) -> Clip {
    let number = refused.cameras.iter().position(|camera| Some(camera) == clip.camera.as_ref());
    Clip {
        scene: substitute.scene.clone(),
        camera: number.and_then(|number| substitute.cameras.get(number)).cloned(),
        moves: clip.moves.iter().filter(|one| is_of_no_scene(&one.param)).cloned().collect(),
        ..clip.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::{Move, TimedTransition};
    use mariana_field::lang::About;

    fn card(scene: &str, energy: f32, cameras: &[&str]) -> SceneCard {
        let about = About { energy: (energy, energy), ..About::default() };
        let cameras = cameras.iter().map(|camera| (*camera).to_owned()).collect();
        SceneCard { scene: scene.to_owned(), about, cameras, params: Vec::new(), rise: None }
    }

    fn clip(start: f64, scene: &str, camera: Option<&str>) -> Clip {
        let moved = |param: &str| Move { param: param.to_owned(), start, seconds: 0.0, from: 1.0, to: 1.0 };
        Clip {
            start,
            scene: scene.to_owned(),
            camera: camera.map(str::to_owned),
            transition: TimedTransition::CUT,
            moves: vec![moved("swell"), moved("picture brightness")],
        }
    }

    #[test]
    fn refused_scenes_are_replaced_by_similar_ones() {
        let cards = [
            card("calm", 0.2, &[]),
            card("heavy", 0.7, &["near", "far"]),
            card("like it", 0.75, &["left"]),
            card("loud", 0.9, &[]),
        ];
        let clips = [
            clip(0.0, "calm", None),
            clip(4.0, "heavy", None),
            clip(6.0, "heavy", Some("near")),
            clip(7.0, "heavy", Some("far")),
            clip(8.0, "loud", None),
            clip(9.0, "heavy", Some("near")),
            clip(10.0, "like it", None),
        ];
        let found = with_substitutes(&clips, &cards, |scene| scene == "heavy").unwrap();
        let scenes: Vec<_> = found.iter().map(|clip| (&*clip.scene, clip.camera.as_deref())).collect();
        let like_it = [("like it", None), ("like it", Some("left")), ("like it", None)];
        let expected =
            [&[("calm", None)][..], &like_it, &[("loud", None), ("calm", None), ("like it", None)]];
        assert_eq!(scenes, expected.concat());
        let moved = |clip: &Clip| clip.moves.iter().map(|one| one.param.clone()).collect::<Vec<_>>();
        assert_eq!(moved(&found[1]), ["picture brightness"], "parameters of the refused scene are dropped");
        assert_eq!(found[4], clips[4]);
        assert_eq!(with_substitutes(&clips, &cards, |_| true), None);
    }
}
