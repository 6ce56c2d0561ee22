//! A network of dilated convolutions, which processes a stream: residual blocks with one weighted sum of three moments
//! each (van den Oord et al. 2016). Davies and Böck (2019) used such networks for beats.
//!
//! The first blocks look ahead as far as back, so that the output is late by [`Network::late`] steps. The other blocks
//! only look back. Moments before the start and after the end count as 0.

use super::input::NUMBERS;

/// The width of the blocks.
const WIDE: usize = 24;
/// A sum spans an earlier, a middle and a later moment.
const TAPS: usize = 3;
const MIDDLE: usize = 1;
const NEWEST: usize = 2;
/// The largest number of blocks.
const BLOCKS_MAX: u8 = 12;
/// The slope of the activation function below 0.
const LEAK: f32 = 0.05;

type State = [f32; WIDE];

/// A weighted sum of the values of some moments. The weights are `[tap][input][output]`.
struct Sum<const IN: usize, const OUT: usize> {
    weights: Vec<[f32; OUT]>,
    bias: [f32; OUT],
}

/// Reads the numbers of a file of weights.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn bytes(&mut self, count: usize) -> Option<&[u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn number(&mut self) -> Option<f32> {
        Some(f32::from_le_bytes(self.bytes(4)?.try_into().ok()?))
    }

    /// Reads the bias and the scale of each output, then the weights as signed bytes.
    fn sum<const IN: usize, const OUT: usize>(&mut self, taps: usize) -> Option<Sum<IN, OUT>> {
        let (mut bias, mut scales) = ([0.0; OUT], [0.0; OUT]);
        for (bias, scale) in bias.iter_mut().zip(&mut scales) {
            (*bias, *scale) = (self.number()?, self.number()?);
        }
        let (rows, _) = self.bytes(taps * IN * OUT)?.as_chunks::<OUT>();
        let scaled = |row: &[u8; OUT]| std::array::from_fn(|o| f32::from(row[o].cast_signed()) * scales[o]);
        Some(Sum { weights: rows.iter().map(scaled).collect(), bias })
    }
}

impl<const IN: usize, const OUT: usize> Sum<IN, OUT> {
    fn add(&self, tap: usize, values: &[f32; IN], out: &mut [f32; OUT]) {
        let rows = self.weights.get(tap * IN..).unwrap_or_default();
        for (row, value) in rows.iter().zip(values) {
            out.iter_mut().zip(row).for_each(|(sum, weight)| *sum += value * weight);
        }
    }
}

fn bent(state: State) -> State {
    state.map(|value| value.max(LEAK * value))
}

/// The last moments, as many as a sum spans.
struct Past<const IN: usize> {
    values: Vec<[f32; IN]>,
    dilation: usize,
    newest: usize,
}

impl<const IN: usize> Past<IN> {
    fn new(dilation: usize) -> Self {
        Self { values: vec![[0.0; IN]; (TAPS - 1) * dilation + 1], dilation, newest: 0 }
    }

    fn clear(&mut self) {
        self.values.fill([0.0; IN]);
    }

    fn push(&mut self, values: [f32; IN]) {
        self.newest = (self.newest + 1) % self.values.len();
        self.values[self.newest] = values;
    }

    /// Returns the moment of a tap, the oldest first.
    fn at(&self, tap: usize) -> &[f32; IN] {
        let count = self.values.len();
        &self.values[(self.newest + count - (TAPS - 1 - tap) * self.dilation) % count]
    }
}

struct Block {
    past: Past<WIDE>,
    looks_ahead: bool,
    around: Sum<WIDE, WIDE>,
    mixed: Sum<WIDE, WIDE>,
}

impl Block {
    fn late(&self) -> usize {
        if self.looks_ahead { self.past.dilation } else { 0 }
    }
}

/// A network and its state.
pub(super) struct Network {
    past: Past<NUMBERS>,
    first: Sum<NUMBERS, WIDE>,
    blocks: Vec<Block>,
    last: Sum<WIDE, 1>,
    /// The number of moments processed, and the number at the end.
    count: usize,
    end: usize,
}

impl Network {
    /// Reads a file: the bytes `MBN` and 2, the number of blocks, the number of blocks that look ahead, then each sum. A
    /// sum has the bias and the scale of each output, and the weights. Returns `None` if the file is damaged.
    pub(super) fn read(file: &[u8]) -> Option<Self> {
        let mut reader = Reader(file.strip_prefix(b"MBN\x02")?);
        let [blocks, ahead] = reader.bytes(2)?.try_into().ok()?;
        let first = reader.sum(TAPS)?;
        let blocks = (0..blocks.min(BLOCKS_MAX)).map(|n| {
            let (past, looks_ahead) = (Past::new(1 << n), n < ahead);
            Some(Block { past, looks_ahead, around: reader.sum(TAPS)?, mixed: reader.sum(1)? })
        });
        let blocks = blocks.collect::<Option<_>>()?;
        let last = reader.sum(1)?;
        let is_whole = reader.0.is_empty();
        is_whole.then(|| Self { past: Past::new(1), first, blocks, last, count: 0, end: usize::MAX })
    }

    /// The number of steps after which the output of a moment follows.
    pub(super) fn late(&self) -> usize {
        1 + self.blocks.iter().map(Block::late).sum::<usize>()
    }

    /// Forgets all moments.
    pub(super) fn restart(&mut self) {
        self.past.clear();
        self.blocks.iter_mut().for_each(|block| block.past.clear());
        (self.count, self.end) = (0, usize::MAX);
    }

    /// Processes the next moment; `None` after the last one. Returns the log odds of a beat, [`Network::late`] steps
    /// ago.
    pub(super) fn follow(&mut self, input: Option<&[f32; NUMBERS]>) -> f32 {
        if input.is_none() {
            self.end = self.end.min(self.count);
        }
        self.past.push(input.copied().unwrap_or([0.0; NUMBERS]));
        let mut late = 1;
        let (count, end) = (self.count, self.end);
        let is_inside = |late: usize| count >= late && count - late < end;
        let mut state = self.first.bias;
        (0..TAPS).for_each(|tap| self.first.add(tap, self.past.at(tap), &mut state));
        state = if is_inside(late) { bent(state) } else { [0.0; WIDE] };
        for block in &mut self.blocks {
            block.past.push(state);
            late += block.late();
            if !is_inside(late) {
                state = [0.0; WIDE];
                continue;
            }
            let mut inner = block.around.bias;
            (0..TAPS).for_each(|tap| block.around.add(tap, block.past.at(tap), &mut inner));
            let mut sum = block.mixed.bias;
            block.mixed.add(0, &bent(inner), &mut sum);
            state = *block.past.at(if block.looks_ahead { MIDDLE } else { NEWEST });
            state.iter_mut().zip(sum).for_each(|(state, sum)| *state += sum);
        }
        let mut out = self.last.bias;
        self.last.add(0, &bent(state), &mut out);
        self.count += 1;
        out[0]
    }
}
