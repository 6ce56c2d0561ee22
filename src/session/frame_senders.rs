//! The picture of the window on its way to other programs: it is read back without waiting, and handed to the sends.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::clock;
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::renderer::Renderer;
use crate::placement::{Placement, fitted, within};
use crate::sending::{OutgoingFrame, SendError, SenderTarget, Sending};

/// How often it is looked whether a picture has arrived that is on its way.
const LOOK: Duration = Duration::from_millis(3);

/// Sends that have begun, before there is a picture.
pub(crate) struct Sends {
    sends: Vec<Sending>,
    size: (u32, u32),
    period: Duration,
}

impl Sends {
    /// Begins to send pictures of at most `size` pixels, `fps` times a second.
    ///
    /// # Errors
    /// A place that nothing can be sent to.
    pub(crate) fn start(targets: &[SenderTarget], size: (u32, u32), fps: f64) -> Result<Self, SendError> {
        // Four pixels share their colour.
        let size = (even(size.0), even(size.1));
        let sends =
            targets.iter().map(|target| Sending::start(target, size, fps)).collect::<Result<_, _>>()?;
        let period = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(33));
        Ok(Self { sends, size, period })
    }
}

/// See the module.
pub(crate) struct FrameSenders {
    sends: Vec<Sending>,
    /// Made with the first picture.
    reader: Option<PictureReader>,
    size: (u32, u32),
    period: Duration,
    /// When the next picture is to be read.
    due: Instant,
    /// Whether the picture that shows was not read yet.
    is_new: bool,
    /// Whether somebody took pictures when it was last looked.
    was_wanted: bool,
}

impl FrameSenders {
    /// Feeds these sends.
    pub(crate) fn of(sends: Sends) -> Self {
        let Sends { sends, size, period } = sends;
        Self { sends, reader: None, size, period, due: clock::now(), is_new: false, was_wanted: true }
    }

    /// Whether somebody may see the picture who does not see the window.
    pub(crate) fn are_any(&self) -> bool {
        !self.sends.is_empty()
    }

    /// Forgets what belongs to a context that is lost.
    pub(crate) fn let_go(&mut self) {
        (self.reader, self.is_new) = (None, true);
    }

    /// Notes that another picture shows than before.
    pub(crate) fn note_picture(&mut self) {
        self.is_new = !self.sends.is_empty();
    }

    /// Reads the picture that shows, if it is time for one, and hands on what has arrived. Returns when to look again.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(crate) fn go_on(
        &mut self,
        gl: &Gl,
        renderer: &mut Renderer,
        now: Instant,
    ) -> Result<Option<Instant>, GpuError> {
        if self.sends.is_empty() {
            return Ok(None);
        }
        let is_wanted = self.sends.iter().any(Sending::is_wanted);
        // Whoever comes gets the picture that shows, also where it has stood for long.
        self.is_new |= is_wanted && !self.was_wanted;
        self.was_wanted = is_wanted;
        if self.is_new && is_wanted && now >= self.due {
            let reader = match &mut self.reader {
                Some(reader) => reader,
                none => none.insert(PictureReader::new(gl, self.size)?),
            };
            // What is sent is the whole picture, however it lies in the window.
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
        if let Some(rgba) = reader.take() {
            let picture = OutgoingFrame { size: self.size, rgba: Arc::new(rgba) };
            self.sends.iter().for_each(|send| send.offer(picture.clone()));
        }
        let next = (self.is_new && is_wanted).then_some(self.due);
        Ok(if reader.is_waiting() { Some(now + LOOK) } else { next })
    }

    /// What there is to say of the receivers since the last call.
    pub(crate) fn news(&self) -> Vec<String> {
        self.sends.iter().flat_map(Sending::news).collect()
    }
}

fn even(side: u32) -> u32 {
    (side & !1).max(2)
}
