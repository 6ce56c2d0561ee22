//! The texts of the song as shapes: its title, its artist, and the line of the lyrics at a moment.
//!
//! A text is baked when it changes ([`TextBaker`]). Exports wait for it. The window ([`LiveSongShapes`]) bakes on a
//! thread, the next line ahead of its time, and never waits: the last text stays until the next one is baked. The tree
//! of a frame is built with the same distances that its shaders read.

mod live;

use std::sync::Arc;

pub use live::LiveSongShapes;

use crate::frame::Frame;
use mariana_field::graph::{ShapeAtlas, ShapeGrid};
use mariana_field::lang::{ShapeSource, SongText, TextBaker};
use mariana_field::world::World;
use mariana_player::lyrics::Lyrics;
use mariana_player::playlist::AUDIO_EXTENSIONS;

/// Number of baked texts that are kept.
const KEPT_MAX: usize = 24;
/// Number of atlases that are kept: of the shown scene and of a scene that fades out.
const ATLASES_MAX: usize = 4;

/// The texts of a song. Missing texts are empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SongTexts {
    /// The title.
    pub title: String,
    /// The name of the artist.
    pub artist: String,
    /// The lyrics.
    pub lyrics: Arc<Lyrics>,
}

impl SongTexts {
    /// Returns a text; `line` is the number of the line of the lyrics, from 0, if one is sung.
    pub fn text(&self, what: SongText, line: Option<usize>) -> &str {
        match what {
            SongText::Title => &self.title,
            SongText::Artist => &self.artist,
            SongText::Lyrics => line.and_then(|line| self.lyrics.line(line)).map_or("", |line| &line.words),
        }
    }
}

/// Returns the title that a scene shows: the song's own, or `name` without the extension of a sound file.
pub fn shown_title(title: Option<&str>, name: &str) -> String {
    let is_audio = |end: &str| AUDIO_EXTENSIONS.iter().any(|known| end.eq_ignore_ascii_case(known));
    let stem =
        name.rsplit_once('.').filter(|(stem, end)| !stem.is_empty() && is_audio(end)).map(|(stem, _)| stem);
    title.or(stem).unwrap_or(name).to_owned()
}

/// Returns the texts of the song that a world shows: the numbers of the shapes, what they show, and their bakers.
fn shown(world: &World) -> impl Iterator<Item = (usize, SongText, &Arc<dyn TextBaker>)> {
    world.scene.shapes.iter().enumerate().filter_map(|(number, shape)| match (&shape.source, &shape.baker) {
        (ShapeSource::Song { what, .. }, Some(baker)) => Some((number, *what, baker)),
        _ => None,
    })
}

/// True if a world shows a text of the song.
pub fn are_shown_by(world: &World) -> bool {
    shown(world).next().is_some()
}

/// Identifies a text in a font. The address stays that of the same baker while this exists.
#[derive(Debug, Clone)]
struct Key {
    baker: Arc<dyn TextBaker>,
    text: String,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && are_same(&self.baker, &other.baker)
    }
}

fn are_same(one: &Arc<dyn TextBaker>, other: &Arc<dyn TextBaker>) -> bool {
    std::ptr::addr_eq(Arc::as_ptr(one), Arc::as_ptr(other))
}

/// Baked texts, the last used one at the end.
#[derive(Debug, Default)]
struct Baked(Vec<(Key, ShapeGrid)>);

impl Baked {
    fn get(&mut self, key: &Key) -> Option<ShapeGrid> {
        let at = self.0.iter().position(|(known, _)| known == key)?;
        let found = self.0.remove(at);
        let grid = found.1.clone();
        self.0.push(found);
        Some(grid)
    }

    fn put(&mut self, key: Key, grid: ShapeGrid) {
        if self.0.len() >= KEPT_MAX {
            self.0.remove(0);
        }
        self.0.push((key, grid));
    }
}

/// The atlases of the last frames, so that a frame without a new text has the same atlas as the last one.
#[derive(Debug, Default)]
struct Atlases(Vec<Changed>);

/// An atlas in which the grids of some shapes, by their numbers, are replaced.
#[derive(Debug)]
struct Changed {
    from: ShapeAtlas,
    grids: Vec<(usize, ShapeGrid)>,
    atlas: ShapeAtlas,
}

impl Atlases {
    fn of(&mut self, base: &ShapeAtlas, changed: Vec<(usize, ShapeGrid)>) -> ShapeAtlas {
        if changed.is_empty() {
            return base.clone();
        }
        let same = |known: &[(usize, ShapeGrid)]| {
            known.len() == changed.len()
                && known
                    .iter()
                    .zip(&changed)
                    .all(|((a, one), (b, other))| a == b && one.values().as_ptr() == other.values().as_ptr())
        };
        if let Some(known) = self.0.iter().find(|known| known.from == *base && same(&known.grids)) {
            return known.atlas.clone();
        }
        let atlas = base.with(&changed);
        if self.0.len() >= ATLASES_MAX {
            self.0.remove(0);
        }
        self.0.push(Changed { from: base.clone(), grids: changed, atlas: atlas.clone() });
        atlas
    }
}

/// The texts of the song in stills and videos, which wait for them.
#[derive(Debug, Default)]
pub struct ExactSongShapes {
    baked: Baked,
    atlases: Atlases,
}

impl ExactSongShapes {
    /// Adds the texts at a line of the lyrics to a frame of a world.
    pub fn put_into(&mut self, frame: &mut Frame, world: &World, texts: &SongTexts, line: Option<usize>) {
        let mut changed = Vec::new();
        for (number, what, baker) in shown(world) {
            let key = Key { baker: baker.clone(), text: texts.text(what, line).to_owned() };
            if key.text.is_empty() {
                continue;
            }
            let grid = self.baked.get(&key).unwrap_or_else(|| {
                let grid = baker.bake(&key.text);
                self.baked.put(key, grid.clone());
                grid
            });
            changed.push((number, grid));
        }
        frame.inputs.shapes = self.atlases.of(&world.scene.atlas, changed);
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::scenes::SceneSource;
    use mariana_field::graph::{Interval, Point, SoundInput};
    use mariana_field::tape::{PointEvaluator, Tape};
    use mariana_music::Sound;

    const LYRICS: &str = "[00:01.00]First words\n[00:02.00]Second\n[00:03.00]\n[00:04.00]First words";

    fn world(formula: &str) -> Arc<World> {
        SceneSource::Formula(formula.to_owned()).ready().unwrap().world
    }

    fn texts() -> SongTexts {
        let lyrics = Arc::new(Lyrics::parse(LYRICS));
        SongTexts { title: "Deep".to_owned(), artist: "Mariana".to_owned(), lyrics }
    }

    fn frame(world: &World, line: Option<usize>) -> Frame {
        let mut frame = Frame::new(world, 1.0, Sound::default(), (8, 8));
        frame.inputs.sound[SoundInput::Line] = line.map_or(0.0, |line| line as f32 + 1.0);
        frame
    }

    /// Distances at some points, and whether the bounds of boxes hold them.
    fn distances(world: &World, frame: &Frame) -> Vec<f32> {
        let tape = Tape::new(&world.scene.graph, &[world.scene.distance]);
        let mut values = PointEvaluator::new(&tape, &frame.inputs);
        let points = (0..400).map(|at| ((at % 40) as f32 / 5.0 - 4.0, (at / 40) as f32 / 5.0 - 1.0));
        points
            .map(|(x, y)| {
                let value = values.at(&Point::at(x, y, 0.0))[0];
                let near = |at: f32| Interval::new(at - 0.1, at + 0.1);
                let (over, none) = ([near(x), near(y), near(0.0)], [Interval::point(0.0); 3]);
                let over = [over, none].as_flattened().try_into().unwrap();
                let bound = world.scene.graph.bounds(world.scene.distance, over, &frame.inputs);
                assert!(bound.contains(value), "{value} at {x}, {y}: {bound:?}");
                value
            })
            .collect()
    }

    #[test]
    fn each_moment_has_its_text_and_its_bounds() {
        let world = world("extrude(lyrics(p.xy), p.z, 0.2)");
        let mut exact = ExactSongShapes::default();
        let mut at = |line| {
            let mut frame = frame(&world, line);
            exact.put_into(&mut frame, &world, &texts(), line);
            (distances(&world, &frame), frame.inputs.shapes)
        };
        let (first, nothing, second, again) = (at(Some(0)), at(None), at(Some(1)), at(Some(2)));
        let solid =
            |(values, _): &(Vec<f32>, ShapeAtlas)| values.iter().filter(|value| **value < 0.0).count();
        assert!(solid(&first) > solid(&second) && solid(&second) > 0 && solid(&nothing) == 0);
        assert!(first.0 == again.0 && nothing.1 == world.scene.atlas);
        assert!(at(Some(2)).1 == again.1, "the same text is not joined again");
        let bounds = world.bounds.expect("any text is within its grid");
        assert!(bounds.high[0] < 9.0 && bounds.high[1] < 3.0, "{bounds:?}");
        assert!(!world.non_lipschitz && !are_shown_by(&self::world("length(p) - 1")));
    }

    #[test]
    fn the_window_shows_the_texts_of_stills() {
        let world = world("extrude(min(title(p.xy), lyrics(p.xy + vec2(0, 2))), p.z, 0.2)");
        let (woken, wakes) = std::sync::mpsc::channel();
        let mut live = LiveSongShapes::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let mut exact = ExactSongShapes::default();
        assert!(live.set_texts(texts()) && !live.set_texts(texts()));
        let mut before = None;
        for line in [Some(0), Some(1), None] {
            let mut wanted = frame(&world, line);
            exact.put_into(&mut wanted, &world, &texts(), line);
            let wanted = distances(&world, &wanted);
            let mut found = distances(&world, &live.in_frame(frame(&world, line), &world));
            while found != wanted {
                assert!(before.is_none() || line != Some(1), "the next line is baked ahead");
                wakes.recv_timeout(Duration::from_secs(120)).expect("a text is baked");
                live.has_new_texts();
                found = distances(&world, &live.in_frame(frame(&world, line), &world));
            }
            // Wait until the next line is baked.
            while line == Some(0) && wakes.recv_timeout(Duration::from_secs(2)).is_ok() {}
            before = Some(found);
        }
    }

    #[test]
    fn a_song_without_a_title_does_not_show_the_extension_of_its_file() {
        for (title, name, shown) in [
            (None, "sprint.ogg", "sprint"),
            (None, "Vol. 2.FLAC", "Vol. 2"),
            (None, "Mr. Moon", "Mr. Moon"),
            (None, ".wav", ".wav"),
            (Some("demo.mp3"), "a.ogg", "demo.mp3"),
        ] {
            assert_eq!(shown_title(title, name), shown);
        }
    }
}
