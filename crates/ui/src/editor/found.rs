//! What the loader found: in the scene whose text shows, and in others that were shown before.

use std::path::{Path, PathBuf};

use mariana_scenes::{Findings, SceneSource};

/// See the module.
#[derive(Default)]
pub(super) struct Found {
    /// The scene whose text is shown.
    source: Option<SceneSource>,
    /// What was found last in it.
    findings: Option<Findings>,
    /// What was found in others.
    others: Vec<Findings>,
}

impl Found {
    /// The scene whose text is shown.
    pub(super) fn source(&self) -> Option<&SceneSource> {
        self.source.as_ref()
    }

    /// Goes on with another scene, and with what is known of it.
    pub(super) fn show_scene(&mut self, source: &SceneSource) {
        self.source = Some(source.clone());
        self.others.extend(self.findings.take());
        let known = self.others.iter().position(|found| found.source == *source);
        self.findings = known.map(|at| self.others.swap_remove(at));
    }

    /// Takes in what was found in a scene. Returns whether it is the one whose text is shown.
    pub(super) fn take(&mut self, findings: Findings) -> bool {
        let is_shown = Some(&findings.source) == self.source.as_ref();
        if is_shown {
            self.findings = Some(findings);
        } else {
            self.others.retain(|other| other.source != findings.source);
            self.others.push(findings);
        }
        is_shown
    }

    /// What was found last in the scene whose text is shown.
    pub(super) fn findings(&self) -> Option<&Findings> {
        self.findings.as_ref()
    }

    /// The file of a text of the scene, by its number.
    pub(super) fn file(&self, number: usize) -> Option<&Path> {
        self.findings.as_ref()?.texts.get(number).map(PathBuf::as_path)
    }

    /// The number of a file among the texts of the scene.
    pub(super) fn number_of(&self, file: &Path) -> Option<usize> {
        self.findings.as_ref()?.texts.iter().position(|one| one == file)
    }

    /// The text of the first mistake.
    pub(super) fn first_wrong_text(&self) -> Option<usize> {
        self.findings.as_ref()?.mistakes.first().map(|one| one.text)
    }
}
