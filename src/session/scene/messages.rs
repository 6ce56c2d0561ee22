//! Messages about scenes, drawn over the frame: problems, notices that fade, and hints while the user waits.

use std::time::Instant;

use crate::clock;
use crate::ui::overlay::{Notice, OverlayContent, Problem};

#[derive(Default)]
pub(crate) struct Messages {
    pub(super) problem: Option<(String, String)>,
    notice: Option<(String, Instant)>,
    pub(super) hint: Option<String>,
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
    fn a_problem_ends_with_the_next_scene() {
        let mut messages = Messages::default();
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
