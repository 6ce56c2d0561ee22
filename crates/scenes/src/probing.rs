//! Answers questions of the editor about a frame: the surface at a point, and ray statistics for a coarse grid. A
//! background thread traces the rays with the inputs of that frame. A new question replaces a waiting question of the
//! same kind.

use std::io;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::{ReadyScene, SceneSource};
use mariana_field::ray_probe::{Deciding, Ray, RayProbe, RayStatistics};
use mariana_field::region::RegionOptions;
use mariana_field::world::World;
use mariana_render::frame::Frame;
use mariana_render::frame::projection::EyeRay;
use mariana_render::gpu::scene_resources::{RegionMaker, RegionRequest};
use mariana_render::ray_diagram::RayDiagram;
use mariana_work::{Latest, Shared, contained, latest};

/// A frame with all data needed to trace rays in it.
#[derive(Clone)]
pub struct Scenery {
    /// The scene.
    pub source: SceneSource,
    /// Its world.
    pub world: Arc<World>,
    /// The frame's inputs and camera.
    pub frame: Frame,
    /// Builds the frame's region tree.
    pub maker: RegionMaker,
    /// How the tree is built.
    pub options: RegionOptions,
}

impl Scenery {
    /// Wraps a frame of a scene whose region tree is built from scratch.
    pub fn new(source: SceneSource, scene: ReadyScene, frame: Frame) -> Self {
        let maker = RegionMaker { plan: scene.plan, buffers: scene.buffers, last: None };
        Self { source, world: scene.world, frame, maker, options: RegionOptions::default() }
    }
}

/// Maximum time for an answer. A scene that needs more time is too large for probing.
const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum pause after ray statistics. The pause is as long as their computation, to leave the processors to the show.
const REST_MAX: Duration = Duration::from_secs(1);
const COLUMNS: usize = 160;
/// Width of a probe's ray, as a fraction of a pixel.
const PROBE_WIDTH: f64 = 0.05;

/// The result of probing a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Probed {
    /// The scene.
    pub source: SceneSource,
    /// The point as fractions of the frame's width and height, from the top left.
    pub at: [f64; 2],
    /// The surface; `None` for the sky.
    pub surface: Option<Surface>,
}

/// A surface at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The object's name.
    pub object: String,
    /// The name of the material.
    pub material: String,
    /// Distance from the camera.
    pub distance: f32,
    /// Position in the scene.
    pub position: [f32; 3],
    /// Surface normal of length 1.
    pub normal: [f32; 3],
    /// The formula of the surface: the index of its file among the scene's texts, and its byte range.
    pub written: Option<(usize, Range<usize>)>,
}

/// An answer from the [`Prober`].
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// The surface at a point.
    Point(Probed),
    /// The ray statistics of a scene's frame.
    RayStatistics(SceneSource, Arc<RayStatistics>),
    /// The diagram of a ray.
    Diagram(Arc<RayDiagram>),
    /// The answer would have taken too long.
    TooLong,
}

#[derive(Default)]
struct Probes {
    point: Option<Question>,
    diagram: Option<Question>,
    ray_statistics: Option<Question>,
    /// True while a diagram is drawn.
    draws: bool,
    answers: Vec<Answer>,
    /// True while ray statistics are computed, and during the pause afterwards.
    surveys: bool,
}

enum Question {
    Point(Scenery, [f64; 2]),
    Diagram(Scenery, [f64; 2], (u32, u32)),
    RayStatistics(Scenery),
}

impl Probes {
    fn is_asked_for_ray(&self) -> bool {
        self.point.is_some() || self.diagram.is_some()
    }

    fn next(&mut self) -> Option<Question> {
        let next = self.point.take().or_else(|| self.diagram.take());
        let next = next.or_else(|| self.ray_statistics.take());
        self.draws = matches!(next, Some(Question::Diagram(..)));
        self.surveys = matches!(next, Some(Question::RayStatistics(_)));
        next
    }
}

/// The probing thread, which ends by itself when this is dropped.
pub struct Prober(Latest<Probes>);

impl Prober {
    /// Starts the thread, which calls `wake` after each answer.
    ///
    /// # Errors
    /// Fails with the system's error if no thread can be started.
    pub fn start(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        latest("probe", Probes::default(), Probes::next, move |asked, state| work(asked, state, &wake))
            .map(Self)
    }

    /// Asks for the surface at a point, given as fractions of the frame's width and height.
    pub fn request_point(&self, scenery: Scenery, at: [f64; 2]) {
        self.0.change(|state| state.point = Some(Question::Point(scenery, at)));
    }

    /// Asks for the diagram of the ray through a point, for an image of `size` pixels.
    pub fn request_diagram(&self, scenery: Scenery, at: [f64; 2], size: (u32, u32)) {
        self.0.change(|state| state.diagram = Some(Question::Diagram(scenery, at, size)));
    }

    /// True while a diagram is queued or drawn.
    pub fn draws(&self) -> bool {
        let state = self.0.lock();
        state.draws || state.diagram.is_some()
    }

    /// Asks for ray statistics.
    pub fn request_ray_statistics(&self, scenery: Scenery) {
        self.0.change(|state| state.ray_statistics = Some(Question::RayStatistics(scenery)));
    }

    /// True while ray statistics are queued or computed, and during the pause afterwards.
    pub fn surveys(&self) -> bool {
        let state = self.0.lock();
        state.surveys || state.ray_statistics.is_some()
    }

    /// Returns the answers since the last call.
    pub fn answers(&self) -> Vec<Answer> {
        std::mem::take(&mut self.0.lock().answers)
    }
}

fn work(question: Question, shared: &Shared<Probes>, wake: &dyn Fn()) {
    let begun = Instant::now();
    // A question about a point interrupts the ray statistics of a grid.
    let surveys = matches!(question, Question::RayStatistics(_));
    let is_wanted =
        || !shared.is_over() && begun.elapsed() < PATIENCE && !(surveys && shared.lock().is_asked_for_ray());
    let answer = contained(|| match question {
        Question::Point(scenery, at) => probe(&scenery, at, &is_wanted).map(Answer::Point),
        Question::Diagram(scenery, at, size) => {
            ray_diagram(&scenery, at, size, &is_wanted).map(|diagram| Answer::Diagram(Arc::new(diagram)))
        }
        Question::RayStatistics(scenery) => ray_statistics_of(&scenery, &is_wanted)
            .map(|ray_statistics| Answer::RayStatistics(scenery.source, Arc::new(ray_statistics))),
    });
    let what = if surveys { "a grid" } else { "a ray" };
    tracing::debug!("probed {what} of the frame in {:.1} ms", 1e3 * begun.elapsed().as_secs_f64());
    let mut state = shared.lock();
    match answer {
        Some(Some(answer)) => state.answers.push(answer),
        Some(None) if begun.elapsed() >= PATIENCE => state.answers.push(Answer::TooLong),
        Some(None) | None => {}
    }
    state.draws = false;
    drop(state);
    wake();
    if surveys {
        let rest = begun.elapsed().min(REST_MAX);
        shared.wait_while(rest, |state| !state.is_asked_for_ray()).surveys = false;
        wake();
    }
}

/// Returns the ray through a point, given as fractions of the frame's width and height. `width` is the ray's width as
/// a fraction of a pixel.
fn ray_at(frame: &Frame, [x, y]: [f64; 2], width: f64) -> Ray {
    let Frame { camera, projection, size, .. } = frame;
    let at = (x * f64::from(size.0), y * f64::from(size.1));
    // Outside of a dome's circle, take the camera's axis.
    let axis = EyeRay { origin: camera.position, direction: camera.forward };
    let EyeRay { origin, direction } = projection.ray(camera, *size, at).unwrap_or(axis);
    let spread = projection.pixel_radius(camera, *size) * width;
    Ray {
        origin: origin.as_vec3().to_array(),
        direction: direction.as_vec3().to_array(),
        spread: spread.max(1e-6) as f32,
    }
}

/// Builds the frame's tree and passes it to `run`. Returns `None` once `is_wanted` is false.
fn with_ray_probe<T>(
    scenery: &Scenery,
    is_wanted: &(dyn Fn() -> bool + Sync),
    run: impl FnOnce(&RayProbe<'_>) -> T,
) -> Option<T> {
    let Scenery { world, frame, maker, options, .. } = scenery;
    let request = RegionRequest::of(&maker.plan, &maker.buffers, frame, *options);
    let built = maker.build_while(frame, request, is_wanted);
    is_wanted().then(|| run(&RayProbe::new(world, &built.regions, &frame.inputs, &frame.values.planes)))
}

/// Probes a point, given as fractions of the frame's width and height. Returns `None` once `is_wanted` is false.
pub fn probe(scenery: &Scenery, at: [f64; 2], is_wanted: &(dyn Fn() -> bool + Sync)) -> Option<Probed> {
    let ray = ray_at(&scenery.frame, at, PROBE_WIDTH);
    let scene = &scenery.world.scene;
    let surface = with_ray_probe(scenery, is_wanted, |ray_probe| {
        let hit = ray_probe.trace(&ray).hit?;
        let object = scene.objects.get(hit.object)?;
        let path = ray_probe.path(&hit, Some(&Deciding::new(&scene.graph, object.shape)));
        let written = path.last().and_then(|node| scene.origins.written_at(*node));
        let declared = || {
            let (file, start) = scene.origins.place(object.span.start)?;
            Some((file, start..start))
        };
        Some(Surface {
            object: object.name.clone(),
            material: scene.materials.get(object.material).map_or(String::new(), |one| one.name.clone()),
            distance: hit.distance,
            position: hit.position,
            normal: ray_probe.normal(&ray, &hit),
            written: written.or_else(declared),
        })
    })?;
    Some(Probed { source: scenery.source.clone(), at, surface })
}

/// Draws the diagram of the ray through a point, given as fractions of the frame's width and height, for an image of
/// `size` pixels. Returns `None` once `is_wanted` is false.
pub fn ray_diagram(
    scenery: &Scenery,
    at: [f64; 2],
    size: (u32, u32),
    is_wanted: &(dyn Fn() -> bool + Sync),
) -> Option<RayDiagram> {
    let Scenery { world, frame, .. } = scenery;
    let ray = ray_at(frame, at, 1.0);
    let names: Vec<String> = world.scene.objects.iter().map(|object| object.name.clone()).collect();
    with_ray_probe(scenery, is_wanted, |ray_probe| RayDiagram::of(ray_probe, frame, &ray, &names, size))
}

/// Computes ray statistics of a grid over the frame. Returns `None` once `is_wanted` is false.
pub fn ray_statistics_of(scenery: &Scenery, is_wanted: &(dyn Fn() -> bool + Sync)) -> Option<RayStatistics> {
    let (width, height) = scenery.frame.camera.tan_half;
    let rows = (COLUMNS as f64 * height / width).round().clamp(8.0, COLUMNS as f64 * 2.0) as usize;
    let ray = |x: f64, y: f64| ray_at(&scenery.frame, [x, y], 1.0);
    with_ray_probe(scenery, is_wanted, |ray_probe| {
        RayStatistics::of(ray_probe, COLUMNS, rows, ray, is_wanted)
    })?
}

#[cfg(test)]
mod tests;
