//! The network for training: residual blocks of dilated convolutions (van den Oord et al. 2016; for beats Davies and
//! Böck 2019), trained by back-propagation with Adam (Kingma and Ba 2015).

use super::synth::Random;

/// The width of all layers, and of the last layer: a beat and a downbeat.
const WIDE: usize = 24;
pub(super) const OUT: usize = 2;
const TAPS: usize = 3;

/// A convolution along time. The weights are `[tap][input][output]`.
#[derive(Clone)]
pub(super) struct Conv {
    inputs: usize,
    outputs: usize,
    taps: usize,
    /// The tap of the present moment.
    present: usize,
    dilation: usize,
    weights: Vec<f32>,
    bias: Vec<f32>,
    gradient: Vec<f32>,
    bias_gradient: Vec<f32>,
    moments: [Vec<f32>; 2],
    bias_moments: [Vec<f32>; 2],
}

impl Conv {
    fn new(inputs: usize, outputs: usize, taps: usize, dilation: usize, random: &mut Random) -> Self {
        let count = inputs * outputs * taps;
        let scale = (2.0 / (inputs * taps) as f32).sqrt();
        Self {
            inputs,
            outputs,
            taps,
            present: taps / 2,
            dilation,
            weights: (0..count).map(|_| scale * random.normal()).collect(),
            bias: vec![0.0; outputs],
            gradient: vec![0.0; count],
            bias_gradient: vec![0.0; outputs],
            moments: [vec![0.0; count], vec![0.0; count]],
            bias_moments: [vec![0.0; outputs], vec![0.0; outputs]],
        }
    }

    /// The offset of a tap in moments.
    fn offset(&self, tap: usize) -> isize {
        (tap as isize - self.present as isize) * self.dilation as isize
    }

    fn forward(&self, input: &[f32], out: &mut Vec<f32>) {
        let count = input.len() / self.inputs;
        out.clear();
        (0..count).for_each(|_| out.extend_from_slice(&self.bias));
        for tap in 0..self.taps {
            let weights = &self.weights[tap * self.inputs * self.outputs..][..self.inputs * self.outputs];
            match self.outputs {
                WIDE => add_product::<WIDE>(input, self.inputs, weights, out, self.offset(tap)),
                OUT => add_product::<OUT>(input, self.inputs, weights, out, self.offset(tap)),
                _ => unreachable!(),
            }
        }
    }

    /// Adds to the gradients, and to the gradient of the input if there is one.
    fn backward(&mut self, input: &[f32], out_gradient: &[f32], input_gradient: Option<&mut [f32]>) {
        for row in out_gradient.chunks_exact(self.outputs) {
            self.bias_gradient.iter_mut().zip(row).for_each(|(sum, g)| *sum += g);
        }
        for tap in 0..self.taps {
            let size = self.inputs * self.outputs;
            let (offset, gradient) = (self.offset(tap), &mut self.gradient[tap * size..][..size]);
            match self.outputs {
                WIDE => add_outer::<WIDE>(input, self.inputs, out_gradient, gradient, offset),
                OUT => add_outer::<OUT>(input, self.inputs, out_gradient, gradient, offset),
                _ => unreachable!(),
            }
        }
        if let Some(input_gradient) = input_gradient {
            for tap in 0..self.taps {
                let size = self.inputs * self.outputs;
                let weights = &self.weights[tap * size..][..size];
                let mut turned = vec![0.0; size];
                for i in 0..self.inputs {
                    for o in 0..self.outputs {
                        turned[o * self.inputs + i] = weights[i * self.outputs + o];
                    }
                }
                add_product::<WIDE>(out_gradient, self.outputs, &turned, input_gradient, -self.offset(tap));
            }
        }
    }

    /// Writes the biases and scales of the first `outputs` outputs, and the weights as signed bytes.
    fn write(&self, outputs: usize, file: &mut Vec<u8>) {
        let of = |output: usize| self.weights.iter().skip(output).step_by(self.outputs);
        let scales: Vec<f32> = (0..outputs)
            .map(|o| of(o).fold(1e-9_f32, |most, weight| most.max(weight.abs())) / 127.0)
            .collect();
        for (bias, scale) in self.bias.iter().zip(&scales) {
            file.extend(bias.to_le_bytes());
            file.extend(scale.to_le_bytes());
        }
        for row in self.weights.chunks_exact(self.outputs) {
            let rounded = |(weight, scale): (&f32, &f32)| (weight / scale).round() as i8;
            file.extend(row.iter().zip(&scales).map(rounded).map(i8::cast_unsigned));
        }
    }

    fn step(&mut self, rate: f32, number: i32, scale: f32) {
        let correct = [1.0 - 0.9_f32.powi(number), 1.0 - 0.999_f32.powi(number)];
        let one = |values: &mut [f32], gradient: &mut [f32], moments: &mut [Vec<f32>; 2], decay: f32| {
            let [first, second] = moments;
            for (((value, g), m), v) in values.iter_mut().zip(gradient).zip(first).zip(second) {
                let own = *g * scale;
                *g = 0.0;
                *m += 0.1 * (own - *m);
                *v += 0.001 * (own * own - *v);
                *value -= rate * ((*m / correct[0]) / ((*v / correct[1]).sqrt() + 1e-8) + decay * *value);
            }
        };
        one(&mut self.weights, &mut self.gradient, &mut self.moments, 1e-2);
        one(&mut self.bias, &mut self.bias_gradient, &mut self.bias_moments, 0.0);
    }
}

/// Returns `sum + a · b`, by one instruction where the processor has one.
#[inline(always)]
fn fused(sum: f32, a: f32, b: f32) -> f32 {
    if cfg!(target_feature = "fma") { a.mul_add(b, sum) } else { sum + a * b }
}

/// The number of moments whose sums are kept in registers.
const TOGETHER: usize = 4;

/// Adds `weights` (input × output) times the input at `t + offset` to the output at each `t`.
fn add_product<const O: usize>(
    input: &[f32],
    inputs: usize,
    weights: &[f32],
    out: &mut [f32],
    offset: isize,
) {
    let (weights, _) = weights.as_chunks::<O>();
    let (rows, _) = out.as_chunks_mut::<O>();
    let from = (-offset).max(0) as usize;
    let to = (rows.len() as isize - offset.max(0)).max(0) as usize;
    if from >= to {
        return;
    }
    let input = &input[(from as isize + offset) as usize * inputs..];
    let mut places = input.chunks_exact(inputs * TOGETHER);
    let mut groups = rows[from..to].chunks_exact_mut(TOGETHER);
    for (rows, input) in groups.by_ref().zip(&mut places) {
        let mut sums: [[f32; O]; TOGETHER] = std::array::from_fn(|k| rows[k]);
        let (a, rest) = input.split_at(inputs);
        let (b, rest) = rest.split_at(inputs);
        let (c, d) = rest.split_at(inputs);
        for i in 0..inputs.min(weights.len()).min(d.len()) {
            let w = &weights[i];
            for o in 0..O {
                sums[0][o] = fused(sums[0][o], a[i], w[o]);
                sums[1][o] = fused(sums[1][o], b[i], w[o]);
                sums[2][o] = fused(sums[2][o], c[i], w[o]);
                sums[3][o] = fused(sums[3][o], d[i], w[o]);
            }
        }
        rows.copy_from_slice(&sums);
    }
    let done = (to - from) / TOGETHER * TOGETHER;
    for (row, input) in groups.into_remainder().iter_mut().zip(input[done * inputs..].chunks_exact(inputs)) {
        for (w, x) in weights.iter().zip(input) {
            for o in 0..O {
                row[o] = fused(row[o], *x, w[o]);
            }
        }
    }
}

/// Adds to the gradient of the weights: the sum over all moments of input times output gradient.
fn add_outer<const O: usize>(input: &[f32], inputs: usize, out: &[f32], gradient: &mut [f32], offset: isize) {
    let (rows, _) = out.as_chunks::<O>();
    let (gradient, _) = gradient.as_chunks_mut::<O>();
    let from = (-offset).max(0) as usize;
    let to = (rows.len() as isize - offset.max(0)).max(0) as usize;
    if from >= to {
        return;
    }
    let input = &input[(from as isize + offset) as usize * inputs..];
    for (i, gradient) in gradient.as_chunks_mut::<TOGETHER>().0.iter_mut().enumerate() {
        let mut sums = *gradient;
        for (row, input) in rows[from..to].iter().zip(input.chunks_exact(inputs)) {
            let x: [f32; TOGETHER] = input.as_chunks().0[i];
            for k in 0..TOGETHER {
                for o in 0..O {
                    sums[k][o] = fused(sums[k][o], x[k], row[o]);
                }
            }
        }
        *gradient = sums;
    }
}

const LEAK: f32 = 0.05;

fn bent(values: &[f32], out: &mut Vec<f32>) {
    out.clear();
    out.extend(values.iter().map(|x| if *x > 0.0 { *x } else { LEAK * x }));
}

/// Sets random units to 0, each for the whole piece, and scales the others (spatial dropout, Tompson et al. 2015).
/// Returns the scale of each unit.
fn drop_out(hidden: &mut [f32], fraction: f32, random: &mut Random) -> [f32; WIDE] {
    let kept = 1.0 / (1.0 - fraction);
    let scales = std::array::from_fn(|_| if random.chance(fraction) { 0.0 } else { kept });
    scaled(hidden, &scales);
    scales
}

fn scaled(rows: &mut [f32], scales: &[f32; WIDE]) {
    for row in rows.as_chunks_mut::<WIDE>().0 {
        row.iter_mut().zip(scales).for_each(|(value, scale)| *value *= scale);
    }
}

#[derive(Clone)]
pub(super) struct Net {
    first: Conv,
    blocks: Vec<(Conv, Conv)>,
    /// The number of blocks that look ahead.
    ahead: usize,
    last: Conv,
    number: i32,
}

/// The values of all layers.
#[derive(Default)]
pub(super) struct Values {
    before: Vec<f32>,
    /// The input of each block, and of the last layer.
    states: Vec<Vec<f32>>,
    inner: Vec<Vec<f32>>,
    hidden: Vec<Vec<f32>>,
    scales: Vec<[f32; WIDE]>,
    spare: Vec<f32>,
    top: Vec<f32>,
    pub(super) out: Vec<f32>,
}

impl Net {
    /// Creates a network whose first `ahead` blocks look ahead as far as back, and whose other blocks only look back.
    pub(super) fn new(inputs: usize, blocks: usize, ahead: usize, random: &mut Random) -> Self {
        let blocks = (0..blocks)
            .map(|n| {
                let mut second = Conv::new(WIDE, WIDE, 1, 1, random);
                second.weights.iter_mut().for_each(|w| *w *= 0.3);
                let mut first = Conv::new(WIDE, WIDE, TAPS, 1 << n, random);
                first.present = if n < ahead { TAPS / 2 } else { TAPS - 1 };
                (first, second)
            })
            .collect();
        let mut last = Conv::new(WIDE, OUT, 1, 1, random);
        last.weights.iter_mut().for_each(|w| *w *= 0.1);
        last.bias.fill(-2.0);
        Self { first: Conv::new(inputs, WIDE, TAPS, 1, random), blocks, ahead, last, number: 0 }
    }

    pub(super) fn forward(
        &self,
        input: &[f32],
        values: &mut Values,
        mut dropped: Option<(f32, &mut Random)>,
    ) {
        let count = self.blocks.len();
        values.states.resize_with(count + 1, Vec::new);
        values.inner.resize_with(count, Vec::new);
        values.hidden.resize_with(count, Vec::new);
        values.scales.resize(count, [1.0; WIDE]);
        self.first.forward(input, &mut values.before);
        bent(&values.before, &mut values.states[0]);
        for (n, (first, second)) in self.blocks.iter().enumerate() {
            first.forward(&values.states[n], &mut values.inner[n]);
            bent(&values.inner[n], &mut values.hidden[n]);
            values.scales[n] = match &mut dropped {
                Some((fraction, random)) => drop_out(&mut values.hidden[n], *fraction, random),
                None => [1.0; WIDE],
            };
            second.forward(&values.hidden[n], &mut values.spare);
            let sum = values.states[n].iter().zip(&values.spare).map(|(a, b)| a + b).collect();
            values.states[n + 1] = sum;
        }
        bent(&values.states[count], &mut values.top);
        self.last.forward(&values.top, &mut values.out);
    }

    pub(super) fn backward(&mut self, input: &[f32], values: &Values, out_gradient: &[f32]) {
        let slope = |g: &mut [f32], x: &[f32]| {
            g.iter_mut().zip(x).for_each(|(g, x)| *g *= if *x > 0.0 { 1.0 } else { LEAK });
        };
        let count = self.blocks.len();
        let mut gradient = vec![0.0; values.states[count].len()];
        self.last.backward(&values.top, out_gradient, Some(&mut gradient));
        slope(&mut gradient, &values.states[count]);
        for (n, (first, second)) in self.blocks.iter_mut().enumerate().rev() {
            let mut hidden = vec![0.0; gradient.len()];
            second.backward(&values.hidden[n], &gradient, Some(&mut hidden));
            scaled(&mut hidden, &values.scales[n]);
            slope(&mut hidden, &values.inner[n]);
            first.backward(&values.states[n], &hidden, Some(&mut gradient));
        }
        slope(&mut gradient, &values.before);
        self.first.backward(input, &gradient, None);
    }

    /// Returns the file that the analysis reads ([`super::super::network`]). Of the last layer it has the first output.
    pub(super) fn file(&self) -> Vec<u8> {
        let mut file = b"MBN\x02".to_vec();
        file.extend([self.blocks.len() as u8, self.ahead as u8]);
        self.first.write(WIDE, &mut file);
        for (first, second) in &self.blocks {
            first.write(WIDE, &mut file);
            second.write(WIDE, &mut file);
        }
        self.last.write(1, &mut file);
        file
    }

    pub(super) fn step(&mut self, rate: f32, scale: f32) {
        self.number += 1;
        let number = self.number;
        let blocks = self.blocks.iter_mut().flat_map(|(first, second)| [first, second]);
        let convs = [&mut self.first, &mut self.last].into_iter().chain(blocks);
        convs.for_each(|conv| conv.step(rate, number, scale));
    }
}
