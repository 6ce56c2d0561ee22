//! The loader's findings about the edited scene and about scenes edited before.

use std::path::{Path, PathBuf};

use mariana_scenes::{Findings, SceneSource};

/// The latest findings of each scene.
#[derive(Default)]
pub(super) struct Found {
    /// The edited scene.
    source: Option<SceneSource>,
    /// Its latest findings.
    findings: Option<Findings>,
    /// Findings of other scenes.
    others: Vec<Findings>,
}

impl Found {
    /// The edited scene.
    pub(super) fn source(&self) -> Option<&SceneSource> {
        self.source.as_ref()
    }

    /// Switches to another scene and its known findings.
    pub(super) fn show_scene(&mut self, source: &SceneSource) {
        self.source = Some(source.clone());
        self.others.extend(self.findings.take());
        let known = self.others.iter().position(|found| found.source == *source);
        self.findings = known.map(|at| self.others.swap_remove(at));
    }

    /// Takes over new findings. Returns true if they are about the edited scene.
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

    /// The latest findings of the edited scene.
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

    /// The text with the first mistake.
    pub(super) fn first_wrong_text(&self) -> Option<usize> {
        self.findings.as_ref()?.mistakes.first().map(|one| one.text)
    }
}
