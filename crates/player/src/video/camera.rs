//! Frames of a camera (Video4Linux).

use std::fs;
use std::path::{Path, PathBuf};

use super::VideoFrame;
use super::error::VideoError;
use super::frames::Frames;
use crate::ffmpeg::{CommandLine, Demuxer, ReadBy, Source};

/// The folder in which Linux lists its video devices.
const DEVICES: &str = "/sys/class/video4linux";

/// An open camera.
pub struct Camera {
    name: String,
    device: PathBuf,
    frames: Frames,
}

impl Camera {
    /// Opens a camera by its number, from 1.
    ///
    /// # Errors
    /// Fails if there is no such camera, or ffmpeg is missing.
    pub fn numbered(number: usize) -> Result<Self, VideoError> {
        let device = number.checked_sub(1).and_then(|at| cameras(Path::new(DEVICES)).into_iter().nth(at));
        let device = device
            .ok_or_else(|| VideoError(format!("there is no camera {number}: check that it is plugged in")))?;
        Self::open(&device, &if number == 1 { "the camera".to_owned() } else { format!("camera {number}") })
    }

    /// Opens a camera by the path of its device. `name` is the name in messages.
    ///
    /// # Errors
    /// Fails if ffmpeg is missing.
    pub fn open(device: &Path, name: &str) -> Result<Self, VideoError> {
        let options = ["-fflags", "nobuffer", "-thread_queue_size", "2"];
        let line =
            CommandLine::ffmpeg().input(Source::Camera(device), ReadBy::Demuxer(Demuxer::V4L2), options);
        let frames = Frames::start(line, "").map_err(|failure| VideoError::of(name, failure))?;
        Ok(Self { name: name.to_owned(), device: device.to_owned(), frames })
    }

    /// The name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Waits for the next frame.
    ///
    /// # Errors
    /// Fails if the camera gives no more frames: it is missing, pulled out, or in use.
    pub fn next_frame(&mut self) -> Result<VideoFrame, VideoError> {
        let frame = self.frames.next().map_err(|failure| VideoError::of(&self.name, failure))?;
        frame.ok_or_else(|| {
            let (name, what) = (&self.name, self.frames.process.complaint(&self.device.to_string_lossy()));
            let remedy = "check its cable, and that no other program uses it";
            VideoError(format!("{name} gives no picture ({what}): {remedy}"))
        })
    }
}

/// The devices of all cameras, in the order of their numbers. A camera may have several devices, of which the first
/// one gives pictures.
fn cameras(devices: &Path) -> Vec<PathBuf> {
    let names = fs::read_dir(devices).into_iter().flatten().flatten();
    let mut found: Vec<u32> = names
        .filter_map(|entry| {
            let number = entry.file_name().to_str()?.strip_prefix("video")?.parse().ok()?;
            let index = fs::read_to_string(entry.path().join("index")).ok()?;
            (index.trim() == "0").then_some(number)
        })
        .collect();
    found.sort_unstable();
    found.into_iter().map(|number| PathBuf::from(format!("/dev/video{number}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_counted_by_their_first_devices() {
        let folder = tempfile::tempdir().unwrap();
        for (name, index) in [("video10", "0"), ("video2", "0\n"), ("video3", "1"), ("v4l-subdev0", "0")] {
            fs::create_dir(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("index"), index).unwrap();
        }
        fs::create_dir(folder.path().join("video4")).unwrap();
        assert_eq!(cameras(folder.path()), ["/dev/video2", "/dev/video10"].map(PathBuf::from));
        assert!(cameras(Path::new("/nowhere")).is_empty());
        let refused = Camera::numbered(0).err().map(|error| error.to_string());
        assert!(refused.is_some_and(|error| error.starts_with("there is no camera 0")));
    }
}
