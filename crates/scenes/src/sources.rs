//! Sources of textures whose picture changes during the song: videos, cameras and the cover of the song. The name of a
//! texture decides which source it means.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use super::folder::{Folder, ends_with_one_of};
use mariana_field::lang::{MovingTexture, Scene, TextureRef};
use mariana_field::world::World;

/// Endings of the names of video files. Case does not matter.
pub const VIDEO_ENDINGS: [&str; 14] =
    ["mp4", "m4v", "mov", "webm", "mkv", "avi", "gif", "apng", "mpg", "mpeg", "ts", "ogv", "wmv", "flv"];

/// The source of a texture whose picture changes during the song.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum TextureSource {
    /// A video, in the time of the song.
    Video {
        /// The file.
        file: PathBuf,
        /// Changes when the file changes.
        version: u64,
    },
    /// A camera by its number, from 1.
    Camera(usize),
    /// A camera by the path of its device, such as `/dev/video2`.
    CameraDevice(PathBuf),
    /// The cover of the song.
    Cover,
}

impl TextureSource {
    /// The source of a texture; `None` for an image. A video without a file has an empty path.
    pub fn of(texture: &TextureRef) -> Option<Self> {
        let (file, version) =
            texture.moves.as_ref().map_or((PathBuf::new(), 0), |moves| (moves.file.clone(), moves.version));
        let name = texture.name.as_str();
        if is_video(name) {
            return Some(Self::Video { file, version });
        }
        match name.split_once(' ').unwrap_or((name, "")) {
            ("cover", "") => Some(Self::Cover),
            ("camera", "") => Some(Self::Camera(1)),
            ("camera", device) if is_camera_device(device) => Some(Self::CameraDevice(PathBuf::from(device))),
            ("camera", number) => number.parse().ok().filter(|number| *number > 0).map(Self::Camera),
            _ => None,
        }
    }

    /// The sources of a world's textures, with their numbers. Images are left out.
    pub fn of_world(world: &World) -> impl Iterator<Item = (usize, Self)> + '_ {
        let textures = world.scene.textures.iter().enumerate();
        textures.filter_map(|(number, texture)| Some((number, Self::of(texture)?)))
    }

    /// The name in messages: the name of a video's file without its folder.
    pub fn name(&self) -> String {
        match self {
            Self::Video { file, .. } => {
                file.file_name().unwrap_or_default().to_string_lossy().replace(char::is_control, " ")
            }
            Self::Camera(1) => "the camera".to_owned(),
            Self::Camera(number) => format!("camera {number}"),
            Self::CameraDevice(device) => format!("the camera {}", device.display()),
            Self::Cover => "the cover".to_owned(),
        }
    }

    pub(super) fn is_file(&self) -> bool {
        matches!(self, Self::Video { .. })
    }
}

/// True for paths that can only be video devices. Opening other devices may have effects.
fn is_camera_device(path: &str) -> bool {
    let number = path.strip_prefix("/dev/video");
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
        || path.starts_with("/dev/v4l/")
}

/// True if the name has the ending of a video.
pub(super) fn is_video(name: &str) -> bool {
    ends_with_one_of(name, &VIDEO_ENDINGS)
}

/// Notes the files of moving textures, which are in `folder`.
pub(super) fn find_videos(folder: Option<&Folder>, scene: &mut Scene) {
    for texture in &mut scene.textures {
        let Some(of) = TextureSource::of(texture) else { continue };
        let folder = folder.filter(|_| of.is_file());
        let file = folder.and_then(|folder| folder.file(&texture.name).ok());
        let version = file.as_ref().and_then(|file| std::fs::metadata(file).ok()).map_or(0, |metadata| {
            let mut hasher = DefaultHasher::new();
            (metadata.len(), metadata.modified().ok()).hash(&mut hasher);
            hasher.finish()
        });
        texture.moves = Some(MovingTexture { file: file.unwrap_or_default(), version });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(name: &str) -> Option<TextureSource> {
        TextureSource::of(&TextureRef { name: name.into(), span: Default::default(), moves: None })
    }

    #[test]
    fn names_decide_the_source() {
        let video = Some(TextureSource::Video { file: PathBuf::new(), version: 0 });
        for name in ["a.mp4", "sub/a.WebM", "a.b.gif", "camera.mov", ".mkv"] {
            assert_eq!(source(name), video, "{name}");
        }
        assert_eq!(source("cover"), Some(TextureSource::Cover));
        assert_eq!(source("camera"), Some(TextureSource::Camera(1)));
        assert_eq!(source("camera 2"), Some(TextureSource::Camera(2)));
        assert_eq!(source("camera /dev/video3"), Some(TextureSource::CameraDevice("/dev/video3".into())));
        for name in [
            "wood.png",
            "cover.png",
            "camera.jpg",
            "camera 0",
            "camera -1",
            "camera x",
            "camera /dev/sda",
            "camera /dev/video",
            "camera /etc/video1",
            "mp4",
            "cover 2",
        ] {
            assert_eq!(source(name), None, "{name}");
        }
    }
}
