//! Preview images of scenes, for phones. The show stores finished images here, in memory only. When a phone requests
//! a missing image, the scene's title is queued. The show takes the queue with [`Album::drain_requested`].

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use mariana_work::lock;

use crate::limits::LIMITS;

/// A shared store of preview images. Clones share the contents.
#[derive(Debug, Clone, Default)]
pub struct Album(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    /// The requested images by scene, as JPEG once they are there. Each is requested once.
    pages: Mutex<HashMap<String, Option<Arc<[u8]>>>>,
    wanted: Mutex<Vec<String>>,
    count: AtomicU64,
}

impl Album {
    /// Stores the JPEG image of a scene. Returns false if the image is too large or the album is full.
    pub fn put(&self, scene: &str, jpeg: Arc<[u8]>) -> bool {
        let mut pages = lock(&self.0.pages);
        let is_full = pages.len() >= LIMITS.pictures_max && !pages.contains_key(scene);
        if is_full || jpeg.len() > LIMITS.picture_bytes_max {
            return false;
        }
        pages.insert(scene.to_owned(), Some(jpeg));
        self.0.count.fetch_add(1, Ordering::Release);
        true
    }

    /// Takes the titles of scenes whose images phones have requested, in order of request.
    pub fn drain_requested(&self) -> Vec<String> {
        std::mem::take(&mut *lock(&self.0.wanted))
    }

    /// Returns the number of images stored so far. A new number tells phones to retry missing images.
    pub(crate) fn count(&self) -> u64 {
        self.0.count.load(Ordering::Acquire)
    }

    pub(crate) fn find(&self, scene: &str) -> Option<Arc<[u8]>> {
        lock(&self.0.pages).get(scene)?.clone()
    }

    /// Requests the image of an existing scene. Returns true for the first request.
    pub(crate) fn request(&self, scene: &str) -> bool {
        let mut pages = lock(&self.0.pages);
        let is_new = pages.len() < LIMITS.pictures_max && !pages.contains_key(scene);
        if is_new {
            pages.insert(scene.to_owned(), None);
            lock(&self.0.wanted).push(scene.to_owned());
        }
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_requested_once_and_then_available() {
        let album = Album::default();
        assert!(album.request("orb") && !album.request("orb") && album.find("orb").is_none());
        let other = album.clone();
        assert_eq!(other.drain_requested(), ["orb"]);
        assert!(other.drain_requested().is_empty() && !album.request("orb"));
        assert_eq!(album.count(), 0);
        assert!(other.put("orb", Arc::from(&b"jpeg"[..])));
        assert_eq!((album.find("orb").as_deref(), album.count()), (Some(&b"jpeg"[..]), 1));
        assert!(album.request("heart"));
        assert_eq!(album.drain_requested(), ["heart"]);
        assert!(
            album.find("heart").is_none() && !album.request("heart") && album.drain_requested().is_empty()
        );
    }

    #[test]
    fn pictures_are_bounded_in_size_and_number() {
        let album = Album::default();
        let of = |bytes: usize| Arc::from(vec![0; bytes]);
        assert!(!album.put("large", of(LIMITS.picture_bytes_max + 1)));
        assert!(album.put("fits", of(LIMITS.picture_bytes_max)));
        for scene in 1..LIMITS.pictures_max {
            assert!(album.request(&scene.to_string()), "{scene}");
        }
        assert!(!album.request("one more") && !album.put("one more", of(1)));
        assert!(album.put("fits", of(1)), "a full album still accepts a new image of a known scene");
    }
}
