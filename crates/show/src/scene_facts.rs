//! Facts about a show's scenes: cameras, parameters, preferences.

use std::collections::{BTreeMap, BTreeSet};

use super::cue_list::{Entry, is_of_no_scene};
use super::director::SceneCard;
use mariana_field::lang::{About, Diagnostic, Scene, Span, Way};

/// The facts about one scene.
#[derive(Debug, Clone)]
pub struct SceneFacts {
    /// Its `about` block.
    pub about: About,
    /// The names of its cameras.
    pub cameras: Vec<String>,
    /// The names of its parameters.
    pub params: Vec<String>,
}

impl From<Scene> for SceneFacts {
    fn from(scene: Scene) -> Self {
        let params = scene.params.into_iter().filter(|param| !param.is_number).map(|param| param.name);
        let cameras = scene.cameras.into_iter().map(|(name, _)| name).collect();
        Self { about: scene.about, cameras, params: params.collect() }
    }
}

/// The reason why a scene cannot be used.
#[derive(Debug, Clone)]
pub struct Refusal {
    /// One sentence.
    pub sentence: String,
    /// The mistakes in the scene's text with their places, if it has mistakes.
    pub mistakes: Option<String>,
}

impl SceneFacts {
    /// How the scene likes to come and to go.
    pub(super) fn ways(&self) -> (Option<Way>, Option<Way>) {
        (self.about.enter, self.about.leave)
    }

    /// The card of the scene `name`.
    pub(super) fn card(&self, name: &str) -> SceneCard {
        SceneCard { scene: name.to_owned(), about: self.about.clone(), cameras: self.cameras.clone() }
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
    /// The scenes of these entries, as `find` finds them by name.
    pub(super) fn of(entries: &[Entry], mut find: impl FnMut(&str) -> Result<SceneFacts, Refusal>) -> Self {
        let mut named = Self::default();
        let mut refused = BTreeSet::new();
        for entry in entries {
            if refused.contains(&entry.scene) {
                continue;
            }
            if !named.facts.contains_key(&entry.scene) {
                match find(&entry.scene) {
                    Ok(facts) => {
                        named.facts.insert(entry.scene.clone(), facts);
                    }
                    Err(refusal) => {
                        refused.insert(&entry.scene);
                        named.refuse(entry, refusal);
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
    fn refuse(&mut self, entry: &Entry, refusal: Refusal) {
        let reported = Diagnostic::new(entry.scene_span, refusal.sentence);
        self.mistakes.push(match refusal.mistakes {
            Some(report) => {
                self.reports.push(report);
                reported.hint("correct what is underlined in it")
            }
            None => reported,
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
