//! The entrance to the crate: a field from a text, and everything that is known of it.

use crate::graph::{FrameInputs, Interval};
use crate::region::{RegionOptions, RegionPlan, Regions};
use crate::tape::{Batch, IntervalEvaluator, Points, Tape, TapeOptions};
use crate::world::{World, WorldError};

/// A signed distance function, or any other function of a point, prepared for evaluation.
#[derive(Debug, Clone)]
pub struct Field {
    world: World,
    tape: Tape,
}

impl Field {
    /// The field of a formula, or of a whole scene that includes no other scene. The field of a scene is the distance
    /// to the nearest of its objects.
    ///
    /// # Errors
    /// Mistakes in the text, each with its place and a hint; or more expressions than the [`limits`](crate::limits)
    /// allow.
    pub fn parse(text: &str) -> Result<Self, WorldError> {
        let world = World::parse("field", text)?;
        let scene = &world.scene;
        let failed = |source| WorldError::Tape { scene: world.name.clone(), source };
        let tape = Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default()).map_err(failed)?;
        Ok(Self { world, tape })
    }

    /// The values at the given points, for one moment of time and sound.
    pub fn eval(&self, points: &[[f32; 3]], frame: &FrameInputs) -> Vec<f32> {
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<_>>());
        let points = Points { position: [&x, &y, &z], normal: None };
        Batch::new(&self.tape, frame).run(points).pop().unwrap_or_default()
    }

    /// Bounds of the values over a box: they hold every value in it.
    pub fn bounds(&self, low: [f32; 3], high: [f32; 3], frame: &FrameInputs) -> Interval {
        let position = std::array::from_fn(|axis| Interval::new(low[axis], high[axis]));
        let nothing = [Interval::point(0.0); 3];
        let bounds = IntervalEvaluator::new(&self.tape, frame).over(position, nothing).first().copied();
        bounds.unwrap_or(Interval::ANY)
    }

    /// The clauses that compute the field. They print as a table.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// The field's functions in GLSL, validated by naga.
    ///
    /// # Errors
    /// A limit is exceeded, or the generator has a fault.
    pub fn glsl(&self) -> Result<String, WorldError> {
        self.world.compiled_glsl()
    }

    /// The tree of cells over the surfaces of a frame, each with a bound of the distance and a shortened tape.
    pub fn tree(&self, frame: &FrameInputs) -> Regions {
        RegionPlan::new(&self.world).build(frame, &RegionOptions::default())
    }

    /// The world behind the field, for everything else.
    pub fn world(&self) -> &World {
        &self.world
    }
}
