//! Snapshots of the sliders, and the sounds that move sliders.

use std::collections::BTreeMap;

use super::Playback;
use crate::commands::{Bind, SnapshotKeys};
use crate::config::{Folders, PerformanceFiles, Snapshot};
use crate::session::scene::named;
use crate::show::{print, snapshot_cues};
use crate::ui::overlay::{SNAPSHOTS, SnapshotRow};

/// Duration of a beat while the tempo is unknown, in seconds.
const BEAT_SECONDS: f32 = 0.5;
const MORPH_BEATS_MAX: f32 = 256.0;

/// The effect of the snapshot keys, and the show files of snapshots.
#[derive(Default)]
pub(super) struct Snapshots {
    pub keys: SnapshotKeys,
    files: Option<PerformanceFiles>,
    written: u64,
}

impl Snapshots {
    /// Recalls a snapshot. Takes it the first time, and when the user wants the next snapshot to be taken.
    pub(super) fn press(&mut self, playback: &mut Playback, number: usize) {
        let takes = std::mem::take(&mut self.keys.takes);
        let known = playback.snapshots().and_then(|known| known.get(&number.to_string())).cloned();
        match known.filter(|_| !takes) {
            Some(snapshot) => {
                let SnapshotKeys { morphs, beats, .. } = self.keys;
                let seconds = if morphs { f32::from(beats) * playback.beat_seconds() } else { 0.0 };
                let turned = playback.scene.parameters_in_hand_mut();
                turned.into_iter().for_each(|mut turned| turned.recall(&snapshot, seconds));
                playback.reports.answer(format!("snapshot {number}"));
            }
            None => playback.save_snapshot(number),
        }
    }

    pub(super) fn toggle_take(&mut self, playback: &mut Playback) {
        self.keys.takes = !self.keys.takes;
        let words = match self.keys.takes {
            true => "the next snapshot key takes its snapshot again: press Shift+1 to Shift+8",
            false => "snapshot keys recall their snapshots",
        };
        playback.reports.answer(words);
    }

    pub(super) fn toggle_morph(&mut self, playback: &mut Playback) {
        self.keys.morphs = !self.keys.morphs;
        self.report_morph(playback);
    }

    /// Recalls snapshots over this number of beats; less than one beat means at once.
    pub(super) fn morph_over(&mut self, playback: &mut Playback, beats: f32) {
        let beats = beats.round().clamp(0.0, MORPH_BEATS_MAX) as u16;
        self.keys.morphs = beats > 0;
        if beats > 0 {
            self.keys.beats = beats;
        }
        self.report_morph(playback);
    }

    fn report_morph(&self, playback: &mut Playback) {
        let words = match self.keys {
            SnapshotKeys { morphs: false, .. } => "snapshots change the sliders at once".to_owned(),
            SnapshotKeys { beats: 1, .. } => "snapshots change the sliders over a beat".to_owned(),
            SnapshotKeys { beats, .. } => format!("snapshots change the sliders over {beats} beats"),
        };
        playback.reports.answer(words);
    }

    /// Writes the scene's snapshots as a show file in the folder of recordings.
    pub(super) fn write(&mut self, playback: &mut Playback, folders: &Folders) {
        let Some(source) = playback.scene.scenes.shown_source() else { return };
        let (title, scene) = (source.title(), named(source));
        let Some(snapshots) = playback.listening.sound.kept.settings().snapshots.get(&title) else {
            let words = "this scene has no snapshots: press Shift+1 to take one";
            return playback.reports.answer(words);
        };
        let comments = [
            format!("The snapshots of {title}. Enter shows the next one."),
            "Perform it with `mariana SONG --show FILE`.".to_owned(),
        ];
        let cues = snapshot_cues(&scene, snapshots.values().map(|snapshot| &snapshot.sliders));
        let files = self.files.get_or_insert_with(|| PerformanceFiles::among(folders));
        self.written += 1;
        if !files.keep(self.written, &format!("{title} snapshots"), move || print(&cues, &comments)) {
            let words = "there is no folder for show files: set the environment variable HOME";
            playback.reports.answer(words);
        }
    }

    fn report_written(&self, playback: &mut Playback) {
        let Some(written) = self.files.as_ref().and_then(PerformanceFiles::poll) else { return };
        let words = match written {
            Ok(path) => format!("written: {}; start it with --show FILE", path.display()),
            Err(error) => format!("{error}: the snapshots are not written; {}", error.remedy()),
        };
        tracing::info!("{words}");
        playback.reports.answer(words);
    }

    /// Reports a written show file. Returns the row of snapshots below the sliders.
    pub(super) fn update(&self, playback: &mut Playback) -> SnapshotRow {
        let known = playback.snapshots();
        let is_known = |number: usize| known.is_some_and(|known| known.contains_key(&number.to_string()));
        let taken = std::array::from_fn(|place| is_known(place + 1));
        self.report_written(playback);
        SnapshotRow { taken, keys: self.keys }
    }
}

impl Playback {
    pub(super) fn bind(&mut self, Bind { name, binding }: Bind) {
        let turned = self.scene.parameters_in_hand_mut();
        if !turned.is_some_and(|mut turned| turned.bind(&name, binding)) {
            self.reports.answer(format!("this scene has no parameter '{name}'"));
        }
    }

    /// The snapshots of the scene in hand, by their numbers from 1.
    fn snapshots(&self) -> Option<&BTreeMap<String, Snapshot>> {
        self.listening.sound.kept.settings().snapshots.get(&self.scene.parameters_in_hand().title()?)
    }

    fn save_snapshot(&mut self, number: usize) {
        if !(1..=SNAPSHOTS).contains(&number) {
            return self.reports.answer(format!("there is no snapshot {number}: use 1 to {SNAPSHOTS}"));
        }
        let Some(snapshot) = self.scene.parameters_in_hand().snapshot() else {
            return self.reports.answer("this scene has no sliders to take a snapshot of");
        };
        let title = self.scene.parameters_in_hand().title().unwrap_or_default();
        self.listening.sound.kept.change(move |settings| {
            let of_scene = settings.snapshots.entry(title.clone()).or_default();
            of_scene.insert(number.to_string(), snapshot.clone());
        });
        self.reports.answer(format!("snapshot {number} is taken: Shift+{number} recalls it"));
    }

    fn beat_seconds(&self) -> f32 {
        let tempo = self.tempo();
        if tempo > 0.0 { 60.0 / tempo } else { BEAT_SECONDS }
    }
}
