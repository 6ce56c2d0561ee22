//! A world as the interpreter's texels: the programs of its materials and of its light.
//!
//! | texel | holds |
//! |---|---|
//! | 0 | the addresses of the grids of the sky, the ambient light, the glow and the media |
//! | 1.. | for each object, the addresses of the grids of its material's two programs; two objects in a texel |
//! | a grid | its lower corner; the number of the last cell along each axis (7, or 0 for a single cell) |
//! | | cells per unit of length along each axis, 0 |
//! | | for each cell, x first, the address of its program; four cells in a texel |
//! | a program | a header: the registers of up to 12 outputs ([`OUTPUTS_MAX`]), a byte each; the number of sampled textures |
//! | | a texel for each sampled texture: the number of the image, the address of the tape of its coordinates |
//! | | the program's tape |
//! | | the tapes of the coordinates |
//!
//! [`crate::tape::interpreter`] describes the tapes, which contain a frame's numbers. Distances and objects are
//! computed by the tapes of regions. Cells run shortened programs (`region::surface`), except for texture
//! coordinates.
//!
//! Textures are sampled before a program's own tape runs. Thus only the texture coordinates, which take a few clauses,
//! are also computed for the neighbouring pixels. If a texture's coordinates depend on a second texture, the second
//! texture is sampled first.

use std::iter;

use super::{Bounds, ShortPrograms, SwarmPlan, World, WorthShortening};
use crate::graph::{FrameInputs, Graph, Node, NodeId};
use crate::lang::{Material, SURFACE_NUMBERS};
use crate::region::surface::{Grid, OF_POINT, Over, SIDE, ShortTape, ShortTapes, SurfacePlan};
use crate::region::{Encoder, Formula, FrameTape, MediumPlan, Needs, REGISTERS_MAX, compounds_that_pay};
use crate::tape::interpreter::{Variant, rounded_registers};
use crate::tape::{Tape, glsl};

/// Number of programs before the programs of materials: sky, ambient light, glow and media.
const PROGRAMS_OF_LIGHT: usize = 4;

/// Maximum number of outputs of a program.
const OUTPUTS_MAX: usize = 12;
const _: () = assert!(
    SURFACE_NUMBERS <= OUTPUTS_MAX && Material::NUMBERS - SURFACE_NUMBERS <= OUTPUTS_MAX,
    "a material has more numbers than two programs have outputs"
);

/// The programs that the interpreter shader runs at a surface.
#[derive(Debug, Clone)]
pub struct TapeBuffers {
    /// The programs of sky, ambient light, glow, media, the materials' surfaces and the materials' bodies, in this
    /// order. If no material uses the fields of a body, all materials share the last program, which only interpreters
    /// for several scenes run.
    programs: Vec<SurfaceTape>,
    of_objects: Vec<[usize; 2]>,
    /// The plan of the grid over the media; `None` without media.
    pub medium: Option<MediumPlan>,
    /// The plan of the swarms; `None` without swarms.
    pub swarm: Option<SwarmPlan>,
    bounds: Option<Bounds>,
    /// The interpreter that runs all programs, on a GPU.
    pub variant: Variant,
    /// The interpreter for a renderer that never skips a branch.
    pub software_variant: Variant,
    /// True if there are enough registers for all programs.
    pub runs: bool,
    /// The cost in clauses.
    pub cost: Cost,
}

#[derive(Debug, Clone)]
struct SurfaceTape {
    plan: SurfacePlan,
    /// The number of each texture, and its coordinates u and v.
    textures: Vec<(u16, Formula)>,
    needs: Needs,
    /// The program's own tape, then a tape for the coordinates of each texture.
    tapes: Vec<FrameTape>,
}

/// Half the side of the grid in a scene without bounds.
const AROUND_CENTER: f32 = 12.0;

/// The number of clauses of the programs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Cost {
    /// Clauses of the distance.
    pub distance: usize,
    /// Clauses of all materials.
    pub materials: usize,
    /// Clauses of all programs.
    pub total: usize,
    /// Statements of the compiled functions, where the rounds of a loop count once.
    pub compiled: usize,
}

impl SurfaceTape {
    fn new(graph: &Graph, roots: &[NodeId], over: Over) -> Self {
        // Few programs sample textures. The others need no copy of the graph.
        let samples = !graph.inputs_used(roots).textures.is_empty();
        let separated = samples.then(|| without_coordinates(graph, roots));
        let (graph, mut read, textures) = match &separated {
            Some((own, roots, textures)) => (own, roots.clone(), &textures[..]),
            None => (graph, roots.to_vec(), &[][..]),
        };
        read.extend(textures.iter().flat_map(|(_, place)| place));
        let graph = graph.fused(&mut read);
        let (roots, places) = read.split_at(roots.len());
        let mut needs = Needs::NONE;
        let mut formula = |roots: &[NodeId]| {
            let mut formula = Formula::new(&graph, roots, OF_POINT, textures.len());
            needs.add(&formula.needs());
            formula
        };
        let plan = SurfacePlan { formula: formula(roots), over };
        let places = textures.iter().zip(places.as_chunks::<2>().0);
        let textures = places.map(|((picture, _), place)| (*picture, formula(place))).collect();
        Self { plan, textures, needs, tapes: Vec::new() }
    }

    fn formulas(&self) -> impl Iterator<Item = &Formula> {
        iter::once(&self.plan.formula).chain(self.textures.iter().map(|(_, coordinates)| coordinates))
    }

    fn encode(&mut self, encoder: &mut Encoder) {
        self.tapes = self.formulas().map(|formula| formula.tape(encoder)).collect();
    }

    /// Number of texels, including the header.
    fn len(&self) -> usize {
        1 + self.textures.len() + self.tapes.iter().map(FrameTape::len).sum::<usize>()
    }

    fn head(registers: &[u8], textures: usize) -> [u32; 4] {
        let byte = |place: usize| registers.get(place).copied().unwrap_or(0);
        let [a, b, c] = [0, 4, 8].map(|first| u32::from_le_bytes([0, 1, 2, 3].map(|at| byte(first + at))));
        [a, b, c, textures as u32]
    }

    /// Appends a shortened tape and returns its address. The program's whole tape begins at `whole`.
    fn append_short(&self, short: &ShortTape, whole: usize, texels: &mut Vec<[u32; 4]>) -> u32 {
        let start = texels.len() as u32;
        let textures = if short.samples { self.textures.len() } else { 0 };
        texels.push(Self::head(&short.outputs, textures));
        texels.extend_from_within(whole + 1..whole + 1 + textures);
        texels.extend_from_slice(&short.texels);
        start
    }

    fn append(&self, inputs: &FrameInputs, texels: &mut Vec<[u32; 4]>) {
        let head = texels.len();
        let outputs = self.tapes.first().map_or(&[][..], |tape| &tape.outputs);
        texels.push(Self::head(outputs, self.textures.len()));
        texels.extend(self.textures.iter().map(|(picture, _)| [u32::from(*picture), 0, 0, 0]));
        for (number, tape) in self.tapes.iter().enumerate() {
            if number > 0 {
                texels[head + number][1] = texels.len() as u32;
            }
            tape.append(inputs, texels);
        }
    }
}

type Sampled = (u16, [NodeId; 2]);

/// Separates the texture coordinates from the other expressions. Returns the remaining graph and roots, and each
/// texture's coordinates. Textures are numbered in an order in which they can be sampled.
fn without_coordinates(graph: &Graph, roots: &[NodeId]) -> (Graph, Vec<NodeId>, Vec<Sampled>) {
    let mut own = Graph::new();
    let mut textures: Vec<Sampled> = Vec::new();
    let mut moved = vec![NodeId::default(); graph.len()];
    for id in graph.order(roots) {
        let at = |id: NodeId| moved[id.index()];
        let copy = match graph.node(id) {
            Node::Texture { texture, channel, u, v } => {
                let sampled = (texture, [at(u), at(v)]);
                let known = textures.iter().position(|known| *known == sampled);
                let number = known.unwrap_or(textures.len());
                if known.is_none() {
                    textures.push(sampled);
                }
                let nowhere = own.constant(0.0);
                own.texture(number as u16, channel, nowhere, nowhere)
            }
            node => own.raw(node.with_operands(at)),
        };
        moved[id.index()] = copy;
    }
    let roots = roots.iter().map(|root| moved[root.index()]).collect();
    (own, roots, textures)
}

impl TapeBuffers {
    /// Returns the texels that the interpreter reads in a frame. Programs that were shortened with other numbers are
    /// written whole.
    pub fn texels(&self, inputs: &FrameInputs, short: &ShortPrograms) -> Vec<[u32; 4]> {
        let heads = 1 + self.of_objects.len().div_ceil(2);
        let mut texels = vec![[0; 4]; heads];
        let everywhere = ShortTapes::default();
        let starts: Vec<u32> = self
            .programs
            .iter()
            .enumerate()
            .map(|(number, program)| {
                let whole = texels.len();
                program.append(inputs, &mut texels);
                let short =
                    short.tapes_of(number, || program.plan.formula.key(inputs)).unwrap_or(&everywhere);
                let append = |tape| program.append_short(tape, whole, &mut texels);
                let starts: Vec<u32> = short.tapes.iter().map(append).collect();
                append_grid(short, whole as u32, &starts, &mut texels)
            })
            .collect();
        let start = |program: usize| starts.get(program).copied().unwrap_or(0);
        let directory = [start(0), start(1), start(2), start(3)]
            .into_iter()
            .chain(self.of_objects.iter().flatten().map(|&program| start(program)));
        for (to, from) in texels.as_flattened_mut().iter_mut().zip(directory) {
            *to = from;
        }
        texels
    }

    /// Returns the programs to try to shorten first: all programs that are neither too short nor too long.
    pub fn worth_shortening(&self) -> WorthShortening {
        WorthShortening::of(self.plans().map(SurfacePlan::may_become_shorter))
    }

    pub(super) fn plans(&self) -> impl Iterator<Item = &SurfacePlan> {
        self.programs.iter().map(|program| &program.plan)
    }

    /// Creates an encoder of tapes that both variants can run.
    pub(super) fn encoder(&self) -> Encoder {
        Encoder::new(self.variant.compounds, self.software_variant.registers)
    }

    pub(super) fn whole_length(&self, program: usize) -> usize {
        self.programs.get(program).map_or(0, SurfaceTape::len)
    }

    /// Returns the grid over the scene's bounds. If the scene has no bounds, the grid is centred on `center`.
    pub(super) fn grid(&self, center: [f32; 3]) -> Grid {
        let bounds = self.bounds.unwrap_or_else(|| Bounds::around(center, AROUND_CENTER));
        Grid::of_box(bounds.low, bounds.high)
    }

    /// Returns the number of texels that a frame needs without shortened programs.
    pub fn texels_max(&self) -> usize {
        // The grid of a single cell has three texels.
        let programs = self.programs.iter().map(|program| program.len() + 3).sum::<usize>();
        1 + self.of_objects.len().div_ceil(2) + programs
    }
}

/// Appends a program's grid, given the addresses of the whole tape and of the shortened tapes. Returns the grid's
/// address.
fn append_grid(short: &ShortTapes, whole: u32, starts: &[u32], texels: &mut Vec<[u32; 4]>) -> u32 {
    let start = texels.len() as u32;
    let [x, y, z] = short.grid.low.map(f32::to_bits);
    let of = |tape: &Option<usize>| tape.and_then(|tape| starts.get(tape)).copied().unwrap_or(whole);
    let cells: Vec<u32> = short.cells.iter().map(of).collect();
    if starts.is_empty() {
        texels.extend([[0; 4], [0; 4], [whole; 4]]);
    } else {
        let [per_x, per_y, per_z] = short.grid.scale.map(f32::to_bits);
        texels.extend([[x, y, z, SIDE as u32 - 1], [per_x, per_y, per_z, 0]]);
        texels.extend_from_slice(cells.as_chunks::<4>().0);
    }
    start
}

impl World {
    /// Returns the programs of materials and light.
    pub fn tape_buffers(&self) -> TapeBuffers {
        let program = |(roots, over): (&[NodeId], Over)| SurfaceTape::new(&self.graph, roots, over);
        let of_light = [
            (&self.roots.sky[..], Over::Directions),
            (&self.roots.ambient, Over::Directions),
            (&self.roots.glow, Over::Points),
            (self.roots.medium.as_ref().map_or(&[][..], |medium| &medium[..]), Over::Points),
        ];
        let materials = &self.roots.materials;
        let has_bodies = self.features.body();
        let bodies = if has_bodies { materials.len() } else { 1 };
        let surfaces = materials.iter().map(|roots| &roots[..SURFACE_NUMBERS]);
        let of_materials =
            surfaces.chain(materials.iter().take(bodies).map(|roots| &roots[SURFACE_NUMBERS..]));
        let of_materials = of_materials.map(|roots| (roots, Over::Points));
        let mut programs: Vec<SurfaceTape> = of_light.into_iter().chain(of_materials).map(program).collect();
        // The programs that the scene's own interpreter runs.
        let run = if has_bodies { programs.len() } else { PROGRAMS_OF_LIGHT + materials.len() };
        let medium = self.roots.medium.map(|[density, _, _, _, r, g, b, _]| {
            MediumPlan::new(&self.graph, [density, r, g, b], self.medium_bounds)
        });
        let of_material = |material: usize| {
            let body = materials.len() + material.min(bodies - 1);
            [material, body].map(|program| PROGRAMS_OF_LIGHT + program)
        };
        let of_objects = self.scene.objects.iter().map(|object| of_material(object.material)).collect();
        let mut needs = Needs::NONE;
        programs[..run].iter().for_each(|program| needs.add(&program.needs));
        // The other programs are written with the same encoder, for interpreters that several scenes share.
        let registers = programs.iter().filter_map(|program| program.needs.registers).max();
        needs.registers = needs.registers.and(registers);
        let [on_gpu, on_processor] = self.variants(&programs[..run], &needs);
        let cost = self.cost(&programs[..run]);
        let mut encoder = Encoder::new(on_gpu.compounds, on_processor.registers);
        programs.iter_mut().for_each(|program| program.encode(&mut encoder));
        TapeBuffers {
            variant: on_gpu,
            software_variant: on_processor,
            runs: needs.registers.is_some(),
            cost,
            programs,
            of_objects,
            medium,
            swarm: SwarmPlan::of(&self.scene, self.features.mirrors),
            bounds: self.bounds,
        }
    }

    fn cost(&self, run: &[SurfaceTape]) -> Cost {
        let steps =
            |programs: &[SurfaceTape]| programs.iter().map(|program| program.needs.steps).sum::<usize>();
        let (of_light, of_materials) = run.split_at(PROGRAMS_OF_LIGHT);
        let clauses = |roots: &[NodeId]| Tape::new(&self.graph, roots).clauses.len();
        let (distance, materials) = (clauses(&self.roots.distance), steps(of_materials));
        let total = distance + clauses(&[self.roots.object]) + materials + steps(of_light);
        let functions = self.functions().into_iter();
        let statements = functions.map(|function| glsl::statements(&self.graph, &function.roots));
        Cost { distance, materials, total, compiled: statements.sum() }
    }

    /// Returns the interpreters that run the programs: on a GPU, and on a renderer that never skips a branch. Numbers are
    /// rounded up, so that few variants serve many scenes.
    fn variants(&self, run: &[SurfaceTape], needs: &Needs) -> [Variant; 2] {
        let compounds = compounds_that_pay(run.iter().flat_map(SurfaceTape::formulas));
        let registers = needs.registers.unwrap_or(REGISTERS_MAX).max(8);
        [(false, registers.next_power_of_two()), (true, rounded_registers(registers))].map(
            |(every_case, registers)| Variant {
                operators: needs.operators.clone(),
                compounds,
                registers,
                samples: run.iter().map(|program| program.textures.len()).max().unwrap_or(0),
                textures: self.pictures.len(),
                every_case,
            },
        )
    }
}

#[cfg(test)]
#[path = "shortened_tests.rs"]
mod shortened_tests;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Compounds;
    use crate::world::testing::world_of;

    #[test]
    fn every_program_begins_at_its_address_in_the_directory() {
        let text = "material a { color = p }\nmaterial b { color = n roughness = 0.25 }\n\
                    object first { shape = sphere(p, 1) material = a }\n\
                    object second { shape = box(p, 1) material = b }\n\
                    object third { shape = sphere(p, 2) material = a }";
        let world = world_of(text);
        let inputs = FrameInputs::default();
        let buffers = world.tape_buffers();
        let texels = buffers.texels(&inputs, &ShortPrograms::default());
        let directory = [texels[0], texels[1], texels[2]];
        assert_eq!(directory[1][0], directory[2][0], "the first and the third object are of one material");
        for (grid, roots) in [
            (directory[0][0], &world.roots.sky[..]),
            (directory[0][1], &world.roots.ambient),
            (directory[0][2], &world.roots.glow),
            (directory[1][0], &world.roots.materials[0][..SURFACE_NUMBERS]),
            (directory[1][1], &world.roots.materials[0][SURFACE_NUMBERS..]),
            (directory[1][2], &world.roots.materials[1][..SURFACE_NUMBERS]),
        ] {
            let program = texels[grid as usize + 2][0];
            let (mut alone, mut tape) = (Vec::new(), SurfaceTape::new(&world.graph, roots, Over::Points));
            tape.encode(&mut buffers.encoder());
            tape.append(&inputs, &mut alone);
            assert_eq!(texels[program as usize..][..alone.len()], alone);
        }
        assert_eq!(texels.len(), buffers.texels_max());
    }

    #[test]
    fn there_are_enough_registers_for_every_shipped_scene() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
        let (mut count, most) = (0, Variant::universal().registers);
        for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.extension().is_some_and(|extension| extension == "scene") {
                let text = std::fs::read_to_string(&path).unwrap();
                let mut include = |name: &str| {
                    std::fs::read_to_string(folder.join(name)).map_err(|error| error.to_string())
                };
                let scene = crate::lang::compile("shipped", &text, &mut include).scene.unwrap();
                let buffers = World::new("shipped", scene, Vec::new()).unwrap().tape_buffers();
                assert!(buffers.runs && buffers.variant.registers <= most, "{path:?}: {:?}", buffers.variant);
                count += 1;
            }
        }
        assert!(count > 20, "{count}");
    }

    #[test]
    fn textures_are_sampled_once_in_order_of_dependence() {
        let mut graph = Graph::new();
        let (x, y) = (graph.input(crate::graph::Input::X), graph.input(crate::graph::Input::Y));
        let first = [0, 1].map(|channel| graph.texture(3, channel, x, y));
        let nested = graph.texture(1, 2, first[0], x);
        let sum = graph.add(first[1], nested);
        let mut program = SurfaceTape::new(&graph, &[sum], Over::Points);
        let pictures: Vec<u16> = program.textures.iter().map(|(picture, _)| *picture).collect();
        assert_eq!(pictures, [3, 1]);
        let mut texels = Vec::new();
        program.encode(&mut Encoder::new(Compounds::ALL, REGISTERS_MAX));
        program.append(&FrameInputs::default(), &mut texels);
        assert_eq!(texels[0][3], 2);
        // The sum reads green of the first texture and blue of the second.
        let read: Vec<u32> = texels[3..texels[1][1] as usize]
            .iter()
            .filter(|texel| texel[2] & 255 == u32::from(crate::tape::opcode::TEXTURE))
            .map(|texel| texel[3])
            .collect();
        assert_eq!(read, [1, 4 + 2]);
    }
}
