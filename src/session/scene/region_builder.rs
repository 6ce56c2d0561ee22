//! Trees of regions, built in parallel with the frames on a thread of their own.
//!
//! Only the latest request counts: it replaces one that was not begun. The tree comes back with the whole frame that
//! it was requested for, so that a picture is drawn with the inputs of its tree. A tree that takes longer than it may
//! is given up, and so is one that nobody waits for any more.
//!
//! **A picture is drawn with the inputs of its tree.** `Renderer::draw` builds the regions of a frame if nobody has:
//! this is the only way for stills, videos and measurements. The window asks a thread for them (the latest request
//! only) and draws a picture when its tree has come, whenever that is; if inputs take long, the picture follows the
//! sound with fewer frames. If the compiled program draws faster than a tree is built, it draws without cells. An
//! interpreter without cells takes tens of times as long as with them, longer than any tree takes. The line of key I
//! says which is used.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::frame::Frame;
use crate::gpu::scene_resources::{BuiltRegions, RegionMaker, RegionRequest};

/// A tree to be built.
pub(super) struct TreeJob<Tag> {
    /// What the asker knows it by.
    pub tag: Tag,
    /// The frame that is to be drawn with it.
    pub frame: Frame,
    /// What builds it.
    pub maker: RegionMaker,
    /// What it is built for.
    pub request: RegionRequest,
    /// How long it may take.
    pub patience: Duration,
}

/// A tree that is done.
pub(super) struct BuiltTree<Tag> {
    /// What the asker knows it by.
    pub tag: Tag,
    /// The frame that is to be drawn with it.
    pub frame: Frame,
    /// The tree; none if it would have taken longer than allowed.
    pub regions: Option<Arc<BuiltRegions>>,
}

/// How long the end of the program waits for a tree that is being built.
const END_WAIT: Duration = Duration::from_millis(200);

struct State<Tag> {
    next: Option<TreeJob<Tag>>,
    done: Option<BuiltTree<Tag>>,
    /// How often the requests were forgotten: a tree that was begun before is of no use.
    forgotten: u64,
    over: bool,
}

struct Shared<Tag> {
    state: Mutex<State<Tag>>,
    changed: Condvar,
}

impl<Tag> Shared<Tag> {
    fn lock(&self) -> MutexGuard<'_, State<Tag>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The thread and the queue between it and the frames.
pub(super) struct RegionBuilder<Tag> {
    shared: Arc<Shared<Tag>>,
    thread: Option<JoinHandle<()>>,
}

impl<Tag: Send + 'static> RegionBuilder<Tag> {
    /// Starts the thread, which calls `wake` after each tree.
    ///
    /// # Errors
    /// What the system says about threads.
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let state = State { next: None, done: None, forgotten: 0, over: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let theirs = shared.clone();
        let thread = std::thread::Builder::new().name("regions".into());
        let thread = thread.spawn(move || work(&theirs, &wake))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Requests a tree in place of any that was not begun.
    pub(super) fn request(&self, job: TreeJob<Tag>) {
        self.shared.lock().next = Some(job);
        self.shared.changed.notify_one();
    }

    /// The latest tree that is done, once.
    pub(super) fn poll(&self) -> Option<BuiltTree<Tag>> {
        self.shared.lock().done.take()
    }

    /// Drops everything that was requested and not taken.
    pub(super) fn forget(&self) {
        let mut state = self.shared.lock();
        (state.next, state.done) = (None, None);
        state.forgotten += 1;
    }

    /// Whether [`RegionBuilder::poll`] has something.
    pub(super) fn has_built(&self) -> bool {
        self.shared.lock().done.is_some()
    }
}

impl<Tag> Drop for RegionBuilder<Tag> {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.over = true;
        state.next = None;
        drop(state);
        self.shared.changed.notify_one();
        // A tree takes milliseconds; that of a scene too large to be drawn takes minutes, and nobody waits for it.
        let until = Instant::now() + END_WAIT;
        let Some(thread) = self.thread.take() else { return };
        while !thread.is_finished() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(1));
        }
        if thread.is_finished() && thread.join().is_err() {
            tracing::warn!("the thread of the regions ended with a panic");
        }
    }
}

fn work<Tag: Send>(shared: &Shared<Tag>, wake: &dyn Fn()) {
    loop {
        let mut state = shared.lock();
        while state.next.is_none() && !state.over {
            state = shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let Some(job) = state.next.take().filter(|_| !state.over) else { return };
        let forgotten = state.forgotten;
        drop(state);
        let TreeJob { tag, frame, maker, request, patience } = job;
        let begun = Instant::now();
        let is_wanted = || {
            let state = shared.lock();
            state.forgotten == forgotten && !state.over && begun.elapsed() < patience
        };
        // After a panic the picture must not wait for ever: the next request is another chance.
        let built = catch_unwind(AssertUnwindSafe(|| maker.build_while(&frame, request, &is_wanted)));
        match built {
            Ok(regions) => {
                let mut state = shared.lock();
                if state.forgotten == forgotten {
                    let in_time = begun.elapsed() < patience;
                    let regions = in_time.then(|| Arc::new(regions));
                    state.done = Some(BuiltTree { tag, frame, regions });
                }
            }
            Err(_) => tracing::error!("building the regions ended with a panic"),
        }
        wake();
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
        let (plan, buffers) = (RegionPlan::new(world).into(), world.tape_buffers().unwrap().into());
        RegionMaker { plan, buffers, last: None }
    }

    /// A builder, its wakes, and what it takes to ask it for a tree that is not built at once.
    fn long_tree() -> (RegionBuilder<usize>, Receiver<()>, Frame, RegionMaker, RegionRequest) {
        let world = world("union(for i in 0..200: sphere(p - vec3(i, 0, 0), 0.3 + 0.01 * sin(t)))");
        let maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let frame = Frame::new(&world, 1.0, Features::SILENCE, (8, 8));
        let request = RegionRequest::of(&maker.plan, &frame, RegionOptions::default());
        (builder, wakes, frame, maker, request)
    }

    #[test]
    fn what_is_forgotten_while_it_is_built_does_not_come() {
        let (builder, wakes, frame, maker, request) = long_tree();
        builder.request(TreeJob { tag: 1, frame, maker, request, patience: Duration::MAX });
        while builder.shared.lock().next.is_some() {
            std::thread::yield_now();
        }
        builder.forget();
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(!builder.has_built());
    }

    #[test]
    fn a_tree_that_takes_too_long_kept_others_waiting() {
        let (builder, wakes, frame, maker, request) = long_tree();
        builder.request(TreeJob { tag: 1, frame, maker, request, patience: Duration::ZERO });
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        let built = builder.poll().unwrap();
        assert!(built.tag == 1 && built.regions.is_none());
    }

    #[test]
    fn the_latest_request_is_built_and_comes_with_its_frame() {
        let world = world("object ball { shape = sphere(p, 1 + 0.1 * sin(t)) }");
        let maker = maker_of(&world);
        let (woken, wakes) = channel();
        let builder = RegionBuilder::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let job = |tag: usize| {
            let frame = Frame::new(&world, tag as f64, Features::SILENCE, (8, 8));
            let request = RegionRequest::of(&maker.plan, &frame, RegionOptions::default());
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
    fn programs_are_shortened_beside_the_tree_which_stays_where_only_they_change() {
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
                ..RegionRequest::of(&maker.plan, &frame, RegionOptions::default())
            };
            let inputs = frame.inputs.clone();
            builder.request(TreeJob { tag, frame, maker: maker.clone(), request, patience: Duration::MAX });
            wakes.recv_timeout(Duration::from_secs(20)).unwrap();
            let regions = builder.poll().unwrap().regions.unwrap();
            let [short, whole] = [&regions.programs, &Default::default()]
                .map(|programs| maker.buffers.texels(&inputs, programs).len());
            assert!(short > whole, "nothing was shortened");
            maker.last = Some(regions.clone());
            built.push(regions);
        }
        assert!(Arc::ptr_eq(&built[0].regions, &built[1].regions));
        assert_ne!(built[0].programs, built[1].programs);
    }
}
