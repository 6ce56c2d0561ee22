//! A show with its timeline and the sources of its scenes. Errors in the show file and its scenes are found here.

use std::collections::BTreeMap;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_assets::DEMO_SHOW;
use mariana_files::reading::{TextError, read_text};
use mariana_music::SongStructure;
use mariana_scenes::{SceneBlend, SceneError, SceneSource, SeenScene};
use mariana_show::limits as show_limits;
use mariana_show::{
    Clip, CueListError, Moment, Refusal, SceneCard, Show, TimedTransition, Timeline, TransitionKind,
};

const DEMO_NAME: &str = "demo.show";

/// The source of a show.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum ShowSource {
    /// The director chooses among scenes.
    #[default]
    Auto,
    /// The demo track's own show.
    Demo,
    /// A show file.
    File(PathBuf),
}

/// Errors that leave no show to play.
#[derive(Debug, thiserror::Error)]
pub enum ShowError {
    /// The file is not a readable text.
    #[error("the show {} {problem}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: TextError,
    },
    /// The show file has mistakes.
    #[error(transparent)]
    CueList(#[from] CueListError),
    /// All entries wait for a key, which only a window has.
    #[error(
        "every entry of the show waits for a key (`at cue`), which only a window has: write `at start` and a scene \
         above them"
    )]
    WaitsForKeys,
    /// The director has no scene without mistakes.
    #[error("there is no scene to show: name a scene without mistakes with --scene")]
    NoScenes,
}

/// A timeline with the sources of its scenes.
#[derive(Debug, Clone, Default)]
pub struct PreparedShow {
    show: Show,
    scenes: BTreeMap<String, SceneSource>,
    /// False if the user chose the scenes, by a show file or the command line.
    is_by_program: bool,
}

impl Deref for PreparedShow {
    type Target = Show;

    fn deref(&self) -> &Show {
        &self.show
    }
}

impl PreparedShow {
    /// Returns the same scenes with another timeline.
    pub fn with_timeline(&self, timeline: Option<Timeline>) -> Self {
        Self { show: self.show.with_timeline(timeline), ..self.clone() }
    }

    /// True if the user chose the scenes; false for the director's shows and that of the demo track.
    pub fn is_by_user(&self) -> bool {
        !self.is_by_program
    }

    /// Replaces `refused` scenes by other scenes of the show. Returns `None` if all are refused or the user chose
    /// them.
    pub fn without(&self, refused: &[SceneSource]) -> Option<Self> {
        if self.is_by_user() {
            return None;
        }
        let is_refused = |scene: &str| self.source(scene).is_some_and(|source| refused.contains(source));
        Some(Self { show: self.show.without(is_refused)?, ..self.clone() })
    }

    /// Returns a show that cuts to each scene at its time, in seconds.
    pub fn of_cuts(scenes: impl IntoIterator<Item = (f64, SceneSource)>) -> Self {
        Self::of_clips(scenes.into_iter().map(|(start, source)| (source, start, TimedTransition::CUT)))
    }

    /// Returns a show of two decks: a fader leads from the first scene to the second, which was loaded at `start`
    /// seconds of the song. The scenes must have different names.
    pub fn of_decks(scenes: [SceneSource; 2], kind: TransitionKind, start: f64) -> Self {
        let [from, to] = scenes;
        Self::of_clips([(from, 0.0, TimedTransition::CUT), (to, start, TimedTransition::by_fader(kind))])
    }

    /// Returns a show of scenes with their start times, in seconds, and transitions.
    fn of_clips(scenes: impl IntoIterator<Item = (SceneSource, f64, TimedTransition)>) -> Self {
        let mut prepared_show = Self::default();
        let mut clips = Vec::new();
        for (source, start, transition) in scenes {
            let scene = name_of(&source);
            prepared_show.scenes.insert(scene.clone(), source);
            clips.push(Clip { start, scene, camera: None, transition, moves: Vec::new() });
        }
        prepared_show.with_timeline(Timeline::new(clips))
    }

    /// Returns the show of a song, from a file or from the director, who chooses among those `scenes` that have no
    /// mistakes. The second result reports entries that do not fit the song.
    ///
    /// # Errors
    /// [`ShowError`]
    pub fn of_song(
        source: &ShowSource,
        song: &SongStructure,
        scenes: &[SceneSource],
    ) -> Result<(Self, Option<String>), ShowError> {
        match source {
            ShowSource::Auto => Ok((Self::directed(song, scenes, &[])?, None)),
            ShowSource::Demo => {
                let (prepared_show, reported) =
                    Self::of_text(DEMO_NAME, DEMO_SHOW, song, |name| source_of(name, Path::new("")))?;
                Ok((Self { is_by_program: true, ..prepared_show }, reported))
            }
            ShowSource::File(path) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                Self::of_text(&path.display().to_string(), &read(path)?, song, |name| source_of(name, folder))
            }
        }
    }

    /// Returns the director's show of a song from those `scenes` that have no mistakes. `recent` are the names of the
    /// scenes that earlier songs have shown, the last one at the end.
    ///
    /// # Errors
    /// [`ShowError::NoScenes`]
    pub fn directed(
        song: &SongStructure,
        scenes: &[SceneSource],
        recent: &[String],
    ) -> Result<Self, ShowError> {
        let card = |source: &SceneSource| {
            let card = card_of(source).inspect_err(|error| tracing::warn!("not shown: {error}")).ok()?;
            Some((card, source.clone()))
        };
        Self::directed_among(song, scenes.iter().filter_map(card), recent)
    }

    /// Returns the director's show as [`Self::directed`] does, from scenes that are read already.
    ///
    /// # Errors
    /// [`ShowError::NoScenes`]
    pub fn directed_among(
        song: &SongStructure,
        scenes: impl IntoIterator<Item = (SceneCard, SceneSource)>,
        recent: &[String],
    ) -> Result<Self, ShowError> {
        let scenes = scenes.into_iter().map(|(card, source)| (name_of(&source), (card, source)));
        let known: BTreeMap<String, _> = scenes.collect();
        let cards = known.values().map(|(card, _)| card.clone()).collect();
        let show = Show::directed(song, cards, recent).ok_or(ShowError::NoScenes)?;
        let scenes = known.into_iter().map(|(name, (_, source))| (name, source)).collect();
        Ok(Self { show, scenes, is_by_program: true })
    }

    /// Returns the show that `text` describes for a song, and a report of the entries that do not fit the song. `find`
    /// returns the scene with a name. Messages call the text `name`.
    ///
    /// # Errors
    /// [`ShowError::CueList`] if the text has mistakes.
    pub fn of_text(
        name: &str,
        text: &str,
        song: &SongStructure,
        find: impl Fn(&str) -> Result<SceneSource, SceneError>,
    ) -> Result<(Self, Option<String>), ShowError> {
        let mut scenes = BTreeMap::new();
        let (show, reported) = Show::of_text(name, text, song, |scene| {
            let source = find(scene).map_err(refusal)?;
            let card = SceneCard::of(scene, source.checked().map_err(refusal)?);
            scenes.insert(scene.to_owned(), source);
            Ok(card)
        })?;
        Ok((Self { show, scenes, is_by_program: false }, reported))
    }

    /// Returns the same show, with the key for cues pressed at the times `cues`, in seconds.
    pub fn with_cues(&self, song: &SongStructure, cues: &[f64]) -> Self {
        Self { show: self.show.with_cues(song, cues), ..self.clone() }
    }

    /// Returns the state of the show at `time` seconds; `None` without a timeline.
    pub fn at(&self, time: f64) -> Option<Moment<'_>> {
        self.timeline().map(|timeline| timeline.at(time))
    }

    /// Returns the source of a scene in the timeline.
    pub fn source(&self, scene: &str) -> Option<&SceneSource> {
        self.scenes.get(scene)
    }

    /// Returns the names in the show and the sources of all its scenes, also of those that this song lacks.
    pub fn scenes(&self) -> impl Iterator<Item = (&str, &SceneSource)> {
        self.scenes.iter().map(|(name, source)| (name.as_str(), source))
    }

    /// Returns the blend that leads from one clip to the next; `None` if the transition mixes no worlds, if both clips
    /// show the same scene, or if a scene is unknown.
    pub fn blend(&self, from: &Clip, to: &Clip) -> Option<SceneSource> {
        let kind = to.transition.kind.blend().filter(|_| from.scene != to.scene)?;
        let seen = |clip: &Clip| {
            Some(SeenScene { source: self.source(&clip.scene)?.clone(), camera: clip.camera.clone() })
        };
        // A fader moves at any time, so the time of its clip says nothing.
        let middle = if to.transition.by_fader { 0.0 } else { to.start + 0.5 * to.transition.seconds };
        let aligned_at = (1000.0 * middle).max(0.0) as u64;
        let blend = SceneBlend { from: seen(from)?, to: seen(to)?, kind, aligned_at };
        Some(SceneSource::Blend(Arc::new(blend)))
    }

    /// Returns the scenes of the timeline, in the order of their first clips.
    pub fn sources(&self) -> Vec<&SceneSource> {
        let mut names: Vec<&str> = Vec::new();
        for clip in self.clips() {
            if !names.contains(&clip.scene.as_str()) {
                names.push(&clip.scene);
            }
        }
        names.into_iter().filter_map(|name| self.source(name)).collect()
    }
}

/// Returns what the director knows about a scene.
///
/// # Errors
/// Fails if the scene cannot be read or has mistakes.
pub fn card_of(source: &SceneSource) -> Result<SceneCard, SceneError> {
    Ok(SceneCard::of(&name_of(source), source.checked()?))
}

/// Returns the name of a scene in shows.
pub fn name_of(source: &SceneSource) -> String {
    match source {
        SceneSource::Shipped(name) => name.clone(),
        SceneSource::File(path) => path.display().to_string(),
        SceneSource::Formula(text) => text.clone(),
        SceneSource::Blend(blend) => name_of(&blend.to.source),
    }
}

fn refusal(error: SceneError) -> Refusal {
    match error {
        SceneError::Mistakes { name, found } => Refusal {
            sentence: format!("the scene {name} has mistakes"),
            mistakes: Some(found.render(false)),
        },
        error => Refusal { sentence: error.to_string(), mistakes: None },
    }
}

/// Returns the scene with this name in a show file: a file in its folder, or a shipped scene.
pub fn source_of(name: &str, folder: &Path) -> Result<SceneSource, SceneError> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Ok(SceneSource::File(beside));
    }
    match SceneSource::find(name)? {
        SceneSource::File(_) => Ok(SceneSource::File(beside)),
        found => Ok(found),
    }
}

fn read(path: &Path) -> Result<String, ShowError> {
    read_text(path, show_limits::BYTES_MAX)
        .map_err(|problem| ShowError::File { path: path.to_owned(), problem })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::{Section, SongBeat};

    /// The song has 32 bars of two seconds, all in the section A.
    fn song() -> SongStructure {
        let beat = |index: usize| SongBeat {
            time: 0.5 + 0.5 * index as f64,
            of_bar: (index % 4) as u8 + 1,
            tempo: 120.0,
        };
        let section = Section { start: 0.0, end: 64.5, letter: "A".to_owned(), energy: 0.5 };
        SongStructure {
            seconds: 64.5,
            tempo: Some(120.0),
            beats: (0..128).map(beat).collect(),
            sections: vec![section],
            ..SongStructure::default()
        }
    }

    fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(
            folder.path().join("own.scene"),
            "param size = 1 in 0 .. 2\ncamera near { }\nlength(p) - size",
        )
        .unwrap();
        std::fs::write(folder.path().join("bare.scene"), "length(p) - 1").unwrap();
        let path = folder.path().join("my.show");
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn a_show_finds_its_scenes_in_its_folder_and_among_the_shipped_ones() {
        let (folder, path) = file("at start own.scene camera near\n set size = 0.5\nat bar 3 orb");
        let (prepared_show, reported) = PreparedShow::of_song(&ShowSource::File(path), &song(), &[]).unwrap();
        assert_eq!(reported, None);
        let sources: Vec<SceneSource> = prepared_show.sources().into_iter().cloned().collect();
        assert_eq!(
            sources,
            [SceneSource::File(folder.path().join("own.scene")), SceneSource::Shipped("orb".to_owned())]
        );
        assert_eq!(prepared_show.clips().len(), 2);
    }

    #[test]
    fn each_refusal_names_the_missing_item() {
        for (text, wanted) in [
            ("at start none.scene", "none.scene"),
            ("at start orbb", "orbb"),
            ("at start own.scene camera far", "the scene's cameras are near"),
            ("at start bare.scene camera far", "the scene has no named cameras"),
            ("at start own.scene\nset swell = 1", "the scene's parameters are size"),
            ("at start own.scene flyy", "my.show:1:20"),
            ("at section Z orb\nat drop 9 orb", "no entry of the show fits this song"),
        ] {
            let (_folder, path) = file(text);
            let error = PreparedShow::of_song(&ShowSource::File(path), &song(), &[]).unwrap_err().to_string();
            assert!(error.contains(wanted), "{text}: {error}");
        }
        let (folder, path) = file("at start own.scene\nat section Z orb");
        let (_, reported) = PreparedShow::of_song(&ShowSource::File(path.clone()), &song(), &[]).unwrap();
        assert!(reported.unwrap().contains("the song has no section Z"));
        std::fs::write(&path, [b'a', 0xff]).unwrap();
        let refused =
            |path: PathBuf| PreparedShow::of_song(&ShowSource::File(path), &song(), &[]).unwrap_err();
        assert!(matches!(refused(path.clone()), ShowError::File { problem: TextError::NotText(1), .. }));
        std::fs::write(&path, vec![b'#'; show_limits::BYTES_MAX + 1]).unwrap();
        assert!(matches!(refused(path), ShowError::File { problem: TextError::TooLarge(_), .. }));
        assert!(matches!(
            refused(folder.path().join("none.show")),
            ShowError::File { problem: TextError::Unreadable(_), .. }
        ));
        // Reading a device or a pipe may never end.
        assert!(matches!(
            refused(PathBuf::from("/dev/zero")),
            ShowError::File { problem: TextError::Unreadable(_), .. }
        ));
    }

    #[test]
    fn the_director_passes_over_broken_scenes() {
        let broken = SceneSource::Formula("length(".to_owned());
        let good = SceneSource::Shipped("orb".to_owned());
        let (prepared_show, _) =
            PreparedShow::of_song(&ShowSource::Auto, &song(), &[broken, good.clone()]).unwrap();
        assert_eq!(prepared_show.sources(), [&good]);
    }
}
