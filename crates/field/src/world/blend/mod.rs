//! Blends: one world that shows the transition from one scene to another.
//!
//! ```text
//! two worlds → two sides in one graph → field, materials, light, camera of both → a world like any other
//! ```
//!
//! **A blend is a scene.** [`World::blend`] combines two worlds; the same programs, tree and views draw the result. The
//! parameters of both worlds come first, then the fraction of the second world, so one program draws every fraction. At
//! the fractions 0 and 1, draw the original worlds, which evaluate only one field.
//!
//! **Mixed quantities.** The light of shining objects is weighted by the fraction of their scene. Lights change in the
//! middle half of the transition, and the tone map changes at the middle. Sky, reach, image settings and camera are
//! mixed. A surface has the material of the nearest object in its scene. In a melt the nearer surface decides which
//! scene that is; in a portal, the side of the portal.

mod alignment;
mod camera;
mod depth;
mod melt;
mod portal;
mod side;
#[cfg(test)]
mod tests;

pub use alignment::Alignment;
pub use portal::PortalShape;

use super::media::{MediumRoots, PHASE};
use super::{Bounds, FrameTape, Plane, Rest, Surfaces, Traced, World, WorldError};
use crate::graph::{Graph, Input, NodeId, Op};
use crate::lang::{About, Light, Material, Object, Param, Picture, Scene, Sky, Swarm, TransitionStyle};
use crate::limits::LIMITS;
use side::{Before, Side, Steps};

/// A kind of transition between two scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlendKind {
    /// The union of both scenes; the first shrinks and the second grows with the fraction.
    Melt,
    /// The second scene is inside a shape that grows with the fraction, the first one outside.
    Portal(PortalShape),
}

impl BlendKind {
    /// All kinds, with their names and descriptions.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (Self::Melt, "melt", "every surface flows from one scene to the other"),
        (Self::Portal(PortalShape::Ball), "ball", "the other scene is inside a growing ball"),
        (Self::Portal(PortalShape::Plane), "plane", "the other scene is behind a moving plane"),
        (Self::Portal(PortalShape::Own), "shape", "the other scene is inside a shape that it names"),
    ];

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(kind, ..)| *kind == self).map_or("", |(_, name, _)| name)
    }

    /// Finds a kind by its name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, known, _)| *known == name).map(|(kind, ..)| kind)
    }

    /// Returns the keyword in scenes and shows.
    pub fn style(self) -> TransitionStyle {
        match self {
            Self::Melt => TransitionStyle::Melt,
            Self::Portal(_) => TransitionStyle::Portal,
        }
    }
}

/// A reason for which two worlds cannot be blended. A fade is always possible, because it draws each world alone.
#[derive(Debug, thiserror::Error)]
pub enum BlendError {
    /// Together the worlds exceed a limit of a single scene.
    #[error(
        "the scenes {from} and {to} together have {count} {what}, but one scene may have at most {max}: fade instead"
    )]
    OverLimit {
        /// The first scene.
        from: String,
        /// The second scene.
        to: String,
        /// The items that exceed the limit, as a plural noun.
        what: &'static str,
        /// The number of both scenes together.
        count: usize,
        /// The limit.
        max: usize,
    },
    /// A scene depends on its earlier frames, which a blend does not have.
    #[error("the scene {0} shows its last frame, so it cannot melt or open a portal: fade instead")]
    Feedback(String),
    /// A melt with glass would show opaque slabs where glass begins to grow.
    #[error("the scene {0} has glass, which cannot melt: fade instead, or open a portal")]
    Glass(String),
    /// The blended scene exceeds the limits of expressions.
    #[error(transparent)]
    World(#[from] WorldError),
}

impl World {
    /// Blends two worlds. `alignment` moves the second one. The last parameter is the fraction of `to`, 0..1, with
    /// the default `fraction`.
    ///
    /// # Errors
    /// Returns a [`BlendError`] if the two worlds together exceed a limit, one of them depends on earlier frames, or one with
    /// glass would melt.
    pub fn blend(
        from: &World,
        to: &World,
        kind: BlendKind,
        alignment: &Alignment,
        fraction: f32,
    ) -> Result<World, BlendError> {
        check_blend(from, to, kind)?;
        let name = format!("{} into {}", from.name, to.name);
        let mut graph = Graph::new();
        graph.reserve(from.scene.graph.len() + to.scene.graph.len());
        let fraction_number = from.scene.params.len() + to.scene.params.len();
        let s = graph.input(Input::Param(fraction_number as u16));
        let before = Before::of(from);
        let a = Side::of(&mut graph, from, Before::default(), &Alignment::NONE);
        let b = Side::of(&mut graph, to, before, alignment);
        let camera = camera::mixed(&mut graph, &a.camera, &b.camera, s);
        let (planes, rest, material) = match kind {
            BlendKind::Melt => {
                let melt = melt::melt(&mut graph, &a, &b, s);
                let material = material(&mut graph, &a.material, &b.material, &melt, s);
                (melt.planes, melt.rest, material)
            }
            BlendKind::Portal(shape) => {
                let portal = portal::distance(&mut graph, shape, &to.scene, before, &camera, s);
                portal::through(&mut graph, &a, &b, portal)
            }
        };
        let rest = rest.map(|rest| clear_of_the_eye(&mut graph, rest, &a, &b));

        let reach = graph.mix(a.sky.reach, b.sky.reach, s);
        let sky = Sky { reach, ..Sky::of(mixed_all(&mut graph, &a.sky.numbers(), &b.sky.numbers(), s)) };
        let glow = glow(&mut graph, &a, &b, reach, s);
        let medium = medium(&mut graph, &a, &b, s);
        let picture = picture(&mut graph, &a.picture, &b.picture, s);
        let (lights, swarms) = (lights(&mut graph, &a, &b, s), swarms(&mut graph, &a, &b, s));
        let all: Vec<NodeId> = planes.iter().copied().chain(rest.iter().map(|rest| rest[0])).collect();
        let nothing = graph.constant(0.0);
        let distance = all.into_iter().reduce(|a, b| graph.min(a, b)).unwrap_or(nothing);
        graph.check().map_err(WorldError::of(&name))?;
        let scene = Scene {
            graph,
            objects: vec![whole(name.clone(), distance)],
            distance,
            materials: vec![Material::of(String::new(), material)],
            lights,
            media: Vec::new(),
            swarms,
            camera,
            cameras: Vec::new(),
            sky,
            has_own_sky: from.scene.has_own_sky || to.scene.has_own_sky,
            picture,
            about: About::default(),
            params: params(from, to, fraction),
            textures: from.scene.textures.iter().chain(&to.scene.textures).cloned().collect(),
            shapes: from.scene.shapes.iter().chain(&to.scene.shapes).cloned().collect(),
            atlas: from.scene.atlas.joined(&to.scene.atlas).unwrap_or_default(),
            includes: Vec::new(),
            origins: Default::default(),
        };
        let has_planes = [&a, &b].iter().any(|side| !side.planes.is_empty());
        // Traced planes are infinite, so there are no bounds.
        let bounds = if has_planes && planes.is_empty() { None } else { bounds(&a, &b) };
        let surfaces = Surfaces {
            planes: planes.into_iter().map(|shape| Plane { shape, object: 0 }).collect(),
            rest: rest.map(|[bound, estimate]| Rest { bound, estimate, object: nothing }),
            glow,
            medium,
        };
        let non_lipschitz = a.non_lipschitz || b.non_lipschitz;
        let traced = Traced { bounds, non_lipschitz, is_blend: true, ..Traced::default() };
        let pictures = from.pictures.iter().chain(&to.pictures).cloned().collect();
        let frame_tape = FrameTape::new(&scene, &surfaces.planes);
        let world = Self::prepared(&name, scene, surfaces, traced, frame_tape, pictures)?;
        Ok(Self { blended: Some(from.scene.params.len()), ..world })
    }
}

fn params(from: &World, to: &World, fraction: f32) -> Vec<Param> {
    let fraction = Param {
        name: String::new(),
        default: if fraction > 0.0 { fraction.min(1.0) } else { 0.0 },
        min: 0.0,
        max: 1.0,
        is_number: true,
        span: Default::default(),
    };
    from.scene.params.iter().chain(&to.scene.params).cloned().chain([fraction]).collect()
}

fn whole(name: String, shape: NodeId) -> Object {
    Object { name, span: Default::default(), shape, bound: None, material: 0, trusted: false }
}

fn check_blend(from: &World, to: &World, kind: BlendKind) -> Result<(), BlendError> {
    if let Some(world) = [from, to].into_iter().find(|world| world.features.glass)
        && kind == BlendKind::Melt
    {
        return Err(BlendError::Glass(world.name.clone()));
    }
    if let Some(world) = [from, to].into_iter().find(|world| world.frame_tape.feedback.is_some()) {
        return Err(BlendError::Feedback(world.name.clone()));
    }
    let counts = |of: fn(&World) -> usize| of(from) + of(to);
    let fraction = 1;
    let has_media = [from, to].iter().any(|world| world.features.media);
    let textures_max =
        if has_media { LIMITS.scene_textures_beside_media_max } else { LIMITS.scene_textures_max };
    for (what, count, max) in [
        ("lights", counts(|world| world.scene.lights.len()), LIMITS.scene_lights_max),
        ("pictures", counts(|world| world.pictures.len()), textures_max),
        ("texts and pictures as shapes", counts(|world| world.scene.shapes.len()), LIMITS.scene_shapes_max),
        ("swarms", counts(|world| world.scene.swarms.len()), LIMITS.scene_swarms_max),
        ("numbers with inertia", counts(|world| world.scene.graph.motions().len()), LIMITS.scene_motions_max),
        (
            "points in swarms",
            counts(|world| world.scene.swarms.iter().map(|swarm| swarm.points).sum()),
            LIMITS.scene_swarm_points_max,
        ),
        ("parameters", counts(|world| world.scene.params.len()) + fraction, LIMITS.scene_params_max),
    ] {
        if count > max {
            let (from, to) = (from.name.clone(), to.name.clone());
            return Err(BlendError::OverLimit { from, to, what, count, max });
        }
    }
    Ok(())
}

/// Shrinks the solids until the eye is outside of them, because the eye moves between two cameras, where there may be
/// solids. Each camera has a distance from its own scene's surfaces; the eye keeps at least half of the smaller
/// distance. At the beginning and at the end the eye is already far enough away, so nothing changes.
fn clear_of_the_eye(graph: &mut Graph, rest: Steps, a: &Side, b: &Side) -> Steps {
    let eye = [Input::EyeX, Input::EyeY, Input::EyeZ].map(|input| graph.input(input));
    let now = side::at(graph, rest[0], eye);
    let mut distances = [graph.constant(0.0); 2];
    for (distance, side) in distances.iter_mut().zip([a, b]) {
        if let Some([bound, _]) = side.whole(graph) {
            let own = side::at(graph, bound, side.camera.position);
            *distance = graph.max(own, 0.0);
        }
    }
    let missing = graph.max(Op::Min.pair(distances[0], distances[1]) * 0.5 - now, 0.0);
    rest.map(|part| graph.add(part, missing))
}

fn mixed_all(graph: &mut Graph, a: &[NodeId], b: &[NodeId], s: NodeId) -> Vec<NodeId> {
    a.iter().zip(b).map(|(&a, &b)| if a == b { a } else { graph.mix(a, b, s) }).collect()
}

/// Returns the material of a melt, which depends on the surface that contains the point. Mirrors of the first side
/// disappear before the middle, and mirrors of the second side appear after the middle, so that no frame traces more
/// mirror rays than a single scene.
fn material(graph: &mut Graph, a: &[NodeId], b: &[NodeId], melt: &melt::Melt, s: NodeId) -> Vec<NodeId> {
    let of = |numbers: &[NodeId]| Material::of(String::new(), numbers.iter().copied());
    let (a_own, b_own) = (of(a), of(b));
    let owner = melt.owner;
    let mut mixed = of(&mixed_all(graph, a, b, owner));
    mixed.haze = graph.max(mixed.haze, melt.haze);
    if a_own.reflect != b_own.reflect {
        let twice = graph.add(s, s);
        let on_b = graph.add(owner, owner);
        let (on_a, on_b) = (graph.min(2.0 - on_b, 1.0), graph.min(on_b, 1.0));
        let gone = a_own.reflect * ((1.0 - twice) * on_a);
        let come = b_own.reflect * ((twice - 1.0) * on_b);
        let alone = graph.max(gone, come);
        let both = graph.min(a_own.reflect, b_own.reflect);
        mixed.reflect = graph.max(both, alone);
    }
    mixed.numbers()
}

/// Returns the light of nearby shining objects. Each side's light is already attenuated by that side's distance, so
/// shaders get the distance 0.
fn glow(graph: &mut Graph, a: &Side, b: &Side, reach: NodeId, s: NodeId) -> Option<[NodeId; 4]> {
    let rest = graph.sub(1.0, s);
    let mut light: Option<[NodeId; 3]> = None;
    for (glow, fraction) in [(a.glow, rest), (b.glow, s)] {
        let Some([r, g, b, distance]) = glow else { continue };
        // The same attenuation as in `shaders/occlusion.glsl`.
        let away = graph.max(distance, 0.0);
        let near = graph.max(1.0 - away / reach, 0.0);
        let fraction = graph.mul(Op::Square.of(near) * near, fraction);
        let own = [r, g, b].map(|part| graph.mul(part, fraction));
        light = Some(light.map_or(own, |sum| [0, 1, 2].map(|part| graph.add(sum[part], own[part]))));
    }
    let [r, g, b] = light?;
    Some([r, g, b, graph.constant(0.0)])
}

/// Returns the media of both sides, weighted by the fractions. The side with the larger fraction sets the
/// direction of scattering.
fn medium(graph: &mut Graph, a: &Side, b: &Side, s: NodeId) -> Option<MediumRoots> {
    let rest = graph.sub(1.0, s);
    let mut weighted = |numbers: MediumRoots, fraction: NodeId| -> MediumRoots {
        std::array::from_fn(|at| if at == PHASE { numbers[at] } else { graph.mul(numbers[at], fraction) })
    };
    let a = a.medium.map(|numbers| weighted(numbers, rest));
    let b = b.medium.map(|numbers| weighted(numbers, s));
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    Some(std::array::from_fn(|at| match at {
        PHASE => graph.select(Op::Less.pair(0.5, s), b[at], a[at]),
        _ => graph.add(a[at], b[at]),
    }))
}

/// Returns the lights of both sides, weighted by the fractions. Lights change in the middle half of the transition,
/// because near the ends, where the surfaces of one scene are nearly whole, shadow rays of both sides cost most.
fn lights(graph: &mut Graph, a: &Side, b: &Side, s: NodeId) -> Vec<Light> {
    let s = s - 0.5;
    let s = graph.clamp(s + s + 0.5, 0.0, 1.0);
    let rest = graph.sub(1.0, s);
    let mut lights: Vec<Light> = Vec::with_capacity(a.lights.len() + b.lights.len());
    for (side, fraction) in [(a, rest), (b, s)] {
        for light in &side.lights {
            let color = light.color.map(|part| graph.mul(part, fraction));
            lights.push(Light { color, ..light.clone() });
        }
    }
    lights
}

/// Returns the swarms of both sides. Balls shrink and light fades with the fraction.
fn swarms(graph: &mut Graph, a: &Side, b: &Side, s: NodeId) -> Vec<Swarm> {
    let rest = graph.sub(1.0, s);
    let mut swarms: Vec<Swarm> = Vec::with_capacity(a.swarms.len() + b.swarms.len());
    for (side, fraction) in [(a, rest), (b, s)] {
        for swarm in &side.swarms {
            let [emission, glow] =
                [swarm.emission, swarm.glow].map(|light| light.map(|part| graph.mul(part, fraction)));
            let size = graph.mul(swarm.size, fraction);
            swarms.push(Swarm { size, emission, glow, ..swarm.clone() });
        }
    }
    swarms
}

/// Mixes image settings. The tone map cannot be mixed, so it changes at the middle.
fn picture(graph: &mut Graph, a: &Picture, b: &Picture, s: NodeId) -> Picture {
    let tone_map = graph.select(Op::LessEqual.pair(0.5, s), b.tone_map, a.tone_map);
    let mixed = Picture::of(mixed_all(graph, &a.numbers(), &b.numbers(), s));
    Picture { tone_map, ..mixed }
}

/// The box around the surfaces of both sides. In a melt or a portal, no solid extends beyond its own scene's box.
fn bounds(a: &Side, b: &Side) -> Option<Bounds> {
    match (a.rest.is_some(), b.rest.is_some()) {
        (true, true) => Some(a.bounds?.hull(&b.bounds?, 0.0)),
        (true, false) => a.bounds,
        (false, true) => b.bounds,
        (false, false) => None,
    }
}
