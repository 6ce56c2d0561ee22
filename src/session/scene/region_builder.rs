//! Region trees, built on their own thread while frames are drawn. Only the latest request counts. A build is
//! cancelled when it exceeds its time limit or is no longer needed.
//!
//! **A frame is drawn with the inputs of its tree,** even if the tree is late: a slow tree lowers the frame rate, but
//! frames match the sound. If the compiled program draws faster than a tree is built, it draws without cells. An
//! interpreter always waits for the tree: without cells it takes tens of times as long, which is longer than any tree
//! takes. In stills, videos and measurements, `Renderer::draw` builds missing regions itself.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cpu_time::ThreadTime;
use mariana_work::{Latest, Shared, contained, latest};

use crate::faults::{self, Fault};
use crate::frame::Frame;
use crate::gpu::scene_resources::{BuiltRegions, RegionMaker, RegionRequest};
use crate::gpu::{CellUse, Mode, SceneResources};
use crate::limits;
use mariana_music::Features;

pub(super) struct TreeJob<Tag> {
    /// The caller's identifier of the request.
    pub tag: Tag,
    pub frame: Frame,
    pub maker: RegionMaker,
    pub request: RegionRequest,
    /// Maximum processor time of the builder's thread.
    pub patience: Duration,
}

pub(super) struct BuiltTree<Tag> {
    pub tag: Tag,
    pub frame: Frame,
    /// The tree; `None` if the build exceeded its time limit.
    pub regions: Option<Arc<BuiltRegions>>,
}

/// Maximum time to wait for the thread at exit: a tree takes milliseconds, but minutes for a scene that is too large to
/// draw.
const END_WAIT: Duration = Duration::from_millis(200);

/// Size of the frame for a scene's first tree. Only its aspect ratio matters.
const TRIAL_SIZE: (u32, u32) = (16, 9);

struct State<Tag> {
    next: Option<TreeJob<Tag>>,
    done: Option<BuiltTree<Tag>>,
    /// Counts calls of `forget`: a build begun before the last call is obsolete.
    forgotten: u64,
}

pub(super) struct RegionBuilder<Tag>(Latest<State<Tag>>);

impl RegionBuilder<u64> {
    /// Requests the first tree of the scene `id`. Replaces the request for any other scene.
    pub(super) fn request_first(&self, id: u64, scene: &SceneResources, cells: CellUse) {
        scene.set_cells(cells != CellUse::Never || scene.world().non_lipschitz, Mode::Interpreted);
        let frame = Frame::new(scene.world(), 0.0, Features::SILENCE, TRIAL_SIZE);
        let request = scene.region_request(&frame);
        self.forget();
        let (maker, patience) = (scene.region_maker(), longest_wait());
        self.request(TreeJob { tag: id, frame, maker, request, patience });
    }
}

/// The longest that a scene's first tree may take.
pub(super) fn longest_wait() -> Duration {
    let share = if faults::is_wanted(Fault::LittlePatience) { 0.1 } else { 1.0 };
    Duration::from_secs_f64(share * limits::PICTURE_SECONDS_MAX)
}

impl<Tag: Send + 'static> RegionBuilder<Tag> {
    /// Starts the thread, which calls `wake` after each tree.
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let state = State { next: None, done: None, forgotten: 0 };
        let next = |state: &mut State<Tag>| Some((state.next.take()?, state.forgotten));
        let build = move |(job, forgotten), shared: &_| {
            build(job, forgotten, shared);
            wake();
        };
        Ok(Self(latest("regions", state, next, build)?.finished_at_drop(END_WAIT)))
    }

    /// Requests a tree. Replaces a request that has not begun.
    pub(super) fn request(&self, job: TreeJob<Tag>) {
        self.0.change(|state| state.next = Some(job));
    }

    pub(super) fn poll(&self) -> Option<BuiltTree<Tag>> {
        self.0.lock().done.take()
    }

    pub(super) fn forget(&self) {
        let mut state = self.0.lock();
        (state.next, state.done) = (None, None);
        state.forgotten += 1;
    }

    pub(super) fn has_built(&self) -> bool {
        self.0.lock().done.is_some()
    }
}

fn build<Tag: Send>(job: TreeJob<Tag>, forgotten: u64, shared: &Shared<State<Tag>>) {
    let TreeJob { tag, frame, maker, request, patience } = job;
    // The limit is this thread's processor time, so that other programs make no scene too large. Threads that help
    // with the tree begin at 0, so this one is the first to reach the limit.
    let begun = ThreadTime::now().as_duration();
    let is_late = AtomicBool::new(false);
    let is_wanted = || {
        is_late
            .fetch_or(ThreadTime::now().as_duration().saturating_sub(begun) >= patience, Ordering::Relaxed);
        shared.lock().forgotten == forgotten && !shared.is_over() && !is_late.load(Ordering::Relaxed)
    };
    // After a panic the frame must not wait for ever: the next request tries again.
    let Some(regions) = contained(|| maker.build_while(&frame, request, &is_wanted)) else { return };
    let mut state = shared.lock();
    if state.forgotten == forgotten {
        let regions = (!is_late.into_inner()).then(|| Arc::new(regions));
        state.done = Some(BuiltTree { tag, frame, regions });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::scene_resources::RegionRequest;
    use mariana_field::region::{RegionOptions, RegionPlan};
    use mariana_field::world::World;
    use mariana_music::Features;
    use std::sync::mpsc::{Receiver, channel};

    fn world(text: &str) -> World {
        World::parse("test", text).unwrap()
    }

    fn maker_of(world: &World) -> RegionMaker {
        let (plan, buffers) = (RegionPlan::new(world).into(), world.tape_buffers().into());
        RegionMaker { plan, buffers, last: None }
    }

    fn long_tree() -> (RegionBuilder<usize>, Receiver<()>, Frame, RegionMaker, RegionRequest) {
        let world = world("union(for i in 0..200: sphere(p - vec3(i, 0, 0), 0.3 + 0.01 * sin(t)))");
        let maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let frame = Frame::new(&world, 1.0, Features::SILENCE, (8, 8));
        let request = RegionRequest::of(&maker.plan, &maker.buffers, &frame, RegionOptions::default());
        (builder, wakes, frame, maker, request)
    }

    #[test]
    fn a_request_forgotten_during_its_build_returns_nothing() {
        let (builder, wakes, frame, maker, request) = long_tree();
        builder.request(TreeJob { tag: 1, frame, maker, request, patience: Duration::MAX });
        while builder.0.lock().next.is_some() {
            std::thread::yield_now();
        }
        builder.forget();
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(!builder.has_built());
    }

    #[test]
    fn a_tree_over_its_time_limit_is_given_up() {
        let (builder, wakes, frame, maker, request) = long_tree();
        builder.request(TreeJob { tag: 1, frame, maker, request, patience: Duration::ZERO });
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        let built = builder.poll().unwrap();
        assert!(built.tag == 1 && built.regions.is_none());
    }

    #[test]
    fn a_tree_that_waits_for_other_programs_is_not_given_up() {
        let world = world("union(for i in 0..20: sphere(p - vec3(i, 0, 0), 0.3 + 0.01 * sin(t)))");
        let maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let frame = Frame::new(&world, 1.0, Features::SILENCE, (8, 8));
        let request = RegionRequest::of(&maker.plan, &maker.buffers, &frame, RegionOptions::default());
        let patience = Duration::from_secs(1);
        builder.request(TreeJob { tag: 1, frame, maker, request, patience });
        let held = loop {
            let state = builder.0.lock();
            if state.next.is_none() {
                break state;
            }
        };
        // The thread waits for the lock, as it waits for a processor.
        std::thread::sleep(patience);
        drop(held);
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(builder.poll().unwrap().regions.is_some());
    }

    #[test]
    fn the_latest_request_is_built_and_comes_with_its_frame() {
        let world = world("object ball { shape = sphere(p, 1 + 0.1 * sin(t)) }");
        let maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let job = |tag: usize| {
            let frame = Frame::new(&world, tag as f64, Features::SILENCE, (8, 8));
            let request = RegionRequest::of(&maker.plan, &maker.buffers, &frame, RegionOptions::default());
            TreeJob { tag, frame, maker: maker.clone(), request, patience: Duration::MAX }
        };
        for tag in 0..50 {
            builder.request(job(tag));
        }
        let last = loop {
            wakes.recv_timeout(Duration::from_secs(20)).unwrap();
            match builder.poll() {
                Some(built) if built.tag == 49 => break built,
                _ => {}
            }
        };
        assert_eq!(last.frame.inputs.time, 49.0);
        let alone = maker.plan.build(&last.frame.inputs, &RegionOptions::default());
        assert_eq!(*last.regions.unwrap().regions, alone);
        assert!(builder.poll().is_none(), "a tree comes once");
    }

    #[test]
    fn a_tree_is_reused_if_only_the_shortened_programs_change() {
        let text = "material lit { emission = vec3(sum(for i in 1..9: sin(i * p.x - t))) * smoothstep(1, 0, abs(p.x)) }\n\
                    object wall { shape = box(p, 2) material = lit }";
        let world = world(text);
        let mut maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let mut built = Vec::new();
        for tag in 0..2 {
            let frame = Frame::new(&world, tag as f64, Features::SILENCE, (8, 8));
            let programs = maker.buffers.worth_shortening().request(&maker.buffers, &frame.inputs);
            let request = RegionRequest {
                programs,
                ..RegionRequest::of(&maker.plan, &maker.buffers, &frame, RegionOptions::default())
            };
            let inputs = frame.inputs.clone();
            builder.request(TreeJob { tag, frame, maker: maker.clone(), request, patience: Duration::MAX });
            wakes.recv_timeout(Duration::from_secs(20)).unwrap();
            let regions = builder.poll().unwrap().regions.unwrap();
            let [short, whole] = [&regions.programs, &Default::default()]
                .map(|programs| maker.buffers.texels(&inputs, programs).len());
            assert!(short > whole, "the programs were not shortened");
            maker.last = Some(regions.clone());
            built.push(regions);
        }
        assert!(Arc::ptr_eq(&built[0].regions, &built[1].regions));
        assert_ne!(built[0].programs, built[1].programs);
    }
}
