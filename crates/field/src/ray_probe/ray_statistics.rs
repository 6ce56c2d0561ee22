//! Statistics of an image: rays on a coarse grid, the parts of the scene that they hit, and their costs.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::ops::Range;

use super::{Deciding, Ray, RayProbe, Traced};
use crate::graph::NodeId;
use crate::lang::TextPlace;

/// The hits and costs of a grid of rays.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RayStatistics {
    /// Number of columns of rays.
    pub columns: usize,
    /// For each ray, in rows from the upper left: 1 + the index of the hit part, or 0 for the sky.
    pub cells: Vec<u16>,
    /// The parts that rays hit.
    pub parts: Vec<Part>,
    /// The costs of the objects, in the order of the scene.
    pub objects: Vec<ObjectCost>,
    /// The number of rays that end in the sky, and the number of clauses that were run for these rays.
    pub sky: (u32, u64),
}

/// A part of an object that rays hit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Index of the object.
    pub object: usize,
    /// The positions in the text that contribute to the part, sorted.
    pub places: Vec<TextPlace>,
}

/// The cost of an object.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ObjectCost {
    /// The name.
    pub name: String,
    /// The number of clauses of the shape, and the number of clauses of the material.
    pub clauses: (usize, usize),
    /// The number of rays that end on the object.
    pub rays: u32,
    /// The number of evaluations of the distance for these rays.
    pub evaluations: u64,
    /// The number of clauses that these evaluations ran.
    pub run: u64,
    /// The position of the declaration.
    pub place: Option<TextPlace>,
    /// The parts on which rays end, the most expensive part first. Each part comes from one expression.
    pub parts: Vec<PartCost>,
}

/// The cost of a part of an object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartCost {
    /// The file and the byte range of the expression that defines the part.
    pub written: (usize, Range<usize>),
    /// The number of rays that end on the part.
    pub rays: u32,
    /// The number of evaluations of the distance for these rays.
    pub evaluations: u64,
    /// The number of clauses that these evaluations ran.
    pub run: u64,
}

impl ObjectCost {
    fn count_part(&mut self, written: (usize, Range<usize>), traced: &Traced) {
        let known = self.parts.iter().position(|part| part.written == written);
        let place = known.unwrap_or(self.parts.len());
        if known.is_none() {
            self.parts.push(PartCost { written, rays: 0, evaluations: 0, run: 0 });
        }
        let part = &mut self.parts[place];
        part.rays += 1;
        part.evaluations += u64::from(traced.evaluations);
        part.run += traced.clauses;
    }
}

impl RayStatistics {
    /// Returns the number of all clauses that were run.
    pub fn run(&self) -> u64 {
        self.sky.1 + self.objects.iter().map(|object| object.run).sum::<u64>()
    }

    /// Follows a ray for each cell of a grid of `columns` by `rows`, in rows from the upper left. `ray_at` returns the
    /// ray for fractions of the image's width and height. Calls `is_wanted` between rows, and returns `None` once it
    /// returns false.
    pub fn of(
        ray_probe: &RayProbe<'_>,
        columns: usize,
        rows: usize,
        ray_at: impl Fn(f64, f64) -> Ray,
        is_wanted: impl Fn() -> bool,
    ) -> Option<Self> {
        let scene = &ray_probe.world.scene;
        let deciding: Vec<Deciding<'_>> =
            scene.objects.iter().map(|object| Deciding::new(&scene.graph, object.shape)).collect();
        let mut ray_statistics = Self { columns, ..Self::default() };
        for (object, deciding) in scene.objects.iter().zip(&deciding) {
            let numbers = scene.materials.get(object.material).map(|one| one.numbers()).unwrap_or_default();
            let of_material = scene.graph.order(&numbers);
            let of_material = of_material.into_iter().filter(|id| scene.graph.is_clause(*id)).count();
            ray_statistics.objects.push(ObjectCost {
                name: object.name.clone(),
                clauses: (deciding.clauses(), of_material),
                place: scene.origins.place(object.span.start),
                ..ObjectCost::default()
            });
        }
        // Equal paths lead to the same part.
        let mut known: HashMap<(usize, Vec<NodeId>), u16> = HashMap::new();
        for row in 0..rows {
            if !is_wanted() {
                return None;
            }
            for column in 0..columns {
                let fraction = |place: usize, of: usize| (place as f64 + 0.5) / of as f64;
                let ray = ray_at(fraction(column, columns), fraction(row, rows));
                let traced = ray_probe.trace(&ray);
                let Some(hit) = traced.hit else {
                    ray_statistics.sky = (ray_statistics.sky.0 + 1, ray_statistics.sky.1 + traced.clauses);
                    ray_statistics.cells.push(0);
                    continue;
                };
                if let Some(object) = ray_statistics.objects.get_mut(hit.object) {
                    object.rays += 1;
                    object.evaluations += u64::from(traced.evaluations);
                    object.run += traced.clauses;
                }
                let path = ray_probe.path(&hit, deciding.get(hit.object));
                let written = path.last().and_then(|node| scene.origins.written_at(*node));
                if let Some((object, written)) = ray_statistics.objects.get_mut(hit.object).zip(written) {
                    object.count_part(written, &traced);
                }
                let next = ray_statistics.parts.len() as u16;
                let part = *known.entry((hit.object, path)).or_insert_with_key(|(object, path)| {
                    if next == u16::MAX - 1 {
                        return next;
                    }
                    ray_statistics
                        .parts
                        .push(Part { object: *object, places: ray_probe.places(*object, path) });
                    next
                });
                ray_statistics.cells.push(part + 1);
            }
        }
        for object in &mut ray_statistics.objects {
            object.parts.sort_by_key(|part| Reverse(part.run));
        }
        Some(ray_statistics)
    }
}
