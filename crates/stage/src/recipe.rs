//! The recipe of a frame: the scenes that a show draws at a moment, one over the other.

use super::prepared_show::PreparedShow;
use mariana_field::world::World;
use mariana_music::Sound;
use mariana_render::frame::held_inputs::HeldInputs;
use mariana_render::frame::orbit_controls::OrbitControls;
use mariana_render::frame::{Frame, FrameOptions};
use mariana_scenes::{SceneSource, camera_number};
use mariana_show::{Clip, Moment};

/// What a show draws at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe<'a> {
    /// The scenes to draw, from the lowest to the highest. There is at least one.
    pub layers: Vec<Layer<'a>>,
    /// Factor on the linear light of the finished image, 0..1.
    pub brightness: f32,
}

/// A scene, or a blend of two scenes, in a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer<'a> {
    /// The scene or blend.
    pub source: SceneSource,
    /// The moment of the song that is drawn, in seconds. A frozen frame shows an earlier moment.
    pub time: f64,
    /// The clip; in a blend, the incoming one.
    pub clip: &'a Clip,
    /// In a blend, the outgoing clip and the fraction of the incoming one, between 0 and 1.
    pub leaving: Option<(&'a Clip, f32)>,
    /// The weight of all earlier layers in the mix with this one, 0..1; `None` for the first layer.
    pub below: Option<f32>,
}

impl PreparedShow {
    /// Returns what the show draws at `time` seconds; `None` without a timeline. `exposed` is the moment of the scenes that
    /// are not frozen; the shutter is open then. A fade replaces each blend of worlds that `can_blend` refuses.
    pub fn recipe(
        &self,
        time: f64,
        exposed: f64,
        can_blend: impl Fn(&SceneSource) -> bool,
    ) -> Option<Recipe<'_>> {
        let timeline = self.timeline()?;
        let mut held = timeline.held_at(time);
        let lowest = held.last().map_or(exposed, |oldest| oldest.since);
        let mut layers = self.layers(timeline.at(lowest), lowest, &can_blend)?;
        // Later frozen frames, and then the frame of the moment, cover the oldest one. If a scene is fading out in them, it
        // is left out.
        while let Some(lower) = held.pop() {
            let since = held.last().map_or(exposed, |upper| upper.since);
            if lower.fraction < 1.0 || !held.is_empty() {
                let clip = timeline.at(since).clip;
                layers.push(self.layer(clip, since)?.over(lower.fraction));
            }
        }
        Some(Recipe { layers, brightness: timeline.picture_at(time).brightness })
    }

    /// Returns the scenes that are not frozen in the state `moment` of the timeline, for the frame at `time` seconds: one,
    /// or two that fade into each other. `can_blend` is as in [`Self::recipe`].
    pub fn layers<'a>(
        &'a self,
        moment: Moment<'a>,
        time: f64,
        can_blend: impl Fn(&SceneSource) -> bool,
    ) -> Option<Vec<Layer<'a>>> {
        let layer = self.layer(moment.clip, time)?;
        let Some((leaving, fraction)) = moment.leaving else { return Some(vec![layer]) };
        Some(match self.blend(leaving, moment.clip).filter(can_blend) {
            Some(source) => vec![Layer { source, leaving: Some((leaving, fraction)), ..layer }],
            None => vec![self.layer(leaving, time)?, layer.over(1.0 - fraction)],
        })
    }

    fn layer<'a>(&self, clip: &'a Clip, time: f64) -> Option<Layer<'a>> {
        let source = self.source(&clip.scene)?.clone();
        Some(Layer { source, time, clip, leaving: None, below: None })
    }
}

impl Layer<'_> {
    fn over(self, weight: f32) -> Self {
        Self { below: Some(weight), ..self }
    }

    /// Returns the frame of the layer's world in `size` pixels. Its moment is `time`, which is earlier than that of the layer
    /// for frames that the layer's frame remembers.
    pub fn frame(
        &self,
        world: &World,
        time: f64,
        sound: Sound,
        size: (u32, u32),
        held: &HeldInputs,
    ) -> Frame {
        let camera = self.clip.camera.as_deref().filter(|_| self.leaving.is_none());
        let camera = camera_number(world, camera);
        let options = FrameOptions { params: &self.params(world, time), held, camera };
        let frame = Frame::staged(world, time, sound, size, &options);
        frame.by_hand(world, OrbitControls::of_turns(self.clip.turns_at(time)))
    }

    /// The parameters at `time` seconds. A blend has the parameters of the outgoing scene, then of the incoming scene, then
    /// the fraction ([`World::blend`]).
    fn params(&self, world: &World, time: f64) -> Vec<f32> {
        let params = world.scene.params.as_slice();
        let Some(((leaving, fraction), split)) = self.leaving.zip(world.blended) else {
            return self.clip.numbers_at(params, time);
        };
        let (first, second) = params.split_at_checked(split).unwrap_or((params, &[]));
        let mut numbers = leaving.numbers_at(first, time);
        numbers.extend(self.clip.numbers_at(second, time));
        if let Some(last) = numbers.last_mut() {
            *last = fraction;
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShowSource;
    use mariana_music::SongStructure;

    fn show(text: &str) -> PreparedShow {
        let find = |name: &str| SceneSource::find(name);
        PreparedShow::of_text("test.show", text, &SongStructure::default(), find).unwrap().0
    }

    /// Name, moment and weight of the layers below of each layer.
    fn layers(show: &PreparedShow, time: f64) -> Vec<(String, f64, Option<f32>)> {
        let layers = show.recipe(time, time, |_| true).unwrap().layers.into_iter();
        layers.map(|layer| (layer.source.title(), layer.time, layer.below)).collect()
    }

    fn layer(scene: &str, time: f64, below: Option<f32>) -> (String, f64, Option<f32>) {
        (scene.to_owned(), time, below)
    }

    #[test]
    fn a_fade_draws_the_outgoing_scene_first() {
        let show = show(
            "at start orb\nat 10 s city fade over 4 s\nset picture brightness = 1 -> 0 over 2 s after 4 s",
        );
        assert_eq!(layers(&show, 5.0), [layer("orb", 5.0, None)]);
        assert_eq!(layers(&show, 11.0), [layer("orb", 11.0, None), layer("city", 11.0, Some(0.75))]);
        assert_eq!(layers(&show, 14.0), [layer("city", 14.0, None)]);
        assert_eq!(show.recipe(15.0, 15.0, |_| true).unwrap().brightness, 0.5);
        assert!(PreparedShow::default().recipe(1.0, 1.0, |_| true).is_none(), "it has no timeline");
    }

    #[test]
    fn a_fade_replaces_a_blend_that_is_refused() {
        let show = show("at start orb\nset relief = 0.25\nat 10 s metaballs melt over 4 s");
        let recipe = show.recipe(11.0, 11.0, |_| true).unwrap();
        let [blend] = recipe.layers.as_slice() else { panic!("{recipe:?}") };
        assert!(matches!(blend.source, SceneSource::Blend(_)) && blend.leaving.is_some());
        let world = blend.source.ready().unwrap().world;
        let frame = blend.frame(&world, 11.0, Sound::default(), (16, 9), &HeldInputs::default());
        let of = |name: &str| {
            let place = world.scene.params.iter().position(|param| param.name == name).unwrap();
            frame.inputs.params.get(place).copied().unwrap()
        };
        assert_eq!(
            (of("relief"), frame.inputs.params.last()),
            (0.25, Some(&0.25)),
            "the fraction is the last one"
        );
        let recipe = show.recipe(11.0, 11.0, |blend| !matches!(blend, SceneSource::Blend(_))).unwrap();
        let below: Vec<Option<f32>> = recipe.layers.iter().map(|layer| layer.below).collect();
        assert_eq!(below, [None, Some(0.75)]);
    }

    #[test]
    fn a_melt_from_a_scene_to_itself_is_a_fade() {
        let show = show("at start orb\nat 10 s orb melt over 4 s");
        assert_eq!(layers(&show, 11.0), [layer("orb", 11.0, None), layer("orb", 11.0, Some(0.75))]);
    }

    #[test]
    fn frozen_frames_lie_below_the_frame_of_the_moment() {
        let show = show(
            "at start orb\n set picture freeze = 1 -> 0.5 over 2 s after 1 s\n\
             at 3 s city cut\n set picture freeze = 0.5 -> 1 over 0 s -> 0 over 4 s",
        );
        assert_eq!(layers(&show, 2.0), [layer("orb", 0.0, None), layer("orb", 2.0, Some(0.75))]);
        assert_eq!(layers(&show, 3.0), [layer("orb", 0.0, None), layer("city", 3.0, Some(0.5))]);
        let mixed = [layer("orb", 0.0, None), layer("city", 3.0, Some(0.5)), layer("city", 5.0, Some(0.5))];
        assert_eq!(layers(&show, 5.0), mixed);
        assert_eq!(layers(&show, 9.0), [layer("city", 9.0, None)]);
        // A shutter that opens before the frame shows earlier moments of what moves only.
        let exposed = show.recipe(5.0, 4.9, |_| true).unwrap().layers;
        assert_eq!(exposed.iter().map(|layer| layer.time).collect::<Vec<_>>(), [0.0, 3.0, 4.9]);
    }

    #[test]
    fn the_directors_show_has_a_recipe_at_every_moment() {
        let scenes = ["orb", "city"].map(|name| SceneSource::Shipped(name.to_owned()));
        let (show, _) = PreparedShow::of_song(&ShowSource::Auto, &SongStructure::default(), &scenes).unwrap();
        for time in [-1.0, 0.0, 3.0, 1e9] {
            assert!(!show.recipe(time, time, |_| true).unwrap().layers.is_empty());
        }
    }
}
