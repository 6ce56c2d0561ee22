//! Reads pictures back without waiting for the GPU: each is copied into a buffer of the driver, and taken from there when
//! the GPU has come so far.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::collections::VecDeque;

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Buffer;
use super::target::{Target, Texel};

/// Most pictures that are on their way.
const ON_THEIR_WAY_MAX: usize = 3;

/// Pictures of one size on their way from the GPU.
pub struct PictureReader {
    gl: Gl,
    target: Target,
    free: Vec<Buffer>,
    on_their_way: VecDeque<(Buffer, glow::NativeFence)>,
}

impl PictureReader {
    /// For pictures of `size` pixels.
    ///
    /// # Errors
    /// No room for them.
    pub fn new(gl: &Gl, size: (u32, u32)) -> Result<Self, GpuError> {
        let target = Target::new(gl, size, &[Texel::Rgba8], None)?;
        let bytes = i32::try_from(size.0 as usize * size.1 as usize * 4).unwrap_or(i32::MAX);
        let mut free = Vec::new();
        for _ in 0..ON_THEIR_WAY_MAX {
            let buffer = Buffer::new(gl)?;
            // SAFETY: the buffer is ours.
            unsafe {
                gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(buffer.native()));
                gl.buffer_data_size(glow::PIXEL_PACK_BUFFER, bytes, glow::STREAM_READ);
                gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
            }
            free.push(buffer);
        }
        gl.check("making room for pictures to be sent")?;
        Ok(Self { gl: gl.clone(), target, free, on_their_way: VecDeque::new() })
    }

    /// Where a picture is drawn that is to be read.
    pub(super) fn target(&self) -> &Target {
        &self.target
    }

    /// Width and height of the pictures, in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.target.size()
    }

    /// Sends what was drawn on its way. False if too many are on theirs: then it is left out.
    pub(super) fn begin(&mut self) -> bool {
        let Some(buffer) = self.free.pop() else { return false };
        self.target.read_into(&buffer);
        // SAFETY: plain calls; a fence belongs to this context.
        match unsafe { self.gl.fence_sync(glow::SYNC_GPU_COMMANDS_COMPLETE, 0) } {
            Ok(fence) => {
                // So that the GPU comes there without anybody asking again.
                // SAFETY: as above.
                unsafe { self.gl.flush() }
                self.on_their_way.push_back((buffer, fence));
                true
            }
            Err(error) => {
                tracing::warn!("no picture can be read: {error}");
                self.free.push(buffer);
                false
            }
        }
    }

    /// Whether a picture is on its way.
    pub fn is_waiting(&self) -> bool {
        !self.on_their_way.is_empty()
    }

    /// The newest picture that has arrived since the last call: four bytes for each pixel, in the order of the rows in
    /// which it was drawn, the lowest first.
    pub fn take(&mut self) -> Option<Vec<u8>> {
        let mut newest = None;
        while let Some((buffer, fence)) = self.on_their_way.pop_front() {
            // SAFETY: the fence is ours; asked with no time, the driver answers at once.
            let state = unsafe { self.gl.client_wait_sync(fence, 0, 0) };
            if state == glow::TIMEOUT_EXPIRED {
                self.on_their_way.push_front((buffer, fence));
                break;
            }
            // SAFETY: as above.
            unsafe { self.gl.delete_sync(fence) }
            if let Some(before) = newest.replace(buffer) {
                self.free.push(before);
            }
        }
        let buffer = newest?;
        let mut bytes = vec![0; self.size().0 as usize * self.size().1 as usize * 4];
        // SAFETY: the buffer is ours and has as many bytes; what was copied into it is complete.
        unsafe {
            self.gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(buffer.native()));
            self.gl.get_buffer_sub_data(glow::PIXEL_PACK_BUFFER, 0, &mut bytes);
            self.gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
        }
        self.free.push(buffer);
        Some(bytes)
    }
}

impl Drop for PictureReader {
    fn drop(&mut self) {
        for (_, fence) in self.on_their_way.drain(..) {
            // SAFETY: the fence is ours.
            unsafe { self.gl.delete_sync(fence) }
        }
    }
}
