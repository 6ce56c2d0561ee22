//! The optional parts of the shaders that a scene needs, such as panels, mirrors, glass, a lens, media.
//!
//! Parts that a scene does not need are not compiled, because a renderer that never skips a branch would compute them
//! in vain.

use crate::graph::{Input, NodeId};
use crate::lang::{LightKind, Material, Scene};

/// Declares the features: each with its define in the shaders, and true unless only few scenes need its code.
macro_rules! features {
    ($($(#[doc = $doc:literal])+ $name:ident, $define:literal, $is_usual:literal;)+) => {
        /// Parts of the shaders that only some scenes need.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct SceneFeatures { $($(#[doc = $doc])+ pub $name: bool,)+ }

        impl SceneFeatures {
            /// All features except those whose code few scenes need.
            pub const USUAL: Self = Self { $($name: $is_usual,)+ };

            /// Returns these features and all usual ones.
            pub fn with_usual(self) -> Self {
                Self { $($name: self.$name | Self::USUAL.$name,)+ }
            }

            /// Returns the shader defines of these features.
            pub fn defines(self) -> impl Iterator<Item = &'static str> {
                let all = [$((self.$name, $define),)+ (self.body(), "BODY")];
                all.into_iter().filter_map(|(is_there, define)| is_there.then_some(define))
            }
        }
    };
}

features! {
    /// Rectangular lights.
    panels, "PANELS", true;
    /// Mirroring surfaces.
    mirrors, "MIRRORS", true;
    /// Rough mirrors.
    blur, "BLUR", true;
    /// Shining objects.
    glow, "GLOW", true;
    /// A lens with depth of field.
    lens, "LENS", true;
    /// A blend of two scenes. A lamp of one scene may be inside a surface of the other scene.
    blend, "BLEND", true;
    /// A sky that depends on the picture's pixel.
    pixel, "PIXEL", true;
    /// Fog and other media.
    media, "MEDIA", false;
    /// Swarms of points.
    swarm, "SWARM", false;
    /// Glass.
    glass, "GLASS", false;
    /// Translucent bodies.
    translucent, "TRANSLUCENT", false;
    /// Thin films and velvet.
    sheen, "SHEEN", false;
    /// Light that nearby surfaces throw on each other.
    bounce, "BOUNCE", false;
}

impl SceneFeatures {
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
            pixel: used.inputs.contains(&Input::X) || used.inputs.contains(&Input::Y),
        }
    }

    /// True if a material uses the fields that describe how light passes through a body and its layers.
    pub fn body(self) -> bool {
        self.glass || self.translucent || self.sheen
    }

    /// True if these features include all of `other`.
    pub fn covers(self, other: Self) -> bool {
        other.defines().all(|define| self.defines().any(|own| own == define))
    }
}
