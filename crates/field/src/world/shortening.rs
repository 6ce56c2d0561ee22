//! Which programs of materials and light are shortened for a frame, and what comes of it.
//!
//! Shortening costs time in every frame. A program of which the last attempt saved little is therefore left whole for
//! a while; then it gets another chance, because the numbers of a frame decide what can be left out.

use super::interpreted::TapeBuffers;
use crate::graph::FrameInputs;
use crate::region::surface::{ShortTapes, Shortener};
use crate::region::{RegionKey, Surfaces};

/// A program of which less than this share of its clauses was saved is left whole ..
const SAVED_MIN: f32 = 0.2;
/// .. for so many frames.
const REST_FRAMES: u32 = 600;
/// Most texels of a frame's shortened programs: they are uploaded for each frame.
const SHORTENED_TEXELS_MAX: usize = 1 << 15;

/// Which programs are to be shortened for a frame, and the numbers that they read: with equal requests they become the
/// same, but for where surfaces are. By default none is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShortenRequest {
    /// By program; `None` for one that is left whole. Empty if all are.
    keys: Vec<Option<RegionKey>>,
}

/// Where programs are shortened, and how much room there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortenOptions<'a> {
    /// Most texels, as far as the whole programs leave room: what the driver reports for a texture buffer.
    pub texels_max: usize,
    /// In a scene without bounds, the middle of the cells.
    pub center: [f32; 3],
    /// Where surfaces are, if that is known: only there are programs shortened.
    pub surfaces: Option<Surfaces<'a>>,
}

impl Default for ShortenOptions<'_> {
    fn default() -> Self {
        Self { texels_max: 1 << 16, center: [0.0; 3], surfaces: None }
    }
}

/// Programs that were shortened for a frame. By default all are whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShortPrograms {
    request: ShortenRequest,
    /// By program, as far as any was requested.
    programs: Vec<ShortTapes>,
}

/// Which programs are worth shortening, by what the last attempts saved.
#[derive(Debug, Clone, PartialEq)]
pub struct WorthShortening {
    /// By program: frames until it is tried again, 0 if it is shortened in each; `None` if it never is.
    rests: Vec<Option<u32>>,
}

impl ShortenRequest {
    /// Whether what was built for `other` can be drawn with in place of what would be built for this: no program was
    /// shortened with other numbers. Where `other` left a program whole, that serves everywhere.
    pub fn is_served_by(&self, other: &Self) -> bool {
        let served = |(own, other): (&Option<RegionKey>, &Option<RegionKey>)| {
            own.is_none() || other.is_none() || own == other
        };
        self.keys.iter().zip(&other.keys).all(served)
    }

    /// The numbers of a program that is to be shortened.
    pub(super) fn key_of(&self, program: usize) -> Option<&RegionKey> {
        self.keys.get(program)?.as_ref()
    }
}

impl ShortPrograms {
    /// The tapes of a program if it was shortened with these numbers.
    pub(super) fn tapes_of(&self, program: usize, key: impl FnOnce() -> RegionKey) -> Option<&ShortTapes> {
        let known = self.request.key_of(program)?;
        self.programs.get(program).filter(|_| *known == key())
    }
}

impl WorthShortening {
    /// At first every program of which any may be true.
    pub(super) fn of(may_become_shorter: impl Iterator<Item = bool>) -> Self {
        Self { rests: may_become_shorter.map(|may| may.then_some(0)).collect() }
    }

    /// What is to be shortened in a frame.
    pub fn request(&self, buffers: &TapeBuffers, inputs: &FrameInputs) -> ShortenRequest {
        let keys = buffers.plans().zip(&self.rests);
        let mut keys: Vec<_> =
            keys.map(|(plan, rest)| (*rest == Some(0)).then(|| plan.key(inputs))).collect();
        if keys.iter().all(Option::is_none) {
            keys.clear();
        }
        ShortenRequest { keys }
    }

    /// Learns from what an attempt saved.
    pub fn note(&mut self, short: &ShortPrograms) {
        for (rest, tapes) in self.rests.iter_mut().zip(&short.programs) {
            if tapes.saved.is_some_and(|saved| saved < SAVED_MIN) {
                *rest = Some(REST_FRAMES);
            }
        }
    }

    /// A frame has passed.
    pub fn pass_frame(&mut self) {
        self.rests.iter_mut().flatten().for_each(|rest| *rest = rest.saturating_sub(1));
    }
}

impl TapeBuffers {
    /// Shortens the programs of a frame that a request of it names. It may take some 10 ms.
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
        let limits = (self.variant.compounds, self.variant.registers);
        let grid = self.grid(options.center);
        let mut shortener = Shortener::new(inputs, grid, options.surfaces, limits, room);
        let shorten = |(number, plan)| match request.key_of(number) {
            Some(_) => shortener.shorten(plan, self.whole_length(number, inputs)),
            None => ShortTapes::default(),
        };
        let programs = self.plans().enumerate().map(shorten).collect();
        ShortPrograms { request: request.clone(), programs }
    }
}
