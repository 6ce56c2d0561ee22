//! Tests of the session in a context without a window: requested scenes and messages.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use mariana_field::graph::Screen;
use mariana_music::{Features, Section, SongStructure};
use mariana_player::Moment;
use mariana_testing::process::wait_until;

use super::performed::Performed;
use super::program_task::{ProgramOf, Task};
use super::report;
use super::testing::loader;
use super::{
    DrawingChoice, DrawingWays, LoadedScene, SceneLoader, SceneLoaders, SceneSession, WantedPicture,
};
use crate::config::SdfChoice;
use crate::frame::projection::Projection;
use crate::gpu::background::ProgramProduct;
use crate::gpu::{CellUse, Counting, EdgeSamples, GpuError, Headless, Renderer, ShaderLibrary, Sources};
use crate::scenes::SceneSource;
use crate::show::{PreparedShow, ShowSource};
use crate::ui::overlay::PanelSwitches;

/// Names of scenes, and the energies that they are made for.
const SCENES: [(&str, &str); 3] = [("calm", "0 .. 0.3"), ("loud", "0.7 .. 1"), ("other", "0.5 .. 0.8")];
const CALM: f64 = 5.0;
const LOUD: f64 = 45.0;

struct Staged {
    session: SceneSession,
    folder: tempfile::TempDir,
    // Last, because the session draws in it.
    context: Headless,
}

fn source(folder: &Path, name: &str) -> SceneSource {
    SceneSource::File(folder.join(format!("{name}.scene")))
}

fn at(song_time: f64) -> Moment {
    Moment { song_time, track: 1, ..Moment::default() }
}

impl Staged {
    fn new() -> Self {
        Self::with(None, 0.0)
    }

    fn with(ahead: Option<[SceneLoader; 2]>, fade: f64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (number, (name, energy)) in SCENES.iter().enumerate() {
            let text =
                format!("about {{ energy = {energy} }}\nobject ball {{ shape = sphere(p, 1.{number}) }}");
            fs::write(folder.path().join(format!("{name}.scene")), text).unwrap();
        }
        let section = |letter: &str, start, energy| Section {
            start,
            end: start + 30.0,
            letter: letter.to_owned(),
            energy,
        };
        let sections = vec![section("A", 0.0, 0.15), section("B", 30.0, 0.9)];
        let song = SongStructure { seconds: 60.0, sections, ..SongStructure::default() };
        let sources = SCENES.map(|(name, _)| source(folder.path(), name));
        let (show, _) = PreparedShow::of_song(&ShowSource::Auto, &song, &sources).unwrap();
        let on = |time: f64| show.source(&show.at(time).unwrap().clip.scene).cloned();
        assert_eq!([on(CALM), on(LOUD)], [0, 1].map(|place| sources.get(place).cloned()));

        let context = Headless::new(false).unwrap();
        let shown = loader();
        let [first, ..] = sources;
        shown.request(first);
        let mut loaded = None;
        wait_until("the first scene", || {
            loaded = shown.poll();
            loaded.is_some()
        });
        let loaded = loaded.unwrap();
        let first = LoadedScene { source: loaded.source, scene: loaded.value.unwrap() };
        let sources = Sources { library: ShaderLibrary::embedded(), cache: Arc::new(()) };
        let choice = DrawingChoice { sdf: SdfChoice::Compiled, cells: CellUse::Never };
        let ways = DrawingWays { choice, view: None, projection: Projection::default(), fade };
        let loaders = SceneLoaders { shown, ahead };
        let session =
            SceneSession::new(context.gl(), Vec::new(), sources, ways, loaders, first, || {}).unwrap();
        let mut staged = Self { session, folder, context };
        staged.wait_for("calm");
        staged.session.show.set_prepared_show(Some(Arc::new(show)), None);
        staged.session.follow(CALM);
        staged
    }

    fn source(&self, name: &str) -> SceneSource {
        source(self.folder.path(), name)
    }

    fn wait_for(&mut self, name: &str) {
        let session = &mut self.session;
        wait_until(name, || {
            session.update().unwrap();
            session.scenes.name().as_deref() == Some(name)
        });
        self.draws(true);
    }

    /// Pretends that a frame of the shown scene has been drawn, or has not been drawn.
    fn draws(&mut self, drawn: bool) {
        let pictures = &mut self.session.composer.pictures;
        pictures.finish(self.session.scenes.shown_id().unwrap_or_default(), Duration::ZERO);
        pictures.scene = pictures.scene.filter(|_| drawn);
    }

    fn draw(&mut self, renderer: &mut Renderer, song_time: f64) {
        let mut drawn = None;
        wait_until("a frame", || {
            let moment = at(song_time);
            let (sound, size, edges) = (Features::SILENCE.into(), (32, 18), EdgeSamples::Four);
            let (aspect, screen) = (16.0 / 9.0, Screen::of_size(size));
            let picture = WantedPicture {
                moment,
                sound,
                earlier: &|_| Features::SILENCE.into(),
                size,
                aspect,
                screen,
                quality: 1.0,
                edges,
                runs: true,
            };
            self.session.update().unwrap();
            drawn = self.session.draw(renderer, picture).unwrap();
            drawn.is_some()
        });
        assert_eq!(drawn.map(|drawn| drawn.shown.moment.song_time), Some(song_time));
    }

    fn words(&mut self) -> Vec<String> {
        let content = self.session.content(None, PanelSwitches::default());
        let notice = content.notice.map(|notice| notice.text);
        let problem = content.problem.map(|problem| problem.heading);
        content.hint.into_iter().chain(notice).chain(problem).map(str::to_owned).collect()
    }
}

#[test]
fn a_show_without_user_input_shows_no_messages() {
    let mut staged = Staged::new();
    staged.session.follow(LOUD);
    assert_eq!(
        (staged.session.preparation.library.wanted.clone(), staged.words()),
        (staged.source("loud"), Vec::new())
    );
    staged.wait_for("loud");
    assert_eq!(staged.words(), [""; 0]);
    let other = staged.source("other");
    staged.session.show_source(other);
    assert_eq!(staged.words(), ["other is being prepared"]);
}

#[test]
fn a_show_silently_replaces_a_scene_that_is_too_slow() {
    let mut staged = Staged::new();
    staged.session.follow(LOUD);
    staged.wait_for("loud");
    // The first frame of the loud scene is too expensive, so the calm scene returns.
    staged.draws(false);
    let before = staged.source("calm");
    staged.session.withdraw("a frame of this window would take about 99 s");
    assert_eq!(staged.words(), [""; 0]);
    assert_eq!(staged.session.scenes.shown_source(), Some(&before));
    staged.session.follow(LOUD + 0.1);
    staged.wait_for("other");
    assert_eq!(staged.words(), [""; 0]);
    let line = report::line(&staged.session, "", &"").unwrap();
    assert!(line.ends_with("too much for this machine: loud"), "{line}");
    let loud = staged.source("loud");
    staged.session.show_source(loud);
    staged.wait_for("loud");
    staged.session.withdraw("a frame of this window would take about 99 s");
    let words = staged.words();
    assert!(words.iter().any(|words| words.contains("loud is too much for this machine")), "{words:?}");
}

#[test]
fn a_scene_requested_by_the_user_is_kept_when_the_shows_next_scene_is_due() {
    let mut staged = Staged::new();
    let other = staged.source("other");
    staged.session.show_source(other.clone());
    // The next scene of the show is due while this scene is being prepared.
    staged.session.follow(LOUD);
    assert_eq!(staged.session.preparation.library.wanted, other);
    staged.wait_for("other");
    staged.session.follow(LOUD + 1.0);
    assert_eq!(
        staged.session.preparation.library.wanted, other,
        "the user's scene stays until the next scene of the show"
    );
    staged.session.follow(CALM);
    assert_eq!(staged.session.preparation.library.wanted, staged.source("calm"));
}

#[test]
fn a_text_with_mistakes_keeps_the_last_good_scene_and_shows_a_message_until_fixed() {
    let mut staged = Staged::new();
    let other = staged.folder.path().join("other.scene");
    fs::write(&other, "object ball { shape = sphere(p }").unwrap();
    staged.session.show_source(staged.source("other"));
    let heading = "other has mistakes; the last good scene stays";
    wait_until(heading, || {
        staged.session.update().unwrap();
        staged.words() == [heading]
    });
    assert_eq!(staged.session.scenes.name().as_deref(), Some("calm"));
    fs::write(&other, "object ball { shape = sphere(p, 2) }").unwrap();
    staged.wait_for("other");
    assert!(!staged.words().contains(&heading.to_owned()), "{:?}", staged.words());
}

#[test]
fn a_file_with_warnings_is_shown_with_the_first_one() {
    let mut staged = Staged::new();
    let text = "let lost = 1\nobject ball { shape = sphere(p, 2) }";
    fs::write(staged.folder.path().join("other.scene"), text).unwrap();
    staged.session.show_source(staged.source("other"));
    staged.wait_for("other");
    let notice = "other: the value `lost` is never used (E shows it in the text)";
    assert!(staged.words().contains(&notice.to_owned()), "{:?}", staged.words());
}

#[test]
fn a_fade_by_the_user_follows_the_songs_time_and_shows_both_scenes() {
    let mut staged = Staged::with(None, 2.0);
    let mut renderer = Renderer::new(staged.context.gl(), &ShaderLibrary::embedded(), Counting::Off).unwrap();
    staged.draw(&mut renderer, 10.0);
    let calm = staged.session.scenes.shown_id();
    staged.session.show_source(staged.source("other"));
    wait_until("the other scene", || {
        staged.session.update().unwrap();
        staged.session.scenes.shown_id() != calm
    });
    for (time, fraction) in [(10.25, 1.0), (11.249, 0.5), (11.249, 0.5), (10.749, 0.75)] {
        staged.draw(&mut renderer, time);
        let found = staged.session.composer.fading.fraction_of_scene(&at(time)).unwrap();
        assert!((found - fraction).abs() < 0.001, "{found} at {time}");
        assert_eq!(staged.session.scenes.fading_out.as_ref().map(|scene| scene.id), calm);
        let performed = Performed::of(&staged.session, time).unwrap();
        assert_eq!((performed.faded, performed.fades), (Some((2.0, 10.249)), true));
    }
    // The fade has ended, and the outgoing scene is dropped.
    staged.draw(&mut renderer, 12.5);
    assert!(!staged.session.composer.fading.goes_on());
    staged.draw(&mut renderer, 12.6);
    assert!(staged.session.scenes.fading_out.is_none());
}

#[test]
fn neighbours_are_prepared_after_the_scene_the_next_one_first() {
    let mut staged = Staged::with(Some([loader(), loader()]), 0.0);
    let mut renderer = Renderer::new(staged.context.gl(), &ShaderLibrary::embedded(), Counting::Off).unwrap();
    // Without a show, the neighbours are the neighbouring files in the folder.
    staged.session.show.set_prepared_show(None, None);
    staged.session.show_source(staged.source("loud"));
    staged.wait_for("loud");
    staged.draw(&mut renderer, 1.0);
    let mut order = Vec::new();
    wait_until("both neighbours", || {
        staged.session.update().unwrap();
        staged.session.rehearse(&mut renderer);
        for scene in staged.session.scenes.ahead.rehearsed() {
            if !order.contains(&scene.title()) {
                order.push(scene.title());
            }
        }
        order.len() == 2
    });
    assert_eq!(order, ["other", "calm"]);
    // A change to a neighbour needs no loader and no compiler.
    staged.session.step_scene(true);
    assert_eq!(staged.session.scenes.name().as_deref(), Some("other"));
}

#[test]
fn a_driver_that_rejects_paths_ends_the_refinement_with_a_message() {
    let mut staged = Staged::new();
    assert!(
        staged.session.toggle_refinement() && !staged.session.can_refine(),
        "the program is still to come"
    );
    let rejected = GpuError::Compile { name: "path.frag".to_owned(), log: "no paths".to_owned() };
    let task = Task { product: ProgramProduct::Paths, of: ProgramOf::Compiled(0), has_cells: false };
    staged.session.receive_special(task, Err(rejected));
    let words = staged.words();
    assert!(words.iter().any(|words| words == "this driver cannot draw paths of light"), "{words:?}");
    wait_until("the program that was requested", || {
        staged.session.update().unwrap();
        staged.session.is_complete()
    });
    assert!(!staged.session.can_refine(), "the picture is refined after a failure");
    assert!(staged.session.toggle_refinement() && staged.session.can_refine(), "a key tries again");
}
