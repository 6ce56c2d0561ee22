//! What the user wants to see in a video, as arguments of `mariana video`.

use crate::config::{Choice, Choices};
use crate::export::video::{Preset, VideoPlace};

/// A video to render.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// The song's file; `None` for the demo track.
    pub song: Option<String>,
    /// The service or use.
    pub place: Option<VideoPlace>,
    /// Width and height in pixels; `None` for the size of the place.
    pub size: Option<(u32, u32)>,
    /// The start in the song's file, in seconds.
    pub start: f64,
    /// The length in seconds; `None` for the rest of the song.
    pub duration: Option<f64>,
    /// The scene or the show.
    pub show: OrderedShow,
    /// Held values of the scene's parameters.
    pub set: Vec<(String, f32)>,
    /// Shows title and artist during the first seconds.
    pub title_card: bool,
    /// Shows the lyrics.
    pub captions: bool,
    /// Draws faster, with coarser edges.
    pub draft: bool,
    /// The choices of the window, of which a video follows gain, tone map and flash limiter.
    pub choices: Choices,
}

/// The scenes of a video.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OrderedShow {
    /// One scene: a shipped name, a path or a formula.
    Scene(String),
    /// A show: `auto`, `demo` or a file; and the scenes among which the director chooses.
    Show(String, Vec<String>),
}

impl Order {
    /// The requirements of the place.
    pub fn preset(&self) -> Preset {
        Preset::of(self.place)
    }

    /// Returns the arguments of `mariana video`, without the output.
    pub fn arguments(&self) -> Vec<String> {
        let mut line = Vec::new();
        if let Some(place) = self.place {
            line.extend(["--for".to_owned(), place.name().to_owned()]);
        }
        if let Some((width, height)) = self.size {
            line.extend(["--size".to_owned(), format!("{width}x{height}")]);
        }
        self.add_rest(&mut line, self.start, self.duration);
        line
    }

    /// Returns the arguments for a few seconds from `start` on, with the size and rate of this video.
    pub(super) fn probe(&self, start: f64, seconds: f64) -> Vec<String> {
        let preset = self.preset();
        let (width, height) = self.size.unwrap_or(preset.size);
        let mut line = vec!["--size".to_owned(), format!("{width}x{height}")];
        // A loop's place would draw its seam too.
        line.extend(["--fps".to_owned(), preset.fps.to_string()]);
        self.add_rest(&mut line, start, Some(seconds));
        line
    }

    fn add_rest(&self, line: &mut Vec<String>, start: f64, duration: Option<f64>) {
        line.extend(["--start".to_owned(), start.to_string()]);
        if let Some(seconds) = duration {
            line.extend(["--duration".to_owned(), seconds.to_string()]);
        }
        // With `=`, a formula may begin with a minus.
        let scene = |name: &String| format!("--scene={name}");
        match &self.show {
            OrderedShow::Scene(name) => line.push(scene(name)),
            OrderedShow::Show(show, scenes) => {
                line.push(format!("--show={show}"));
                line.extend(scenes.iter().map(scene));
            }
        }
        line.extend(self.set.iter().map(|(name, value)| format!("--set={name}={value}")));
        for (is_on, flag) in
            [(self.title_card, "--title-card"), (self.captions, "--lyrics"), (self.draft, "--draft")]
        {
            line.extend(is_on.then(|| flag.to_owned()));
        }
        let Choices { flash_limiter, tone_map, gain, .. } = &self.choices;
        line.push(format!("--flash-limiter={}", flash_limiter.name()));
        line.push(format!("--tone-map={}", tone_map.name()));
        line.push(format!("--gain={}", gain.name()));
        line.extend(self.song.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_becomes_arguments_that_the_command_takes() {
        let order = Order {
            song: Some("/music/夜 song.flac".to_owned()),
            place: Some(VideoPlace::Reel),
            size: None,
            start: 62.5,
            duration: Some(20.0),
            show: OrderedShow::Scene("-x".to_owned()),
            set: vec![("size".to_owned(), 0.75)],
            title_card: true,
            captions: false,
            draft: true,
            choices: Choices::default(),
        };
        assert_eq!(
            order.arguments().join(" "),
            "--for reel --start 62.5 --duration 20 --scene=-x --set=size=0.75 --title-card --draft \
             --flash-limiter=on --tone-map=scene --gain=auto /music/夜 song.flac"
        );
        assert!(
            order
                .probe(70.0, 0.25)
                .join(" ")
                .starts_with("--size 1080x1920 --fps 30 --start 70 --duration 0.25 ")
        );
        let show = OrderedShow::Show("auto".to_owned(), vec!["orb".to_owned()]);
        let order = Order {
            song: None,
            duration: None,
            show,
            set: Vec::new(),
            title_card: false,
            draft: false,
            ..order
        };
        assert!(order.arguments().join(" ").contains(" --start 62.5 --show=auto --scene=orb --flash"));
    }
}
