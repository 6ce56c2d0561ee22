//! A plan with the scenes it needs: where they come from, and what is wrong with any of them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::director::{SceneCard, direct};
use super::parse::DIAGNOSTICS_MAX;
use super::plan::{Entrance, Moment, Plan, Stay};
use super::resolve::resolve;
use super::scene_facts::{NamedScenes, SceneFacts};
use super::script::Script;
use super::substitutes::with_substitutes;
use super::{parse, print};
use crate::limits::LIMITS;
use crate::scenes::{SceneBlend, SceneSource, SeenScene};
use mariana_field::lang::{Diagnostic, Sources, Way, render_all};
use mariana_field::world::BlendKind;
use mariana_music::SongStructure;

/// See [`ShowSource::Demo`].
const DEMO_SHOW: &str = include_str!("../../assets/demo.show");
const DEMO_NAME: &str = "demo.show";

/// Where a show comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ShowSource {
    /// The director's choice among scenes.
    Auto,
    /// The show that was made for the demo track.
    Demo,
    /// A file.
    File(PathBuf),
}

/// Why there is no show.
#[derive(Debug, thiserror::Error)]
pub enum ShowError {
    /// The file cannot be read.
    #[error("the show {} cannot be read ({reason}): check the path", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file is larger than shows may be.
    #[error("the show {} is larger than {max} bytes: make several shows of it", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        max: usize,
    },
    /// The file is not text.
    #[error("the show {} is not text: byte {position} is not UTF-8; save it as UTF-8", .path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// The first byte that is none.
        position: usize,
    },
    /// The text has mistakes, or asks for what the song does not have.
    #[error("the show has mistakes: correct what is underlined\n{}", .report.trim_end())]
    Mistakes {
        /// They with their places.
        report: String,
    },
    /// Every entry names a moment that the song lacks.
    #[error(
        "nothing of the show is in this song: give its first entry a moment that every song has, such as `at start`\n{}",
        .report.trim_end()
    )]
    NothingFits {
        /// The entries that are left out, with their places.
        report: String,
    },
    /// Every entry is a cue, but only a window has the key for cues.
    #[error(
        "every entry of the show waits for a key (`at cue`), which only a window has: write `at start` and a scene \
         above them"
    )]
    WaitsForKeys,
    /// The director has no scene without mistakes.
    #[error("there is no scene to show: name one without mistakes by --scene")]
    NoScenes,
}

/// How a scene likes to come and to go.
type Liked = (Option<Way>, Option<Way>);

/// See the module.
#[derive(Debug, Clone, Default)]
pub struct Programme {
    /// `None` as long as every entry waits for a key.
    plan: Option<Plan>,
    script: Script,
    scenes: BTreeMap<String, SceneSource>,
    /// How scenes like to come and to go.
    ways: BTreeMap<String, Liked>,
    cards: Vec<SceneCard>,
    author: Author,
}

/// Who chose the scenes of a show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Author {
    /// The user, in a show file or on the command line.
    #[default]
    User,
    /// The director.
    Director,
    /// The author of the demo track's show.
    Demo,
}

impl Programme {
    /// The same scenes by another plan.
    pub(super) fn with_plan(&self, plan: Option<Plan>) -> Self {
        Self { plan, ..self.clone() }
    }

    /// Whether the director made it.
    pub fn is_directed(&self) -> bool {
        self.author == Author::Director
    }

    /// True if the user chose the scenes.
    pub fn is_by_user(&self) -> bool {
        self.author == Author::User
    }

    /// Replaces the `refused` scenes. Returns `None` if every scene is refused, or if the user chose the scenes.
    pub fn without(&self, refused: &[SceneSource]) -> Option<Self> {
        if self.is_by_user() {
            return None;
        }
        let is_refused = |scene: &str| self.source(scene).is_some_and(|source| refused.contains(source));
        let stays = with_substitutes(self.stays(), &self.cards, is_refused)?;
        Some(self.with_plan(Plan::new(stays)))
    }

    /// Descriptions of the scenes; for the director, of all that it may choose.
    pub(super) fn cards(&self) -> &[SceneCard] {
        &self.cards
    }

    /// Scenes that are cut from one to the next at these moments, in seconds.
    pub fn of_cuts(scenes: impl IntoIterator<Item = (f64, SceneSource)>) -> Self {
        let mut programme = Self::default();
        let mut stays = Vec::new();
        for (start, source) in scenes {
            let scene = name_of(&source);
            programme.scenes.insert(scene.clone(), source);
            stays.push(Stay { start, scene, camera: None, entrance: Entrance::CUT, moves: Vec::new() });
        }
        programme.plan = Plan::new(stays);
        programme
    }

    /// The show of a song: from a file, or the director's choice among `scenes`. Scenes that are broken are no choice.
    ///
    /// # Errors
    /// [`ShowError`]; what the song does not have is no error but is told as text.
    pub fn of_song(
        source: &ShowSource,
        song: &SongStructure,
        scenes: &[SceneSource],
    ) -> Result<(Self, Option<String>), ShowError> {
        match source {
            ShowSource::Auto => Ok((Self::directed(song, scenes)?, None)),
            ShowSource::Demo => {
                let (programme, told) = Self::of_text(DEMO_NAME, DEMO_SHOW, Path::new(""), song)?;
                Ok((Self { author: Author::Demo, ..programme }, told))
            }
            ShowSource::File(path) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                Self::of_text(&path.display().to_string(), &read(path)?, folder, song)
            }
        }
    }

    fn directed(song: &SongStructure, scenes: &[SceneSource]) -> Result<Self, ShowError> {
        let mut known = BTreeMap::new();
        for source in scenes {
            match SceneFacts::of(source.clone()) {
                Ok(scene) => {
                    known.insert(name_of(source), scene);
                }
                Err(error) => tracing::warn!("not shown: {error}"),
            }
        }
        let cards = cards_of(&known);
        let script = direct(song, &cards, seed_of(song));
        let ways = ways_of(&known);
        let plan = resolved(&script, song, &[], &ways).0.ok_or(ShowError::NoScenes)?;
        let scenes = known.into_iter().map(|(name, scene)| (name, scene.source)).collect();
        Ok(Self { plan: Some(plan), script, scenes, ways, cards, author: Author::Director })
    }

    /// The show that a text describes for a song, and a report of the entries that do not fit the song. Scenes are shipped
    /// ones or files in `folder`. Messages call the text `name`.
    ///
    /// # Errors
    /// [`ShowError::Mistakes`] with all mistakes of the text and of its scenes, and [`ShowError::NothingFits`].
    pub fn of_text(
        name: &str,
        text: &str,
        folder: &Path,
        song: &SongStructure,
    ) -> Result<(Self, Option<String>), ShowError> {
        let parsed = parse(name, text);
        let named = NamedScenes::of(&parsed.entries, folder);
        let script = match parsed.script {
            Some(script) if named.mistakes.is_empty() => script,
            _ => {
                let mut mistakes = [parsed.diagnostics, named.mistakes].concat();
                mistakes.sort_by_key(|one| one.span.start);
                mistakes.truncate(DIAGNOSTICS_MAX);
                let of_text = render_all(&mistakes, &parsed.sources, false);
                let report = std::iter::once(of_text).chain(named.reports).collect::<Vec<_>>().join("\n");
                return Err(ShowError::Mistakes { report });
            }
        };
        let (ways, cards) = (ways_of(&named.facts), cards_of(&named.facts));
        let (plan, left_out) = resolved(&script, song, &[], &ways);
        let told = told(&left_out, &parsed.sources);
        if plan.is_none() && script.cues().next().is_none() {
            return Err(ShowError::NothingFits { report: told.unwrap_or_default() });
        }
        let scenes = named.facts.into_iter().map(|(name, scene)| (name, scene.source)).collect();
        Ok((Self { plan, script, scenes, ways, cards, author: Author::User }, told))
    }

    /// The same show where the key was pressed at these moments, in seconds, for which entries wait.
    pub fn with_cues(&self, song: &SongStructure, cues: &[f64]) -> Self {
        let (plan, _) = resolved(&self.script, song, cues, &self.ways);
        self.with_plan(plan)
    }

    /// The scenes that wait for a key, in their order.
    pub fn cues(&self) -> Vec<&str> {
        self.script.cues().map(|entry| entry.scene.as_str()).collect()
    }

    /// What is on when; `None` as long as every entry waits for a key.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// What is on at `time` seconds; `None` without a plan.
    pub fn at(&self, time: f64) -> Option<Moment<'_>> {
        self.plan().map(|plan| plan.at(time))
    }

    /// The stays in their order; none without a plan.
    pub fn stays(&self) -> &[Stay] {
        self.plan().map_or(&[], Plan::stays)
    }

    /// Where a scene of the plan comes from.
    pub fn source(&self, scene: &str) -> Option<&SceneSource> {
        self.scenes.get(scene)
    }

    /// One stay's scene on its way into another's, which follows it; none if either is not of this show.
    pub fn blend(&self, from: &Stay, to: &Stay, kind: BlendKind) -> Option<SceneBlend> {
        let seen = |stay: &Stay| {
            Some(SeenScene { source: self.source(&stay.scene)?.clone(), camera: stay.camera.clone() })
        };
        let aligned_at = (1000.0 * (to.start + 0.5 * to.entrance.seconds)).max(0.0) as u64;
        Some(SceneBlend { from: seen(from)?, to: seen(to)?, kind, aligned_at })
    }

    /// The scenes of the plan in the order in which they are on for the first time.
    pub fn sources(&self) -> Vec<&SceneSource> {
        let mut names: Vec<&str> = Vec::new();
        for stay in self.stays() {
            if !names.contains(&stay.scene.as_str()) {
                names.push(&stay.scene);
            }
        }
        names.into_iter().filter_map(|name| self.source(name)).collect()
    }

    /// The text of a show file that is this show, below lines of comment.
    pub fn text(&self, comments: &[String]) -> String {
        print(&self.script, comments)
    }
}

fn ways_of(known: &BTreeMap<String, SceneFacts>) -> BTreeMap<String, Liked> {
    known.iter().map(|(name, scene)| (name.clone(), scene.ways())).collect()
}

fn cards_of(known: &BTreeMap<String, SceneFacts>) -> Vec<SceneCard> {
    let card = |(name, scene): (&String, &SceneFacts)| SceneCard {
        scene: name.clone(),
        about: scene.about.clone(),
        cameras: scene.cameras.clone(),
    };
    known.iter().map(card).collect()
}

fn resolved(
    script: &Script,
    song: &SongStructure,
    cues: &[f64],
    ways: &BTreeMap<String, Liked>,
) -> (Option<Plan>, Vec<Diagnostic>) {
    resolve(script, song, cues, |from, to| {
        let liked = |name: &str| ways.get(name).copied().unwrap_or_default();
        liked(to).0.or(from.and_then(|from| liked(from).1))
    })
}

fn told(left_out: &[Diagnostic], sources: &Sources) -> Option<String> {
    (!left_out.is_empty()).then(|| render_all(left_out, sources, false))
}

/// What a show calls a scene.
pub fn name_of(source: &SceneSource) -> String {
    match source {
        SceneSource::Shipped(name) => name.clone(),
        SceneSource::File(path) => path.display().to_string(),
        SceneSource::Formula(text) => text.clone(),
        SceneSource::Blend(blend) => name_of(&blend.to.source),
    }
}

fn read(path: &Path) -> Result<String, ShowError> {
    let unreadable =
        |error: std::io::Error| ShowError::Unreadable { path: path.to_owned(), reason: error.to_string() };
    // Checked before it is opened, because opening a pipe waits for somebody who writes.
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        let reason = "it is no regular file".to_owned();
        return Err(ShowError::Unreadable { path: path.to_owned(), reason });
    }
    let max = LIMITS.show_bytes_max;
    let bytes = crate::scenes::read_at_most(path, max).map_err(unreadable)?;
    let bytes = bytes.ok_or_else(|| ShowError::TooLarge { path: path.to_owned(), max })?;
    String::from_utf8(bytes).map_err(|error| {
        let position = error.utf8_error().valid_up_to();
        ShowError::NotText { path: path.to_owned(), position }
    })
}

/// The seed of a song's show. It follows from the song's content, but not from anything that the arithmetic of another
/// machine might round in another way.
pub fn seed_of(song: &SongStructure) -> u64 {
    let whole = |number: f64| number.round() as u64;
    let key = song.key.map_or(99, |key| u64::from(key.root));
    let of_sections = song.sections.iter().flat_map(|section| {
        section.letter.bytes().map(u64::from).chain([whole(section.start), whole(section.end)])
    });
    let all = [whole(song.seconds), key, song.beats.len() as u64 / 8].into_iter().chain(of_sections);
    // FNV-1a, by words.
    all.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::resolve::testing::song;

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
    fn a_show_finds_its_scenes_beside_it_and_among_the_shipped_ones() {
        let (folder, path) = file("at start own.scene camera near\n set size = 0.5\nat bar 3 orb");
        let (programme, told) = Programme::of_song(&ShowSource::File(path), &song(), &[]).unwrap();
        assert_eq!(told, None);
        let sources: Vec<SceneSource> = programme.sources().into_iter().cloned().collect();
        assert_eq!(
            sources,
            [SceneSource::File(folder.path().join("own.scene")), SceneSource::Shipped("orb".to_owned())]
        );
        assert_eq!(programme.stays().len(), 2);
    }

    #[test]
    fn each_refusal_says_what_is_missing() {
        for (text, wanted) in [
            ("at start none.scene", "none.scene"),
            ("at start orbb", "orbb"),
            ("at start own.scene camera far", "its cameras are near"),
            ("at start bare.scene camera far", "no cameras with names"),
            ("at start own.scene\nset swell = 1", "its parameters are size"),
            ("at start own.scene flyy", "my.show:1:20"),
            ("at section Z orb\nat drop 9 orb", "nothing of the show is in this song"),
        ] {
            let (_folder, path) = file(text);
            let error = Programme::of_song(&ShowSource::File(path), &song(), &[]).unwrap_err().to_string();
            assert!(error.contains(wanted), "{text}: {error}");
        }
        let (folder, path) = file("at start own.scene\nat section Z orb");
        let (_, told) = Programme::of_song(&ShowSource::File(path.clone()), &song(), &[]).unwrap();
        assert!(told.unwrap().contains("the song has no section Z"));
        std::fs::write(&path, [b'a', 0xff]).unwrap();
        let refused = |path: PathBuf| Programme::of_song(&ShowSource::File(path), &song(), &[]).unwrap_err();
        assert!(matches!(refused(path.clone()), ShowError::NotText { position: 1, .. }));
        std::fs::write(&path, vec![b'#'; LIMITS.show_bytes_max + 1]).unwrap();
        assert!(matches!(refused(path), ShowError::TooLarge { .. }));
        assert!(matches!(refused(folder.path().join("none.show")), ShowError::Unreadable { .. }));
        // A device, and a pipe would be the same: reading one may never end.
        assert!(matches!(refused(PathBuf::from("/dev/zero")), ShowError::Unreadable { .. }));
    }

    #[test]
    fn the_director_passes_over_broken_scenes() {
        let broken = SceneSource::Formula("length(".to_owned());
        let good = SceneSource::Shipped("orb".to_owned());
        let (programme, _) = Programme::of_song(&ShowSource::Auto, &song(), &[broken, good.clone()]).unwrap();
        assert_eq!(programme.sources(), [&good]);
    }
}
