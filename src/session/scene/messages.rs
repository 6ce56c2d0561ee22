//! What is said about scenes over the picture: mistakes, answers that fade, and what the user waits for.

use std::time::Instant;

use crate::clock;
use mariana_control::Slider;

/// See the module.
#[derive(Default)]
pub(crate) struct Messages {
    problem: Option<(String, String)>,
    notice: Option<(String, Instant)>,
    /// The hint about a scene that the user asked for, until it is there.
    hint: Option<String>,
    /// The latest technical remark, and the task that it is about.
    remark: Option<(String, Option<u64>)>,
}

/// What is shown over the picture.
pub(crate) struct SceneWords<'a> {
    /// What is wrong: a heading, and the messages.
    pub problem: Option<(&'a str, &'a str)>,
    /// A line that fades, and when it came up.
    pub notice: Option<(&'a str, Instant)>,
    /// A line that stays for as long as it is given.
    pub hint: Option<&'a str>,
    /// The parameters of the scene, which the user may move.
    pub sliders: &'a mut [Slider],
}

impl Messages {
    /// Shows what is wrong with the scene, or with something that the scenes follow, until the next scene is loaded.
    pub(crate) fn set_problem(&mut self, heading: String, text: String) {
        self.problem = Some((heading, text));
    }

    /// Nothing is wrong any more.
    pub(super) fn clear_problem(&mut self) {
        self.problem = None;
    }

    /// Shows a line for a moment.
    pub(super) fn answer(&mut self, text: String) {
        tracing::debug!("told: {text}");
        self.notice = Some((text, clock::now()));
    }

    /// Shows which scene the user waits for; none once that is over.
    pub(super) fn set_hint(&mut self, hint: Option<String>) {
        self.hint = hint;
    }

    /// Whether the user waits for a scene.
    pub(super) fn is_scene_awaited(&self) -> bool {
        self.hint.is_some()
    }

    /// Replaces the remark in the line of key I. The remark disappears when its `task` ends.
    pub(super) fn note_remark(&mut self, remark: String, task: Option<u64>) {
        self.remark = Some((remark, task));
    }

    /// The remark, if its task goes on.
    pub(super) fn remark(&self, goes_on: impl Fn(u64) -> bool) -> Option<&str> {
        let due = self.remark.as_ref().filter(|(_, task)| task.is_none_or(goes_on));
        due.map(|(text, _)| &**text)
    }

    /// All that shows over the picture, with the sliders of the scene.
    pub(super) fn with<'a>(&'a self, sliders: &'a mut [Slider]) -> SceneWords<'a> {
        SceneWords {
            problem: self.problem.as_ref().map(|(heading, text)| (&**heading, &**text)),
            notice: self.notice.as_ref().map(|(text, since)| (&**text, *since)),
            hint: self.hint.as_deref(),
            sliders,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_goes_with_its_task_and_a_problem_with_the_next_scene() {
        let mut messages = Messages::default();
        messages.note_remark("the driver is slow".to_owned(), Some(3));
        assert_eq!(messages.remark(|task| task == 3), Some("the driver is slow"));
        assert_eq!(messages.remark(|_| false), None);
        messages.note_remark("interpreted instead".to_owned(), None);
        assert_eq!(messages.remark(|_| false), Some("interpreted instead"));
        messages.set_problem("orb has mistakes".to_owned(), "line 3".to_owned());
        messages.answer("compiled".to_owned());
        let words = messages.with(&mut []);
        assert_eq!(words.problem, Some(("orb has mistakes", "line 3")));
        assert_eq!(words.notice.map(|(text, _)| text), Some("compiled"));
        messages.clear_problem();
        assert!(messages.with(&mut []).problem.is_none() && !messages.is_scene_awaited());
    }
}
