//! One of the two worlds of a blend, in the common graph.

use super::super::distance_check::{Growth, NormalizedValue};
use super::super::media::{self, MediumRoots};
use super::super::{Bounds, nearby_light, planes};
use super::alignment::{Alignment, Vector};
use crate::graph::{Graph, Input, Motion, Node, NodeId, Op, SHAPE_NUMBERS};
use crate::lang::{Camera, Light, Picture, Scene, Sky, Swarm};
use crate::world::World;

/// The numbers of things of the first world, which precede the things of the second world.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Before {
    pub(super) textures: usize,
    pub(super) params: usize,
    pub(super) shapes: usize,
}

impl Before {
    pub(super) fn of(world: &World) -> Self {
        let scene = &world.scene;
        Self { textures: world.pictures.len(), params: scene.params.len(), shapes: scene.shapes.len() }
    }
}

/// A world in a blend's graph. Its values are distances, or values that are normalized to be similar to distances.
pub(super) struct Side {
    /// The planes, each with slope 1.
    pub(super) planes: Vec<NodeId>,
    /// True if the values are not distances, so that rays must not step by them.
    pub(super) non_lipschitz: bool,
    pub(super) bounds: Option<Bounds>,
    pub(super) rest: Option<Steps>,
    pub(super) material: Vec<NodeId>,
    /// The emission near a point, and the distance to the shining object.
    pub(super) glow: Option<[NodeId; 4]>,
    pub(super) medium: Option<MediumRoots>,
    pub(super) lights: Vec<Light>,
    pub(super) swarms: Vec<Swarm>,
    pub(super) camera: Camera,
    /// Parameters in the blend's order: 0 for those before this side's own, then this scene's defaults.
    pub(super) params: Vec<f32>,
    pub(super) sky: Sky,
    pub(super) picture: Picture,
}

impl Side {
    /// Copies a world into the graph. `before`: how many images, parameters and shapes precede its own.
    pub(super) fn of(graph: &mut Graph, world: &World, before: Before, alignment: &Alignment) -> Self {
        let mut scene = world.scene.clone();
        let (planes, rest) = planes::split(&mut scene);
        let glow = nearby_light::nearby_light(&mut scene, world.non_lipschitz);
        let medium = media::sum(&mut scene);
        let own = Own::of(graph, alignment);
        // In distances, the input for the normal's x holds the penumbra (see `Roots`).
        let [moved, turned] = [own, own.turned(graph, alignment)].map(|own| {
            let every = (0..scene.graph.len()).map(NodeId::at);
            copied(graph, &scene.graph, every, before, &|input| own.value(input))
        });
        // The sky's point is the picture's pixel, which stays in its place.
        let in_sky = Own { point: position(graph), ..own.turned(graph, alignment) };
        let in_sky =
            copied_roots(graph, &scene.graph, &scene.sky.color, before, &|input| in_sky.value(input));
        let color = scene.sky.color.map(|id| in_sky[id.index()]);
        let at = |id: NodeId| moved[id.index()];
        let on_surface = |id: NodeId| turned[id.index()];
        let all = |numbers: Vec<NodeId>| numbers.into_iter().map(at);
        let planes = planes.iter().map(|plane| of_slope_1(graph, at(plane.shape))).collect();
        let rest = rest.map(|rest| {
            [rest.bound, rest.estimate].map(|value| match world.slopes.tamed {
                Some(tamed) => {
                    let near = like_a_distance(graph, at(value), own.point, tamed);
                    world.bounds.map_or(near, |bounds| {
                        let far = outside(graph, own.point, &bounds);
                        graph.max(near, far)
                    })
                }
                None => at(value),
            })
        });
        Self {
            planes,
            non_lipschitz: world.slopes.tamed.is_some_and(|tamed| !tamed.is_distance),
            bounds: world.bounds.map(|bounds| alignment.common_box(&bounds)),
            rest,
            material: material_of_the_nearest(graph, &scene, on_surface),
            glow: glow.map(|glow| glow.map(at)),
            medium: medium.map(|numbers| numbers.map(at)),
            lights: scene
                .lights
                .iter()
                .map(|light| {
                    let light = Light::of(light.kind, all(light.numbers()));
                    let position = alignment.common_point(graph, light.position);
                    let [direction, right, up] = [light.direction, light.right, light.up]
                        .map(|direction| alignment.common_direction(graph, direction));
                    Light { position, direction, right, up, ..light }
                })
                .collect(),
            swarms: swarms(graph, &scene, before, alignment),
            camera: {
                let camera = Camera::of(all(scene.camera.numbers()));
                let [position, target] =
                    [camera.position, camera.target].map(|place| alignment.common_point(graph, place));
                Camera { position, target, ..camera }
            },
            params: std::iter::repeat_n(0.0, before.params)
                .chain(scene.params.iter().map(|param| param.default))
                .collect(),
            sky: Sky { color, ..Sky::of(scene.sky.numbers().into_iter().map(on_surface)) },
            picture: Picture::of(all(scene.picture.numbers())),
        }
    }

    pub(super) fn whole(&self, graph: &mut Graph) -> Option<Steps> {
        let planes = self.planes.iter().copied().reduce(|a, b| graph.min(a, b));
        nearer(graph, planes.map(|plane| [plane; 2]), self.rest)
    }
}

/// Expressions of the traced surfaces: the length of a ray's step, and the estimate.
pub(super) type Steps = [NodeId; 2];

/// The steps to the nearer of two surfaces.
pub(super) fn nearer(graph: &mut Graph, a: Option<Steps>, b: Option<Steps>) -> Option<Steps> {
    match (a, b) {
        (Some(a), Some(b)) => Some([0, 1].map(|part| graph.min(a[part], b[part]))),
        (a, b) => a.or(b),
    }
}

/// Copies the swarms of a scene. The number of a point is the x of its expressions, and a blend does not move it.
fn swarms(graph: &mut Graph, scene: &Scene, before: Before, alignment: &Alignment) -> Vec<Swarm> {
    let roots: Vec<NodeId> = scene.swarms.iter().flat_map(Swarm::numbers).collect();
    let own = Own { point: position(graph), ..Own::of(graph, alignment) };
    let copies = copied_roots(graph, &scene.graph, &roots, before, &|input| own.value(input));
    let copied = scene.swarms.iter().map(|swarm| {
        let own = Swarm::of(swarm.points, swarm.numbers().into_iter().map(|id| copies[id.index()]));
        let position = alignment.common_point(graph, own.position);
        let stretch = alignment.common_direction(graph, own.stretch);
        Swarm { position, stretch, ..own }
    });
    copied.collect()
}

#[derive(Clone, Copy)]
struct Own {
    point: Vector,
    normal: Vector,
    eye: Vector,
}

impl Own {
    fn of(graph: &mut Graph, alignment: &Alignment) -> Self {
        let inputs = |graph: &mut Graph, inputs: [Input; 3]| inputs.map(|input| graph.input(input));
        let point = position(graph);
        let normal = inputs(graph, [Input::NX, Input::NY, Input::NZ]);
        let eye = inputs(graph, [Input::EyeX, Input::EyeY, Input::EyeZ]);
        let [point, eye] = [point, eye].map(|place| alignment.own_point(graph, place));
        Self { point, normal, eye }
    }

    /// Returns the inputs for expressions that read a normal or a direction.
    fn turned(self, graph: &mut Graph, alignment: &Alignment) -> Self {
        Self { normal: alignment.own_direction(graph, self.normal), ..self }
    }

    fn value(&self, input: Input) -> Option<NodeId> {
        let of_eye = [Input::EyeX, Input::EyeY, Input::EyeZ].iter().position(|eye| *eye == input);
        let place = input.of_point().or(of_eye.map(|axis| Input::OF_POINT.len() + axis))?;
        [self.point, self.normal, self.eye].as_flattened().get(place).copied()
    }
}

/// Copies `root` and its operands, with the point at `place`.
pub(super) fn copied_at(
    graph: &mut Graph,
    from: &Graph,
    root: NodeId,
    before: Before,
    place: Vector,
) -> NodeId {
    let value = |input: Input| place.get(input.of_point()?).copied();
    copied_roots(graph, from, &[root], before, &value)[root.index()]
}

/// Copies the roots and their operands. Returns the copies by the index of their nodes.
fn copied_roots(
    graph: &mut Graph,
    from: &Graph,
    roots: &[NodeId],
    before: Before,
    value: &dyn Fn(Input) -> Option<NodeId>,
) -> Vec<NodeId> {
    // The operands of motions, which the roots do not name. A motion reads only motions before it.
    let operands = from.motions().iter().map(|motion| motion.operands.as_slice());
    let order = operands.chain([roots]).flat_map(|roots| from.order(roots));
    copied(graph, from, order, before, value)
}

/// Copies nodes in an order in which operands come first; `value` returns the replacement of an input. Returns the
/// copies by the index of their nodes.
fn copied(
    graph: &mut Graph,
    from: &Graph,
    order: impl Iterator<Item = NodeId>,
    before: Before,
    value: &dyn Fn(Input) -> Option<NodeId>,
) -> Vec<NodeId> {
    let mut moved = vec![NodeId::default(); from.len()];
    for id in order {
        let at = |id: NodeId| moved[id.index()];
        let copy = match from.node(id) {
            Node::Constant(value) => graph.constant(value),
            Node::Input(Input::Param(number)) => graph.input(Input::Param(number + before.params as u16)),
            Node::Input(Input::Motion(number)) => {
                let motion = from.motions()[usize::from(number)];
                graph.motion(Motion { operands: motion.operands.map(at), ..motion })
            }
            Node::Input(input) => value(input).unwrap_or_else(|| graph.input(input)),
            Node::Unary(Op::ShapeNumber, a) => {
                let own = at(a);
                let index =
                    graph.as_constant(own).map(|index| index + (SHAPE_NUMBERS * before.shapes) as f32);
                let index = index.map_or(own, |index| graph.constant(index));
                graph.unary(Op::ShapeNumber, index)
            }
            Node::Unary(op, a) => graph.unary(op, at(a)),
            Node::Binary(op, a, b) => graph.binary(op, at(a), at(b)),
            Node::Texture { texture, channel, u, v } => {
                graph.texture(texture + before.textures as u16, channel, at(u), at(v))
            }
        };
        moved[id.index()] = copy;
    }
    moved
}

pub(super) fn position(graph: &mut Graph) -> Vector {
    [Input::X, Input::Y, Input::Z].map(|input| graph.input(input))
}

/// Returns the value at the point `place`, with a zero normal.
pub(super) fn at(graph: &mut Graph, value: NodeId, place: Vector) -> NodeId {
    let zero = graph.constant(0.0);
    let moved = graph
        .with_inputs(&[value], |_, input| input.of_point().map(|at| place.get(at).copied().unwrap_or(zero)));
    moved.first().copied().unwrap_or_default()
}

/// Divides a plane by its slope, so that the value is comparable to a distance.
fn of_slope_1(graph: &mut Graph, plane: NodeId) -> NodeId {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let origin = at(graph, plane, [zero; 3]);
    let slopes = [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(|place| {
        let there = at(graph, plane, place);
        graph.sub(there, origin)
    });
    let slope = graph.length(&slopes);
    graph.div(plane, slope)
}

fn like_a_distance(graph: &mut Graph, value: NodeId, p: Vector, tamed: NormalizedValue) -> NodeId {
    let mut scale = graph.constant(tamed.scale);
    if tamed.growth.power > 0 {
        let Growth { middle, half, power } = tamed.growth;
        let mut base = graph.constant(1.0);
        for (axis, middle) in p.into_iter().zip(middle) {
            let square = graph.square(axis * (1.0 / half) - middle / half);
            base = graph.add(base, square);
        }
        for _ in 0..power {
            scale = graph.mul(scale, base);
        }
    }
    let value = graph.div(value, scale);
    if tamed.reach.is_infinite() {
        return value;
    }
    let value = graph.unary(Op::Atan, value / tamed.reach);
    graph.mul(value, tamed.reach)
}

/// Returns the distance of a point from a box; negative inside.
fn outside(graph: &mut Graph, p: Vector, bounds: &Bounds) -> NodeId {
    let off = [0, 1, 2].map(|axis| {
        let off = Op::Abs.of(p[axis] - 0.5 * (bounds.low[axis] + bounds.high[axis]));
        graph.sub(off, 0.5 * bounds.side(axis))
    });
    let beyond = off.map(|off| graph.max(off, 0.0));
    let beyond = graph.length(&beyond);
    let [x, y, z] = off;
    let most = Op::Max.pair(Op::Max.pair(x, y), z);
    graph.add(beyond, Op::Min.pair(most, 0.0))
}

fn material_of_the_nearest(graph: &mut Graph, scene: &Scene, at: impl Fn(NodeId) -> NodeId) -> Vec<NodeId> {
    let mut nearest: Option<(NodeId, Vec<NodeId>)> = None;
    for (index, material) in scene.materials.iter().enumerate() {
        let shapes = scene.objects.iter().filter(|object| object.material == index);
        let shapes: Vec<NodeId> = shapes.map(|object| at(object.shape)).collect();
        let Some(shape) = shapes.into_iter().reduce(|a, b| graph.min(a, b)) else { continue };
        let numbers: Vec<NodeId> = material.numbers().into_iter().map(&at).collect();
        nearest = Some(match nearest {
            None => (shape, numbers),
            Some((so_far, others)) => {
                let is_nearer = graph.binary(Op::Less, shape, so_far);
                let both = numbers.into_iter().zip(others);
                let chosen = both.map(|(own, other)| graph.select(is_nearer, own, other)).collect();
                (graph.min(so_far, shape), chosen)
            }
        });
    }
    // A scene of sky alone has a material without objects.
    let unused = || scene.materials.first().map(|one| one.numbers().into_iter().map(&at).collect());
    nearest.map(|(_, numbers)| numbers).or_else(unused).unwrap_or_default()
}
