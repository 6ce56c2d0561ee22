//! The choices for the next video, and the queue of videos.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::config::Choice;
use crate::export::video::VideoPlace;
use crate::videos::{JobState, Order, Videos};

/// Further sizes that the panel offers, in pixels.
pub(super) const SIZES: [(u32, u32); 2] = [(1280, 720), (1920, 1080)];
/// The choices must stay the same for this time before the rendering time is measured.
pub(super) const SETTLED: Duration = Duration::from_millis(600);

/// The choices of the panel. Indices count the options of a row.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Form {
    pub(super) place: usize,
    /// `None` follows the window.
    pub(super) show: Option<ShowChoice>,
    pub(super) title_card: bool,
    pub(super) captions: bool,
    pub(super) draft: bool,
    /// True for the song's folder, false for the user's folder of videos.
    pub(super) beside: bool,
}

/// The scenes of a video, in the order of the options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShowChoice {
    Scene,
    Show,
    Performance,
}

impl ShowChoice {
    pub(super) const ALL: [Self; 3] = [Self::Scene, Self::Show, Self::Performance];
}

#[derive(Default)]
pub(super) struct VideoMaking {
    /// `None` if the thread could not start.
    pub(super) videos: Option<Videos>,
    pub(super) form: Form,
    /// Index and title of the track to which the marks belong.
    pub(super) track: (usize, String),
    /// The scenes among which the director chooses; empty for the shipped ones.
    pub(super) scenes: Vec<String>,
    /// The order to measure, and the time since which it has been the same.
    pub(super) settling: Option<(Wish, Instant)>,
    pub(super) is_measured: bool,
    pub(super) warned: Option<Instant>,
}

/// A video that can be ordered.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wish {
    pub(super) order: Order,
    /// Length in seconds.
    pub(super) seconds: f64,
    pub(super) file: PathBuf,
    pub(super) title: String,
}

impl VideoMaking {
    pub(super) fn start(videos: std::io::Result<Videos>) -> Self {
        let videos = videos.inspect_err(|error| tracing::warn!("no videos can be made: {error}"));
        // 1920x1080.
        let form = Form { place: VideoPlace::ALL.len() + 1, ..Form::default() };
        Self { videos: videos.ok(), form, ..Self::default() }
    }

    /// A note for the window's title.
    pub(super) fn title_note(&self) -> Option<String> {
        self.videos.as_ref()?.with_shown(crate::videos::Shown::title_note)
    }

    /// True if a video is being rendered, or paused.
    pub(super) fn is_rendering(&self) -> bool {
        let renders =
            |state: &JobState| matches!(state, JobState::Rendering { .. } | JobState::Paused { .. });
        self.videos
            .as_ref()
            .is_some_and(|videos| videos.with_shown(|shown| shown.jobs.iter().any(|job| renders(&job.state))))
    }

    /// Measures a wish once it has settled. `None` ends the measuring.
    pub(super) fn measure(&mut self, wish: Option<&Wish>, now: Instant) {
        let Some(videos) = &self.videos else { return };
        match wish {
            None => {
                if self.settling.take().is_some() {
                    videos.measure(None);
                }
            }
            Some(wish) if self.settling.as_ref().is_none_or(|(settling, _)| settling != wish) => {
                // The old estimate is wrong.
                videos.measure(None);
                (self.settling, self.is_measured) = (Some((wish.clone(), now)), false);
            }
            Some(wish) => {
                let is_settled = self.settling.as_ref().is_some_and(|(_, since)| now - *since >= SETTLED);
                if is_settled && !self.is_measured {
                    self.is_measured = true;
                    videos.measure(Some((&wish.order, wish.seconds, wish.file.clone())));
                }
            }
        }
    }
}
