//! Sends the window's frames to other programs. Frames are read back without waiting.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::clock;
use crate::config::PlaySettings;
use crate::gpu::{Gl, GpuError, PictureReader, Renderer};
use crate::placement::{Placement, fitted, within};
use crate::sending::{OutgoingFrame, SendError, Sending};

const LOOK: Duration = Duration::from_millis(3);

pub(crate) struct FrameSenders {
    sends: Vec<Sending>,
    reader: Option<PictureReader>,
    size: (u32, u32),
    period: Duration,
    due: Instant,
    /// True if the shown frame has not been read back.
    is_new: bool,
    was_wanted: bool,
}

impl FrameSenders {
    /// Starts the senders that the settings name.
    ///
    /// # Errors
    /// Fails if a target cannot be reached.
    pub(crate) fn start(settings: &PlaySettings) -> Result<Vec<Sending>, SendError> {
        let start = |target| Sending::start(target, size_of(settings), settings.send_fps);
        settings.sends.iter().map(start).collect()
    }

    /// Sends frames by senders that were started with the same settings.
    pub(crate) fn of(sends: Vec<Sending>, settings: &PlaySettings) -> Self {
        let period = Duration::try_from_secs_f64(1.0 / settings.send_fps);
        Self {
            sends,
            reader: None,
            size: size_of(settings),
            period: period.unwrap_or(Duration::from_millis(33)),
            due: clock::now(),
            is_new: false,
            was_wanted: true,
        }
    }

    /// True if frames are sent. Then even a hidden window is drawn.
    pub(crate) fn are_any(&self) -> bool {
        !self.sends.is_empty()
    }

    /// Drops everything that belongs to a lost context.
    pub(crate) fn let_go(&mut self) {
        (self.reader, self.is_new) = (None, true);
    }

    pub(crate) fn record_picture(&mut self) {
        self.is_new = !self.sends.is_empty();
    }

    /// Starts to read back the shown frame if one is due. Sends frames that have been read. Returns when to call this
    /// again.
    pub(crate) fn send_due(
        &mut self,
        gl: &Gl,
        renderer: &mut Renderer,
        now: Instant,
    ) -> Result<Option<Instant>, GpuError> {
        if self.sends.is_empty() {
            return Ok(None);
        }
        let is_wanted = self.sends.iter().any(|send| send.latest_frame.is_wanted());
        // Send the current frame to a new receiver, even if the frame has not changed for a long time.
        self.is_new |= is_wanted && !self.was_wanted;
        self.was_wanted = is_wanted;
        if self.is_new && is_wanted && now >= self.due {
            let reader = match &mut self.reader {
                Some(reader) => reader,
                none => none.insert(PictureReader::new(gl, self.size)?),
            };
            // Send the whole frame, regardless of its placement in the window.
            let whole = Placement::default();
            let area = renderer.shape().map_or([0.0, 0.0, 1.0, 1.0], |shape| fitted(shape, self.size));
            if renderer.send_placed(reader, &within(area, &whole.map()), whole.part())? {
                self.is_new = false;
                self.due = (self.due + self.period).max(now);
            }
        }
        let Some(reader) = &mut self.reader else {
            return Ok((self.is_new && is_wanted).then_some(self.due));
        };
        if let Some(rgba) = reader.drain() {
            let picture = OutgoingFrame { size: self.size, rgba: Arc::new(rgba) };
            self.sends.iter().for_each(|send| send.latest_frame.put(picture.clone()));
        }
        let next = (self.is_new && is_wanted).then_some(self.due);
        Ok(if reader.is_waiting() { Some(now + LOOK) } else { next })
    }

    pub(crate) fn news(&self) -> Vec<String> {
        self.sends.iter().flat_map(|send| send.latest_frame.news()).collect()
    }
}

fn size_of(settings: &PlaySettings) -> (u32, u32) {
    even(settings.send_size.unwrap_or(settings.size))
}

/// A size with even sides: in videos, groups of four pixels share their colour.
pub(super) fn even(size: (u32, u32)) -> (u32, u32) {
    ((size.0 & !1).max(2), (size.1 & !1).max(2))
}
