//! Swarms: sparks, dust, rain, fireflies. The points of a frame are computed on the CPU, and rays find them by trees.
//!
//! ```text
//! number of a point → tape → place, radius, colours → two trees of boxes → texels
//! ```
//!
//! | texel | holds |
//! |---|---|
//! | 0 | of the balls, then of everything faint: the first texel of the tree and the number of its nodes |
//! | 1..7 | ambient light on surfaces that face +x, -x, +y, -y, +z, -z |
//! | 7 | of the tiles: the first texel, their side in pixels, their number in a row |
//! | 8 | the same for the mirror image in a plane; the number of the plane, from 1; 0 without one |
//! | a node | lower corner of a box; the number of the node to visit if a ray misses the box |
//! | | upper corner; 0, or the texel of the only point in the box |
//! | a point | place, radius |
//! | | the way along which it is stretched; its colour, a byte for each part |
//! | | its light; 1 for a ball |
//!
//! The nodes are in the order of a walk through the whole tree. Points are sorted along a curve that
//! fills space (Morton 1966), and a box is cut where the curve leaves one half of space (Lauterbach et al. 2009).
//!
//! Faint are glow, and balls that are thinner than [`THIN`] pixels. They are drawn at least as wide as a pixel, and fainter
//! instead; boxes contain this width. Rays sum them in any order.

use std::ops::Range;

use super::media::{AXES, facing};
use crate::bounds::Bounds;
use crate::graph::{FrameInputs, InputsUsed, NodeId, Point};
use crate::lang::{Scene, Swarm};
use crate::region::RegionKey;
use crate::tape::{Batch, PointEvaluator, Points, Tape};
use crate::vectors::{difference, dot, length, sum};

/// A mirrored point is seen from at most this multiple of its distance from the eye. Beyond it, pixels are wider than
/// the point is drawn, and it may flicker.
pub const WIDEST: f32 = 2.0;

/// A ball is thin if its diameter is less than this number of pixels.
const THIN: f32 = 2.0;
/// Points with a larger number in any value are left out, and so are points beyond these coordinates.
const LARGEST: f32 = 1e6;
/// Texels before the first tree.
const HEAD: usize = 9;
const NODE_TEXELS: usize = 2;
const POINT_TEXELS: usize = 3;
/// Bits of a coordinate on the curve.
const CURVE_BITS: u32 = 10;

/// The parts of a scene's swarms that all frames share.
#[derive(Debug, Clone, PartialEq)]
pub struct SwarmPlan {
    swarms: Vec<(usize, Tape)>,
    /// The ambient light along the axes.
    ambient: Tape,
    used: InputsUsed,
    has_mirrors: bool,
}

/// The eye that sees a swarm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwarmView {
    /// Its position.
    pub eye: [f32; 3],
    /// Half of a pixel's width at distance 1.
    pub pixel: f32,
    /// Its picture, if that is flat and the only one.
    pub picture: Option<SwarmPicture>,
    /// A plane that may be a mirror: its number, its unit normal towards the eye, and the origin's distance from it.
    pub mirror: Option<(usize, [f32; 4])>,
}

impl SwarmView {
    /// Returns the eye behind the mirror whose rays are the mirrored ones of this eye.
    fn mirrored(&self) -> Option<Self> {
        let (_, [x, y, z, distance]) = self.mirror?;
        let turned = |way: [f32; 3], distance: f32| {
            let twice = 2.0 * (way[0] * x + way[1] * y + way[2] * z + distance);
            [way[0] - twice * x, way[1] - twice * y, way[2] - twice * z]
        };
        let picture = |picture: SwarmPicture| SwarmPicture {
            forward: turned(picture.forward, 0.0),
            half: picture.half.map(|half| turned(half, 0.0)),
            ..picture
        };
        Some(Self { eye: turned(self.eye, distance), picture: self.picture.map(picture), ..*self })
    }
}

impl SwarmPlan {
    /// `has_mirrors` is false if no surface of the scene is a mirror.
    pub(super) fn of(scene: &Scene, has_mirrors: bool) -> Option<Self> {
        if scene.swarms.is_empty() {
            return None;
        }
        let mut graph = scene.graph.clone();
        let facing = |direction| facing(&mut graph, &scene.sky.ambient, direction);
        let ambient: Vec<NodeId> = AXES.into_iter().flat_map(facing).collect();
        let numbers = scene.swarms.iter().flat_map(Swarm::numbers);
        let all: Vec<NodeId> = numbers.chain(ambient.iter().copied()).collect();
        let tape = |swarm: &Swarm| (swarm.points, Tape::new(&graph, &swarm.numbers()));
        Some(Self {
            swarms: scene.swarms.iter().map(tape).collect(),
            ambient: Tape::new(&graph, &ambient),
            used: graph.inputs_used(&all),
            has_mirrors,
        })
    }

    /// Returns the inputs that determine a frame's points.
    pub fn key(&self, inputs: &FrameInputs) -> RegionKey {
        RegionKey::of(&self.used, inputs)
    }

    /// Number of points of all swarms.
    pub fn point_count(&self) -> usize {
        self.swarms.iter().map(|(count, _)| count).sum()
    }

    /// Computes a part of the points of a frame. Points that are invalid or invisible are left out.
    pub fn points(&self, inputs: &FrameInputs, part: Range<usize>) -> Vec<Swarm<f32>> {
        let mut points = Vec::with_capacity(part.len());
        let mut first = 0;
        for (count, tape) in &self.swarms {
            let own = part.start.max(first)..part.end.min(first + count);
            if !own.is_empty() {
                let index: Vec<f32> = own.map(|number| (number - first) as f32).collect();
                let zero = vec![0.0; index.len()];
                let columns =
                    Batch::new(tape, inputs).run(Points { position: [&index, &zero, &zero], normal: None });
                let row =
                    |at: usize| columns.iter().map(move |column| column.get(at).copied().unwrap_or(f32::NAN));
                points.extend((0..index.len()).filter_map(|at| checked(Swarm::of(1, row(at)))));
            }
            first += count;
        }
        points
    }

    /// Returns the texels of a frame's points: at most `texels_max`, if there is room for [`POINT_TEXELS_MAX`] of each.
    pub fn texels(
        &self,
        points: &[Swarm<f32>],
        inputs: &FrameInputs,
        view: &SwarmView,
        texels_max: usize,
    ) -> Vec<[f32; 4]> {
        let mut texels = vec![[0.0; 4]; HEAD];
        let mut ambient = PointEvaluator::new(&self.ambient, inputs);
        let light = ambient.at(&Point::default()).as_chunks::<3>().0;
        for (texel, [r, g, b]) in texels.iter_mut().skip(1).zip(light) {
            *texel = [*r, *g, *b, 0.0].map(|part| if part > 0.0 { part.min(LARGEST) } else { 0.0 });
        }
        let bodies = points.iter().flat_map(|point| Body::all_of(point, view));
        let (faint, balls): (Vec<_>, Vec<_>) = bodies.partition(|body| body.is_faint);
        let mirrored = view.mirrored().filter(|_| self.has_mirrors);
        let mut pictures = [Some(*view), mirrored].map(|view| (view, Vec::new()));
        let trees = [balls, faint].map(|bodies| append_tree(bodies, &mut texels, &mut pictures));
        let plane = view.mirror.map_or(0, |(plane, _)| plane + 1);
        let mut tiles_of = |(view, outlines): &(Option<SwarmView>, Vec<Outline>), others: usize| {
            let room = texels_max.saturating_sub(texels.len() + others);
            let Some(picture) = view.and_then(|view| view.picture) else { return [0; 3] };
            append_tiles(outlines, picture.size, room, &mut texels)
        };
        // The mirrored picture has room for one tile at least.
        let [seen, mirrored] = &pictures;
        let tiles = [tiles_of(seen, mirrored.1.len() + 1), tiles_of(mirrored, 0)];
        if let [head, .., seen, mirrored] = &mut texels[..HEAD] {
            let [[ball, balls], [faint, all_faint]] = trees;
            *head = [ball, balls, faint, all_faint].map(|number| number as f32);
            for (texel, [first, side, columns]) in [seen, mirrored].into_iter().zip(tiles) {
                let plane = if side > 0 { plane } else { 0 };
                *texel = [first, side, columns, plane].map(|number| number as f32);
            }
        }
        texels
    }
}

/// Most texels that a point may take.
pub const POINT_TEXELS_MAX: usize = 2 * (POINT_TEXELS + 2 * NODE_TEXELS + 2);

/// Returns the point with its values in their ranges; `None` if one of them is not a number or too large.
fn checked(point: Swarm<f32>) -> Option<Swarm<f32>> {
    let is_sound = point.numbers().iter().all(|number| number.abs() <= LARGEST);
    is_sound.then(|| point.in_ranges(|number, range| range.clamp(number)))
}

/// A ball or the glow of a point.
#[derive(Debug, Clone, Copy)]
struct Body<'a> {
    point: &'a Swarm<f32>,
    radius: f32,
    light: [f32; 3],
    is_ball: bool,
    is_faint: bool,
    /// Half of a pixel's width at its place.
    pixel: f32,
    bounds: Bounds,
    /// The number of its middle on the curve.
    place: u32,
}

impl<'a> Body<'a> {
    /// Returns what is visible of a point.
    fn all_of(point: &'a Swarm<f32>, view: &SwarmView) -> impl Iterator<Item = Self> {
        let pixel = view.pixel * length(difference(point.position, view.eye));
        let body = move |radius: f32, light: [f32; 3], is_ball: bool| {
            // The widths at which shaders draw glow and thin balls. Shaders round differently.
            let widest = WIDEST * pixel;
            let drawn = if is_ball { radius.max(widest) + widest } else { radius.hypot(4.0 * widest) };
            let around = drawn * 1.001 + 1e-6;
            let (place, way) = (point.position, point.stretch);
            let bounds = Bounds {
                low: std::array::from_fn(|axis| place[axis] + way[axis].min(0.0) - around),
                high: std::array::from_fn(|axis| place[axis] + way[axis].max(0.0) + around),
            };
            let is_faint = !is_ball || radius < THIN * pixel;
            Self { point, radius, light, is_ball, is_faint, pixel, bounds, place: 0 }
        };
        let ball = (point.size > 0.0).then(|| body(point.size, point.emission, true));
        let glows = point.reach > 0.0 && point.glow.iter().any(|part| *part > 0.0);
        ball.into_iter().chain(glows.then(|| body(point.reach, point.glow, false)))
    }

    /// Returns what a flat picture shows of the body, whose first texel is given.
    fn outline(&self, view: &SwarmView, texel: usize) -> Option<Outline> {
        let picture = view.picture?;
        let away = difference(self.point.position, view.eye);
        let end = sum(away, self.point.stretch);
        // The width at the farther end, which rays from the eye see without a mirror.
        let pixel = (view.pixel * length(end)).clamp(self.pixel, WIDEST * self.pixel);
        let drawn = match (self.is_ball, self.is_faint) {
            (true, false) => self.radius,
            (true, true) => self.radius.max(pixel) + pixel,
            (false, _) => self.radius.hypot(4.0 * pixel),
        };
        let [low, high] = picture.corners([away, end], 1.001 * drawn)?;
        let before = |axis: usize| {
            (self.bounds.low[axis] - view.eye[axis]).max(view.eye[axis] - self.bounds.high[axis]).max(0.0)
        };
        let near = 0.999 * length([before(0), before(1), before(2)]);
        Some(Outline { low, high, near, texel, is_faint: self.is_faint })
    }

    fn texels(&self) -> [[f32; 4]; POINT_TEXELS] {
        let ([x, y, z], [dx, dy, dz], [r, g, b]) = (self.point.position, self.point.stretch, self.light);
        let color = self.point.color.iter().rfold(0.0, |sum, part| 256.0 * sum + (255.0 * part).round());
        [[x, y, z, self.radius], [dx, dy, dz, color], [r, g, b, f32::from(self.is_ball)]]
    }
}

/// Appends the tree of the bodies of points, and what flat pictures show of them. Returns the tree's first texel and the
/// number of its nodes.
fn append_tree(
    mut bodies: Vec<Body<'_>>,
    texels: &mut Vec<[f32; 4]>,
    pictures: &mut [(Option<SwarmView>, Vec<Outline>)],
) -> [usize; 2] {
    let whole = bodies.iter().map(|body| body.bounds).reduce(|a, b| a.hull(&b, 0.0));
    let Some(whole) = whole else { return [0; 2] };
    for body in &mut bodies {
        body.place = place_on_curve(&whole, &body.bounds);
    }
    bodies.sort_unstable_by_key(|body| body.place);
    let first = texels.len();
    // A tree has a leaf for each body, and a node less between them.
    let count = 2 * bodies.len() - 1;
    let mut tree =
        Tree { nodes: Vec::with_capacity(count), first_point: first + NODE_TEXELS * count, points: 0 };
    tree.add(&bodies);
    texels.extend(tree.nodes.into_iter().flatten());
    for (view, outlines) in pictures {
        let places = (texels.len()..).step_by(POINT_TEXELS);
        let outline = |(body, texel): (&Body<'_>, usize)| body.outline(view.as_ref()?, texel);
        outlines.extend(bodies.iter().zip(places).filter_map(outline));
    }
    texels.extend(bodies.iter().flat_map(Body::texels));
    [first, count]
}

struct Tree {
    nodes: Vec<[[f32; 4]; NODE_TEXELS]>,
    first_point: usize,
    /// Number of points so far.
    points: usize,
}

impl Tree {
    /// Adds the node of these bodies and the nodes inside. Returns its box.
    fn add(&mut self, bodies: &[Body<'_>]) -> Bounds {
        let number = self.nodes.len();
        self.nodes.push([[0.0; 4]; NODE_TEXELS]);
        let mut point = 0;
        let bounds = if let [body] = bodies {
            point = self.first_point + POINT_TEXELS * self.points;
            self.points += 1;
            body.bounds
        } else {
            let (a, b) = bodies.split_at(cut(bodies));
            let bounds = self.add(a);
            bounds.hull(&self.add(b), 0.0)
        };
        let ([x, y, z], [hx, hy, hz], next) = (bounds.low, bounds.high, self.nodes.len() as f32);
        self.nodes[number] = [[x, y, z, next], [hx, hy, hz, point as f32]];
        bounds
    }
}

/// Returns how many of the sorted bodies are in the first half of their space, or half of them if none differs.
fn cut(bodies: &[Body<'_>]) -> usize {
    let [first, .., last] = bodies else { return bodies.len() };
    let differing = first.place ^ last.place;
    match differing.checked_ilog2() {
        Some(bit) => bodies.partition_point(|body| (body.place ^ first.place) >> bit == 0),
        None => bodies.len() / 2,
    }
}

/// Returns the number of a box's middle on a curve through `whole`: the bits of the coordinates, interleaved.
fn place_on_curve(whole: &Bounds, own: &Bounds) -> u32 {
    let mut place = 0;
    for axis in 0..3 {
        let middle = 0.5 * (own.low[axis] + own.high[axis]) - whole.low[axis];
        let part = middle / (whole.high[axis] - whole.low[axis]);
        let cell = ((part * (1 << CURVE_BITS) as f32) as u32).min((1 << CURVE_BITS) - 1);
        let spread = (0..CURVE_BITS).fold(0, |spread, bit| spread | (cell >> bit & 1) << (3 * bit));
        place |= spread << axis;
    }
    place
}

// Lists of a swarm's points in the square tiles of a flat picture, for the rays of the eye: a ray tests only the points of
// its tile.
//
// | texel | holds |
// |---|---|
// | a tile | first entry, first faint entry, end of its entries |
// | an entry | the box of the point within its tile, see [`packed`]; its least distance from the eye; its texel |
//
// Tiles are as small as the room for entries permits, because a large point is in many tiles.

/// Parts of a tile's side in which boxes are measured. A float holds two of them.
pub const TILE_PARTS: f32 = 1024.0;

/// The least side of a tile, in pixels.
const TILE_SIDE_MIN: u32 = 8;
/// The most tiles of a picture.
const TILES_MAX: usize = 1 << 15;
/// The mean number of tiles in which a ball or a glow may be.
const ENTRIES_PER_POINT: usize = 8;
/// Boxes are larger by this number of pixels, because shaders round differently.
const MARGIN: f32 = 0.02;

/// A flat picture for one eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwarmPicture {
    /// From the eye, the way to the middle of the picture's plane at distance 1.
    pub forward: [f32; 3],
    /// From there to the right and the upper edge, perpendicular to each other and to `forward`.
    pub half: [[f32; 3]; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// The part of the picture that a point may cover.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outline {
    /// Lower left and upper right corner of a box around it, in pixels from the picture's lower left corner.
    pub low: [f32; 2],
    pub high: [f32; 2],
    /// Its least distance from the eye.
    pub near: f32,
    /// Its texel.
    pub texel: usize,
    pub is_faint: bool,
}

impl SwarmPicture {
    /// Returns the corners of a box around balls of a radius along a streak, whose ends are `a` and `b` as seen from the
    /// eye. `None` if the picture does not show them.
    pub(super) fn corners(&self, [a, b]: [[f32; 3]; 2], radius: f32) -> Option<[[f32; 2]; 2]> {
        let ahead = [a, b].map(|end| dot(end, self.forward));
        if ahead[0].max(ahead[1]) <= -radius {
            return None;
        }
        let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
        for ((half, size), (low, high)) in self.half.iter().zip(self.size).zip(low.iter_mut().zip(&mut high))
        {
            let length2 = dot(*half, *half).max(1e-12);
            let scale = 0.5 * size as f32 / length2.sqrt();
            let across = [a, b].map(|end| dot(end, *half) / length2.sqrt());
            let [least, most] = slopes([[across[0], ahead[0]], [across[1], ahead[1]]], radius);
            *low = (scale * least + 0.5 * size as f32 - MARGIN).max(0.0);
            *high = (scale * most + 0.5 * size as f32 + MARGIN).min(size as f32);
            if *low >= *high {
                return None;
            }
        }
        Some([low, high])
    }
}

/// Returns the least and the largest slope, across by ahead, of the rays from the origin that meet discs along a line.
fn slopes([a, b]: [[f32; 2]; 2], radius: f32) -> [f32; 2] {
    const ALL: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];
    let way = [b[0] - a[0], b[1] - a[1]];
    let along = -(a[0] * way[0] + a[1] * way[1]) / (way[0] * way[0] + way[1] * way[1]).max(1e-12);
    let along = along.clamp(0.0, 1.0);
    let nearest = [a[0] + along * way[0], a[1] + along * way[1]];
    let is_on_one_side = a[1].min(b[1]) > 0.0 || a[0] * b[0] > 0.0;
    if !is_on_one_side || nearest[0].hypot(nearest[1]) <= 1.0001 * radius {
        return ALL;
    }
    let [a, b] = [a, b].map(|[x, z]| {
        let tangent = (x * x + z * z - radius * radius).max(0.0).sqrt();
        // Both tangents, unless they are behind.
        let slope = |side: f32| {
            let ahead = z * tangent - side * x * radius;
            if ahead > 0.0 { (x * tangent + side * z * radius) / ahead } else { x.signum() * f32::INFINITY }
        };
        [slope(-1.0), slope(1.0)]
    });
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The tiles of a picture, row by row.
struct Grid {
    side: u32,
    size: [u32; 2],
}

impl Grid {
    fn columns(&self) -> usize {
        self.size[0].div_ceil(self.side) as usize
    }

    fn count(&self) -> usize {
        self.columns() * self.size[1].div_ceil(self.side) as usize
    }

    /// Returns the columns and rows of the tiles that contain a part of the outline.
    fn tiles(&self, outline: &Outline) -> [Range<usize>; 2] {
        [0, 1].map(|axis| {
            let scale = 1.0 / self.side as f32;
            let most = self.size[axis].div_ceil(self.side) as usize;
            (outline.low[axis] * scale) as usize..((outline.high[axis] * scale) as usize + 1).min(most)
        })
    }

    fn entries(&self, outlines: &[Outline]) -> usize {
        outlines
            .iter()
            .map(|outline| self.tiles(outline).map(|tiles| tiles.len()).iter().product::<usize>())
            .sum()
    }
}

/// Appends the lists of the tiles, at most `room` texels. Returns the texel of the first tile, the tiles' side in pixels
/// and their number in a row.
pub(super) fn append_tiles(
    outlines: &[Outline],
    size: [u32; 2],
    room: usize,
    texels: &mut Vec<[f32; 4]>,
) -> [usize; 3] {
    let room = room.min(ENTRIES_PER_POINT * outlines.len() + TILES_MAX);
    let mut grid = Grid { side: TILE_SIDE_MIN, size };
    // The largest tile is the whole picture.
    while grid.side < size[0].max(size[1])
        && (grid.count() > TILES_MAX || grid.count() + grid.entries(outlines) > room)
    {
        grid.side *= 2;
    }
    let (first, columns) = (texels.len(), grid.columns());
    // For each tile its balls, then everything faint.
    let mut lists = vec![0; 2 * grid.count()];
    let each = |lists: &mut [usize], put: &mut dyn FnMut(usize, &Outline, [usize; 2])| {
        for outline in outlines {
            let [across, rows] = grid.tiles(outline);
            for row in rows {
                for column in across.clone() {
                    let list = 2 * (row * columns + column) + usize::from(outline.is_faint);
                    put(lists[list], outline, [column, row]);
                    lists[list] += 1;
                }
            }
        }
    };
    each(&mut lists, &mut |_, _, _| {});
    let mut end = first + grid.count();
    for list in &mut lists {
        end += std::mem::replace(list, end);
    }
    let ends = lists.iter().copied().skip(2).step_by(2).chain([end]);
    let tiles = lists.as_chunks::<2>().0.iter().zip(ends);
    texels.extend(tiles.map(|([balls, faint], end)| [*balls as f32, *faint as f32, end as f32, 0.0]));
    texels.resize(end, [0.0; 4]);
    each(&mut lists, &mut |place, outline, tile| {
        let [x, y] = [0, 1].map(|axis| packed(outline, axis, tile[axis], grid.side));
        texels[place] = [x, y, outline.near, outline.texel as f32];
    });
    [first, grid.side as usize, columns]
}

/// Returns both sides of an outline's box along an axis in a tile's parts: the lower side, and as a fraction the upper.
fn packed(outline: &Outline, axis: usize, tile: usize, side: u32) -> f32 {
    let parts = |at: f32| {
        let at = TILE_PARTS * (at / side as f32 - tile as f32);
        // A cast is faster than `floor`.
        f32::from(at.clamp(0.0, TILE_PARTS - 1.0) as u16)
    };
    parts(outline.low[axis]) + parts(outline.high[axis]) / TILE_PARTS
}

#[cfg(test)]
#[path = "swarm_tests.rs"]
mod tests;
