//! Packs a frame into the shaders' `FrameBlock` (std140: all members are vec4, see `shaders/frame_block.glsl`).

use super::{Frame, sound_tables};
use mariana_field::graph::ScreenInput::{MousePressed, MouseX, MouseY};
use mariana_field::graph::{
    FRAME_SHAPES_MAX, LEVEL_COUNT, PartInput, SHAPE_COLUMNS, SHAPE_NUMBERS, SHAPE_STEP, SoundInput,
};
use mariana_field::lang::{Light, TextureRef};
use mariana_field::limits::LIMITS as FIELD_LIMITS;
use mariana_field::rays::ROOT_SIDE;
use mariana_field::region::ROOT_GROWTH;
use mariana_field::region::{MEDIUM_SIDE, MediumGrid, Regions};
use mariana_field::world::{Bounds, LightKind, PLANES_MAX, TILE_PARTS, WIDEST, World};
use mariana_music::{HISTORY_POINTS, SPECTRUM_POINTS, WAVEFORM_POINTS};

const _: () = assert!(PLANES_MAX <= 4, "the objects of the planes are one vector");

/// Number of vec4 before the block's arrays.
const HEAD: usize = 19;
const LIGHT: usize = 4;
const LIGHTS_MAX: usize = FIELD_LIMITS.scene_lights_max;
const HEARD_QUADS: usize = SoundInput::ALL.len().div_ceil(4);
const PARAM_QUADS: usize = FIELD_LIMITS.scene_params_max.div_ceil(4);
const HOISTED_QUADS: usize = FIELD_LIMITS.hoisted_max.div_ceil(4);

/// Number of vec4 in the block.
pub const FRAME_BLOCK_VECTORS: usize =
    HEAD + PLANES_MAX + LIGHT * LIGHTS_MAX + HEARD_QUADS + LEVEL_COUNT + PARAM_QUADS + HOISTED_QUADS;

/// The block of one frame.
pub type FrameBlock = [[f32; 4]; FRAME_BLOCK_VECTORS];

/// The defines of `shaders/frame_block.glsl`: the lengths of the block's arrays and of the sound tables.
pub fn block_defines() -> [String; 16] {
    [
        format!("PLANES_MAX {PLANES_MAX}"),
        format!("LIGHTS_MAX {LIGHTS_MAX}"),
        format!("LEVEL_COUNT {LEVEL_COUNT}"),
        format!("HEARD_QUADS {HEARD_QUADS}"),
        format!("PARAM_QUADS {PARAM_QUADS}"),
        format!("HOISTED_QUADS {HOISTED_QUADS}"),
        format!("SPECTRUM_POINTS {SPECTRUM_POINTS}"),
        format!("WAVEFORM_POINTS {WAVEFORM_POINTS}"),
        format!("HISTORY_POINTS {HISTORY_POINTS}"),
        format!("PART_NUMBERS {}", PartInput::COUNT),
        format!("MEDIUM_SIDE {MEDIUM_SIDE}"),
        format!("SWARM_WIDEST {WIDEST:?}"),
        format!("SWARM_TILE_PARTS {TILE_PARTS:?}"),
        format!("SHAPE_COLUMNS {SHAPE_COLUMNS}"),
        format!("SHAPE_STEP {SHAPE_STEP:?}"),
        format!("SHAPE_NUMBER_COUNT {}", SHAPE_NUMBERS * FRAME_SHAPES_MAX),
    ]
}

/// The shader divides by the reach of ambient light, so it must not be 0.
const REACH_MIN: f32 = 1e-4;

impl Frame {
    /// Packs the frame for the shaders, with its tree and the grid over its media. Every number is finite.
    pub fn block(&self, world: &World, tree: &Regions, medium: Option<&MediumGrid>) -> FrameBlock {
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let camera = &self.camera;
        let ([right, up, forward], projection) = self.projection.packed(camera);
        let (eye_width, eye_height) = self.projection.eye_size(self.size);
        // The radius of a pixel's cone at distance 1.
        let pixel_radius = self.projection.pixel_radius(camera, self.size);
        let inputs = &self.inputs;
        let [screen_width, screen_height] = inputs.screen.size;
        let pointer = |input| inputs.screen.value(input);
        let xyz = |v: glam::DVec3, w: f64| [v.x, v.y, v.z, w].map(|value| value as f32);
        let planes = self.planes();
        let (first_row, row_span) = inputs.history.scroll();
        let lights = self.values.lights.iter().take(LIGHTS_MAX);
        let bounds = tree.bounds.or(world.bounds);
        let Bounds { low, high } = bounds.unwrap_or(Bounds::around([0.0; 3], 0.0));
        let mut plane_objects = [0.0; 4];
        for (to, plane) in plane_objects.iter_mut().zip(&world.planes) {
            *to = plane.object as f32;
        }
        let has_cells = tree.size.iter().all(|side| *side > 0.0);
        let per_unit = tree.size.map(|side| if has_cells { ROOT_SIDE / side } else { 1.0 });
        let middle = |axis: usize| tree.low[axis] + 0.5 * tree.size[axis];
        let growth = ROOT_GROWTH.pow(tree.roots.saturating_sub(1) as u32) as f32;
        let half_side = if has_cells { 0.5 * ROOT_SIDE * growth } else { 0.0 };
        let mut media = media(world, medium, sound_tables::texel_count(inputs));
        let last_frame = world.scene.textures.iter().position(TextureRef::is_last_frame);
        media[0][3] = last_frame.map_or(-1.0, |number| number as f32);
        let mut block = [[0.0; 4]; FRAME_BLOCK_VECTORS];
        let head: [[f32; 4]; HEAD] = [
            [width, height, 1.0 / width, 1.0 / height].map(|value| value as f32),
            xyz(camera.position, pixel_radius),
            xyz(right, sound_tables::first_shape(inputs, medium) as f64),
            xyz(up, inputs.shapes.rows() as f64),
            xyz(forward, f64::from(self.values.bounce)),
            [inputs.time, self.values.lights.len() as f32, first_row, row_span],
            // The last component of each line is a flag: the world has something to trace; the bounds are known.
            [low[0], low[1], low[2], if world.has_rest { 1.0 } else { 0.0 }],
            [high[0], high[1], high[2], if bounds.is_some() { 1.0 } else { 0.0 }],
            plane_objects,
            [middle(0), middle(1), middle(2), half_side],
            [per_unit[0], per_unit[1], per_unit[2], tree.whole_tape as f32],
            [self.values.reach.max(REACH_MIN), self.quality.clamp(0.0, 1.0), 0.0, world.shadow_step_growth()],
            [screen_width, screen_height, screen_width / eye_width as f32, screen_height / eye_height as f32],
            [
                pointer(MouseX),
                pointer(MouseY),
                pointer(MousePressed),
                sound_tables::first_of_swarm(inputs, medium) as f32,
            ],
            projection.map(|value| value as f32),
            media[0],
            media[1],
            media[2],
            media[3],
        ];
        let mut rest = &mut block[..];
        put(&mut rest, HEAD, head);
        put(&mut rest, PLANES_MAX, planes);
        put(&mut rest, LIGHT * LIGHTS_MAX, lights.flat_map(light));
        put(&mut rest, HEARD_QUADS, quads(inputs.sound.numbers()));
        put(&mut rest, LEVEL_COUNT, inputs.levels.numbers().iter().map(|level| [*level, 0.0, 0.0, 0.0]));
        put(&mut rest, PARAM_QUADS, quads(&inputs.params));
        put(&mut rest, HOISTED_QUADS, quads(&inputs.hoisted));
        for value in block.as_flattened_mut() {
            *value = super::finite(*value);
        }
        block
    }

    /// The planes: a unit normal, and the origin's distance from the plane. The normal of a missing plane is 0.
    pub(super) fn planes(&self) -> impl Iterator<Item = [f32; 4]> {
        self.values.planes.iter().take(PLANES_MAX).map(|plane| {
            let [a, b, c, d] = plane.map(f64::from);
            let slope = (a * a + b * b + c * c).sqrt();
            let is_plane = slope > 0.0 && slope.is_finite() && d.is_finite();
            if is_plane { [a, b, c, d].map(|value| (value / slope) as f32) } else { [0.0; 4] }
        })
    }
}

/// Endless sides of media end at this coordinate, which is finite as all numbers of the block.
const ENDLESS: f32 = 1e9;

/// The box of the media, and the grid over them, which begins at the texel `first`.
fn media(world: &World, medium: Option<&MediumGrid>, first: usize) -> [[f32; 4]; 4] {
    let Some(grid) = medium else { return [[0.0; 4]; 4] };
    let [low, high] = [world.medium_bounds.low, world.medium_bounds.high]
        .map(|corner| corner.map(|at| at.clamp(-ENDLESS, ENDLESS)));
    let scale = grid.size.map(|side| MEDIUM_SIDE as f32 / side);
    [
        [low[0], low[1], low[2], 0.0],
        [high[0], high[1], high[2], 0.0],
        [grid.low[0], grid.low[1], grid.low[2], first as f32],
        [scale[0], scale[1], scale[2], grid.densest()],
    ]
}

/// The numbers of the kinds of lights, as defines for `shaders/light.glsl`.
pub fn light_defines() -> impl Iterator<Item = String> {
    let kinds = LightKind::ALL.into_iter().map(|(kind, name)| format!("LIGHT_{name} {:?}", number_of(kind)));
    kinds.chain([format!("LIGHT_KINDS {}", LightKind::ALL.len())])
}

fn number_of(kind: LightKind) -> f32 {
    kind as u8 as f32 + 1.0
}

fn light(light: &Light<f32>) -> [[f32; 4]; LIGHT] {
    let light = light.clone().in_ranges(|number, range| range.clamp(number));
    let ([x, y, z], kind) = (light.place(), number_of(light.kind));
    let ([r, g, b], [rx, ry, rz], [ux, uy, uz]) = (light.color, light.right, light.up);
    [[x, y, z, kind], [r, g, b, light.radius], [rx, ry, rz, light.range], [ux, uy, uz, light.shadow]]
}

fn put(rest: &mut &mut [[f32; 4]], length: usize, vectors: impl IntoIterator<Item = [f32; 4]>) {
    let (member, behind) = std::mem::take(rest).split_at_mut(length);
    for (to, from) in member.iter_mut().zip(vectors) {
        *to = from;
    }
    *rest = behind;
}

fn quads(values: &[f32]) -> impl Iterator<Item = [f32; 4]> + '_ {
    values.chunks(4).map(|chunk| std::array::from_fn(|place| chunk.get(place).copied().unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::testing::world_of;
    use mariana_music::Features;

    #[test]
    fn all_members_are_packed_in_order_and_finite() {
        let text = "param a = 0.5 in 0 .. 1\nparam b = 2 in 0 .. 4\n\
                    object floor { shape = 2 * p.y - 1 }\nobject ball { shape = sphere(p, 1) }\n\
                    light sun { direction = vec3(0, -1, 0) color = vec3(exp(99 + t), 2, 0) }";
        let world = world_of(text);
        let mut features = Features::default();
        for (index, band) in features.bands.iter_mut().enumerate() {
            *band = index as f32 / 32.0;
        }
        features.bands[7] = f32::NAN;
        features.volume = [0.25, f32::INFINITY];
        let block = Frame::with_params(&world, f64::NAN, features, (0, 7), &[f32::NAN, 9.0]);
        let mut tree = Regions::default();
        (tree.low, tree.size) = ([1.0; 3], [2.0, 4.0, 8.0]);
        (tree.roots, tree.whole_tape) = (2, 9);
        let block = block.block(&world, &tree, None);
        assert!(block.as_flattened().iter().all(|value| value.is_finite()));
        assert_eq!(block[0], [1.0, 7.0, 1.0, 1.0 / 7.0]);
        assert_eq!(block[5], [0.0, 1.0, 0.0, 0.0], "time, number of lights, rows of the history");
        assert_eq!((block[6][3], block[7][3]), (1.0, 1.0));
        assert_eq!(block[9..11], [[2.0, 3.0, 5.0, 32.0], [8.0, 4.0, 2.0, 9.0]]);
        assert_eq!(block[HEAD], [0.0, 1.0, 0.0, -0.5]);
        let lights = HEAD + PLANES_MAX;
        assert_eq!(block[lights], [0.0, -1.0, 0.0, 2.0]);
        assert_eq!(block[lights + 1][1], 2.0);
        assert_eq!(block[lights + 3], [0.0, 0.0, 0.0, 1.0], "the scene does not set the shadow");
        assert_eq!(block[lights + LIGHT][3], 0.0, "there is no second light");
        let bands = lights + LIGHT * LIGHTS_MAX;
        assert_eq!(block[bands][..2], [0.25, 0.0], "volumes");
        let bands = bands + HEARD_QUADS;
        assert_eq!(block[bands + 3], [3.0 / 32.0, 0.0, 0.0, 0.0]);
        assert_eq!(block[bands + 7][0], 0.0);
        assert_eq!(block[bands + LEVEL_COUNT], [0.5, 4.0, 0.0, 0.0]);
    }
}
