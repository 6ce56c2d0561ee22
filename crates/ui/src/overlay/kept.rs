//! Values that one layout keeps for the next. A value is dropped if the next layout does not keep it again, so that a
//! panel which opens again starts afresh.

use egui::cache::FramePublisher;
use egui::{ColorImage, Context, Id, TextureHandle, TextureId, TextureOptions};

type Values<T> = FramePublisher<Id, T>;

/// Returns the value that the last layout has kept.
pub(super) fn last<T: Clone + Send + Sync + 'static>(context: &Context, id: Id) -> Option<T> {
    context.memory_mut(|memory| memory.caches.cache::<Values<T>>().get(&id).cloned())
}

/// Keeps a value for the next layout. Returns the value that the last layout has kept.
pub(super) fn replace<T: Clone + Send + Sync + 'static>(context: &Context, id: Id, value: T) -> Option<T> {
    let before = last(context, id);
    context.memory_mut(|memory| memory.caches.cache::<Values<T>>().set(id, value));
    before
}

/// Keeps a texture. Without a texture of the last layout, makes it of an image. `of` lives as long as the texture.
pub(super) fn texture<Of: Clone + Send + Sync + 'static>(
    context: &Context,
    id: Id,
    of: Of,
    image: impl FnOnce() -> ColorImage,
) -> TextureId {
    let known = last::<(Of, TextureHandle)>(context, id).map(|(_, texture)| texture);
    let texture = known.unwrap_or_else(|| context.load_texture("kept", image(), TextureOptions::LINEAR));
    let texture_id = texture.id();
    replace(context, id, (of, texture));
    texture_id
}
