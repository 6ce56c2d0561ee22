//! Facts about a show's scenes that are needed before anything is drawn: sources, cameras, parameters, preferences.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::script::{Entry, is_of_no_scene};
use crate::scenes::{SceneError, SceneSource};
use mariana_field::lang::{About, Diagnostic, Span, Way};

/// What a show has to know of one scene.
#[derive(Debug, Clone)]
pub(super) struct SceneFacts {
    pub source: SceneSource,
    pub about: About,
    /// The names of its cameras and parameters.
    pub cameras: Vec<String>,
    pub params: Vec<String>,
}

impl SceneFacts {
    /// Compiles a scene.
    pub(super) fn of(source: SceneSource) -> Result<Self, SceneError> {
        let scene = source.checked()?;
        let params = scene.params.into_iter().filter(|param| !param.is_number).map(|param| param.name);
        let cameras = scene.cameras.into_iter().map(|(name, _)| name).collect();
        Ok(Self { source, about: scene.about, cameras, params: params.collect() })
    }

    /// How the scene likes to come and to go.
    pub(super) fn ways(&self) -> (Option<Way>, Option<Way>) {
        (self.about.enter, self.about.leave)
    }

    /// Cameras and parameters of an entry that this scene lacks.
    fn missing(&self, entry: &Entry) -> Vec<Diagnostic> {
        let scene = &entry.scene;
        let lacks = |span: Span, what: &str, name: &str, hint: String| {
            Diagnostic::new(span, format!("the scene {scene} has no {what} `{name}`")).hint(hint)
        };
        let mut missing = Vec::new();
        if let Some(camera) = entry.camera.as_ref().filter(|camera| !self.cameras.contains(camera)) {
            missing.push(lacks(entry.camera_span, "camera", camera, listed("cameras", &self.cameras)));
        }
        for setting in &entry.settings {
            if !self.params.contains(&setting.param) && !is_of_no_scene(&setting.param) {
                let hint = listed("parameters", &self.params);
                missing.push(lacks(setting.span, "parameter", &setting.param, hint));
            }
        }
        missing
    }
}

/// The scenes that a show's entries name.
#[derive(Default)]
pub(super) struct NamedScenes {
    /// By their names in the show.
    pub facts: BTreeMap<String, SceneFacts>,
    /// Scenes that are refused, and cameras and parameters that scenes lack.
    pub mistakes: Vec<Diagnostic>,
    /// The mistakes inside scenes, with their places there.
    pub reports: Vec<String>,
}

impl NamedScenes {
    /// Compiles the scenes of these entries. Files are looked for in `folder`.
    pub(super) fn of(entries: &[Entry], folder: &Path) -> Self {
        let mut named = Self::default();
        let mut refused = BTreeSet::new();
        for entry in entries {
            if refused.contains(&entry.scene) {
                continue;
            }
            if !named.facts.contains_key(&entry.scene) {
                match source_of(&entry.scene, folder).and_then(SceneFacts::of) {
                    Ok(facts) => {
                        named.facts.insert(entry.scene.clone(), facts);
                    }
                    Err(error) => {
                        refused.insert(&entry.scene);
                        named.refuse(entry, error);
                    }
                }
            }
            if let Some(facts) = named.facts.get(&entry.scene) {
                named.mistakes.extend(facts.missing(entry));
            }
        }
        named
    }

    /// Notes at the entry why its scene is refused.
    fn refuse(&mut self, entry: &Entry, error: SceneError) {
        self.mistakes.push(match error {
            SceneError::Mistakes { name, plain, .. } => {
                self.reports.push(plain);
                Diagnostic::new(entry.scene_span, format!("the scene {name} has mistakes"))
                    .hint("correct what is underlined in it")
            }
            error => Diagnostic::new(entry.scene_span, error.to_string()),
        });
    }
}

/// What to do about a wrong name, given the right ones.
fn listed(what: &str, names: &[String]) -> String {
    match names {
        [] => format!("it has no {what} with names: leave it out"),
        names => format!("its {what} are {}: choose one of them, or leave it out", names.join(", ")),
    }
}

/// The scene that a show means by a name: a file in its folder, or a shipped scene.
fn source_of(name: &str, folder: &Path) -> Result<SceneSource, SceneError> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Ok(SceneSource::File(beside));
    }
    match SceneSource::find(name)? {
        SceneSource::File(_) => Ok(SceneSource::File(beside)),
        found => Ok(found),
    }
}
