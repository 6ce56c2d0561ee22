//! A checked scene: one graph, and the meaning of its nodes.
//!
//! **Bounds and estimates.** A shape may leave out parts. For example, it may measure only the nearest two of 32 bars.
//! An object's `bound` is then a lower bound of the distance to the parts that are left out, and rays step by the
//! lesser of bound and shape. Penumbras and occlusion use only the shape (the estimate), because a bound would cast
//! shadows of objects that do not exist (Abt 2022, figure 12). Where rays step by the bound, the estimate is larger, so
//! that no shadow is cast there.

use std::path::PathBuf;
use std::sync::Arc;

use super::about::About;
use super::builtin::uses::{DIRECTION, EYE, FRAME, INDEX, NOTHING, PIXEL, POINT, SCREEN, TEXTURE};
use super::fields::DefaultValue::{Each, Library, Parts};
use super::fields::{choices, section};
use super::material::Material;
use super::origins::Origins;
use super::shape::ShapeRef;
use super::source::Span;
use crate::graph::{FrameInputs, Graph, Interval, NodeId, ShapeAtlas};

/// A scene without mistakes. All [`NodeId`]s refer to [`Scene::graph`].
#[derive(Debug, Clone)]
pub struct Scene {
    /// The expressions.
    pub graph: Graph,
    /// The objects; empty for a scene of sky alone.
    pub objects: Vec<Object>,
    /// The union of all objects: the minimum of their shapes, or a large number without objects. Depends on the point
    /// and the frame.
    pub distance: NodeId,
    /// The materials of the objects; at least one.
    pub materials: Vec<Material>,
    /// The lights; at least one.
    pub lights: Vec<Light>,
    /// The media that fill space, such as fog and clouds.
    pub media: Vec<Medium>,
    /// The swarms of points.
    pub swarms: Vec<Swarm>,
    /// The default camera.
    pub camera: Camera,
    /// The named cameras.
    pub cameras: Vec<(String, Camera)>,
    /// The background, which is visible where rays hit nothing.
    pub sky: Sky,
    /// True if the text sets the sky's colour.
    pub has_own_sky: bool,
    /// Exposure, tone map and other effects.
    pub picture: Picture,
    /// The contents of the block `about`.
    pub about: About,
    /// The parameters, shown as sliders; `Input::Param(i)` is the i-th.
    pub params: Vec<Param>,
    /// The textures. Their indices are the texture numbers in the graph.
    pub textures: Vec<TextureRef>,
    /// The texts and pictures that shapes read. Their indices are their numbers in the graph.
    pub shapes: Vec<ShapeRef>,
    /// The distances to [`Scene::shapes`], in the same order. The loader of scenes sets them.
    pub atlas: ShapeAtlas,
    /// Paths of the files that were included, in the order in which they were read.
    pub includes: Vec<String>,
    /// The locations of nodes in the text; empty for a scene that blends two scenes.
    pub origins: Arc<Origins>,
}

impl Scene {
    /// True if both scenes have the same expressions, node by node, and the same objects, materials, lights, cameras,
    /// parameters and textures, apart from their names. The texts and the locations in them may differ.
    pub fn draws_the_same(&self, other: &Self) -> bool {
        let shape = |object: &Object| (object.shape, object.bound, object.material);
        let range = |param: &Param| (param.default, param.min, param.max, param.is_number);
        let nameless = |material: &Material| Material { name: String::new(), ..material.clone() };
        self.graph.is_same(&other.graph)
            && self.objects.iter().map(shape).eq(other.objects.iter().map(shape))
            && self.distance == other.distance
            && self.materials.iter().map(nameless).eq(other.materials.iter().map(nameless))
            && self.lights == other.lights
            && (&self.media, &self.swarms) == (&other.media, &other.swarms)
            && self.camera == other.camera
            && self.cameras.iter().map(|one| &one.1).eq(other.cameras.iter().map(|one| &one.1))
            && (&self.sky, self.has_own_sky, &self.picture) == (&other.sky, other.has_own_sky, &other.picture)
            && self.about == other.about
            && self.params.iter().map(range).eq(other.params.iter().map(range))
            && self.textures.iter().map(|one| &one.name).eq(other.textures.iter().map(|one| &one.name))
            && self.shapes.iter().map(|one| &one.source).eq(other.shapes.iter().map(|one| &one.source))
            && self.atlas == other.atlas
    }
}

/// A shape with its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// The name; `shape` for a bare expression.
    pub name: String,
    /// The location of its declaration.
    pub span: Span,
    /// The distance function. Depends on the point and the frame.
    pub shape: NodeId,
    /// A lower bound of the distance to everything that the shape leaves out. Rays step by the lesser of bound and
    /// shape. Shadows and occlusion, which need actual surfaces, use only the shape.
    pub bound: Option<NodeId>,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// True if rays may step by the shape's value although its slope exceeds 1, as with an estimate of the distance to
    /// a fractal.
    pub trusted: bool,
}

/// A row: documentation, variant, name in shaders, and the field that [`Light::place`] returns.
macro_rules! define_light_kinds {
    ($( $(#[$documentation:meta])* $kind:ident, $name:literal, $place:ident; )*) => {
        /// The kind of a light.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum LightKind { $( $(#[$documentation])* $kind, )* }

        impl LightKind {
            /// All kinds with their names in shaders, in the order of their numbers, which begin with 1.
            pub const ALL: [(Self, &'static str); [$($name),*].len()] = [$( (Self::$kind, $name), )*];
        }

        impl Light<f32> {
            /// Returns the light's position, or the direction of the rays if the light is infinitely far away.
            pub fn place(&self) -> [f32; 3] {
                match self.kind { $( LightKind::$kind => self.$place, )* }
            }
        }
    };
}

// A new kind needs three changes: its row here (and its special fields in [`Light`]), the fields that select it in
// `lower::lights`, and its rays in `shaders/light.glsl`, which does not compile until it handles all kinds.
define_light_kinds! {
    /// A point or, with a radius, a ball. Its light falls off with the square of the distance.
    Lamp, "LAMP", position;
    /// Parallel light from infinitely far away.
    Sun, "SUN", direction;
    /// A rectangle. It emits light on one side, in the direction of the cross product of its sides.
    Panel, "PANEL", position;
}

section! {
    /// A light. Its values depend only on the frame.
    Light {
        /// The kind.
        kind: LightKind,
    }
    position: Vector = Each(0.0), FRAME, "The position; for a panel, its centre. Unused for a sun.";
    direction: Vector = Each(0.0), FRAME, "The direction in which a sun's rays travel, of any length but 0.";
    color: Vector = Each(1.0), FRAME,
        "The strength in red, green and blue: the light that arrives at distance 1 or, for a sun, everywhere. For a \
         panel, its brightness in the units of `emission`.";
    radius: Number = Each(0.0), FRAME, FROM_0,
        "Radius of the shining ball; for a sun, the tangent of its half angle. A larger radius makes shadows softer.";
    range: Number = Each(0.0), FRAME, FROM_0, "Distance at which the light has faded to 0. A range of 0 means no limit.";
    shadow: Number = Each(1.0), FRAME, FRACTION, "Fraction of the light that shadows remove, 0..1.";
    right: Vector = Each(0.0), FRAME, "From a panel's centre to the middle of its right side; else 0.";
    up: Vector = Each(0.0), FRAME, "From a panel's centre to the middle of its upper side; else 0.";
}

section! {
    /// A medium: fog, smoke, a cloud, an aurora. Light is absorbed and scattered on its way through the medium.
    Medium {}
    density: Number = Each(0.1), POINT | FRAME | EYE, FROM_0,
        "Fraction of the light that is lost per unit of length, in thin fog: light falls to 1/e over a length of \
         1 / density.";
    color: Vector = Each(1.0), POINT | FRAME | EYE, FRACTION, "The colour of the scattered light, 0..1.";
    scatter: Number = Each(1.0), POINT | FRAME | EYE, FRACTION,
        "Fraction of the lost light that is scattered, 0 dark smoke .. 1 fog; the rest is absorbed.";
    emission: Vector = Each(0.0), POINT | FRAME | EYE, FROM_0,
        "Light that the medium emits per unit of length. It does not depend on the density.";
    phase: Number = Each(0.0), POINT | FRAME | EYE, PHASE,
        "The direction in which light is scattered: 0 all directions alike, towards 1 forward, so that fog is bright \
         around a light, towards -1 backward.";
    shape: Shape = Each(-1.0), POINT | FRAME | EYE,
        "Distance to the space that the medium fills. Outside of that space there is no medium.";
}

section! {
    /// A swarm: many points, such as sparks, dust, rain or fireflies. Each value is a function of the point's number.
    Swarm {
        /// The number of points, which [`Swarm::count`] holds as an expression.
        points: usize,
    }
    count: Number = Each(1000.0), NOTHING, "The number of points, a whole number that never changes.";
    position: Vector = Each(0.0), INDEX | FRAME | EYE, "The position of the point `index`.";
    size: Number = Each(0.02), INDEX | FRAME | EYE, FROM_0, "Radius of the ball around the position; 0 for no ball.";
    color: Vector = Each(1.0), INDEX | FRAME | EYE, FRACTION, "The colour of the ball, 0..1.";
    emission: Vector = Each(0.0), INDEX | FRAME | EYE, FROM_0, "Light that the ball emits.";
    glow: Vector = Each(0.0), INDEX | FRAME | EYE, FROM_0,
        "Light that surrounds the place: its strength in the middle. It does not light surfaces.";
    reach: Number = Each(0.3), INDEX | FRAME | EYE, FROM_0, "Distance at which the glow has faded to 0.";
    stretch: Vector = Each(0.0), INDEX | FRAME | EYE,
        "From the place to the end of a streak: ball and glow are drawn out along this way.";
}

section! {
    /// A camera. Its values depend only on the frame. The default camera shows the unit ball at the origin and the
    /// ball of the thesis at (1, 1, 6).
    Camera {}
    position: Vector = Parts([0.0, 2.0, -5.0]), FRAME, "The eye.";
    target: Vector = Parts([0.0, 0.5, 0.0]), FRAME, "The point at which the camera looks.";
    fov: Number = Each(45.0), FRAME, FOV,
        "Vertical field of view in degrees. It widens, to at most 100, in a picture higher than wide, which shows as \
         much from left to right as a square one.";
    roll: Number = Each(0.0), FRAME,
        "Roll around the line of sight in radians; positive values turn the image clockwise.";
    aperture: Number = Each(0.0), FRAME, LENS, "Radius of the lens. With 0 the image is sharp everywhere.";
    focus: Number = Each(f32::INFINITY), FRAME,
        "Distance in focus. If it is not finite, the target is in focus.";
    keep: Number = Each(0.0), FRAME,
        "Width at the target that always stays visible: in a narrow window the camera moves back to show it. 0 for no \
         such width.";
}

section! {
    /// The background. The default is a dusk that is brightest at the horizon, so that no ray ends in black.
    Sky {}
    color: Vector = Library("default_sky"), DIRECTION | TEXTURE | FRAME | EYE | PIXEL | SCREEN,
        "Light from the given direction, or at the given pixel.";
    ambient: Vector = Library("default_ambient"), DIRECTION | FRAME | EYE,
        "Ambient light on a surface whose normal has the given direction.";
    reach: Number = Each(1.1), FRAME, FROM_0,
        "Distance from a surface within which other objects block ambient light and replace it by their own light.";
    bounce: Number = Each(0.0), FRAME, FRACTION,
        "Fraction of the light that surfaces within the reach throw on each other, 0..1: one bounce, as if both had the \
         same colour.";
}

section! {
    /// The conversion of light to the colours of the image. Its values depend only on the frame. The default has a
    /// slight glow around bright areas, and grain too weak to be seen.
    Picture {}
    exposure: Number = Each(1.0), FRAME | SCREEN, EXPOSURE, "Factor by which light is multiplied.";
    bloom: Number = Each(0.04), FRAME | SCREEN, FRACTION, "Fraction of the light that is scattered around bright areas, 0..1.";
    vignette: Number = Each(0.0), FRAME | SCREEN, FRACTION, "Fraction of the light that is lost in the corners, 0..1.";
    grain: Number = Each(1.0), FRAME | SCREEN, GRAIN, "Strength of the grain, in steps of 1/255.";
    tone_map: ToneMap = Each(ToneMap::Agx.number()), NOTHING,
        "The number of the [`ToneMap`], which converts light to a colour of the screen.";
    decay: Number = Each(0.0), FRAME | SCREEN, DECAY,
        "Fraction of the last frame's light that stays, at 60 frames a second: trails. The brighter of the trails and \
         the scene is visible. 0 for no trails.";
    warp: Place = Each(f32::INFINITY), FRAME | SCREEN | PIXEL,
        "The place in the last frame from which the trails at `pixel` come, as in `previous`; beyond 0..1 they are \
         black. If it is infinite, the trails stay in place.";
    blur: Number = Each(0.0), FRAME | SCREEN, BLUR,
        "Radius of the blur of the trails in each frame, in heights of the picture, 0..0.02.";
    memory: Number = Each(0.0), NOTHING,
        "Seconds of earlier frames that a frame may depend on, up to 10. 0 derives them from `decay`; a scene that \
         calls `previous` has at least 2.";
}

impl Picture {
    /// Returns an upper bound of `decay` over all frames; `any` are the inputs of all frames. Not limited to a useful
    /// range; 0 for a constant NaN.
    pub(crate) fn largest_decay(&self, graph: &Graph, any: &FrameInputs) -> f32 {
        match graph.as_constant(self.decay) {
            Some(constant) if constant.is_nan() => 0.0,
            Some(constant) => constant,
            None => {
                let bounds = graph.bounds(self.decay, [Interval::ANY; 6], any);
                if bounds.is_any() { f32::INFINITY } else { bounds.hi }
            }
        }
    }
}

choices! {
    /// The tone map, which converts light to a colour of the screen. `shaders/tone_map.glsl` has the same numbers.
    #[derive(Default)]
    ToneMap {
        /// AgX (Troy Sobotka): a film-like curve in which bright colours fade to white.
        #[default]
        Agx, "agx";
        /// ACES, fitted (Stephen Hill). It has more contrast, and the hue shifts as colours get brighter.
        Aces, "aces";
        /// Extended Reinhard on luminance (Abt 2022, section 3.2): hues stay the same until a component is clipped.
        Reinhard, "reinhard";
        /// No tone map: light of 0..1 is unchanged, brighter light is clipped to 1.
        None, "none";
    }
}

/// A parameter of a scene: a number that the user sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// The name.
    pub name: String,
    /// The initial value; `min <= default <= max`, all finite.
    pub default: f32,
    /// Minimum.
    pub min: f32,
    /// Maximum.
    pub max: f32,
    /// True for a number of the text that is being edited. Such a parameter has no name, and follows all named
    /// parameters. Its range is a single value, except while the number is being dragged.
    pub is_number: bool,
    /// The location of the declaration, or of the number in the text.
    pub span: Span,
}

/// A texture that a scene reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureRef {
    /// The path relative to the scene's folder, with `/` between folders. It never leads out of the folder.
    pub name: String,
    /// The location of its first use.
    pub span: Span,
    /// Set by the loader of scenes if the picture changes during the song; `None` for an image.
    pub moves: Option<MovingTexture>,
}

impl TextureRef {
    /// Returns the last frame as a texture. No file has its empty name.
    pub(super) fn last_frame(span: Span) -> Self {
        Self { name: String::new(), span, moves: None }
    }

    /// True for the last frame, which scenes read by `previous`.
    pub fn is_last_frame(&self) -> bool {
        self.name.is_empty()
    }
}

/// A texture whose picture changes during the song. The loader of scenes finds out which source its name means.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct MovingTexture {
    /// The file of the pictures; empty if the source is no file.
    pub file: PathBuf,
    /// Changes when the file changes.
    pub version: u64,
}
