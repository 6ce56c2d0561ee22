//! Status texts about the shown scene, for the title and the status line (key I).

use std::fmt::Display;

use super::prepared_scene::PreparedScene;
use super::session::SceneSession;
use crate::scenes::SceneSource;

pub(crate) fn notes(session: &SceneSession) -> Vec<String> {
    let Some((scene, mode)) = session.drawn() else { return Vec::new() };
    let view = session.composer.views.choice.map(|view| format!("view {view}"));
    [scene.title(), mode.to_string()].into_iter().chain(view).collect()
}

/// The status line: name; rate and size of frames (`pictures`); mode; clauses and regions; `quality`; the coming scene.
pub(crate) fn line(session: &SceneSession, pictures: &str, quality: &impl Display) -> Option<String> {
    let (scene, mode) = session.drawn()?;
    let clauses = scene.resources.buffers().cost.distance;
    let (built, drawn) = (scene.resources.regions(), (scene.id, mode));
    let regions = session.composer.regions.about(drawn, built.as_deref(), session.preparation.choice.cells);
    let numbers = format!("{pictures} · {mode} · {clauses} clauses · {regions} · {quality}");
    Some([scene.title(), numbers].into_iter().chain(remarks(session)).collect::<Vec<_>>().join(" · "))
}

fn remarks(session: &SceneSession) -> Vec<String> {
    let is_another = |scene: &&PreparedScene| session.scenes.shown_source() != Some(&scene.source);
    let coming = session.scenes.coming.as_ref().filter(is_another);
    let coming = coming.map(|scene| format!("{} is being prepared", scene.title()));
    let is_scene = |source: &&SceneSource| !matches!(source, SceneSource::Blend(_));
    let refused: Vec<_> = session.show.refused.iter().filter(is_scene).map(SceneSource::title).collect();
    let without = (!refused.is_empty()).then(|| format!("too much for this machine: {}", refused.join(", ")));
    coming.into_iter().chain(without).collect()
}
