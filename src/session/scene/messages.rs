//! Messages about scenes, drawn over the frame: problems, notices that fade, and hints while the user waits.

use std::time::Instant;

use crate::clock;
use crate::ui::overlay::{Notice, OverlayContent, Problem};

#[derive(Default)]
pub(crate) struct Messages {
    pub(super) problem: Option<(String, String)>,
    notice: Option<(String, Instant)>,
    pub(super) hint: Option<String>,
    /// The latest technical remark, and the task it is about.
    remark: Option<(String, Option<u64>)>,
}

impl Messages {
    /// Shows a problem of the scene, or of a show or controller, until the next scene is loaded.
    pub(crate) fn set_problem(&mut self, heading: String, text: String) {
        tracing::debug!("problem: {heading}");
        self.problem = Some((heading, text));
    }

    pub(super) fn answer(&mut self, text: impl Into<String>) {
        let text = text.into();
        tracing::debug!("message: {text}");
        self.notice = Some((text, clock::now()));
    }

    /// Replaces the remark in the status line (key I). The remark disappears when its `task` ends.
    pub(super) fn set_remark(&mut self, remark: String, task: Option<u64>) {
        self.remark = Some((remark, task));
    }

    pub(super) fn remark(&self, goes_on: impl Fn(u64) -> bool) -> Option<&str> {
        let due = self.remark.as_ref().filter(|(_, task)| task.is_none_or(goes_on));
        due.map(|(text, _)| &**text)
    }

    pub(super) fn content(&self) -> OverlayContent<'_> {
        let notice = self.notice.as_ref();
        OverlayContent {
            problem: self.problem.as_ref().map(|(heading, text)| Problem { heading, text }),
            notice: notice.map(|(text, since)| Notice { text, fraction: None, since: *since }),
            hint: self.hint.as_deref(),
            ..OverlayContent::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_ends_with_its_task_and_a_problem_with_the_next_scene() {
        let mut messages = Messages::default();
        messages.set_remark("the driver is slow".to_owned(), Some(3));
        assert_eq!(messages.remark(|task| task == 3), Some("the driver is slow"));
        assert_eq!(messages.remark(|_| false), None);
        messages.set_remark("interpreted instead".to_owned(), None);
        assert_eq!(messages.remark(|_| false), Some("interpreted instead"));
        messages.set_problem("orb has mistakes".to_owned(), "line 3".to_owned());
        messages.answer("compiled");
        let content = messages.content();
        let problem = content.problem.map(|problem| (problem.heading, problem.text));
        assert_eq!(problem, Some(("orb has mistakes", "line 3")));
        assert_eq!(content.notice.map(|notice| notice.text), Some("compiled"));
        messages.problem = None;
        assert!(messages.content().problem.is_none() && messages.hint.is_none());
    }
}
