//! Scenes for tests, in a context without a window.

use super::library::SceneLoader;
use super::prepared_scene::PreparedScene;
use crate::gpu::gl::Gl;
use crate::scenes::{Drafts, Loader, NumberEdits, SceneSource, TextureCache};

pub(super) fn uploaded(gl: &Gl, id: u64, source: &SceneSource) -> PreparedScene {
    PreparedScene::upload(gl, id, source.clone(), source.ready().unwrap(), None).unwrap()
}

pub(super) fn text(text: &str) -> SceneSource {
    SceneSource::Formula(text.to_owned())
}

pub(super) fn loader() -> SceneLoader {
    let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
    let texts = Drafts::default().texts();
    let load = move |source: &SceneSource| source.ready_with(&mut textures, &mut edits, &texts);
    Loader::start(load, || {}).unwrap()
}
