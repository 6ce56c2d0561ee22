//! The loader's findings about the edited scene and about previously edited scenes.

use std::path::{Path, PathBuf};

use mariana_scenes::{Findings, SceneSource};

#[derive(Default)]
pub(super) struct Found {
    pub(super) source: Option<SceneSource>,
    pub(crate) findings: Option<Findings>,
    others: Vec<Findings>,
}

impl Found {
    pub(super) fn show_scene(&mut self, source: &SceneSource) {
        self.source = Some(source.clone());
        self.others.extend(self.findings.take());
        let known = self.others.iter().position(|found| found.source == *source);
        self.findings = known.map(|at| self.others.swap_remove(at));
    }

    /// Stores new findings. Returns true if the findings are about the edited scene.
    pub(super) fn store(&mut self, findings: Findings) -> bool {
        let is_shown = Some(&findings.source) == self.source.as_ref();
        if is_shown {
            self.findings = Some(findings);
        } else {
            self.others.retain(|other| other.source != findings.source);
            self.others.push(findings);
        }
        is_shown
    }

    pub(super) fn file(&self, number: usize) -> Option<&Path> {
        self.findings.as_ref()?.texts.get(number).map(PathBuf::as_path)
    }

    /// The text with this number, which is a file of the scene.
    pub(super) fn text(&self, number: usize) -> Option<SceneSource> {
        self.file(number).map(|file| SceneSource::File(file.to_owned()))
    }

    pub(super) fn number_of(&self, file: &Path) -> Option<usize> {
        self.findings.as_ref()?.texts.iter().position(|one| one == file)
    }
}
