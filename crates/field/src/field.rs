//! A field compiled from text, with shortcuts to the rest of the crate: evaluation, bounds, tape, GLSL and region
//! tree.

use crate::graph::{FrameInputs, Interval};
use crate::region::{RegionOptions, RegionPlan, Regions};
use crate::tape::{Batch, Points, Tape};
use crate::world::{World, WorldError};

/// A signed distance function, or any other function of a point, prepared for evaluation.
#[derive(Debug, Clone)]
pub struct Field {
    world: World,
    tape: Tape,
}

impl Field {
    /// Compiles a formula or a scene without includes. The field of a scene is the distance to the nearest object.
    ///
    /// # Errors
    /// Fails if the text has mistakes (each is reported with its location and a hint) or exceeds the
    /// [`limits`](crate::limits).
    pub fn parse(text: &str) -> Result<Self, WorldError> {
        let world = World::parse("field", text)?;
        let tape = Tape::new(&world.scene.graph, &[world.scene.distance]);
        Ok(Self { world, tape })
    }

    /// Returns the field's values at `points` for the inputs of one frame.
    pub fn eval(&self, points: &[[f32; 3]], frame: &FrameInputs) -> Vec<f32> {
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<_>>());
        let points = Points { position: [&x, &y, &z], normal: None };
        Batch::new(&self.tape, frame).run(points).pop().unwrap_or_default()
    }

    /// Returns bounds of the field's values in the box from `low` to `high`.
    pub fn bounds(&self, low: [f32; 3], high: [f32; 3], frame: &FrameInputs) -> Interval {
        let [x, y, z] = [0, 1, 2].map(|axis| Interval::new(low[axis], high[axis]));
        let none = Interval::point(0.0);
        let scene = &self.world.scene;
        scene.graph.bounds(scene.distance, [x, y, z, none, none, none], frame)
    }

    /// Returns the tape, the clauses that compute the field. `Display` prints it as a table.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Returns the field's functions in GLSL, validated by naga.
    ///
    /// # Errors
    /// Fails if a limit is exceeded, or if the generator has a bug.
    pub fn glsl(&self) -> Result<String, WorldError> {
        self.world.compiled_glsl()
    }

    /// Builds a frame's tree of cells. Each cell has a lower bound of the distance and a shortened tape.
    pub fn tree(&self, frame: &FrameInputs) -> Regions {
        RegionPlan::new(&self.world).build(frame, &RegionOptions::default())
    }

    /// Returns the compiled world of the field, for everything that this type has no shortcut for.
    pub fn world(&self) -> &World {
        &self.world
    }
}
