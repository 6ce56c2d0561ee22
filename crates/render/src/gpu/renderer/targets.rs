//! The render targets of a frame.

use std::rc::Rc;

use crate::gpu::edge_list::EdgeList;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::Result;
use crate::gpu::evaluations::{Counting, Evaluations};
use crate::gpu::gl::Gl;
use crate::gpu::media::MediaTargets;
use crate::gpu::post::PostTargets;
use crate::gpu::target::{Stencil, Target, Texel};

/// The properties of a scene's frames that decide about their targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TargetsKind {
    pub(super) size: (u32, u32),
    pub(super) has_lens: bool,
    pub(super) has_media: bool,
}

pub(super) struct Targets {
    pub(super) kind: TargetsKind,
    pub(super) media: Option<MediaTargets>,
    pub(super) first: Target,
    pub(super) edges: Edges,
    pub(super) post: PostTargets,
}

pub(super) enum Edges {
    /// The sum of the samples, drawn through a stencil. Used on GPUs.
    Stencil(Target),
    /// A list of pixels, with their samples side by side. Used on software renderers.
    List(EdgeList),
}

impl Edges {
    fn samples(&self) -> &Target {
        match self {
            Edges::Stencil(sum) => sum,
            Edges::List(list) => &list.samples,
        }
    }
}

impl Targets {
    pub(super) fn new(gl: &Gl, kind: TargetsKind, samples: EdgeSamples, counting: Counting) -> Result<Self> {
        let TargetsKind { size, has_lens, has_media } = kind;
        // Counts replace the shader outputs of the lens: images with counts are never shown, so they need no blur.
        let texels: &[Texel] = match (counting, has_lens) {
            (Counting::On, _) => &[Texel::Rgba16F, Texel::Rgba32F, Texel::Rgba32F, Texel::Rgba32F],
            (Counting::Off, true) => &[Texel::Rgba16F, Texel::R16F],
            (Counting::Off, false) => &[Texel::Rgba16F],
        };
        let mut texels = texels.to_vec();
        if gl.info().software {
            // The last target holds how far each pixel's beam is free of surfaces (shaders/beams.glsl).
            texels.push(Texel::R32F);
        }
        Target::check_size(gl, size)?;
        let media =
            has_media.then(|| MediaTargets::new(gl, size, &texels, samples.media_layers())).transpose()?;
        let (stencil, edges) = if gl.info().software {
            (None, Edges::List(EdgeList::new(gl, size, &texels, samples)?))
        } else {
            let stencil = Rc::new(Stencil::new(gl, size)?);
            (Some(stencil.clone()), Edges::Stencil(Target::new(gl, size, &texels, Some(stencil))?))
        };
        Ok(Self {
            kind,
            media,
            first: Target::new(gl, size, &texels, stencil)?,
            edges,
            post: PostTargets::new(gl, size, has_lens && counting == Counting::Off, size)?,
        })
    }

    /// Returns the counts, divided by a number of pixels.
    pub(super) fn evaluations(&self, samples: EdgeSamples, pixels: f64) -> Evaluations {
        let mut sums = [[0.0; 4]; 3];
        let media = self.media.as_ref().map(|media| &media.rays);
        for target in [&self.first, self.edges.samples()].into_iter().chain(media) {
            for (sum, index) in sums.iter_mut().zip(1..) {
                for texel in target.read_rgba32f(index).as_chunks::<4>().0 {
                    sum.iter_mut().zip(texel).for_each(|(sum, count)| *sum += f64::from(*count));
                }
            }
        }
        let [
            [primary, reflection, normal, shadow],
            [occlusion, capped_rays, clauses, lookups],
            [surface_clauses, media, media_steps, swarm_steps],
        ] = sums.map(|four| four.map(|sum| sum / pixels));
        let edge_pixels = self.edge_pixels(samples) / pixels;
        Evaluations {
            primary,
            reflection,
            normal,
            shadow,
            occlusion,
            capped_rays,
            clauses,
            surface_clauses,
            lookups,
            media,
            media_steps,
            swarm_steps,
            edge_pixels,
        }
    }

    pub(super) fn edge_pixels(&self, samples: EdgeSamples) -> f64 {
        let drawn = self.edges.samples().read_rgba32f(0);
        let texels = drawn.as_chunks::<4>().0.iter().filter(|texel| texel[3] > 0.0).count() as f64;
        match &self.edges {
            Edges::Stencil(_) => texels,
            Edges::List(_) => texels / samples.count() as f64,
        }
    }
}
