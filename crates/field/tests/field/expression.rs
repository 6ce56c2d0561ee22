//! Random expressions, and the effect of rounding on them.

use mariana_field::graph::{AtlasShape, ShapeAtlas, ShapeGrid};
use mariana_field::graph::{FrameInputs, Graph, Input, Node, NodeId, Op, PartInput, Point, TableData};
use mariana_field::graph::{LEVEL_COUNT, LevelList, Levels, SoundInput, SoundInputs, levels_glsl};

/// A small generator of reproducible random numbers (splitmix64; Steele et al. 2014).
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.word() % end as u64) as usize
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.word() >> 40) as f32 / (1u32 << 24) as f32
    }
}

/// Builds about `operators` operators. All operators are equally likely. Most operands are recent results, so that few
/// results stay unused.
pub(crate) fn random_expression(random: &mut Random, graph: &mut Graph, operators: usize) -> NodeId {
    let of_frame = [
        Input::T,
        Input::Sound(SoundInput::VolumeLeft),
        Input::Level(LevelList::Band.nearest(7.0)),
        Input::Param(1),
    ];
    let inputs = [&Input::OF_POINT[..], &of_frame].concat();
    let mut unused: Vec<NodeId> = Vec::new();
    let leaf = |random: &mut Random, graph: &mut Graph| match random.below(10) {
        0 => {
            let whole = random.below(9) as f32 - 4.0;
            graph.constant(whole)
        }
        1 | 2 => {
            let number = random.between(-4.0, 4.0);
            graph.constant(number)
        }
        3..=6 => graph.input(inputs[random.below(3)]),
        _ => graph.input(inputs[random.below(inputs.len())]),
    };
    for _ in 0..operators {
        let op = Op::ALL[random.below(Op::ALL.len())];
        let mut operand = |random: &mut Random, graph: &mut Graph| {
            if unused.is_empty() || random.below(3) == 0 {
                leaf(random, graph)
            } else {
                let place = unused.len() - 1 - random.below(unused.len().min(3));
                if random.below(4) == 0 { unused[place] } else { unused.remove(place) }
            }
        };
        let a = operand(random, graph);
        let node = if op.arity() == 1 {
            graph.unary(op, a)
        } else {
            let b = operand(random, graph);
            graph.binary(op, a, b)
        };
        if graph.as_constant(node).is_none() {
            unused.push(node);
        }
    }
    let mut root = unused.pop().unwrap_or_else(|| leaf(random, graph));
    for node in unused {
        root = graph.add(root, node);
    }
    root
}

/// Returns the inputs of a frame with some sound; [`tables_glsl`] contains the same tables.
pub(crate) fn frame() -> FrameInputs {
    FrameInputs {
        time: 12.5,
        sound: SoundInputs::with(&[(SoundInput::VolumeLeft, 0.25), (SoundInput::VolumeRight, 0.75)]),
        levels: levels(),
        parts: (0..PartInput::COUNT).map(|i| i as f32 * 0.015625 - 0.5).collect(),
        params: vec![1.0, -2.5],
        spectrum: TableData::row(vec![0.5, 0.25, 0.75, 1.0, 0.125]),
        waveform: TableData::row(vec![-0.5, 0.25, -0.75, 1.0]),
        history: TableData::rows(vec![0.5, 0.25, 0.75, 1.0, 0.0, 0.375], 3),
        shapes: shapes(),
        ..FrameInputs::default()
    }
}

/// Returns a grid of three columns and two rows.
fn shapes() -> ShapeAtlas {
    let grid = ShapeGrid::new(vec![0.5, -0.25, 0.25, 0.75, 0.125, 1.5], 3, 2.0);
    let shapes = grid.into_iter().map(|grid| AtlasShape { grid, changes: false });
    ShapeAtlas::new(shapes.collect()).unwrap_or_default()
}

/// Returns levels that differ from place to place and have short decimals.
fn levels() -> Levels {
    let mut levels = Levels::SILENCE;
    for list in LevelList::ALL {
        for (number, level) in levels.of_mut(list).iter_mut().enumerate() {
            *level = (list.first() + number) as f32 * 0.0625 - 0.5;
        }
    }
    levels
}

/// Returns the GLSL declarations that the generated code needs, with the same values as in [`frame`].
pub(crate) fn tables_glsl() -> String {
    let levels =
        levels().numbers().iter().map(|level| format!("vec4({level:?})")).collect::<Vec<_>>().join(", ");
    let count = LEVEL_COUNT;
    format!("const vec4 frame_levels[{count}] = vec4[{count}]({levels});\n{}{CURVES_GLSL}", levels_glsl())
}

const CURVES_GLSL: &str = "\
const float frame_time = 12.5;
const vec4 frame_heard[1] = vec4[1](vec4(0.25, 0.75, 0.0, 0.0));
const vec4 frame_params[1] = vec4[1](vec4(1.0, -2.5, 0.0, 0.0));
float unit(float v) { return v > 0.0 ? min(v, 1.0) : 0.0; }
float table_part(float i) { return floor(i > 0.0 ? min(i, 223.0) : 0.0) * 0.015625 - 0.5; }
float entry(int table, int row, int at, int count) {
    const float entries[15] = float[15](0.5, 0.25, 0.75, 1.0, 0.125, -0.5, 0.25, -0.75, 1.0, 0.5, 0.25, 0.75, 1.0, 0.0, 0.375);
    at = at < 0 ? -at : at >= count ? 2 * (count - 1) - at : at;
    return entries[table + row * count + at];
}
float cubic(float d) {
    d = abs(d);
    float far = max(2.0 - d, 0.0);
    return d < 1.0 ? 2.0 / 3.0 - d * d * (1.0 - 0.5 * d) : far * far * far / 6.0;
}
float along_row(int table, int row, int count, float u) {
    float along = unit(u) * float(count - 1);
    int first = min(int(along), count - 2);
    float sum = 0.0;
    for (int k = -1; k < 3; k++)
        sum += cubic(along - float(first + k)) * entry(table, row, first + k, count);
    return sum;
}
float table_spectrum(float u) { return along_row(0, 0, 5, u); }
float table_waveform(float u) { return along_row(5, 0, 4, u); }
float shape_number(float i) {
    const float numbers[5] = float[5](0.5, 0.25, 0.03125, 0.015625, 0.0078125);
    int number = int(i > 0.0 ? min(i, 319.0) : 0.0);
    return number < 5 ? numbers[number] : 0.0;
}
float shape_entry(int column, int row) {
    const float entries[6] = float[6](0.5, -0.25, 0.25, 0.75, 0.125, 1.5);
    return column < 4 && row < 3 ? entries[3 * min(row, 1) + min(column, 2)] : 1.0;
}
float shape_distance(float u, float v) {
    float x = u > 0.0 ? min(64.0 * u, 2047.0) : 0.0;
    float y = v > 0.0 ? min(64.0 * v, 2.0) : 0.0;
    int column = min(int(x), 2046);
    int row = min(int(y), 1);
    float lower = mix(shape_entry(column, row), shape_entry(column + 1, row), x - float(column));
    float upper = mix(shape_entry(column, row + 1), shape_entry(column + 1, row + 1), x - float(column));
    return mix(lower, upper, y - float(row));
}
float table_history(float u, float v) {
    float y = unit(v);
    float now = along_row(9, 0, 3, u);
    float oldest = along_row(9, 1, 3, u);
    return now * (cubic(y) + cubic(2.0 - y)) + oldest * (cubic(1.0 - y) + cubic(1.0 + y));
}
";

/// The largest error that drivers make in an operator's result, given its first operand and its exact result.
pub(crate) type Disturbance = fn(op: Op, a: f32, result: f32) -> f32;

/// Returns the largest change of the last node of `order` at a point when the results of all operators are disturbed.
/// It is the maximum of a few tries, and infinite if a value is not finite.
pub(crate) fn spread(
    graph: &Graph,
    order: &[NodeId],
    point: &Point,
    frame: &FrameInputs,
    disturbance: Disturbance,
    random: &mut Random,
) -> f32 {
    let Some(root) = order.last() else { return 0.0 };
    let mut values = vec![0.0f32; root.index() + 1];
    let mut exact = None;
    let mut largest = 0.0f32;
    for attempt in 0..11 {
        // Larger disturbances reach jumps farther away. Smooth errors are proportional, so divide by the size below.
        let size = if attempt % 2 == 0 { 1.0 } else { 4.0 };
        for &id in order {
            // Some drivers give an exact whole number where others give a number close to it, as at the ends of a TANH.
            let disturb = |op: Op, a: f32, value: f32, random: &mut Random| {
                let by = size * disturbance(op, a, value);
                match random.below(2) {
                    _ if attempt == 0 => value,
                    _ if attempt == 1 && (value.round() - value).abs() <= by => value.round(),
                    _ if attempt == 1 => value,
                    0 => value + by,
                    _ => value - by,
                }
            };
            let value = |id: NodeId| values[id.index()];
            values[id.index()] = match graph.node(id) {
                Node::Constant(value) => value,
                Node::Input(input) => match input.of_point() {
                    Some(place) => point.inputs()[place],
                    None => frame.value(input),
                },
                Node::Unary(op, a) => disturb(op, value(a), op.value(value(a), 0.0, frame), random),
                Node::Binary(op, a, b) => disturb(op, value(a), op.value(value(a), value(b), frame), random),
                Node::Texture { .. } => 0.0,
            };
        }
        if order.iter().any(|id| !values[id.index()].is_finite()) {
            return f32::INFINITY;
        }
        let value = values[root.index()];
        largest = largest.max((value - *exact.get_or_insert(value)).abs() / size);
    }
    largest
}
