//! The pictures of the window, which never waits for them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use image::RgbaImage;

use super::feed::Feed;
use super::pictures_of;
use crate::clock;
use crate::frame::Frame;
use crate::scenes::TextureSource;
use mariana_field::world::World;

/// A source that no frame needs for this time is closed.
const KEPT: Duration = Duration::from_secs(5);

/// The moving textures of a session.
pub struct LiveTextures {
    feeds: Vec<Used>,
    messages: Vec<String>,
    cover: Option<Arc<RgbaImage>>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

struct Used {
    source: TextureSource,
    feed: Feed,
    last: Instant,
}

impl LiveTextures {
    /// `wake` is called when a picture comes that the last frame lacks, and when a source has a message.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self { feeds: Vec::new(), messages: Vec::new(), cover: None, wake: Arc::new(wake) }
    }

    /// Sets the cover of the song. Returns true if it is another one.
    pub fn set_cover(&mut self, cover: Option<Arc<RgbaImage>>) -> bool {
        let pointer = |cover: &Option<Arc<RgbaImage>>| cover.as_ref().map(Arc::as_ptr);
        let is_another = pointer(&cover) != pointer(&self.cover);
        self.cover = cover;
        is_another
    }

    /// Adds the pictures at the frame's time to a frame of a world, as far as they have come. Starts missing sources,
    /// and closes those that are no longer used.
    pub fn in_frame(&mut self, mut frame: Frame, world: &World) -> Frame {
        let (now, time) = (clock::now(), f64::from(frame.inputs.time));
        frame.pictures = pictures_of(world, |source| match source {
            TextureSource::Cover => self.cover.clone(),
            source => self.of_feed(source, time, now),
        });
        self.feeds.retain(|used| now.saturating_duration_since(used.last) < KEPT);
        frame
    }

    fn of_feed(&mut self, source: TextureSource, time: f64, now: Instant) -> Option<Arc<RgbaImage>> {
        if let Some(used) = self.feeds.iter_mut().find(|used| used.source == source) {
            used.last = now;
            return used.feed.at(time);
        }
        let wake = self.wake.clone();
        let feed = Feed::start(source.clone(), time, move || wake()).unwrap_or_else(|error| {
            let words = format!("a texture does not move: the system has no thread left ({error})");
            self.messages.push(words);
            Feed::default()
        });
        let picture = feed.at(time);
        self.feeds.push(Used { source, feed, last: now });
        picture
    }

    /// True if pictures have come since the last call that the last frame lacks.
    pub fn has_new_pictures(&mut self) -> bool {
        let news = self.feeds.iter().filter(|used| used.feed.has_new_picture());
        news.count() > 0
    }

    /// Sentences about sources that have failed and cameras that are on, each once.
    pub fn drain_messages(&mut self) -> Vec<String> {
        let of_feeds = self.feeds.iter().filter_map(|used| used.feed.drain_message());
        self.messages.drain(..).chain(of_feeds).collect()
    }
}
