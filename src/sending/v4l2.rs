//! A camera for other programs, by v4l2loopback. An ioctl sets the device's format; each write passes a frame.

#![expect(unsafe_code, reason = "the device's format is set by an ioctl of the kernel")]

use std::fs::{File, OpenOptions};
use std::io::ErrorKind;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

use rustix::ioctl::{Updater, ioctl, opcode};

use super::SendError;
use super::latest_frame::OutgoingFrame;
use super::stream::{Receiver, Stream};
use crate::y4m::quarter_planes;

/// `struct v4l2_format` with a `struct v4l2_pix_format`, from linux/videodev2.h.
#[repr(C)]
#[derive(Clone, Copy)]
struct Format {
    kind: u32,
    /// Aligns the union that follows, which contains pointers in C.
    _align: [u64; 0],
    pixels: PixelFormat,
    rest: [u8; REST],
}

#[repr(C)]
#[derive(Clone, Copy)]
struct PixelFormat {
    width: u32,
    height: u32,
    pixel_format: u32,
    field: u32,
    bytes_per_line: u32,
    size_image: u32,
    colorspace: u32,
    magic: u32,
    flags: u32,
    encoding: u32,
    quantization: u32,
    transfer: u32,
}

/// The rest of the union, which has 200 bytes.
const REST: usize = 200 - size_of::<PixelFormat>();
/// `V4L2_BUF_TYPE_VIDEO_OUTPUT`.
const OUTPUT: u32 = 2;
/// `V4L2_PIX_FMT_YUV420`.
const YU12: u32 = u32::from_le_bytes(*b"YU12");
/// `V4L2_FIELD_NONE`.
const PROGRESSIVE: u32 = 1;
/// `V4L2_COLORSPACE_REC709`.
const REC_709: u32 = 3;
/// `V4L2_PIX_FMT_PRIV_MAGIC`: the fields after it are valid.
const MAGIC: u32 = 0xfeed_cafe;
/// `V4L2_QUANTIZATION_LIM_RANGE`.
const LIMITED: u32 = 2;

/// `VIDIOC_S_FMT`.
const SET_FORMAT: rustix::ioctl::Opcode = opcode::read_write::<Format>(b'V', 5);

fn format_of(size: (u32, u32)) -> Format {
    let (width, height) = size;
    let pixels = PixelFormat {
        width,
        height,
        pixel_format: YU12,
        field: PROGRESSIVE,
        bytes_per_line: width,
        size_image: width * height * 3 / 2,
        colorspace: REC_709,
        magic: MAGIC,
        flags: 0,
        encoding: 0,
        quantization: LIMITED,
        transfer: 0,
    };
    Format { kind: OUTPUT, _align: [], pixels, rest: [0; REST] }
}

/// Returns the device at `path` as a receiver of frames of `size` pixels.
///
/// # Errors
/// Fails if the device does not exist, cannot be written, or has another format.
pub(super) fn camera(path: &Path, size: (u32, u32)) -> Result<Receiver, SendError> {
    let refused = |reason: String| SendError::Refused { to: path.display().to_string(), reason };
    match std::fs::metadata(path) {
        Ok(found) if found.file_type().is_char_device() => {}
        Ok(_) => return Err(refused("it is no device: give a device of v4l2loopback".to_owned())),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let advice =
                "there is no such device: load v4l2loopback (modprobe v4l2loopback) and check the number";
            return Err(refused(advice.to_owned()));
        }
        Err(error) => return Err(refused(format!("{error}: check the path"))),
    }
    let opened = open_device(path, size)
        .map_err(|error| refused(format!("{error}: give a device of v4l2loopback that you can write to")))?;
    // The device, from the check at the start until a frame is sent.
    let (mut checked, path) = (Some(opened), path.to_owned());
    let open = move || -> std::io::Result<Stream> {
        Ok(Box::new(checked.take().map_or_else(|| open_device(&path, size), Ok)?))
    };
    let bytes = |picture: &OutgoingFrame| quarter_planes(&picture.rgba, picture.size);
    Ok(Receiver { open: Box::new(open), bytes, comes_again: true })
}

fn open_device(path: &Path, size: (u32, u32)) -> std::io::Result<File> {
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut format = format_of(size);
    // SAFETY: the opcode contains the size of `Format`, whose layout is the kernel's (see the test), and `format`
    // is valid for reads and writes during the call.
    unsafe { ioctl(&file, Updater::<SET_FORMAT, Format>::new(&mut format))? };
    let taken = format.pixels;
    if (taken.width, taken.height, taken.pixel_format) != (size.0, size.1, YU12) {
        let reason = format!("the device has another format ({}x{})", taken.width, taken.height);
        return Err(std::io::Error::other(reason));
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_has_the_kernel_s_layout() {
        // Values that a C compiler computes from linux/videodev2.h on 64-bit systems.
        assert_eq!((size_of::<Format>(), std::mem::offset_of!(Format, pixels)), (208, 8));
        assert_eq!(SET_FORMAT, 0xc0d0_5605);
        assert_eq!(std::mem::offset_of!(PixelFormat, colorspace), 24);
    }

    #[test]
    fn other_files_than_cameras_are_refused_with_advice() {
        for (path, part) in [
            ("/dev/video-that-is-not-there", "modprobe v4l2loopback"),
            ("/dev", "it is no device"),
            ("/dev/null", "give a device of v4l2loopback"),
        ] {
            let refused = camera(Path::new(path), (2, 2)).err().map(|error| error.to_string());
            assert!(refused.as_ref().is_some_and(|reported| reported.contains(part)), "{path}: {refused:?}");
        }
    }
}
