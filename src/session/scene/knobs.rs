//! The sliders of a scene and the parameters that they control.

use std::rc::Rc;

use crate::scenes::SceneSource;
use mariana_control::{Bound, ChangedBy, Slider};
use mariana_field::world::World;

pub(super) struct Knob {
    /// Index among the world's parameters.
    pub place: usize,
    pub scene: Rc<str>,
}

#[derive(Default)]
pub(super) struct SceneKnobs {
    pub(super) sliders: Vec<Slider>,
    knobs: Vec<Knob>,
}

impl SceneKnobs {
    /// Creates the sliders of a scene. A blend has the sliders of both scenes that it mixes.
    pub(super) fn of(source: &SceneSource, world: &World) -> Self {
        let title: Rc<str> = source.title().into();
        let leaving: Option<(usize, Rc<str>)> = match (source, world.blended) {
            (SceneSource::Blend(blend), Some(split)) => Some((split, blend.from.source.title().into())),
            _ => None,
        };
        let params = world.scene.params.iter().enumerate().filter(|(_, param)| !param.is_number);
        let pairs = params.map(|(place, param)| {
            let scene = leaving.as_ref().filter(|(split, _)| place < *split).map_or(&title, |(_, from)| from);
            let slider = Slider {
                name: param.name.clone(),
                value: param.default,
                min: param.min,
                max: param.max,
                default: param.default,
                changed_by: ChangedBy::Text,
                bound: None,
            };
            (slider, Knob { place, scene: scene.clone() })
        });
        let (sliders, knobs) = pairs.unzip();
        Self { sliders, knobs }
    }

    /// Updates the bindings that the sliders show. `bound` returns the binding of a scene's parameter.
    pub(super) fn update_bindings(&mut self, bound: impl Fn(&str, &str) -> Option<Bound>) {
        for (slider, knob) in self.sliders.iter_mut().zip(&self.knobs) {
            slider.bound = bound(&knob.scene, &slider.name);
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&Slider, &Knob)> {
        self.sliders.iter().zip(&self.knobs)
    }

    pub(super) fn get(&self, place: usize) -> Option<(&Slider, &Knob)> {
        self.sliders.get(place).zip(self.knobs.get(place))
    }

    /// Returns the index of the slider with this name. In a blend, the slider belongs to the incoming scene.
    pub(super) fn place_of(&self, name: &str) -> Option<usize> {
        self.sliders.iter().rposition(|slider| slider.name == name)
    }

    pub(super) fn named(&self, name: &str) -> Option<(&Slider, &Knob)> {
        self.get(self.place_of(name)?)
    }

    pub(super) fn titles(&self) -> Vec<&str> {
        let mut titles: Vec<&str> = self.knobs.iter().map(|knob| &*knob.scene).collect();
        titles.dedup();
        titles
    }
}
