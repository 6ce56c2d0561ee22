//! Technical messages during a show that the user has not touched. They appear in the log and in the line of key I. A
//! scene that cannot be drawn is replaced.

use super::{Cast, SceneStage, Task};
use crate::gpu::scene_program::Mode;
use crate::scenes::SceneSource;

/// See the module.
#[derive(Default)]
pub(super) struct Quiet {
    /// The latest remark, and its task.
    remark: Option<(String, Option<u64>)>,
    /// Scenes that this machine cannot draw.
    refused: Vec<SceneSource>,
}

impl Quiet {
    /// Replaces the remark in the line of key I. The remark disappears when its `task` ends.
    pub(super) fn note(&mut self, remark: String, task: Option<u64>) {
        self.remark = Some((remark, task));
    }

    /// Scenes that this machine cannot draw.
    pub(super) fn refused(&self) -> &[SceneSource] {
        &self.refused
    }
}

impl SceneStage {
    /// Handles a scene that cannot be drawn. If the director chose it, the show takes another one without a message.
    /// Otherwise the message appears over the picture.
    pub(super) fn refuse(&mut self, source: SceneSource, heading: String, text: String) {
        self.awaited = None;
        let is_edit = self.shown_source() == Some(&source);
        if is_edit || !self.is_own_choice() {
            self.problem = Some((heading, text));
            return;
        }
        if !self.quiet.refused.contains(&source) {
            self.quiet.refused.push(source);
        }
        self.avoid_refused();
    }

    /// True if the user requested the scene or mode that a task compiles for, or if the window is still empty.
    pub(super) fn user_waits_for(&self, task: u64) -> bool {
        let Some(task) = self.tasks.get(&task) else { return false };
        let coming = self.coming.as_ref().filter(|_| self.awaited.is_some());
        let waits = match task {
            Task::Views(_) => true,
            Task::Compiled { id, .. } => {
                self.asked_mode == Some(Mode::Compiled) || coming.is_some_and(|cast| cast.id == *id)
            }
            Task::Interpreter(_) | Task::Universal { .. } => {
                let lacks_interpreter = |cast: &Cast| cast.program(Mode::Interpreted).is_none();
                self.asked_mode == Some(Mode::Interpreted) || coming.is_some_and(lacks_interpreter)
            }
        };
        waits || self.on_stage.is_none()
    }

    /// Pending work and refused scenes, for the line of key I.
    pub(super) fn remarks(&self) -> Vec<String> {
        let is_another = |cast: &&Cast| self.shown_source() != Some(&cast.source);
        let coming = self.coming.as_ref().filter(is_another);
        let coming = coming.map(|cast| format!("{} is being prepared", cast.source.title()));
        let is_due = |task: &Option<u64>| task.is_none_or(|task| self.tasks.contains_key(&task));
        let remark =
            self.quiet.remark.as_ref().filter(|(_, task)| is_due(task)).map(|(text, _)| text.clone());
        let is_scene = |source: &&SceneSource| !matches!(source, SceneSource::Blend(_));
        let refused: Vec<_> = self.quiet.refused.iter().filter(is_scene).map(SceneSource::title).collect();
        let without =
            (!refused.is_empty()).then(|| format!("too much for this machine: {}", refused.join(", ")));
        coming.into_iter().chain(remark).chain(without).collect()
    }
}
