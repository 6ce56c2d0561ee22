//! Measures the GPU's time with GL_TIME_ELAPSED, if the driver has timers ([`super::gl::GlInfo::has_timers`]): OpenGL ES
//! has none, and the times of software renderers are meaningless.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::collections::VecDeque;
use std::time::Duration;

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::object::Query;

/// A timer of draws.
pub struct GpuTimer {
    gl: Gl,
    query: Query,
}

impl GpuTimer {
    /// Creates a timer in the current context.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create another query.
    pub fn new(gl: &Gl) -> Result<Self> {
        Ok(Self { gl: gl.clone(), query: Query::new(gl)? })
    }

    /// Runs `draws`, waits for the GPU, and returns the result of `draws` and the GPU's time.
    pub fn time<T>(&self, draws: impl FnOnce() -> T) -> (T, Duration) {
        // SAFETY: `self` owns the query, and no second timer is active. The driver waits for the result.
        unsafe {
            self.gl.begin_query(glow::TIME_ELAPSED, self.query.native());
            let result = draws();
            self.gl.end_query(glow::TIME_ELAPSED);
            let nanoseconds = self.gl.get_query_parameter_u64(self.query.native(), glow::QUERY_RESULT);
            (result, Duration::from_nanos(nanoseconds))
        }
    }
}

const TIMES_ON_THEIR_WAY: usize = 4;

/// Measures GPU times of frames that are drawn in one call. It never waits for the GPU: times arrive some frames later.
/// The default does not measure.
#[derive(Default)]
pub(super) struct PictureClock {
    gl: Option<Gl>,
    free: Vec<Query>,
    running: Option<Query>,
    on_their_way: VecDeque<Query>,
    pub(super) cost: Option<Duration>,
}

impl PictureClock {
    pub(super) fn new(gl: &Gl) -> Result<Self> {
        let free = (0..TIMES_ON_THEIR_WAY).map(|_| Query::new(gl)).collect::<Result<_, _>>()?;
        Ok(Self { gl: Some(gl.clone()), free, ..Self::default() })
    }

    /// Begins a frame. The frame is not timed if too many results of earlier frames are pending.
    pub(super) fn begin(&mut self) {
        if self.running.is_some() {
            return;
        }
        let (Some(gl), Some(query)) = (&self.gl, self.free.pop()) else { return };
        // SAFETY: `self` owns the query, and no second query is active.
        unsafe { gl.begin_query(glow::TIME_ELAPSED, query.native()) }
        self.running = Some(query);
    }

    pub(super) fn end(&mut self) {
        let (Some(gl), Some(query)) = (&self.gl, self.running.take()) else { return };
        // SAFETY: the active query is the query that `begin` started.
        unsafe { gl.end_query(glow::TIME_ELAPSED) }
        self.on_their_way.push_back(query);
    }

    /// The latest GPU time of a frame that has become known since the last call.
    pub(super) fn drain(&mut self) -> Option<Duration> {
        let gl = self.gl.as_ref()?;
        let mut newest = None;
        while let Some(query) = self.on_their_way.pop_front() {
            // SAFETY: `self` owns the query, and `end` has ended it.
            let time = unsafe {
                let available = gl.get_query_parameter_u32(query.native(), glow::QUERY_RESULT_AVAILABLE);
                (available != 0).then(|| gl.get_query_parameter_u64(query.native(), glow::QUERY_RESULT))
            };
            let Some(nanoseconds) = time else {
                self.on_their_way.push_front(query);
                break;
            };
            newest = Some(Duration::from_nanos(nanoseconds));
            self.free.push(query);
        }
        self.cost = newest.or(self.cost);
        newest
    }
}
