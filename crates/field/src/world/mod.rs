//! A world: a checked scene, prepared for drawing.
//!
//! ```text
//! Scene → planes, which are solved exactly, and the rest → bounds of the rest → programs: tapes and GLSL
//! ```
//!
//! Everything here is computed once per scene, on any thread. The crate `mariana-render` adds the values of each
//! frame and draws with OpenGL. No scene is special: everything in an image comes from the scene's text.

use std::sync::Arc;

use image::RgbaImage;

use crate::graph::{FrameInputs, Graph, GraphError, NodeId, Point, ScreenInput};
use crate::lang::{Diagnostic, Material, Object, Scene, compile, no_includes};
use crate::tape::Tape;
use media::MEDIUM_NUMBERS;

mod blend;
mod bounds;
mod cells;
mod compiled;

mod distance_check;
mod feedback;
mod hoist;
mod interpreted;
mod media;
mod mesh;
mod motions;
mod nearby_light;
mod planes;
mod scene_features;
mod shortening;
mod swarm;

pub use crate::bounds::Bounds;
pub use blend::{Alignment, BlendError, BlendKind, PortalShape};
pub use compiled::{FrameTape, FrameValues};
pub use distance_check::Slopes;
pub use feedback::{Feedback, WARP_CELLS};
pub use hoist::Hoisted;
pub use interpreted::{Cost, TapeBuffers};
pub use mesh::{Mesh, MeshError, Vertex};
pub use motions::{Motions, Moving};
pub use planes::{PLANES_MAX, Plane, Rest};
pub use scene_features::SceneFeatures;
pub use shortening::{ShortPrograms, ShortenOptions, ShortenRequest, WorthShortening};
pub use swarm::{POINT_TEXELS_MAX, SwarmPicture, SwarmPlan, SwarmView, TILE_PARTS, WIDEST};
// The kinds of lights, and the tone maps.
pub use crate::lang::{LightKind, ToneMap};

/// A reason for which a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// The text is not a scene.
    #[error("{0}")]
    Text(String),
    /// The scene has too many expressions.
    #[error("{scene}: {source}")]
    TooLarge {
        /// The scene.
        scene: String,
        /// The cause.
        source: GraphError,
    },
    /// The generated GLSL is invalid.
    #[error(
        "the GLSL generated for {scene} is invalid: this is a bug in Mariana; show the \
         scene with --sdf interpreted and report it\n{reason}"
    )]
    Refused {
        /// The scene.
        scene: String,
        /// The message of naga.
        reason: String,
    },
}

impl WorldError {
    /// Returns a function that adds the scene to an error.
    fn of(scene: &str) -> impl Fn(GraphError) -> Self {
        move |source| Self::TooLarge { scene: scene.to_owned(), source }
    }
}

/// The expressions that the shader evaluates: programs of the interpreter and functions of the compiled shader.
#[derive(Debug, Clone, PartialEq)]
pub struct Roots {
    /// For the surfaces that are not planes: the length of a ray's step, and the distance to an actual surface. The
    /// input for the normal's x holds the penumbra: the distance beyond which a surface casts no shadow, or 0.
    pub distance: [NodeId; 2],
    /// For the surfaces that are not planes: the number of the nearest object.
    pub object: NodeId,
    /// The numbers of each material, in the order of [`Material::numbers`](crate::lang::Material::numbers).
    pub materials: Vec<Vec<NodeId>>,
    /// The light from a direction.
    pub sky: [NodeId; 3],
    /// The light on a surface from all directions.
    pub ambient: [NodeId; 3],
    /// The emission near a point, and the distance to the nearest shining object; black if no object shines.
    pub glow: [NodeId; 4],
    /// The sum of the media at a point (`media`); `None` without media.
    pub medium: Option<[NodeId; MEDIUM_NUMBERS]>,
}

impl Roots {
    /// Returns all expressions.
    pub fn all(&self) -> impl Iterator<Item = NodeId> + '_ {
        let rest = [self.object].into_iter().chain(self.sky).chain(self.ambient).chain(self.glow);
        let light = self.distance.into_iter().chain(rest).chain(self.medium.into_iter().flatten());
        light.chain(self.materials.iter().flatten().copied())
    }

    fn map(&self, new: impl Fn(NodeId) -> NodeId) -> Self {
        Self {
            distance: self.distance.map(&new),
            object: new(self.object),
            materials: self
                .materials
                .iter()
                .map(|material| material.iter().map(|number| new(*number)).collect())
                .collect(),
            sky: self.sky.map(&new),
            ambient: self.ambient.map(&new),
            glow: self.glow.map(&new),
            medium: self.medium.map(|numbers| numbers.map(&new)),
        }
    }
}

/// A scene that can be drawn.
#[derive(Debug, Clone)]
pub struct World {
    /// The name in messages and in the title.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// The expressions of [`World::roots`], without the parts that are constant within a frame.
    pub graph: Graph,
    /// The parts that are constant within a frame, which are computed once per frame.
    pub hoisted: Hoisted,
    /// The surfaces that are planes, each with its object.
    pub planes: Vec<Plane>,
    /// True if there are surfaces other than planes.
    pub has_rest: bool,
    /// Bounds of the surfaces that are not planes, for all sounds and times; `None` if unknown.
    pub bounds: Option<Bounds>,
    /// A box around all media, for all sounds and times. A side without a bound is infinite.
    pub medium_bounds: Bounds,
    /// True if the value of the surfaces that are not planes is not a distance: its slope is above 1, or far below 1 at
    /// surfaces. Rays then need bounds of the value's slopes.
    pub non_lipschitz: bool,
    /// The slopes of a value that is not a distance.
    pub slopes: Slopes,
    /// The parts of the shaders that the scene needs.
    pub features: SceneFeatures,
    /// The expressions that the shader evaluates.
    pub roots: Roots,
    /// The values that the CPU computes once per frame.
    pub frame_tape: FrameTape,
    /// For a blend, the number of parameters that belong to the outgoing scene.
    pub blended: Option<usize>,
    /// The images of [`Scene::textures`].
    pub pictures: Vec<Arc<RgbaImage>>,
}

impl World {
    /// Prepares the scene of a text without includes and textures.
    ///
    /// # Errors
    /// Fails if the text has mistakes, or if the scene exceeds the limits on nodes or clauses.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        let mut compiled = compile(name, text, &mut no_includes);
        let Some(scene) = compiled.scene.take() else {
            return Err(WorldError::Text(compiled.render(false)));
        };
        Self::new(name, scene, Vec::new())
    }

    /// Prepares a scene. `pictures` are the images of its textures, in their order.
    ///
    /// # Errors
    /// Fails if the scene exceeds the limit on nodes.
    pub fn new(name: &str, mut scene: Scene, pictures: Vec<Arc<RgbaImage>>) -> Result<Self, WorldError> {
        let (planes, rest) = planes::split(&mut scene);
        let frame_tape = FrameTape::new(&scene, &planes);
        let traced = match &rest {
            Some(rest) => Traced::of(&mut scene, rest.bound, &frame_tape),
            None => Traced::default(),
        };
        let glow = nearby_light::nearby_light(&mut scene, traced.non_lipschitz);
        let medium = media::sum(&mut scene);
        Self::prepared(name, scene, Surfaces { planes, rest, glow, medium }, traced, frame_tape, pictures)
    }

    /// Returns this world, seen by the camera with the given index in [`Scene::cameras`]; unchanged if there is no such
    /// camera. The programs stay the same.
    pub fn seen_by(&self, camera: usize) -> Self {
        let mut world = self.clone();
        if let Some((_, camera)) = self.scene.cameras.get(camera) {
            world.scene.camera = camera.clone();
            world.frame_tape = FrameTape::new(&world.scene, &world.planes);
        }
        world
    }

    /// Growth of a shadow ray's shortest step with each step. It is 0 in a single scene, where shadow rays move away from
    /// surfaces. In a blend, a lamp of one scene may be inside a surface of the other scene, and shadow rays creep along
    /// that surface.
    pub fn shadow_step_growth(&self) -> f32 {
        if self.features.blend { SHADOW_STEP_GROWTH } else { 0.0 }
    }

    /// True if the pointer over the picture changes it.
    pub fn follows_pointer(&self) -> bool {
        use ScreenInput::{MousePressed, MouseX, MouseY};
        [MouseX, MouseY, MousePressed].iter().any(|input| self.frame_tape.screen_inputs.contains(input))
    }

    /// Prepares a scene that is already split into planes and other surfaces, and whose formula is analysed.
    fn prepared(
        name: &str,
        mut scene: Scene,
        Surfaces { planes, rest, glow, medium }: Surfaces,
        traced: Traced,
        frame_tape: FrameTape,
        pictures: Vec<Arc<RgbaImage>>,
    ) -> Result<Self, WorldError> {
        let medium_bounds = match &medium {
            Some(medium) => {
                let any = any_frame(&scene);
                media::bounds(&mut scene.graph, medium, &any)
            }
            None => Bounds::around([0.0; 3], 0.0),
        };
        let (has_glow, has_media) = (glow.is_some(), medium.is_some());
        let nothing = scene.graph.constant(0.0);
        let roots = Roots {
            distance: rest.map_or([nothing; 2], |rest| [rest.bound, rest.estimate]),
            object: rest.map_or(nothing, |rest| rest.object),
            materials: scene.materials.iter().map(Material::numbers).collect(),
            sky: scene.sky.color,
            ambient: scene.sky.ambient,
            glow: glow.unwrap_or([nothing; 4]),
            medium,
        };
        scene.graph.check().map_err(WorldError::of(name))?;
        let Traced { bounds, non_lipschitz, slopes, is_blend } = traced;
        let features = SceneFeatures::of(&scene, has_glow, has_media, is_blend);
        let (graph, roots, hoisted) = hoist::hoist(&scene.graph, &roots);
        Ok(Self {
            name: name.to_owned(),
            has_rest: rest.is_some(),
            bounds,
            non_lipschitz,
            slopes,
            medium_bounds,
            features,
            roots,
            graph,
            hoisted,
            frame_tape,
            planes,
            scene,
            blended: None,
            pictures,
        })
    }

    /// Returns a warning if the shape's value is not a distance and a factor makes it one; at the first object. A formula
    /// without such a factor is drawn as its author wrote it.
    pub fn warning(&self) -> Option<Diagnostic> {
        let object = self.scene.objects.first().filter(|_| self.non_lipschitz)?;
        let factor = self.slopes.distance_factor?;
        let message =
            "the shape's value is not a distance, so rays take short steps and its shadows are sharp";
        let hint = format!("multiply the value by {factor:.2} to make it a distance");
        Some(Diagnostic::warning(object.span, message).hint(hint))
    }

    /// Returns the object whose body contains a point. An eye there sees only the body's inside. Planes have no
    /// inside, and one can look through glass. `inputs` have the hoisted values.
    pub fn object_around(&self, [x, y, z]: [f32; 3], inputs: &FrameInputs) -> Option<&Object> {
        let roots = [self.roots.distance[1], self.roots.object];
        let values = self.graph.evaluate(&roots, &Point::at(x, y, z), inputs);
        let [distance, number] = values.first_chunk()?;
        let object = self.scene.objects.get(*number as usize).filter(|_| self.has_rest && *distance < 0.0)?;
        let glass = self.scene.materials.get(object.material)?.glass;
        self.scene.graph.as_constant(glass).is_some_and(|glass| glass <= 0.0).then_some(object)
    }
}

/// The value of [`World::shadow_step_growth`] in blends. A shadow ray that creeps along a surface then travels about 20
/// units. Tried: the same growth for the distance at which a ray hits, so that rays along the last rock of a tunnel
/// end. With twice this growth a speck appeared in the sky where there was no surface.
const SHADOW_STEP_GROWTH: f32 = 0.004;

struct Surfaces {
    planes: Vec<Plane>,
    rest: Option<Rest>,
    glow: Option<[NodeId; 4]>,
    medium: Option<media::MediumRoots>,
}

/// The inputs of all frames of a scene.
fn any_frame(scene: &Scene) -> FrameInputs {
    let params = scene.params.iter().map(|param| (param.min, param.max));
    FrameInputs::any(scene.graph.ranges(params), &scene.atlas)
}

/// A normalized value stops growing at this distance from surfaces, as a fraction of half the size of the bounds.
const NORMALIZED_FRACTION: f32 = 1.0;
const TAMED_REACH: f32 = 8.0;

#[derive(Default)]
struct Traced {
    bounds: Option<Bounds>,
    non_lipschitz: bool,
    slopes: Slopes,
    is_blend: bool,
}

impl Traced {
    fn of(scene: &mut Scene, distance: NodeId, frame_tape: &FrameTape) -> Self {
        let any = any_frame(scene);
        let bounds = bounds::find(&scene.graph, distance, &any, false);
        let slopes = untrusted(scene, distance).and_then(|checked| {
            let tape = Tape::new(&scene.graph, &[checked]);
            let around = |inputs: &FrameInputs| match bounds {
                Some(bounds) => vec![bounds],
                None => distance_check::around(frame_tape.values(inputs).camera.target),
            };
            let frames =
                distance_check::frames(&scene.params, &scene.atlas).map(|inputs| (around(&inputs), inputs));
            let reach = bounds.map_or(TAMED_REACH, |bounds| NORMALIZED_FRACTION * bounds.half());
            distance_check::tamed(&tape, frames, bounds.as_ref(), reach)
        });
        let non_lipschitz = slopes.is_some();
        // Far away, an estimate that the scene trusts may be larger than the distance.
        let is_distance = !non_lipschitz && !scene.objects.iter().any(|object| object.trusted);
        let bounds = match bounds {
            None if is_distance => bounds::find(&scene.graph, distance, &any, true),
            found => found,
        };
        Self { bounds, non_lipschitz, slopes: slopes.unwrap_or_default(), ..Self::default() }
    }
}

/// The part of `distance` that is checked for being a distance: all but the shapes that the scene trusts.
fn untrusted(scene: &mut Scene, distance: NodeId) -> Option<NodeId> {
    if !scene.objects.iter().any(|object| object.trusted) {
        return Some(distance);
    }
    let shapes = scene.objects.iter().filter(|object| !object.trusted).map(|object| object.shape);
    let shapes: Vec<NodeId> = shapes.collect();
    shapes.into_iter().reduce(|a, b| scene.graph.min(a, b))
}

#[cfg(test)]
pub(crate) mod testing {
    use super::World;

    pub(crate) const SPEAKERS: &str = include_str!("../../../../tests/oracle/speakers.scene");

    pub(crate) fn world_of(text: &str) -> World {
        World::parse("test", text).unwrap()
    }
}
