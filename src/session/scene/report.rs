//! Status texts about the shown scene, for the title and the status line (key I).

use super::composer::SceneComposer;
use super::messages::Messages;
use super::prepared_scene::{DrawingChoice, PreparedScene};
use super::prepared_scenes::PreparedScenes;
use super::program_library::ProgramLibrary;
use super::show_follower::ShowFollower;
use crate::scenes::SceneSource;

pub(crate) struct SceneReport<'a> {
    pub(super) scenes: &'a PreparedScenes,
    pub(super) show: &'a ShowFollower,
    pub(super) composer: &'a SceneComposer,
    pub(super) messages: &'a Messages,
    pub(super) programs: &'a ProgramLibrary,
    pub(super) choice: DrawingChoice,
}

impl SceneReport<'_> {
    pub(crate) fn notes(&self) -> Vec<String> {
        let Some(scene) = &self.scenes.shown else { return Vec::new() };
        let Some(mode) = scene.mode(self.choice.sdf) else { return Vec::new() };
        let view = self.composer.view().map(|view| format!("view {view}"));
        [scene.title(), mode.to_string()].into_iter().chain(view).collect()
    }

    /// The status line: name; rate and size of frames (`pictures`); mode; clauses and regions; `quality`; pending work.
    pub(crate) fn line(&self, pictures: &str, quality: &str) -> Option<String> {
        let scene = self.scenes.shown.as_ref()?;
        let mode = scene.mode(self.choice.sdf)?;
        let clauses = scene.resources.buffers().cost.distance;
        let (built, drawn) = (scene.resources.regions(), (scene.id, mode));
        let regions = self.composer.regions.about(drawn, built.as_deref(), self.choice.cells);
        let numbers = format!("{pictures} · {mode} · {clauses} clauses · {regions} · {quality}");
        Some([scene.title(), numbers].into_iter().chain(self.remarks()).collect::<Vec<_>>().join(" · "))
    }

    fn remarks(&self) -> Vec<String> {
        let is_another = |scene: &&PreparedScene| self.scenes.shown_source() != Some(&scene.source);
        let coming = self.scenes.coming.as_ref().filter(is_another);
        let coming = coming.map(|scene| format!("{} is being prepared", scene.title()));
        let remark = self.messages.remark(|task| self.programs.task(task).is_some());
        let is_scene = |source: &&SceneSource| !matches!(source, SceneSource::Blend(_));
        let refused: Vec<_> = self.show.refused.iter().filter(is_scene).map(SceneSource::title).collect();
        let without =
            (!refused.is_empty()).then(|| format!("too much for this machine: {}", refused.join(", ")));
        coming.into_iter().chain(remark.map(str::to_owned)).chain(without).collect()
    }
}
