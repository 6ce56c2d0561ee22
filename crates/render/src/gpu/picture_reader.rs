//! Reads images back without waiting for the GPU. The GPU copies an image to a buffer, which is read after the copy.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::collections::VecDeque;

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::object::Buffer;
use super::target::{Target, Texel};

const ON_THEIR_WAY_MAX: usize = 3;

/// A queue of images of one size that are being read back.
pub struct PictureReader {
    gl: Gl,
    pub(super) target: Target,
    free: Vec<Buffer>,
    on_their_way: VecDeque<(Buffer, glow::Fence)>,
}

impl PictureReader {
    /// Creates a reader for images of `size` pixels.
    ///
    /// # Errors
    /// Fails if the driver has no memory for the buffers.
    pub fn new(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        let target = Target::new(gl, size, &[Texel::Rgba8], None)?;
        let bytes = i32::try_from(size.0 as usize * size.1 as usize * 4).unwrap_or(i32::MAX);
        let mut free = Vec::new();
        for _ in 0..ON_THEIR_WAY_MAX {
            let buffer = Buffer::new(gl)?;
            // SAFETY: the buffer was just created in the current context; this only allocates its storage.
            unsafe {
                gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(buffer.native()));
                gl.buffer_data_size(glow::PIXEL_PACK_BUFFER, bytes, glow::STREAM_READ);
                gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
            }
            free.push(buffer);
        }
        gl.check("allocating buffers for images to be sent")?;
        Ok(Self { gl: gl.clone(), target, free, on_their_way: VecDeque::new() })
    }

    /// Width and height of the images, in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.target.size()
    }

    /// Starts reading the target. Returns `false` and skips the image if too many are pending.
    pub(super) fn begin(&mut self) -> bool {
        let Some(buffer) = self.free.pop() else { return false };
        self.target.read_into(&buffer);
        // SAFETY: creates a fence in the current context; `self` owns it.
        match unsafe { self.gl.fence_sync(glow::SYNC_GPU_COMMANDS_COMPLETE, 0) } {
            Ok(fence) => {
                // Flush, so that the GPU reaches the fence without another call.
                // SAFETY: flushes the current context.
                unsafe { self.gl.flush() }
                self.on_their_way.push_back((buffer, fence));
                true
            }
            Err(error) => {
                tracing::warn!("cannot read an image back: {error}");
                self.free.push(buffer);
                false
            }
        }
    }

    /// True if an image is pending.
    pub fn is_waiting(&self) -> bool {
        !self.on_their_way.is_empty()
    }

    /// The latest image that has arrived since the last call: four bytes per pixel, lowest row first.
    pub fn drain(&mut self) -> Option<Vec<u8>> {
        let mut newest = None;
        while let Some((buffer, fence)) = self.on_their_way.pop_front() {
            // SAFETY: `self` owns the fence. With a timeout of zero the call does not block.
            let state = unsafe { self.gl.client_wait_sync(fence, 0, 0) };
            if state == glow::TIMEOUT_EXPIRED {
                self.on_their_way.push_front((buffer, fence));
                break;
            }
            // SAFETY: `self` owns the fence, which has left the queue.
            unsafe { self.gl.delete_sync(fence) }
            if let Some(before) = newest.replace(buffer) {
                self.free.push(before);
            }
        }
        let buffer = newest?;
        let length = self.size().0 as usize * self.size().1 as usize * 4;
        let mapped_length = i32::try_from(length).unwrap_or(i32::MAX);
        // SAFETY: `self` owns the buffer, which has `length` bytes; the fence shows that the copy is complete. A pointer
        // that is not null points to these bytes until the buffer is unmapped.
        let bytes = unsafe {
            let target = glow::PIXEL_PACK_BUFFER;
            self.gl.bind_buffer(target, Some(buffer.native()));
            let mapped = self.gl.map_buffer_range(target, 0, mapped_length, glow::MAP_READ_BIT);
            let bytes = (!mapped.is_null()).then(|| std::slice::from_raw_parts(mapped, length).to_vec());
            if bytes.is_some() {
                self.gl.unmap_buffer(target);
            }
            self.gl.bind_buffer(target, None);
            bytes
        };
        self.free.push(buffer);
        bytes
    }
}

impl Drop for PictureReader {
    fn drop(&mut self) {
        for (_, fence) in self.on_their_way.drain(..) {
            // SAFETY: `self` owns the fence, which has left the queue.
            unsafe { self.gl.delete_sync(fence) }
        }
    }
}
