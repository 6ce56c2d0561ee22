//! A checked scene: one graph, and which of its nodes mean what.
//!
//! **Bounds and estimates.** A shape may leave parts out: of 32 bars only two are measured. An object's `bound` says
//! how far away everything else is at least, and rays step by the lesser of the two. Penumbras and occlusion use the
//! shape alone because a bound would cast shadows of things that do not exist (Abt 2022, figure 12); beyond the bound
//! the estimate grows until it casts none.

use super::material::Material;
use super::source::Span;
use crate::graph::{Graph, NodeId};

/// Three numbers: a point, a direction, or a colour in linear light (red, green, blue).
pub type Vec3 = [NodeId; 3];

/// A scene without mistakes. All [`NodeId`]s are of [`Scene::graph`].
#[derive(Debug, Clone)]
pub struct Scene {
    /// The expressions.
    pub graph: Graph,
    /// At least one.
    pub objects: Vec<Object>,
    /// The union of all objects: the least of their shapes. Depends on the point and the frame.
    pub distance: NodeId,
    /// What objects are made of.
    pub materials: Vec<Material>,
    /// What the scene is lit by; at least one.
    pub lights: Vec<Light>,
    /// Where the scene is seen from.
    pub camera: Camera,
    /// The background, where rays hit nothing.
    pub sky: Sky,
    /// How the scene's light becomes the picture.
    pub picture: Picture,
    /// Sliders; `Input::Param(i)` is the i-th.
    pub params: Vec<Param>,
    /// Textures; texture i of the graph is the i-th.
    pub textures: Vec<TextureRef>,
    /// Paths of the files that were included, in the order in which they were read.
    pub includes: Vec<String>,
}

/// A shape with its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its name; `shape` for a bare expression.
    pub name: String,
    /// Where it was declared.
    pub span: Span,
    /// Its distance function. Depends on the point and the frame.
    pub shape: NodeId,
    /// Where the shape leaves something out (of many bars it may measure only the two that are nearest in x),
    /// everything left out is at least this far away. Rays step by the lesser of bound and shape; shadows and
    /// occlusion, which need actual surfaces, use the shape alone.
    pub bound: Option<NodeId>,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// Where a light's rays come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightPlace {
    /// A point or, with a radius, a ball. Its light falls with the square of the distance.
    At(Vec3),
    /// From infinitely far away, travelling in this direction (of any length but 0).
    Towards(Vec3),
    /// A rectangle around a point: `right` and `up` are half its sides. It shines to the side of their cross product.
    Panel {
        /// The centre of the rectangle.
        at: Vec3,
        /// From the centre to the middle of the right side.
        right: Vec3,
        /// From the centre to the middle of the upper side.
        up: Vec3,
    },
}

/// A light: functions of the frame alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Its name; `default` for the light of a scene that has none.
    pub name: String,
    /// Where its rays come from.
    pub place: LightPlace,
    /// Its strength in red, green and blue: the light that arrives at distance 1 or, for a direction, everywhere. For
    /// a panel its brightness, in the units of `emission`.
    pub color: Vec3,
    /// Radius of the shining ball (for a direction: the tangent of its half angle); softens shadows.
    pub radius: NodeId,
    /// Distance at which its light has faded to nothing; 0 for no limit.
    pub range: NodeId,
    /// Share of its light that shadows remove, 0..1.
    pub shadow: NodeId,
}

/// The camera: functions of the frame alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// The eye.
    pub position: Vec3,
    /// The point it looks at.
    pub target: Vec3,
    /// Vertical field of view in degrees.
    pub fov: NodeId,
    /// Roll around the line of sight in radians; positive values turn the picture clockwise.
    pub roll: NodeId,
    /// Radius of the lens; 0 is sharp everywhere.
    pub aperture: NodeId,
    /// Distance that is in focus; `None` for that of the target.
    pub focus: Option<NodeId>,
    /// Width at the target that is always in the picture: in a narrow window the eye steps back to keep it there. 0
    /// asks for none.
    pub keep: NodeId,
}

/// How the scene's light becomes the picture: functions of the frame alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Factor by which light is multiplied.
    pub exposure: NodeId,
    /// Share of the light that is scattered around its place, 0..1.
    pub bloom: NodeId,
    /// Share of the light that a wide lens loses in the corners, 0..1.
    pub vignette: NodeId,
    /// Strength of the grain, in steps of 1/255.
    pub grain: NodeId,
    /// How light becomes a colour of the screen.
    pub tone_map: ToneMap,
}

/// How light becomes a colour of the screen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// AgX (Troy Sobotka): a film's curve, in which bright colours fade to white.
    #[default]
    Agx,
    /// ACES, fitted (Stephen Hill): more contrast, colours turn as they get brighter.
    Aces,
    /// Extended Reinhard on luminance (Abt 2022, section 3.2): colours stay the same until they are clipped.
    Reinhard,
    /// None: light of 0..1 unchanged, brighter light clipped to 1.
    None,
}

impl ToneMap {
    /// All of them, in the order of their numbers in `shaders/tone_map.glsl`.
    pub const ALL: [ToneMap; 4] = [ToneMap::Agx, ToneMap::Aces, ToneMap::Reinhard, ToneMap::None];

    /// Its name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            ToneMap::Agx => "agx",
            ToneMap::Aces => "aces",
            ToneMap::Reinhard => "reinhard",
            ToneMap::None => "none",
        }
    }
}

/// The background: functions of a direction (read where materials read the normal) and the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// Light from a direction.
    pub color: Vec3,
    /// Light from everywhere on a surface with its normal in that direction.
    pub ambient: Vec3,
    /// Distance from a surface within which other things block that light and give their own: a function of the frame
    /// alone.
    pub reach: NodeId,
}

/// A number that the user sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its value at the start; `min <= default <= max`, all finite.
    pub default: f32,
    /// Least value.
    pub min: f32,
    /// Largest value.
    pub max: f32,
    /// Where it was declared.
    pub span: Span,
}

/// A texture that a scene reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureRef {
    /// Its path below the scene's folder, with `/` between folders; never leads out of it.
    pub name: String,
    /// Where it was first named.
    pub span: Span,
}
