//! The optional parts of the shaders that a scene needs, such as panels, mirrors, glass, a lens, media.
//!
//! Parts that a scene does not need are not compiled, because a renderer that never skips a branch would compute them
//! in vain.

use crate::graph::{Input, NodeId};
use crate::lang::{LightKind, Material, Scene};

/// Parts of the shaders that only some scenes need.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SceneFeatures {
    /// Rectangular lights.
    pub panels: bool,
    /// Mirroring surfaces.
    pub mirrors: bool,
    /// Rough mirrors.
    pub blur: bool,
    /// Shining objects.
    pub glow: bool,
    /// A lens with depth of field.
    pub lens: bool,
    /// A blend of two scenes. A lamp of one scene may be inside a surface of the other scene.
    pub blend: bool,
    /// A sky that depends on the picture's pixel.
    pub pixel: bool,
    /// Fog and other media.
    pub media: bool,
    /// Swarms of points.
    pub swarm: bool,
    /// Glass.
    pub glass: bool,
    /// Translucent bodies.
    pub translucent: bool,
    /// Thin films and velvet.
    pub sheen: bool,
    /// Light that nearby surfaces throw on each other.
    pub bounce: bool,
}

impl SceneFeatures {
    /// All features.
    pub const ALL: Self = Self {
        panels: true,
        mirrors: true,
        blur: true,
        glow: true,
        lens: true,
        blend: true,
        pixel: true,
        media: true,
        swarm: true,
        glass: true,
        translucent: true,
        sheen: true,
        bounce: true,
    };
    /// All features except those whose code few scenes need.
    pub const USUAL: Self = Self {
        media: false,
        swarm: false,
        glass: false,
        translucent: false,
        sheen: false,
        bounce: false,
        ..Self::ALL
    };

    pub(super) fn of(scene: &Scene, glow: bool, media: bool, blend: bool) -> Self {
        let some = |value: NodeId| scene.graph.as_constant(value).is_none_or(|value| value > 0.0);
        // The pixel is the position of the sky's program.
        let used = scene.graph.inputs_used(&scene.sky.color);
        let any = |of: fn(&Material) -> NodeId| scene.materials.iter().any(|material| some(of(material)));
        let [mirrors, glass] = [any(|material| material.reflect), any(|material| material.glass)];
        Self {
            panels: scene.lights.iter().any(|light| light.kind == LightKind::Panel),
            mirrors,
            blur: (mirrors || glass) && any(|material| material.blur),
            glow,
            lens: some(scene.camera.aperture),
            blend,
            media,
            swarm: !scene.swarms.is_empty(),
            glass,
            translucent: any(|material| material.translucent),
            sheen: any(|material| material.film) || any(|material| material.velvet),
            bounce: some(scene.sky.bounce),
            pixel: used.is_ok_and(|used| used.inputs.contains(&Input::X) || used.inputs.contains(&Input::Y)),
        }
    }

    /// True if a material uses the fields that describe how light passes through a body and its layers.
    pub fn body(self) -> bool {
        self.glass || self.translucent || self.sheen
    }

    /// Returns these features and all usual ones.
    pub fn with_usual(self) -> Self {
        let Self { media, swarm, glass, translucent, sheen, bounce, .. } = self;
        Self { media, swarm, glass, translucent, sheen, bounce, ..Self::USUAL }
    }

    /// Returns the shader defines of these features.
    pub fn defines(self) -> impl Iterator<Item = &'static str> {
        let all = [
            (self.panels, "PANELS"),
            (self.mirrors, "MIRRORS"),
            (self.blur, "BLUR"),
            (self.glow, "GLOW"),
            (self.lens, "LENS"),
            (self.blend, "BLEND"),
            (self.pixel, "PIXEL"),
            (self.media, "MEDIA"),
            (self.swarm, "SWARM"),
            (self.glass, "GLASS"),
            (self.translucent, "TRANSLUCENT"),
            (self.sheen, "SHEEN"),
            (self.body(), "BODY"),
            (self.bounce, "BOUNCE"),
        ];
        all.into_iter().filter_map(|(is_there, define)| is_there.then_some(define))
    }

    /// True if these features include all of `other`.
    pub fn covers(self, other: Self) -> bool {
        other.defines().all(|define| self.defines().any(|own| own == define))
    }
}
