//! Selects the programs of materials and light that are shortened for a frame.
//!
//! Shortening costs time in every frame. If an attempt saves little, the program therefore stays whole for some
//! frames. Then shortening is tried again, because the saving depends on the frame's numbers.

use super::interpreted::TapeBuffers;
use crate::graph::FrameInputs;
use crate::region::surface::{ShortTapes, Shortener};
use crate::region::{RegionKey, Surfaces};

/// Minimum fraction of a program's clauses that shortening must save. With 0.1, five scenes run up to 9 % fewer clauses
/// in these programs, but shortening takes 34 ms per frame in wave_tank.
const SAVED_MIN: f32 = 0.2;
/// Number of frames for which a program stays whole after an attempt that saved too little.
const REST_FRAMES: u32 = 600;
/// Maximum number of texels of a frame's shortened programs. They are uploaded for each frame.
const SHORTENED_TEXELS_MAX: usize = 1 << 15;

/// The programs to shorten for a frame, and the numbers that they read. If the surfaces are the same, equal requests
/// give equal programs. By default no program is shortened.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShortenRequest {
    /// The key of each program; `None` for a whole program. Empty if all programs are whole.
    keys: Vec<Option<RegionKey>>,
}

/// Options for shortening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortenOptions<'a> {
    /// Maximum number of texels in a list, as reported by the driver. The whole programs are included.
    pub texels_max: usize,
    /// The middle of the grid in a scene without bounds.
    pub center: [f32; 3],
    /// The surfaces, if known. Programs are shortened only at surfaces.
    pub surfaces: Option<Surfaces<'a>>,
}

impl Default for ShortenOptions<'_> {
    fn default() -> Self {
        Self { texels_max: 1 << 16, center: [0.0; 3], surfaces: None }
    }
}

/// The programs that were shortened for a frame. By default all programs are whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShortPrograms {
    request: ShortenRequest,
    /// The tapes of each program. Empty if no program was requested.
    programs: Vec<ShortTapes>,
}

/// Selects the programs that are worth shortening, by the savings of the last attempts.
#[derive(Debug, Clone, PartialEq)]
pub struct WorthShortening {
    /// For each program, the number of frames until the next attempt. With 0, the program is shortened in each frame;
    /// with `None`, never.
    rests: Vec<Option<u32>>,
}

impl ShortenRequest {
    /// True if programs that were built for `other` can be used, because they were not shortened with different
    /// numbers.
    pub fn is_served_by(&self, other: &Self) -> bool {
        let served = |(own, other): (&Option<RegionKey>, &Option<RegionKey>)| {
            own.is_none() || other.is_none() || own == other
        };
        self.keys.iter().zip(&other.keys).all(served)
    }

    pub(super) fn key_of(&self, program: usize) -> Option<&RegionKey> {
        self.keys.get(program)?.as_ref()
    }
}

impl ShortPrograms {
    /// Returns the tapes of a program if it was shortened with these numbers.
    pub(super) fn tapes_of(&self, program: usize, key: impl FnOnce() -> RegionKey) -> Option<&ShortTapes> {
        let known = self.request.key_of(program)?;
        self.programs.get(program).filter(|_| *known == key())
    }
}

impl WorthShortening {
    pub(super) fn of(may_become_shorter: impl Iterator<Item = bool>) -> Self {
        Self { rests: may_become_shorter.map(|may| may.then_some(0)).collect() }
    }

    /// Returns the request for a frame.
    pub fn request(&self, buffers: &TapeBuffers, inputs: &FrameInputs) -> ShortenRequest {
        let keys = buffers.plans().zip(&self.rests);
        let mut keys: Vec<_> =
            keys.map(|(plan, rest)| (*rest == Some(0)).then(|| plan.formula.key(inputs))).collect();
        if keys.iter().all(Option::is_none) {
            keys.clear();
        }
        ShortenRequest { keys }
    }

    /// Records the savings of an attempt.
    pub fn record(&mut self, short: &ShortPrograms) {
        for (rest, tapes) in self.rests.iter_mut().zip(&short.programs) {
            if tapes.saved.is_some_and(|saved| saved < SAVED_MIN) {
                *rest = Some(REST_FRAMES);
            }
        }
    }

    /// Moves on to the next frame.
    pub fn pass_frame(&mut self) {
        self.rests.iter_mut().flatten().for_each(|rest| *rest = rest.saturating_sub(1));
    }
}

impl TapeBuffers {
    /// Shortens the programs in a frame's request, which may take some 10 ms.
    pub fn shorten(
        &self,
        inputs: &FrameInputs,
        request: &ShortenRequest,
        options: &ShortenOptions,
    ) -> ShortPrograms {
        if request.keys.is_empty() {
            return ShortPrograms::default();
        }
        let room = options.texels_max.saturating_sub(self.texels_max()).min(SHORTENED_TEXELS_MAX);
        let grid = self.grid(options.center);
        let mut shortener = Shortener::new(inputs, grid, options.surfaces, self.encoder(), room);
        let shorten = |(number, plan)| match request.key_of(number) {
            Some(_) => shortener.shorten(plan, self.whole_length(number)),
            None => ShortTapes::default(),
        };
        let programs = self.plans().enumerate().map(shorten).collect();
        ShortPrograms { request: request.clone(), programs }
    }
}
