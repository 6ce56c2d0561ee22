//! "Surprise me": random variations of the shown scene, which exist only as drafts until the user keeps one.
//!
//! A variation is made from the text of the scene and a number, so the number makes it again. It is a scene of its own
//! with its own sliders: the scene that it varies is never changed.

use std::path::{Path, PathBuf};

use mariana_work::once;

use super::Session;
use super::variations::{Variation, vary, words_of};
use crate::documents::{FileEvent, FileThread};
use crate::scenes::SceneSource;

/// Greatest number that a controller may send. Greater numbers are not exact in a message.
const NUMBER_MAX: u64 = 1 << 24;
/// Number of variations to try if the loader refuses one.
const TRIES: u64 = 8;

impl Session {
    /// Shows the variation with this number of the scene; 0 takes a new number.
    pub(super) fn surprise(&mut self, number: f32) {
        if self.surprises.coming.is_awaited() {
            return;
        }
        let replaced = self.playback.scene.foremost().clone();
        if !self.surprises.is_unsaved(&replaced) {
            self.forget_surprises();
        }
        let original = self.surprises.lasting(&replaced).clone();
        let own_scenes = self.interface.folders.own_scenes();
        let folder = original.file().and_then(Path::parent).map(Path::to_owned).or(own_scenes);
        let Some(folder) = folder else {
            let words = "there is no folder for your own scenes: start Mariana with --scene FILE.scene";
            return self.playback.reports.answer(words);
        };
        let is_number = number.is_finite() && number >= 1.0;
        let number = if is_number { (number as u64).min(NUMBER_MAX) } else { self.surprises.next_number() };
        let tries = if is_number { 1 } else { TRIES };
        let drafts = self.interface.drafts.clone();
        // Reading and checking a scene may take longer than a frame.
        let vary = move || vary(&original, &folder, &drafts, number..number + tries);
        match once("surprise", self.interface.waker.waking(), vary) {
            Ok(coming) => (self.surprises.coming, self.surprises.replaced) = (coming, Some(replaced)),
            Err(error) => self.playback.reports.answer(format!("cannot vary the scene: {error}")),
        }
    }

    /// Shows the variation before, and at last the scene itself.
    pub(super) fn surprise_back(&mut self) {
        let replaced = self.playback.scene.foremost().clone();
        let shown = &self.surprises.shown;
        let Some(at) = shown.iter().rposition(|one| replaced.file() == Some(&one.file)) else {
            return self.playback.reports.answer("this is the scene itself: press F5 for a variation");
        };
        let Variation { original, file, .. } = &shown[at];
        let (source, words) = match shown[..at].iter().rfind(|one| one.original == *original) {
            Some(before) => (SceneSource::File(before.file.clone()), words_of(before.number)),
            None => (original.clone(), "the scene itself again".to_owned()),
        };
        let file = file.clone();
        if !self.playback.scene.replace_scene(&replaced, source) {
            return;
        }
        self.playback.reports.answer(words);
        self.surprises.shown.remove(at);
        if !self.surprises.shown.iter().any(|one| one.file == file) {
            self.interface.drafts.remove(&file);
        }
    }

    /// Saves the shown variation in the folder of the scene that it varies; for a shipped scene, of the user's scenes.
    pub(super) fn keep_surprise(&mut self) {
        let foremost = self.playback.scene.foremost().clone();
        if !self.surprises.is_unsaved(&foremost) {
            return self.playback.reports.answer("only a variation can be kept: press F5 for a variation");
        }
        self.keep_variation(&foremost);
    }

    fn keep_variation(&mut self, source: &SceneSource) {
        let Some(Variation { file, text, .. }) = self.surprises.variation(source) else { return };
        if self.surprises.keeping.is_some() {
            return;
        }
        let (file, text) = (file.clone(), text.clone());
        if self.surprises.files.is_none() {
            match FileThread::start(&self.interface.folders, self.interface.waker.waking()) {
                Ok(files) => self.surprises.files = Some(files),
                Err(error) => {
                    return self.playback.reports.answer(format!("cannot save the variation: {error}"));
                }
            }
        }
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some((files, folder)) = self.surprises.files.as_ref().zip(file.parent()) {
            files.create(folder, &name, text.as_bytes().into());
            self.surprises.keeping = Some(file);
        }
    }

    pub(super) fn update_surprises(&mut self) {
        match self.surprises.coming.poll() {
            Some(Ok(Ok(variation))) => self.show_variation(variation),
            Some(Ok(Err(words))) => self.playback.reports.answer(words),
            // A panic is logged.
            Some(Err(_)) | None => {}
        }
        while let Some(event) = self.surprises.files.as_ref().and_then(FileThread::file_events) {
            match event {
                FileEvent::Created(file) => self.open_kept(file),
                FileEvent::Failed(reason) => {
                    (self.surprises.keeping, self.surprises.is_unkeepable) = (None, true);
                    self.playback.reports.answer(reason);
                }
                _ => {}
            }
        }
        // A recorded show names its scenes by their files.
        let may_keep = self.playback.recording.is_on && !self.surprises.is_unkeepable;
        let unsaved = self.playback.scene.played().iter().find(|source| self.surprises.is_unsaved(source));
        if let Some(unsaved) = unsaved.filter(|_| may_keep).cloned() {
            self.keep_variation(&unsaved);
        }
    }

    fn show_variation(&mut self, variation: Variation) {
        let Variation { number, file, text, .. } = &variation;
        self.interface.drafts.set(file, text.as_bytes().into());
        let scene = &self.playback.scene;
        let is_played =
            |replaced: &SceneSource| scene.foremost() == replaced || scene.played().contains(replaced);
        // Another scene may have been chosen meanwhile.
        let Some(replaced) = self.surprises.replaced.take().filter(is_played) else {
            self.interface.drafts.remove(file);
            return;
        };
        if !self.playback.scene.replace_scene(&replaced, SceneSource::File(file.clone())) {
            return;
        }
        self.playback.reports.answer(words_of(*number));
        self.surprises.is_unkeepable = false;
        self.surprises.shown.push(variation);
    }

    /// Shows the saved file of a variation. From now on it is a scene like any other.
    fn open_kept(&mut self, file: PathBuf) {
        let Some(kept) = self.surprises.keeping.take() else { return };
        self.surprises.shown.retain(|one| one.file != kept);
        self.interface.drafts.remove(&kept);
        let kept = SceneSource::File(kept);
        let scene = &mut self.playback.scene;
        let is_shown = scene.foremost() == &kept || scene.played().contains(&kept);
        if is_shown && kept.file() != Some(&file) {
            scene.replace_scene(&kept, SceneSource::File(file.clone()));
        }
        self.playback.reports.answer(format!("kept as {}", file.display()));
    }

    /// Forgets all variations that are not played.
    fn forget_surprises(&mut self) {
        let played: Vec<_> = self.playback.scene.played().iter().filter_map(SceneSource::file).collect();
        let is_played = |one: &mut Variation| played.contains(&one.file.as_path());
        for variation in self.surprises.shown.extract_if(.., |one| !is_played(one)) {
            self.interface.drafts.remove(&variation.file);
        }
    }
}
