//! Pictures of scenes with the demo track: still ones, and animated ones as WebP files, which need ffmpeg.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, ensure};
use image::RgbaImage;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::paths::PathWatch;
use mariana::export::still::{StillRequest, write_still};
use mariana::export::video::{EncodingQuality, VideoRequest, write_video};
use mariana::export::{Output, Showing, Shutter};
use mariana::scenes::SceneSource;
use mariana_music::Gain;

/// Draws a scene at `at` seconds of the demo track, in the same way as `mariana still`.
pub(crate) fn still(scene: SceneSource, at: f64, size: (u32, u32)) -> anyhow::Result<RgbaImage> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("still.png");
    let output = Output::Path(path.clone());
    let request = StillRequest::of(DEMO_TRACK, at, size, scene.into(), output);
    write_still(&request, PathWatch::default())?;
    Ok(image::open(&path)?.into_rgba8())
}

/// The size and length of an animation.
pub(crate) struct Animation {
    /// The first moment of the demo track, in seconds.
    pub start: f64,
    /// The number of frames.
    pub frames: u32,
    /// Frames per second.
    pub rate: u32,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Quality of the encoding, 0..=100.
    pub quality: u8,
}

impl Animation {
    /// Draws the frames of a shipped scene and writes them to `file`.
    pub(crate) fn draw(&self, name: &str, file: &Path) -> anyhow::Result<()> {
        let folder = tempfile::tempdir()?;
        let source = SceneSource::Shipped(name.to_owned());
        let request = VideoRequest {
            song: DEMO_TRACK,
            start: self.start,
            duration: Some(f64::from(self.frames) / f64::from(self.rate)),
            fps: self.rate.into(),
            size: self.size,
            gain: Gain::Auto,
            limit_flashes: false,
            output: Output::Path(folder.path().join("frames/")),
            keeps_others: false,
            showing: Showing::Scenes(vec![(0.0, source.clone())]),
            scene: source.into(),
            set: Vec::new(),
            codec: None,
            quality: EncodingQuality::default(),
            sound: false,
            sound_rate: None,
            title_card: false,
            lyrics: None,
            seam: None,
            shutter: Shutter::MOMENT,
            part: None,
        };
        write_video(&request, &mut |_, _| {})?;
        let frames = folder.path().join("frames/*.png");
        let mut encode = Command::new("ffmpeg");
        encode
            .args(["-v", "error", "-y", "-framerate", &self.rate.to_string(), "-pattern_type", "glob", "-i"])
            .arg(frames);
        let quality = self.quality.to_string();
        encode.args(["-c:v", "libwebp_anim", "-q:v", &quality, "-compression_level", "6", "-loop", "0"]);
        let status = encode.arg(file).status().context("starting ffmpeg")?;
        ensure!(status.success(), "ffmpeg failed: {status}");
        Ok(())
    }
}
