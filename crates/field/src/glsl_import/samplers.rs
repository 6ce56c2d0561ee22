//! Reads of textures: the sound, the last frame, tables of random numbers, and images that the scene names. Other
//! pictures are black.
//!
//! The value of a sampler is the number of its global variable.

use super::Result;
use super::calls::{Argument, Executor};
use super::layout::Part;
use super::outside::Channel;
use super::parse::Special;
use crate::graph::{Graph, Input, Node, NodeId, Op, ScreenInput, SoundInput};
use crate::lang::Diagnostic;
use crate::limits::LAST_LIGHT_MAX;

/// Texels in a row of Shadertoy's texture of the sound.
const ROW: f32 = 512.0;
/// The highest frequency of a row of Shadertoy, and of the spectra of other viewers, in Hz.
const ROW_HZ: f32 = 11_025.0;
const NYQUIST_HZ: f32 = 22_050.0;
/// The ends of the language's `spectrum`, in Hz.
const SPECTRUM_HZ: [f32; 2] = [30.0, 16_000.0];
/// Range and least value of the language's `spectrum` in decibels.
const SPECTRUM_DB: [f32; 2] = [72.0, -84.0];
/// Part of the language's `waveform` that a viewer shows: 512 of 44,100 samples, in its middle.
const WAVE: [f32; 2] = [0.27, 0.365];

/// The value of a sampler that reads texture 0 of the scene. The next textures have the values below.
const FIRST_IMAGE: i64 = -2;

/// Returns the value that makes a sampler read a texture of the scene.
pub fn image_sampler(texture: u16) -> f32 {
    (FIRST_IMAGE - i64::from(texture)) as f32
}

/// Operations that compute a position near the pixel, at most.
const NEAR_PIXEL_MAX: usize = 32;
/// Texels of the noise that replaces the surface of a thing, coarse and fine.
const GRAIN: [f32; 2] = [8.0, 64.0];

/// A read of a texture.
pub(super) struct SamplerRead<'e, 'm, 'g> {
    pub of: &'e mut Executor<'m, 'g>,
}

impl<'m> SamplerRead<'_, 'm, '_> {
    pub(super) fn colour(&mut self, special: Special, arguments: &[Argument]) -> Result<Vec<Part>> {
        self.of.step(64)?;
        let [Argument::Parts(sampler), Argument::Parts(at), ..] = arguments else { return Ok(Vec::new()) };
        let number = sampler.first().and_then(|part| self.of.whole(*part)).unwrap_or(-1);
        let at = at.iter().map(|part| self.of.node(*part)).collect::<Result<Vec<_>>>()?;
        if let Special::TextureSize = special {
            let size = self.of.graph.constant(FLAT);
            return Ok(vec![Part::Node(size); 2]);
        }
        let is_texel = matches!(special, Special::Texel);
        if let (Ok(image), &[u, v, ..]) = (u16::try_from(FIRST_IMAGE.saturating_sub(number)), at.as_slice()) {
            return Ok(self.light(image, 1.0, [u, v], is_texel).map(Part::Node).to_vec());
        }
        let colour = match (self.channel(number, &at, is_texel), at.as_slice()) {
            (Channel::Noise, &[x, y, ..]) if is_texel => cell(self.of.graph, x, y),
            (Channel::Noise, &[u, v]) => flat_noise(self.of.graph, [u, v], FLAT),
            (Channel::Noise, &[u, v, w]) => [solid_noise(self.of.graph, [u, v, w]); 4],
            (Channel::Unknown | Channel::Picture, at) => self.picture(number, at)?,
            (Channel::LastFrame, &[u, v, ..]) => match self.of.session.last_frame {
                Some(texture) => self.light(texture, LAST_LIGHT_MAX, [u, v], is_texel),
                None => [self.of.zero, self.of.zero, self.of.zero, self.of.one],
            },
            (channel, at) => {
                let mut at = at.to_vec();
                if is_texel && let Some(x) = at.first_mut() {
                    *x = self.of.graph.div(*x + 0.5, ROW);
                }
                self.sound(channel, &at)
            }
        };
        Ok(colour.map(Part::Node).to_vec())
    }

    /// Returns the channel of a sampler. A read shows the channel of an unknown one: the row of the sound's texture is
    /// constant, and a position in a table of noise is divided by the size of the table.
    fn channel(&mut self, number: i64, at: &[NodeId], is_texel: bool) -> Channel {
        if let Some(&known) = self.of.session.channels.get(&number) {
            return known;
        }
        let by_name =
            self.of.file.globals.samplers.get(self.global_name(number)).copied().unwrap_or(Channel::Unknown);
        let of_size = |size| at.iter().any(|&node| unscaled(self.of.graph, node, size).is_some());
        let told = match *at {
            _ if by_name != Channel::Unknown => by_name,
            [u, _] if !is_texel && (of_size(FLAT) || is_cell(self.of.graph, u)) => Channel::Noise,
            [_, _, _] if !is_texel && of_size(SOLID) => Channel::Noise,
            [x, row] if self.of.session.in_picture => match self.of.graph.as_constant(row) {
                Some(row) if is_texel && (row == 0.0 || row == 1.0) => Channel::Rows,
                Some(row) if !is_texel && (row * FLAT).fract() == 0.5 => Channel::Noise,
                Some(row) if !is_texel && is_row(row) && self.moves(&[x]) != Some(true) => Channel::Rows,
                _ if is_texel => return Channel::Noise,
                _ => return Channel::Unknown,
            },
            _ if is_texel => return Channel::Noise,
            _ => return Channel::Unknown,
        };
        self.of.session.channels.insert(number, told);
        // Earlier reads took the sampler for a picture.
        self.of.session.learned |= self.of.session.pictures.remove(self.global_name(number));
        told
    }

    /// True if a position moves with the time; `None` if it takes many operations.
    fn moves(&self, at: &[NodeId]) -> Option<bool> {
        let (mut open, mut moves) = (at.to_vec(), false);
        for _ in 0..NEAR_PIXEL_MAX {
            let Some(node) = open.pop() else { return Some(moves) };
            moves |= self.of.graph.node(node) == Node::Input(Input::T);
            open.extend(self.of.graph.node(node).operands());
        }
        None
    }

    fn global_name(&self, number: i64) -> &'m str {
        let file = self.of.file;
        let mut globals = file.module.global_variables.iter();
        let global = usize::try_from(number).ok().and_then(|number| globals.nth(number));
        global.and_then(|(_, global)| global.name.as_deref()).unwrap_or("")
    }

    /// A picture is a mistake in shapes. In pictures, a plain sky replaces the surroundings, a noise the surface of a
    /// thing, and black an image that is read near the pixel.
    fn picture(&mut self, number: i64, at: &[NodeId]) -> Result<[NodeId; 4]> {
        if !self.of.session.in_picture {
            return Err(Diagnostic::unsupported(self.of.here, "a shape cannot read a picture").hint(
                "a read of noise scales the position by 1/256; otherwise use `noise`, or return a number instead",
            ));
        }
        let name = self.global_name(number);
        let is_unnamed = name.starts_with("iChannel");
        let shown = if name.is_empty() { "a texture" } else { name };
        self.of.session.pictures.insert(shown.to_owned());
        let up = match *at {
            [u, v] if is_unnamed && self.moves(at).is_none() => {
                let [coarse, fine] = GRAIN.map(|size| flat_noise(self.of.graph, [u, v], size)[0]);
                let grain = self.of.graph.mix(coarse, fine, 0.5);
                return Ok([grain, grain, grain, self.of.one]);
            }
            [_, up, _] => up,
            _ => return Ok([self.of.zero, self.of.zero, self.of.zero, self.of.one]),
        };
        let length = self.of.graph.length(at);
        let above = self.of.graph.smoothstep(0.0, 1.0, up / length);
        let sky = self.of.graph.add(0.25, 0.45 * above);
        Ok([sky, sky, sky, self.of.one])
    }

    /// A colour of a texture whose light is `most` times as bright as it holds.
    fn light(&mut self, texture: u16, most: f32, [mut u, mut v]: [NodeId; 2], is_texel: bool) -> [NodeId; 4] {
        if is_texel {
            for (at, size) in [(&mut u, ScreenInput::Width), (&mut v, ScreenInput::Height)] {
                let size = self.of.graph.input(Input::Screen(size));
                *at = self.of.graph.div(*at + 0.5, size);
            }
        }
        // Images begin at the top.
        let is_image = most == 1.0;
        if is_image {
            v = self.of.graph.sub(1.0, v);
        }
        let graph = &mut *self.of.graph;
        let [red, green, blue] = [0, 1, 2].map(|channel| {
            let fraction = graph.texture(texture, channel, u, v);
            let light = graph.mul(fraction, most);
            encoded(graph, light)
        });
        let alpha = if is_image { graph.texture(texture, 3, u, v) } else { self.of.one };
        [red, green, blue, alpha]
    }

    fn sound(&mut self, channel: Channel, at: &[NodeId]) -> [NodeId; 4] {
        let (x, row) =
            (at.first().copied().unwrap_or(self.of.zero), at.get(1).copied().unwrap_or(self.of.zero));
        let (zero, one, graph) = (self.of.zero, self.of.one, &mut *self.of.graph);
        let value = match channel {
            Channel::Rows => {
                let (spectrum, wave) = (heard(graph, x, ROW_HZ), wave(graph, x));
                return [graph.select(Op::Less.pair(row, 0.5), spectrum, wave), zero, zero, one];
            }
            Channel::Waveform => wave(graph, x),
            Channel::Sums => {
                // No sum has a bound, and a moment must look the same after a seek: a time that runs faster with bass.
                let (time, drive) = (graph.input(Input::T), graph.input(Input::Sound(SoundInput::BassDrive)));
                graph.mul(time + drive, 0.5)
            }
            Channel::Amplitudes => {
                let height = heard(graph, x, NYQUIST_HZ);
                // 10^(decibels / 20)
                let [range, least] = SPECTRUM_DB.map(|decibels| decibels * std::f32::consts::LOG2_10 / 20.0);
                return [graph.unary(Op::Exp2, height * range + least), zero, zero, one];
            }
            _ => heard(graph, x, NYQUIST_HZ),
        };
        [value, value, value, one]
    }
}

/// True for a whole number divided by another one, as shaders read a random number for each cell.
fn is_cell(graph: &Graph, node: NodeId) -> bool {
    let whole = |node| matches!(graph.node(node), Node::Unary(Op::Floor, _));
    matches!(graph.node(node), Node::Binary(Op::Mul | Op::Div, a, b) if whole(a) && graph.as_constant(b).is_some())
}

/// True for a place in one of the two rows of the sound's texture, not between them.
fn is_row(row: f32) -> bool {
    (0.0..=1.0).contains(&row) && row != 0.5
}

/// The height of the spectrum at a fraction of the frequency `most`.
fn heard(graph: &mut Graph, x: NodeId, most: f32) -> NodeId {
    let [low, high] = SPECTRUM_HZ;
    let octaves = Op::Log.of(Op::Max.pair(x, 1e-4) * (most / low));
    graph.unary(Op::Spectrum, octaves * (high / low).ln().recip())
}

fn wave(graph: &mut Graph, x: NodeId) -> NodeId {
    let [scale, start] = WAVE;
    graph.add(Op::Waveform.of(x * scale + start) * 0.5, 0.5)
}

/// Light as a colour of the screen; the inverse of the language's `srgb`.
fn encoded(graph: &mut Graph, light: NodeId) -> NodeId {
    let above = Op::Pow.pair(light, 1.0 / 2.4) * 1.055 + -0.055;
    let color = graph.select(Op::Less.pair(light, 0.003_130_8), light * 12.92, above);
    graph.min(color, 1.0)
}

// Tables of random numbers, which many shaders read as a noise. Such a read becomes values of `cell_hash`, which are
// smoothed like the texels of a texture.
//
// The tables of Shadertoy have 256 by 256 texels, or 32 in each direction of space. A read of such a table scales the
// position by 1/256 or 1/32, which tells it from the read of a picture. The green channel is the red one moved by
// (37, 17), so that a common trick reads two layers of a noise in space at once.

/// Texels of the tables of noise, along one side.
const FLAT: f32 = 256.0;
const SOLID: f32 = 32.0;
/// Offset of the green channel to the red one.
const GREEN: [f32; 2] = [37.0, 17.0];

/// Returns x if the node is x divided by the size of a table of noise.
fn unscaled(graph: &Graph, node: NodeId, size: f32) -> Option<NodeId> {
    let Node::Binary(op, a, b) = graph.node(node) else { return None };
    let factor = graph.as_constant(b)?;
    let near = |wanted: f32| (factor / wanted - 1.0).abs() < 0.01;
    match op {
        Op::Mul if near(size.recip()) => Some(a),
        Op::Div if near(size) => Some(a),
        _ => None,
    }
}

/// A position in a table of noise, in texels.
fn in_texels(graph: &mut Graph, node: NodeId, size: f32) -> NodeId {
    unscaled(graph, node, size).unwrap_or_else(|| graph.mul(node, size))
}

/// The four channels of a texel.
fn cell(graph: &mut Graph, x: NodeId, y: NodeId) -> [NodeId; 4] {
    std::array::from_fn(|channel| {
        let [dx, dy] = GREEN.map(|offset| offset * channel as f32);
        graph.binary(Op::Hash, Op::Mod.pair(x - dx, FLAT), Op::Mod.pair(y - dy, FLAT))
    })
}

/// The whole part and the fraction of a position, measured from the centres of texels.
fn split(graph: &mut Graph, x: NodeId) -> (NodeId, NodeId) {
    let shifted = graph.sub(x, 0.5);
    (graph.unary(Op::Floor, shifted), graph.unary(Op::Fract, shifted))
}

/// Reads a table of noise with `size` texels along a side.
fn flat_noise(graph: &mut Graph, at: [NodeId; 2], size: f32) -> [NodeId; 4] {
    let [x, y] = at.map(|node| in_texels(graph, node, size));
    let ((x, u), (y, v)) = (split(graph, x), split(graph, y));
    let (x1, y1) = (graph.add(x, 1.0), graph.add(y, 1.0));
    let corners = [(x, y), (x1, y), (x, y1), (x1, y1)].map(|(x, y)| cell(graph, x, y));
    std::array::from_fn(|channel| {
        let [a, b, c, d] = corners.map(|corner| corner[channel]);
        let (low, high) = (graph.mix(a, b, u), graph.mix(c, d, u));
        graph.mix(low, high, v)
    })
}

fn solid_noise(graph: &mut Graph, at: [NodeId; 3]) -> NodeId {
    let at = at.map(|node| in_texels(graph, node, SOLID));
    let parts = at.map(|x| split(graph, x));
    let corners: [NodeId; 8] = std::array::from_fn(|corner| {
        let [x, y, z] = std::array::from_fn(|axis| {
            let whole = parts[axis].0;
            let moved = if corner >> axis & 1 == 1 { graph.add(whole, 1.0) } else { whole };
            graph.binary(Op::Mod, moved, SOLID)
        });
        graph.binary(Op::Hash, Op::Hash.pair(x, y) * 16_777_216.0, z)
    });
    let [u, v, w] = parts.map(|(_, fraction)| fraction);
    let edges: [NodeId; 4] = std::array::from_fn(|at| graph.mix(corners[2 * at], corners[2 * at + 1], u));
    let [low, high] = std::array::from_fn(|at| graph.mix(edges[2 * at], edges[2 * at + 1], v));
    graph.mix(low, high, w)
}
