//! Measures the cost of a scene, and how much the music changes the image.

use std::fmt;

use anyhow::Context as _;
use image::RgbaImage;
use mariana::frame::Frame;
use mariana::gpu::scene_program::{link_scene, variant_of};
use mariana::gpu::{Counting, Evaluations, Headless, Mode, Renderer, SceneResources, ShaderLibrary};
use mariana::scenes::{ReadyScene, SceneSource};
use mariana_music::Sound;

use super::MOMENTS;

const SIZE: (u32, u32) = (320, 180);
/// Image size for counting costs. In a smaller image, edges would contribute too much.
const COST_SIZE: (u32, u32) = (1280, 720);
/// Index of the loudest moment.
const LOUD: usize = 2;
/// Smallest difference of a channel (0..=255) that counts as visible.
const VISIBLE: u8 = 12;

pub struct Figures {
    /// Cost per pixel at the loudest moment.
    pub cost: Evaluations,
    /// Fraction of pixels that differ visibly between the loudest moment and silence.
    pub moved: f64,
    pub black: f64,
    pub white: f64,
}

impl Figures {
    /// Draws a scene with the interpreter and measures it.
    pub fn of(source: &SceneSource, sounds: &[Sound]) -> anyhow::Result<Self> {
        let ReadyScene { world, buffers, plan, .. } = source.ready()?;
        let context = Headless::new(false)?;
        let gl = context.gl();
        let library = ShaderLibrary::embedded();
        let mut renderer = Renderer::new(gl, &library, Counting::On)?;
        let variant = variant_of(&world, &buffers, &plan, Mode::Interpreted, gl.info(), Counting::On)?;
        let program = link_scene(gl, &library, &variant)?;
        let resources = SceneResources::upload(gl, world, buffers, plan)?;
        let mut draw =
            |moment: usize, sound: Sound, size: (u32, u32)| -> anyhow::Result<(RgbaImage, Evaluations)> {
                let frame = Frame::new(resources.world(), MOMENTS[moment], sound, size);
                renderer.draw(&frame, &resources, &program)?;
                let picture = RgbaImage::from_raw(size.0, size.1, renderer.read());
                let pixels = f64::from(size.0) * f64::from(size.1);
                Ok((picture.context("an image has four bytes per pixel")?, renderer.evaluations(pixels)))
            };
        let mut figures = Self { cost: Evaluations::default(), moved: 0.0, black: 0.0, white: 0.0 };
        for (moment, sound) in sounds.iter().enumerate() {
            let (picture, _) = draw(moment, sound.clone(), SIZE)?;
            figures.black =
                figures.black.max(fraction(&picture, |pixel| pixel.iter().all(|value| *value <= 1)));
            figures.white =
                figures.white.max(fraction(&picture, |pixel| pixel.iter().all(|value| *value >= 254)));
            if moment == LOUD {
                let (silent, _) = draw(moment, Sound::default(), SIZE)?;
                let mut before = silent.pixels();
                let moves = |now: &[u8]| {
                    let then = before.next().map_or([0; 4], |pixel| pixel.0);
                    now.iter().zip(then).any(|(a, b)| a.abs_diff(b) > VISIBLE)
                };
                figures.moved = fraction(&picture, moves);
                (_, figures.cost) = draw(moment, sound.clone(), COST_SIZE)?;
            }
        }
        Ok(figures)
    }
}

/// Formats the figures as the cells of a table row.
impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |fraction: f64| 100.0 * fraction;
        write!(
            f,
            "| {:.1} | {:.0} | {:.0} | {:.0} % | {:.1} % | {:.1} % |",
            self.cost.total(),
            self.cost.clauses,
            self.cost.surface_clauses,
            percent(self.moved),
            percent(self.black),
            percent(self.white)
        )
    }
}

/// Returns the fraction of pixels whose red, green and blue values meet a condition.
fn fraction(picture: &RgbaImage, mut is_like_that: impl FnMut(&[u8]) -> bool) -> f64 {
    let count = picture.pixels().filter(|pixel| is_like_that(&pixel.0[..3])).count();
    count as f64 / picture.pixels().len() as f64
}
