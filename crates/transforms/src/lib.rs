//! Fourier transforms and resamplers for single-precision samples.
//!
//! rustfft and rubato are generic: each crate that creates a transform compiles hundreds of functions for it, also if a
//! crate that it depends on has compiled them already. Functions that are not generic are compiled here, once.
//!
//! ```
//! use mariana_transforms::Complex32;
//!
//! let transform = mariana_transforms::forward(4);
//! let mut values = [1.0, 0.0, 0.0, 0.0].map(|value| Complex32::new(value, 0.0));
//! transform.process(&mut values);
//! assert_eq!(values, [Complex32::new(1.0, 0.0); 4]);
//! ```

use std::sync::Arc;

pub use rubato::audioadapter_buffers::direct::InterleavedSlice;
pub use rubato::{Indexing, Resampler, ResamplerConstructionError};
pub use rustfft::Fft;
pub use rustfft::num_complex::Complex32;

use rubato::{
    Async, FixedAsync, FixedSync, SincInterpolationParameters, SincInterpolationType, WindowFunction,
    calculate_cutoff,
};

/// The forward transform of `length` complex values, without scaling.
pub fn forward(length: usize) -> Arc<dyn Fft<f32>> {
    rustfft::FftPlanner::new().plan_fft_forward(length)
}

/// A resampler for `channels` channels from one rate to another, in hertz. It transforms blocks of `block` input frames
/// and has a delay of a whole number of frames at both rates if half a block is one.
///
/// # Errors
/// Fails if rubato refuses a rate or the length of a block.
pub fn fourier_resampler(
    from: u32,
    to: u32,
    block: usize,
    channels: usize,
) -> Result<Box<dyn Resampler<f32>>, ResamplerConstructionError> {
    let window = WindowFunction::BlackmanHarris2;
    let made =
        rubato::Fft::new_custom(from as usize, to as usize, block, 1, channels, window, FixedSync::Both)?;
    Ok(Box::new(made))
}

/// A resampler for `channels` channels that multiplies the rate by `ratio`, with a windowed sinc of `length` input
/// frames. It takes `block` input frames at a time.
///
/// # Errors
/// Fails if rubato refuses the ratio.
pub fn sinc_resampler(
    ratio: f64,
    length: usize,
    block: usize,
    channels: usize,
) -> Result<Box<dyn Resampler<f32>>, ResamplerConstructionError> {
    let window = WindowFunction::BlackmanHarris2;
    let parameters = SincInterpolationParameters {
        sinc_len: length,
        f_cutoff: Some(calculate_cutoff(length, window)),
        interpolation: SincInterpolationType::Cubic,
        oversampling_factor: 256,
        window,
    };
    let made = Async::<f32>::new_sinc(ratio, 1.0, &parameters, block, channels, FixedAsync::Input)?;
    Ok(Box::new(made))
}
