//! The main loop of a session.

use std::time::{Duration, Instant};

use super::opening::renewed;
use super::screen::Event;
use super::waker::Waker;
use super::{Session, SessionError};
use crate::clock;
use crate::commands::{Command, Sender, ShowState};
use crate::config::PlaySettings;
use crate::export::painter::SceneChoice;
use crate::gpu::error::GpuError;
use crate::ui::overlay::PanelSwitches;

/// If a replaced context is lost within this time, it is not replaced again.
const RENEWED_AGAIN: Duration = Duration::from_secs(5);

/// A running session.
pub struct Run {
    pub(super) settings: PlaySettings,
    pub(super) scene: SceneChoice,
    pub(super) waker: Waker,
    /// The time of the program's start.
    pub(super) started: Instant,
    /// True once the session has ended.
    pub over: bool,
    pub(super) renewed_at: Option<Instant>,
    pub(super) session: Session,
}

impl Run {
    /// Runs until the session ends. Replaces a lost OpenGL context. Calls `on_saved` when everything for the next run is
    /// saved, before a driver that is still compiling delays the return.
    pub(crate) fn run(mut self, on_saved: impl FnOnce()) -> Result<(), SessionError> {
        let ended = loop {
            match self.step() {
                Ok(()) if self.over => break Ok(()),
                Ok(()) => {}
                Err(error) if self.can_go_on_after(&error) => self = self.renewed()?,
                Err(error) => break Err(error),
            }
        };
        tracing::info!("frames: {}", &self.session.playback.pace.times);
        tracing::info!("{}", &self.session.interface.typing_times);
        tracing::info!("from message to frame: {}", &self.session.playback.controllers.times);
        // After an error nothing is saved, and the window's thread waits for the error.
        if ended.is_ok() {
            self.finish();
            on_saved();
        }
        ended
    }

    /// Returns `true` if `error` is a lost context and the last replacement is longer ago than five seconds.
    pub fn can_go_on_after(&self, error: &SessionError) -> bool {
        let Some(doing) = doing_at_loss(error) else { return false };
        let is_first = self.renewed_at.is_none_or(|at| clock::since(at) > RENEWED_AGAIN);
        if is_first {
            tracing::warn!("the driver has lost its context while {doing}");
        }
        is_first
    }

    /// Replaces a lost OpenGL context.
    ///
    /// # Errors
    /// Fails if the driver provides no new context.
    pub fn renewed(self) -> Result<Self, SessionError> {
        let session = renewed(self.session, &self.settings, &self.scene, &self.waker)?;
        Ok(Self { renewed_at: Some(clock::now()), session, ..self })
    }

    /// Ends the session as a user would, and saves its state.
    pub fn finish(&mut self) {
        self.session.leave_to_the_next(&self.settings);
    }

    /// Handles finished work, waits for the next event or due time, and draws if needed.
    ///
    /// # Errors
    /// Fails if an error ends the session.
    pub fn step(&mut self) -> Result<(), SessionError> {
        let until = self.update_session()?;
        if self.over {
            return Ok(());
        }
        let mut redraws = false;
        for event in self.session.screen.wait(until) {
            match event {
                Event::Input(input) => {
                    if let Some(command) = self.session.handle_input(&input) {
                        self.carry_out(command, Sender::Window);
                    }
                }
                Event::Assistance(assistance) => {
                    // Carry out the request before the next frame is drawn.
                    self.session.interface.overlay.assist(assistance);
                    self.session.screen.request_redraw();
                }
                Event::Redraw => redraws = true,
                Event::End => {
                    self.over = true;
                    return Ok(());
                }
            }
        }
        self.session.follow_editor();
        self.session.video_desk().allow_quitting();
        if redraws || self.session.playback.scene.composer.is_drawing() {
            self.draw()?;
        }
        Ok(())
    }

    fn update_session(&mut self) -> Result<Instant, SessionError> {
        while let Some(command) = self.session.playback.reports.desktop.poll() {
            self.carry_out(command, Sender::Desktop);
        }
        self.obey_controllers();
        self.over |= self.session.update_status(&self.settings)?;
        self.session.remember_show(&self.settings, clock::now());
        let until = self.session.update()?;
        Ok(self.session.playback.controllers.due().map_or(until, |due| until.min(due)))
    }

    fn draw(&mut self) -> Result<(), SessionError> {
        if self.session.draw()? {
            tracing::info!("first picture after {:.0} ms", clock::since(self.started).as_secs_f64() * 1000.0);
        }
        for command in self.session.handle_acts() {
            self.carry_out(command, Sender::Window);
        }
        Ok(())
    }

    /// Carries out a command at once.
    pub fn carry_out(&mut self, command: Command, sender: Sender) {
        if command == Command::Quit
            && sender == Sender::Window
            && self.session.video_desk().holds_back_quitting()
        {
            return;
        }
        self.over |= command == Command::Quit;
        self.session.carry_out(command, sender);
    }

    /// The state of everything that a named command can change.
    pub fn state(&mut self) -> ShowState {
        self.session.state()
    }

    /// The panels that the user has opened.
    pub fn panels(&self) -> PanelSwitches {
        self.session.interface.ui_state.panels
    }

    /// Returns `true` once an idle show is drawn in its best quality. A frozen frame is always at rest.
    pub fn is_at_rest(&self) -> bool {
        self.session.is_at_rest(clock::now())
    }

    fn obey_controllers(&mut self) {
        let (actions, since) = self.session.apply_input();
        let before = self.session.playback.scene.revision();
        for action in actions {
            match Command::of_controller(&action) {
                Some(command) => self.carry_out(command, Sender::Controller),
                None => self.session.playback.reports.hurry(),
            }
        }
        self.session.record_actions(since, before);
    }
}

/// The operation during which the driver lost the context; `None` for other errors.
fn doing_at_loss(error: &SessionError) -> Option<&'static str> {
    match error {
        SessionError::Gpu(GpuError::ContextLost(doing)) => Some(doing),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_context_is_recognized() {
        assert_eq!(doing_at_loss(&SessionError::Gpu(GpuError::ContextLost("drawing"))), Some("drawing"));
        assert_eq!(doing_at_loss(&SessionError::NoMonitor), None);
    }
}
