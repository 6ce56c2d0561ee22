//! Facts about the scenes of a show: cameras, parameters and preferences.

use std::collections::BTreeMap;

use super::cue_list::{Entry, is_of_no_scene};
use mariana_field::lang::{About, Diagnostic, Scene, Span};

/// Facts about one scene, from which the director chooses.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneCard {
    /// The name or file of the scene.
    pub scene: String,
    /// The scene's `about` block.
    pub about: About,
    /// Names of the scene's cameras.
    pub cameras: Vec<String>,
    /// Names of the scene's parameters.
    pub params: Vec<String>,
    /// The parameter that the director lets rise during a build; `None` if there is none.
    pub rise: Option<Rise>,
}

/// A movement of a parameter during a build.
#[derive(Debug, Clone, PartialEq)]
pub struct Rise {
    /// The name of the parameter.
    pub param: String,
    /// The parameter's default, from which it rises and to which it falls back.
    pub from: f32,
    /// The value at the end of the build.
    pub to: f32,
}

/// Names of parameters that say how much the sound moves the scene. They may move at any time: a speed may not,
/// because it is multiplied by the time, so that the scene would jump.
const RISING: [&str; 7] = ["swell", "pump", "unfold", "jump", "skyline", "heights", "stir"];
/// The part of the range above the default that a parameter rises.
const RISE: f32 = 0.8;

impl Rise {
    fn of(scene: &Scene) -> Option<Self> {
        let named = scene.params.iter().filter(|param| !param.is_number);
        let mut rising =
            named.filter(|param| RISING.contains(&param.name.as_str()) && param.max > param.default);
        let param = rising.next()?;
        let to = param.default + RISE * (param.max - param.default);
        Some(Self { param: param.name.clone(), from: param.default, to })
    }
}

/// The reason why a scene cannot be used.
#[derive(Debug, Clone)]
pub struct Refusal {
    /// One sentence, for a message.
    pub sentence: String,
    /// The rendered mistakes in the scene's text, if there are any.
    pub mistakes: Option<String>,
}

impl SceneCard {
    /// Returns the facts about `scene`, which is called `name` in the show.
    pub fn of(name: &str, scene: Scene) -> Self {
        let rise = Rise::of(&scene);
        let params = scene.params.into_iter().filter(|param| !param.is_number).map(|param| param.name);
        let cameras = scene.cameras.into_iter().map(|(name, _)| name).collect();
        Self { scene: name.to_owned(), about: scene.about, cameras, params: params.collect(), rise }
    }

    /// Returns a diagnostic for each camera and parameter in `entry` that the scene does not have.
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

/// The scenes that a cue list names.
#[derive(Default)]
pub(super) struct NamedScenes {
    /// The key is the name in the cue list. A refused scene has no card.
    pub cards: BTreeMap<String, Option<SceneCard>>,
    /// A diagnostic for each refused scene, missing camera and missing parameter.
    pub mistakes: Vec<Diagnostic>,
    /// Rendered mistakes in the texts of scenes.
    pub reports: Vec<String>,
}

impl NamedScenes {
    /// Collects the scenes that the entries name. Calls `find` once for each name.
    pub(super) fn of(entries: &[Entry], mut find: impl FnMut(&str) -> Result<SceneCard, Refusal>) -> Self {
        let mut named = Self::default();
        for entry in entries {
            if !named.cards.contains_key(&entry.scene) {
                let card = find(&entry.scene).map_err(|refusal| named.refuse(entry, refusal)).ok();
                named.cards.insert(entry.scene.clone(), card);
            }
            if let Some(Some(card)) = named.cards.get(&entry.scene) {
                named.mistakes.extend(card.missing(entry));
            }
        }
        named
    }

    /// Reports why the scene of `entry` is refused, at the position of the scene's name.
    fn refuse(&mut self, entry: &Entry, refusal: Refusal) {
        let reported = Diagnostic::new(entry.scene_span, refusal.sentence);
        self.mistakes.push(match refusal.mistakes {
            Some(report) => {
                self.reports.push(report);
                reported.hint("correct the mistakes in the scene, which are listed below")
            }
            None => reported,
        });
    }
}

/// Returns a hint about a wrong name, with a list of the valid names.
fn listed(what: &str, names: &[String]) -> String {
    match names {
        [] => format!("the scene has no named {what}: leave this one out"),
        names => format!("the scene's {what} are {}: choose one, or leave this one out", names.join(", ")),
    }
}
