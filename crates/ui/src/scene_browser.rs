//! The state of the scene list: a thumbnail of each scene, a search by name, comment or mood, filters, and marks. The
//! overlay draws the list. Keys and the pointer change it. [`Thumbnails`] provides the images.
//!
//! The thumbnail under the pointer moves, or else the selected one. Loops are part of the program, because a slow
//! machine could not draw a second scene beside the show.

mod filters;

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use image::RgbaImage;
use mariana_commands::input::{Key, NamedKey};

use crate::text_query::TextQuery;
use mariana_commands::{Command, Panel};
use mariana_scenes::SceneSource;
use mariana_scenes::thumbnails::{About, Description, Looked, Thumbnails};

use filters::Filters;
pub use filters::{ENERGIES, SceneFilter};

/// A scene in the list.
#[derive(Debug, Clone)]
pub struct Tile {
    /// The scene's title.
    pub name: String,
    /// What the scene's text says about the scene.
    pub about: Description,
    /// The thumbnail.
    pub picture: TilePicture,
    /// True if the user has marked the scene.
    pub favourite: bool,
    source: SceneSource,
}

/// The state of a thumbnail.
#[derive(Debug, Clone)]
pub enum TilePicture {
    /// The thumbnail has not been requested yet.
    Unseen,
    /// The thumbnail is being loaded or rendered.
    Coming,
    /// The finished thumbnail.
    There(Arc<RgbaImage>),
    /// The reason why there is no thumbnail.
    Missing(String),
}

const CLOSE: Command = Command::TogglePanel(Panel::Scenes);

/// The scenes, the search text and the selection.
#[derive(Debug)]
pub struct SceneBrowser {
    tiles: Vec<Tile>,
    /// Indices of the tiles that match the search text, marked tiles first.
    found: Vec<usize>,
    query: TextQuery,
    /// Index in `found`.
    pub selected: usize,
    /// Index in `tiles` of the shown scene.
    present: Option<usize>,
    /// Number of tiles side by side at the last drawing.
    columns: usize,
    favourites: BTreeSet<String>,
    /// The filters by mood and energy.
    pub filters: Filters,
    moving: Option<Moving>,
    /// Scenes whose thumbnail or loop is to be requested.
    wanted: Vec<SceneSource>,
    wanted_motion: Option<SceneSource>,
    /// A number that grows whenever the list or the shown scene changes.
    pub revision: u64,
}

/// The tile that moves.
#[derive(Debug)]
struct Moving {
    source: SceneSource,
    /// Empty until the frames are there, and for a scene without a loop.
    frames: Vec<Arc<RgbaImage>>,
}

impl SceneBrowser {
    /// A list of `scenes`. `present` is the shown scene, and `favourites` are the titles of marked scenes.
    pub fn new(
        scenes: Vec<SceneSource>,
        present: Option<&SceneSource>,
        favourites: BTreeSet<String>,
    ) -> Self {
        let tile = |source: SceneSource| Tile {
            name: source.title(),
            about: Description::default(),
            picture: TilePicture::Unseen,
            favourite: favourites.contains(&source.title()),
            source,
        };
        let tiles: Vec<Tile> = scenes.into_iter().map(tile).collect();
        let mut browser = Self {
            found: Vec::new(),
            query: TextQuery::default(),
            selected: 0,
            present: None,
            columns: 1,
            favourites,
            filters: Filters::default(),
            moving: None,
            wanted: Vec::new(),
            wanted_motion: None,
            revision: 0,
            tiles,
        };
        browser.search();
        browser.set_present(present);
        browser.selected = browser.present.and_then(|at| browser.place_of(at)).unwrap_or(0);
        browser
    }

    /// Sets the shown scene.
    pub fn set_present(&mut self, present: Option<&SceneSource>) {
        let present = present.and_then(|source| self.tiles.iter().position(|tile| tile.source == *source));
        if present != self.present {
            self.present = present;
            self.revision += 1;
        }
    }

    /// The number of matching tiles.
    pub fn found(&self) -> usize {
        self.found.len()
    }

    /// The matching tile at an index.
    pub fn tile(&self, place: usize) -> Option<&Tile> {
        self.tiles.get(*self.found.get(place)?)
    }

    /// The number of all scenes.
    pub fn count(&self) -> usize {
        self.tiles.len()
    }

    /// The search text.
    pub fn query(&self) -> &str {
        self.query.text()
    }

    /// True if the matching tile at an index is the shown scene.
    pub fn is_present(&self, place: usize) -> bool {
        self.present.is_some() && self.found.get(place) == self.present.as_ref()
    }

    /// The frames of the moving thumbnail, if the matching tile at an index moves.
    pub fn frames(&self, place: usize) -> &[Arc<RgbaImage>] {
        let of = self.tile(place).map(|tile| &tile.source);
        let moving = self.moving.as_ref().filter(|moving| Some(&moving.source) == of);
        moving.map_or(&[], |moving| &moving.frames)
    }

    /// Records the drawn tiles, the number of tiles side by side, and the index of the tile that should move.
    pub fn record_drawn(&mut self, places: Range<usize>, columns: usize, moving: Option<usize>) {
        let source = moving.and_then(|place| self.tile(place)).map(|tile| &tile.source);
        if self.moving.as_ref().map(|moving| &moving.source) != source {
            let source = source.cloned();
            self.moving = source.clone().map(|source| Moving { source, frames: Vec::new() });
            self.wanted_motion = source;
        }
        self.columns = columns.max(1);
        for place in places {
            let Some(at) = self.found.get(place).copied() else { break };
            let Some(tile) = self.tiles.get_mut(at) else { continue };
            if matches!(tile.picture, TilePicture::Unseen) {
                tile.picture = TilePicture::Coming;
                self.wanted.push(tile.source.clone());
            }
        }
    }

    /// Requests the missing thumbnails of the drawn tiles.
    pub fn request_thumbnails(&mut self, thumbnails: &mut Thumbnails) {
        self.wanted_motion.take().into_iter().for_each(|source| thumbnails.request_motion(source));
        if !self.wanted.is_empty() {
            thumbnails.request_pictures(std::mem::take(&mut self.wanted));
        }
    }

    /// Requests the descriptions of all scenes.
    pub fn request_descriptions(&self, thumbnails: &mut Thumbnails) {
        thumbnails.request_descriptions(self.tiles.iter().map(|tile| &tile.source));
    }

    /// Stores descriptions and thumbnails that have been found.
    pub fn store(&mut self, found: Vec<Looked>) {
        let mut described = false;
        for Looked { source, about } in found {
            self.revision += 1;
            if let About::Motion(frames) = about {
                let moving = self.moving.as_mut().filter(|moving| moving.source == source);
                moving.into_iter().for_each(|moving| moving.frames.clone_from(&frames));
                continue;
            }
            let Some(tile) = self.tiles.iter_mut().find(|tile| tile.source == source) else { continue };
            match about {
                About::Description(about) => {
                    tile.about = about;
                    described = true;
                }
                About::Motion(_) => {}
                About::Picture(image, _) => tile.picture = TilePicture::There(image),
                About::NoPicture(reason) => tile.picture = TilePicture::Missing(reason),
            }
        }
        if described {
            self.filters.offer_moods(self.tiles.iter().map(|tile| &tile.about));
        }
        if described && (!self.query().is_empty() || self.filters.are_any()) {
            self.search_again();
        }
    }

    /// Handles a key and returns its commands; `command` is true while Ctrl or Command is held. Letters search, arrows
    /// select, Enter shows, and Tab marks. Ctrl with M or E chooses the next mood or energy. Escape clears the search
    /// text, then the filters, and then closes the list.
    pub fn handle_key(&mut self, key: &Key, command: bool) -> Vec<Command> {
        match key {
            Key::Named(NamedKey::Escape) if self.query().is_empty() => {
                if !self.filters.clear() {
                    return vec![CLOSE];
                }
                self.search_again();
            }
            Key::Character(letter) if command && matches!(letter.as_str(), "m" | "e") => {
                self.filters.step(letter == "m");
                self.search_again();
            }
            Key::Named(NamedKey::Enter) => return self.show(self.selected, true),
            Key::Named(NamedKey::Tab) => return self.mark(self.selected),
            Key::Named(NamedKey::ArrowLeft) => self.select(self.selected.saturating_sub(1)),
            Key::Named(NamedKey::ArrowRight) => self.select(self.selected + 1),
            Key::Named(NamedKey::ArrowUp) => self.select(self.selected.saturating_sub(self.columns)),
            Key::Named(NamedKey::ArrowDown) => self.select(self.selected + self.columns),
            Key::Named(NamedKey::Home) => self.select(0),
            Key::Named(NamedKey::End) => self.select(usize::MAX),
            key => {
                if self.query.handle_key(key, command) {
                    self.search();
                    self.selected = 0;
                }
            }
        }
        Vec::new()
    }

    /// Shows the matching scene at an index.
    pub fn show(&mut self, place: usize, close: bool) -> Vec<Command> {
        self.select(place);
        let show = self.tile(place).map(|tile| Command::ShowScene(Box::new(tile.source.clone())));
        let close = show.is_some().then_some(CLOSE).filter(|_| close);
        show.into_iter().chain(close).collect()
    }

    /// Shows only scenes that match a filter, or ends the filter if it is on.
    pub fn filter(&mut self, filter: SceneFilter) {
        self.filters.toggle(filter);
        self.search_again();
    }

    /// Toggles the mark of the matching scene at an index.
    pub fn mark(&mut self, place: usize) -> Vec<Command> {
        let Some(at) = self.found.get(place).copied() else { return Vec::new() };
        let Some(tile) = self.tiles.get_mut(at) else { return Vec::new() };
        tile.favourite = !tile.favourite;
        let name = tile.name.clone();
        if tile.favourite {
            self.favourites.insert(name);
        } else {
            self.favourites.remove(&name);
        }
        self.search();
        self.selected = self.place_of(at).unwrap_or(0);
        vec![Command::MarkScenes(self.favourites.clone())]
    }

    fn select(&mut self, place: usize) {
        self.selected = place.min(self.found.len().saturating_sub(1));
    }

    /// Searches and keeps the selected tile selected, if it still matches.
    fn search_again(&mut self) {
        let selected = self.found.get(self.selected).copied();
        self.search();
        self.selected = selected.and_then(|at| self.place_of(at)).unwrap_or(0);
    }

    /// Finds the tiles that match the filters and contain every word of the search text. Names that begin with the search text come first,
    /// then marked scenes.
    fn search(&mut self) {
        let words =
            |tile: &Tile| format!("{} {} {}", tile.name, tile.about.comment, tile.about.moods.join(" "));
        let matches = |tile: &Tile| self.filters.fit(&tile.about) && self.query.fits(&words(tile));
        let mut found: Vec<usize> =
            self.tiles.iter().enumerate().filter(|(_, tile)| matches(tile)).map(|(at, _)| at).collect();
        let rank =
            |at: &usize| self.tiles.get(*at).map(|tile| (!self.query.begins(&tile.name), !tile.favourite));
        found.sort_by_key(rank);
        self.found = found;
        self.revision += 1;
    }

    fn place_of(&self, tile: usize) -> Option<usize> {
        self.found.iter().position(|at| *at == tile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn browser(names: &[&str]) -> SceneBrowser {
        let scenes: Vec<_> = names.iter().map(|name| SceneSource::Shipped((*name).to_owned())).collect();
        SceneBrowser::new(scenes.clone(), scenes.get(1), BTreeSet::new())
    }

    fn names(browser: &SceneBrowser) -> Vec<&str> {
        (0..browser.found()).filter_map(|at| browser.tile(at)).map(|tile| tile.name.as_str()).collect()
    }

    fn typed(browser: &mut SceneBrowser, text: &str) {
        for letter in text.chars() {
            assert_eq!(browser.handle_key(&Key::Character(letter.to_string()), false), []);
        }
    }

    #[test]
    fn scenes_are_found_by_typing_and_shown_by_enter() {
        let mut browser = browser(&["barth", "city", "clockwork", "speakers", "quick"]);
        assert_eq!((browser.selected, browser.is_present(1)), (1, true));
        typed(&mut browser, "C");
        assert_eq!(names(&browser), ["city", "clockwork", "quick"], "names that begin with it come first");
        typed(&mut browser, "LO");
        assert_eq!(names(&browser), ["clockwork"]);
        let shown = browser.handle_key(&Key::Named(NamedKey::Enter), false);
        let source = SceneSource::Shipped("clockwork".into());
        assert_eq!(shown, [Command::ShowScene(Box::new(source)), CLOSE]);
        typed(&mut browser, "zz");
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Enter), false), []);
        let _ = browser.handle_key(&Key::Named(NamedKey::Backspace), false);
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Escape), false), []);
        assert_eq!((browser.query(), names(&browser).len()), ("", 5));
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Escape), false), [CLOSE]);
        assert_eq!(browser.handle_key(&Key::Character("c".into()), true), []);
        assert_eq!(browser.query(), "");
    }

    #[test]
    fn arrows_move_by_rows_and_stop_at_the_ends() {
        let mut browser = browser(&["a", "b", "c", "d", "e"]);
        browser.columns = 3;
        let mut go = |key| {
            let _ = browser.handle_key(&Key::Named(key), false);
            browser.selected
        };
        assert_eq!(go(NamedKey::ArrowDown), 4);
        assert_eq!(go(NamedKey::ArrowDown), 4);
        assert_eq!(go(NamedKey::ArrowUp), 1);
        assert_eq!([go(NamedKey::ArrowLeft), go(NamedKey::ArrowLeft)], [0, 0]);
        assert_eq!([go(NamedKey::End), go(NamedKey::ArrowRight), go(NamedKey::Home)], [4, 4, 0]);
    }

    #[test]
    fn marked_scenes_come_first_and_the_selection_stays_with_its_scene() {
        let mut browser = browser(&["a", "b", "c"]);
        let _ = browser.handle_key(&Key::Named(NamedKey::End), false);
        let marked = Command::MarkScenes(["c".to_owned()].into());
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Tab), false), [marked]);
        assert_eq!((names(&browser), browser.selected), (vec!["c", "a", "b"], 0));
        assert!(browser.is_present(2));
        assert_eq!(browser.mark(0), [Command::MarkScenes(BTreeSet::new())]);
        assert_eq!((names(&browser), browser.selected), (vec!["a", "b", "c"], 2));
    }

    fn described(names: &[(&str, &[&str], (f32, f32))]) -> SceneBrowser {
        let mut browser = browser(&names.iter().map(|(name, ..)| *name).collect::<Vec<_>>());
        let looked = |(name, moods, energy): &(&str, &[&str], (f32, f32))| Looked {
            source: SceneSource::Shipped((*name).to_owned()),
            about: About::Description(Description {
                comment: String::new(),
                moods: moods.iter().map(|mood| (*mood).to_owned()).collect(),
                energy: Some(*energy),
            }),
        };
        browser.store(names.iter().map(looked).collect());
        browser
    }

    #[test]
    fn moods_and_energy_filter_by_keys_and_pointer() {
        let mut browser = described(&[
            ("sea", &["calm", "wet"], (0.0, 0.4)),
            ("city", &["night", "wet"], (0.5, 0.9)),
            ("moon", &["calm", "night"], (0.0, 0.4)),
            ("fire", &["wild"], (0.7, 1.0)),
        ]);
        assert_eq!(browser.filters.moods, ["calm", "night", "wet"], "moods of one scene are left out");
        let press = |browser: &mut SceneBrowser, letter: &str| {
            assert_eq!(browser.handle_key(&Key::Character(letter.to_owned()), true), []);
        };
        press(&mut browser, "m");
        assert_eq!(names(&browser), ["sea", "moon"]);
        press(&mut browser, "m");
        assert_eq!((names(&browser), browser.query()), (vec!["city", "moon"], ""));
        browser.filter(SceneFilter::Energy(2));
        assert_eq!(names(&browser), ["city"]);
        browser.filter(SceneFilter::Mood(1));
        assert_eq!(names(&browser), ["city", "fire"]);
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Escape), false), []);
        assert_eq!(names(&browser).len(), 4);
        for _ in 0..4 {
            press(&mut browser, "e");
        }
        assert!(!browser.filters.are_any(), "after the last energy come all scenes");
        assert_eq!(browser.handle_key(&Key::Named(NamedKey::Escape), false), [CLOSE]);
        typed(&mut browser, "wild");
        assert_eq!(names(&browser), ["fire"], "moods are found by typing");
    }

    #[test]
    fn only_the_tile_that_was_asked_for_moves() {
        let mut browser = browser(&["a", "b"]);
        let folders = mariana_files::Folders::within(std::path::Path::new("no such folder"));
        let mut thumbnails = Thumbnails::start(&folders, || {}).unwrap();
        let frames = |count: usize| (0..count).map(|_| Arc::new(RgbaImage::new(2, 2))).collect();
        let moved = |name: &str, count| Looked {
            source: SceneSource::Shipped(name.to_owned()),
            about: About::Motion(frames(count)),
        };
        browser.record_drawn(0..2, 2, Some(1));
        browser.request_thumbnails(&mut thumbnails);
        browser.store(vec![moved("b", 5), moved("a", 3)]);
        assert_eq!([0, 1, 2].map(|place| browser.frames(place).len()), [0, 5, 0]);
        browser.record_drawn(0..2, 2, None);
        assert!(browser.frames(1).is_empty());
    }

    #[test]
    fn an_empty_list_ignores_keys() {
        let mut browser = browser(&[]);
        for key in [NamedKey::Enter, NamedKey::Tab, NamedKey::ArrowDown, NamedKey::End] {
            assert_eq!(browser.handle_key(&Key::Named(key), false), []);
        }
    }
}
