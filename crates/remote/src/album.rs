//! Small pictures of scenes, which phones may look at.
//!
//! Whoever made them puts them in; they are held in memory and nowhere else. A picture that a phone asks for and that is
//! not there is wanted, if there is a scene of that name: whoever can make it asks what is ([`Album::take_wanted`]).

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::limits::LIMITS;

/// Copies are the same album.
#[derive(Debug, Clone, Default)]
pub struct Album(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    pages: Mutex<HashMap<String, Page>>,
    /// What is wanted and nobody makes yet, the first wish first.
    wanted: Mutex<Vec<String>>,
    /// Counts the pictures that came.
    count: AtomicU64,
}

/// What is known of a scene's picture.
#[derive(Debug, Clone)]
enum Page {
    /// A phone has asked for it.
    Coming,
    /// Here it is.
    There(Arc<[u8]>),
    /// There is none.
    Missing,
}

impl Album {
    /// Puts in the picture of a scene, a JPEG. Returns whether there is room for it.
    pub fn put(&self, scene: &str, jpeg: Arc<[u8]>) -> bool {
        let mut pages = self.lock();
        let is_full = pages.len() >= LIMITS.pictures_max && !pages.contains_key(scene);
        if is_full || jpeg.len() > LIMITS.picture_bytes_max {
            return false;
        }
        pages.insert(scene.to_owned(), Page::There(jpeg));
        self.0.count.fetch_add(1, Ordering::Release);
        true
    }

    /// Notes that a scene that was wanted has no picture: nobody is asked for it again.
    pub fn miss(&self, scene: &str) {
        if let Some(page) = self.lock().get_mut(scene) {
            *page = Page::Missing;
        }
    }

    /// The scenes of which phones want pictures that nobody makes yet, the first wish first.
    pub fn take_wanted(&self) -> Vec<String> {
        std::mem::take(&mut *self.0.wanted.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// How many pictures have come: another number, and there may be one that was missing.
    pub(crate) fn count(&self) -> u64 {
        self.0.count.load(Ordering::Acquire)
    }

    /// The picture of a scene, if it is there.
    pub(crate) fn find(&self, scene: &str) -> Option<Arc<[u8]>> {
        match self.lock().get(scene)? {
            Page::There(jpeg) => Some(jpeg.clone()),
            Page::Coming | Page::Missing => None,
        }
    }

    /// A phone wants the picture of a scene that there is. Returns whether that is new.
    pub(crate) fn want(&self, scene: &str) -> bool {
        let mut pages = self.lock();
        let is_new = pages.len() < LIMITS.pictures_max && !pages.contains_key(scene);
        if is_new {
            pages.insert(scene.to_owned(), Page::Coming);
            self.0.wanted.lock().unwrap_or_else(PoisonError::into_inner).push(scene.to_owned());
        }
        is_new
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<String, Page>> {
        self.0.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wanted_is_asked_for_once_and_then_there() {
        let album = Album::default();
        assert!(album.want("orb") && !album.want("orb") && album.find("orb").is_none());
        let other = album.clone();
        assert_eq!(other.take_wanted(), ["orb"]);
        assert!(other.take_wanted().is_empty() && !album.want("orb"));
        assert_eq!(album.count(), 0);
        assert!(other.put("orb", Arc::from(&b"jpeg"[..])));
        assert_eq!((album.find("orb").as_deref(), album.count()), (Some(&b"jpeg"[..]), 1));
        assert!(album.want("heart"));
        assert_eq!(album.take_wanted(), ["heart"]);
        album.miss("heart");
        assert!(album.find("heart").is_none() && !album.want("heart") && album.take_wanted().is_empty());
    }

    #[test]
    fn pictures_are_bounded_in_size_and_number() {
        let album = Album::default();
        let of = |bytes: usize| Arc::from(vec![0; bytes]);
        assert!(!album.put("large", of(LIMITS.picture_bytes_max + 1)));
        assert!(album.put("fits", of(LIMITS.picture_bytes_max)));
        for scene in 1..LIMITS.pictures_max {
            assert!(album.want(&scene.to_string()), "{scene}");
        }
        assert!(!album.want("one more") && !album.put("one more", of(1)));
        assert!(album.put("fits", of(1)), "another picture of the same scene");
    }
}
