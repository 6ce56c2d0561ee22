//! Lists of a swarm's points in the square tiles of a flat picture, for the rays of the eye: a ray tests only the points of
//! its tile.
//!
//! | texel | holds |
//! |---|---|
//! | a tile | first entry, first faint entry, end of its entries |
//! | an entry | the box of the point within its tile, see [`packed`]; its least distance from the eye; its texel |
//!
//! Tiles are as small as the room for entries permits, because a large point is in many tiles.

use std::ops::Range;

/// Parts of a tile's side in which boxes are measured. A float holds two of them.
pub const TILE_PARTS: f32 = 1024.0;

/// The least side of a tile, in pixels.
const TILE_SIDE_MIN: u32 = 8;
/// The most tiles of a picture.
const TILES_MAX: usize = 1 << 15;
/// The mean number of tiles in which a point may be.
const ENTRIES_PER_POINT: usize = 12;
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

/// What the eye sees of a point.
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

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
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
    let each = |lists: &mut [usize], put: &mut dyn FnMut(usize, [f32; 4])| {
        for outline in outlines {
            let [across, rows] = grid.tiles(outline);
            for row in rows {
                let y = packed(outline, 1, row, grid.side);
                for column in across.clone() {
                    let list = 2 * (row * columns + column) + usize::from(outline.is_faint);
                    if let Some(place) = lists.get_mut(list) {
                        let x = packed(outline, 0, column, grid.side);
                        put(*place, [x, y, outline.near, outline.texel as f32]);
                        *place += 1;
                    }
                }
            }
        }
    };
    each(&mut lists, &mut |_, _| {});
    let mut end = first + grid.count();
    for list in &mut lists {
        end += std::mem::replace(list, end);
    }
    let ends = lists.iter().copied().skip(2).step_by(2).chain([end]);
    let tiles = lists.as_chunks::<2>().0.iter().zip(ends);
    texels.extend(tiles.map(|([balls, faint], end)| [*balls as f32, *faint as f32, end as f32, 0.0]));
    texels.resize(end, [0.0; 4]);
    each(&mut lists, &mut |place, entry| {
        if let Some(texel) = texels.get_mut(place) {
            *texel = entry;
        }
    });
    [first, grid.side as usize, columns]
}

/// Returns both sides of an outline's box along an axis in a tile's parts: the lower side, and as a fraction the upper.
fn packed(outline: &Outline, axis: usize, tile: usize, side: u32) -> f32 {
    let parts =
        |at: f32| (TILE_PARTS * (at / side as f32 - tile as f32)).clamp(0.0, TILE_PARTS - 1.0).floor();
    parts(outline.low[axis]) + parts(outline.high[axis]) / TILE_PARTS
}
