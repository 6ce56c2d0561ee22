//! Tests of the file list and the track list.

use image::RgbaImage;

use super::super::{Cover, Welcome};
use super::*;
use crate::file_browser::tests::open;
use crate::file_browser::{FileBrowser, RememberedFolders};
use mariana_commands::Files;
use mariana_commands::input::{Key, Modifiers as Held, NamedKey};
use mariana_testing::wave::write_tagged_wav;

const SIZES: [Vec2; 4] = [SCREEN, Vec2::new(640.0, 360.0), Vec2::new(2560.0, 1440.0), Vec2::new(60.0, 40.0)];

fn song(folder: &Path, name: &str, title: &str, artist: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    let tags = [("TIT2", title), ("TPE1", artist)];
    write_tagged_wav(&path, 8_000, 1, std::iter::repeat_n(0.0, 8_000 * 65), &tags);
    path
}

fn library(files: &[std::path::PathBuf]) -> TagLibrary {
    let (wake, woken) = channel();
    let library = TagLibrary::start(None, move || wake.send(()).unwrap_or_default()).unwrap();
    let entry =
        |file: &std::path::PathBuf| ListedTrack { file: Some(file.clone()), ..ListedTrack::default() };
    let entries = files.iter().map(entry).collect();
    library.follow_list(&Arc::new(ListedTracks { revision: 1, entries, undo: None }));
    while files.iter().any(|file| library.get(file).is_none()) || library.totals().seconds == 0.0 {
        woken.recv_timeout(Duration::from_secs(60)).expect("the tags are read");
    }
    library
}

fn texts(stage: &mut Stage, content: &dyn Fn() -> OverlayContent<'static>) -> (LaidOut, Vec<(String, Rect)>) {
    stage.frame(Vec::new(), content());
    let laid_out = stage.frame(Vec::new(), content());
    let (_, texts) = drawn(&laid_out);
    (laid_out, texts)
}

fn on_files(acts: Acts, files: &mut FileBrowser) -> Vec<Command> {
    let act = |act| match act {
        PanelAct::Files(act) => act(files),
        _ => panic!("an act on another panel"),
    };
    acts.on_panels.into_iter().flat_map(act).chain(acts.commands).collect()
}

fn shows(texts: &[(String, Rect)], wanted: &str) -> bool {
    texts.iter().any(|(text, rect)| text.contains(wanted) && rect.area() > 20.0)
}

#[test]
fn the_file_list_shows_tags_and_fits_into_every_window() {
    let folder = tempfile::tempdir().unwrap();
    let path = song(folder.path(), "01 long name of a file.wav", "Ebb 夜 🎵", "The Tide");
    fs::create_dir(folder.path().join("album")).unwrap();
    let tags = library(std::slice::from_ref(&path));
    let here = Some(folder.path().to_owned());
    let mut browser = FileBrowser::start(here, RememberedFolders::default(), tags, || {});
    crate::file_browser::tests::read(&mut browser);
    let content = super::open(OpenPanel::Files(browser));
    for screen in SIZES {
        let mut stage = Stage::new(screen);
        let (laid_out, texts) = texts(&mut stage, &content);
        if screen.y < 100.0 {
            continue;
        }
        let panel = laid_out.panels[0];
        assert!(stage.screen.contains_rect(panel), "{screen:?}: {panel:?}");
        assert!(stage.screen.contains_rect(drawn(&laid_out).0), "{screen:?}");
        assert!(panel.height() > 0.9 * screen.y - 30.0, "{screen:?}: the list is only {panel:?}");
        for wanted in ["Ebb 夜 🎵 · The Tide", "1:05", "album", "Home", "play this folder", "add this folder"]
        {
            assert!(shows(&texts, wanted), "{screen:?}: no {wanted} in {texts:?}");
        }
        assert_eq!(shows(&texts, "01 long"), screen.x > 700.0, "{screen:?}");
        // The visible files are read first.
        let mut own = open(folder.path());
        own.tags = TagLibrary::start(None, || {}).unwrap();
        assert_eq!(on_files(laid_out.acts, &mut own), []);
        wait_until("the visible tags are read", || own.tags.get(&path).is_some());
    }
}

#[test]
fn the_pointer_opens_adds_and_plays_entries_of_the_file_list() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("album")).unwrap();
    fs::write(folder.path().join("x.ogg"), "x").unwrap();
    let content = super::open(OpenPanel::Files(open(folder.path())));
    let mut stage = Stage::new(SCREEN);
    let (laid_out, texts) = texts(&mut stage, &content);
    let mut pressed = |place: Pos2| -> (Vec<Command>, std::path::PathBuf) {
        stage.seconds += 2.0;
        let mut own = open(folder.path());
        let commands = on_files(acts(&mut stage, place, content), &mut own);
        (commands, own.folder)
    };
    let (album, right) = (place_of(&texts, "album").center(), laid_out.panels[0].right() - style::PADDING.x);
    let here = || folder.path().to_owned();
    let plays = |path: std::path::PathBuf, append: bool| {
        let open = Command::Open(Files { files: vec![path], append });
        let close = (!append).then_some(Command::TogglePanel(Panel::Files));
        (std::iter::once(open).chain(close).collect(), here())
    };
    assert_eq!(pressed(album), (vec![], here().join("album")));
    let song = place_of(&texts, "x.ogg").center();
    assert_eq!(pressed(song), plays(here().join("x.ogg"), false));
    assert_eq!(pressed(Pos2::new(right - 22.0, song.y)), plays(here().join("x.ogg"), true));
    assert_eq!(pressed(Pos2::new(right - 46.0, album.y)), plays(here().join("album"), false));
    let play = place_of(&texts, "play this folder").center();
    assert_eq!(pressed(play), plays(here(), false));
    let add = place_of(&texts, "add this folder to the tracks").center();
    assert_eq!(pressed(add), plays(here(), true));
    let home = place_of(&texts, "Home").center();
    assert_ne!(pressed(home).1, here());
}

fn tracks(files: &[std::path::PathBuf], tags: TagLibrary) -> TrackPanel {
    let entry = |file: &std::path::PathBuf| ListedTrack {
        name: file.file_name().unwrap().to_string_lossy().into_owned(),
        file: Some(file.clone()),
        ..ListedTrack::default()
    };
    let undo = Some("remove x.wav".into());
    TrackPanel::new(
        Arc::new(ListedTracks { revision: 1, entries: files.iter().map(entry).collect(), undo }),
        1,
        tags,
    )
}

#[test]
fn the_track_list_shows_titles_artists_and_the_total_length() {
    let folder = tempfile::tempdir().unwrap();
    let files =
        [song(folder.path(), "a.wav", "ليل", "فنان"), song(folder.path(), "b.wav", "Ebb", "The Tide")];
    let content = super::open(OpenPanel::Tracks(tracks(&files, library(&files))));
    for screen in SIZES {
        let mut stage = Stage::new(screen);
        let (laid_out, texts) = texts(&mut stage, &content);
        if screen.y < 100.0 {
            continue;
        }
        assert!(stage.screen.contains_rect(drawn(&laid_out).0), "{screen:?}");
        let all = ["Ebb", "The Tide", "1:05", "2 tracks · 2:10", "undo: remove x.wav", "clear", "add music"];
        for wanted in all {
            assert!(shows(&texts, wanted), "{screen:?}: no {wanted} in {texts:?}");
        }
        // The visible files are read first.
        let tags = TagLibrary::start(None, || {}).unwrap();
        let mut own = tracks(&files, tags.clone());
        for act in laid_out.acts.on_panels {
            let PanelAct::Tracks(act) = act else { panic!("an act on another panel") };
            assert_eq!(act(&mut own), []);
        }
        wait_until("the visible tags are read", || files.iter().all(|file| tags.get(file).is_some()));
        let clear = place_of(&texts, "clear").center();
        assert_eq!(commands(&mut stage, clear, content), [Command::ClearTracks], "{screen:?} {clear:?}");
        let undo = place_of(&texts, "undo: remove x.wav").center();
        assert_eq!(commands(&mut stage, undo, content), [Command::UndoTracks]);
    }
}

#[test]
fn a_dragged_track_moves_to_where_it_is_dropped_even_below_the_last() {
    let files: Vec<std::path::PathBuf> = (0..4).map(|n| format!("/nowhere/{n}.wav").into()).collect();
    let content = super::open(OpenPanel::Tracks(tracks(&files, TagLibrary::default())));
    let mut stage = Stage::new(SCREEN);
    let (_, texts) = texts(&mut stage, &content);
    let row = |name: &str| place_of(&texts, name).center();
    let mut dragged = |from: Pos2, to: Pos2| -> Vec<Command> {
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        stage.seconds += 2.0;
        let middle = from + 0.5 * (to - from);
        let frames = [
            vec![Event::PointerMoved(from)],
            vec![button(from, true)],
            vec![Event::PointerMoved(middle)],
            vec![Event::PointerMoved(to)],
            vec![Event::PointerMoved(to)],
            vec![button(to, false)],
            vec![],
        ];
        let mut all = Vec::new();
        for events in frames {
            all.extend(stage.frame(events, content()).acts.commands);
        }
        all
    };
    let (first, third, last) = (row("0.wav"), row("2.wav"), row("3.wav"));
    assert_eq!(dragged(first, third + Vec2::new(0.0, 6.0)), [Command::MoveTrack((0, 2))]);
    assert_eq!(dragged(last, first - Vec2::new(0.0, 6.0)), [Command::MoveTrack((3, 0))]);
    assert_eq!(dragged(first, last + Vec2::new(0.0, 200.0)), [Command::MoveTrack((0, 3))]);
    // A small movement is a click.
    assert_eq!(dragged(first, first + Vec2::new(0.0, 4.0)), [Command::PlayTrack(0)]);
}

#[test]
fn the_cover_is_drawn_in_the_bar_and_in_the_welcome_text() {
    let image: &'static Arc<RgbaImage> = Box::leak(Box::new(Arc::new(RgbaImage::new(256, 100))));
    let now: &'static NowPlaying = Box::leak(Box::new(playing()));
    let textured = |laid_out: &LaidOut| -> Vec<Rect> {
        let all = laid_out.output.shapes.iter().map(|clipped| &clipped.shape);
        all.filter(|shape| shape.texture_id() != egui::TextureId::default())
            .map(egui::Shape::visual_bounding_rect)
            .collect()
    };
    for screen in [SCREEN, Vec2::new(640.0, 360.0)] {
        let mut stage = Stage::new(screen);
        let with_bar = || {
            let bar = Bar { cover: Some(Cover(image)), ..bar(now) };
            OverlayContent { bar: Some(bar), ..Default::default() }
        };
        let (laid_out, texts) = texts(&mut stage, &with_bar);
        let [cover] = textured(&laid_out)[..] else { panic!("no cover") };
        assert!(laid_out.panels[0].contains_rect(cover) && (cover.width() - cover.height()).abs() < 0.1);
        assert!(!cover.intersects(place_of(&texts, "a title · an artist · 3 of 7")));
        let welcome = || {
            let (title, cover, since) = ("a title", Some(Cover(image)), Instant::now());
            let welcome = Welcome { title, artist: None, cover, scene: "city", since };
            OverlayContent { welcome: Some(welcome), ..Default::default() }
        };
        let (laid_out, texts) = super::lists::texts(&mut stage, &welcome);
        let [cover] = textured(&laid_out)[..] else { panic!("no cover") };
        assert!(stage.screen.contains_rect(cover) && !cover.intersects(place_of(&texts, "a title")));
        assert!(textured(&stage.frame(vec![], OverlayContent::default())).is_empty());
    }
}

#[test]
fn screen_readers_hear_the_rows_and_the_buttons_of_both_lists() {
    use egui::accesskit::{Node, Role, Toggled};
    let folder = tempfile::tempdir().unwrap();
    let files = [song(folder.path(), "a.wav", "Ebb", "The Tide")];
    let tags = library(&files);
    let mut panel = tracks(&files, tags.clone());
    panel.present = 0;
    let here = Some(folder.path().to_owned());
    let mut browser = FileBrowser::start(here, RememberedFolders::default(), tags, || {});
    crate::file_browser::tests::read(&mut browser);
    let _ = browser.handle_key(&Key::Named(NamedKey::End), Held::empty());
    let nodes = |content: &dyn Fn() -> OverlayContent<'static>| -> Vec<Node> {
        let mut stage = Stage::new(SCREEN);
        stage.panels.context.enable_accesskit();
        let (laid_out, _) = texts(&mut stage, content);
        let update = laid_out.output.platform_output.accesskit_update.expect("a tree of controls");
        let nodes: Vec<Node> = update.nodes.into_iter().map(|(_, node)| node).collect();
        let nameless = nodes.iter().filter(|node| {
            node.role() == Role::Button && node.label().is_none_or(|label| label.trim().is_empty())
        });
        assert_eq!(nameless.count(), 0, "{nodes:#?}");
        nodes
    };
    let find = |nodes: &[Node], name: &str| {
        let named = |node: &&Node| node.label() == Some(name);
        nodes.iter().find(named).unwrap_or_else(|| panic!("no {name}: {nodes:#?}")).toggled()
    };
    let of_tracks = nodes(&super::open(OpenPanel::Tracks(panel)));
    assert_eq!(find(&of_tracks, "1, Ebb, The Tide, 1:05, playing"), Some(Toggled::True));
    find(&of_tracks, "remove Ebb");
    find(&of_tracks, "undo: remove x.wav");
    let of_files = nodes(&super::open(OpenPanel::Files(browser)));
    assert_eq!(find(&of_files, "a.wav, Ebb · The Tide, 1:05"), Some(Toggled::True));
    for name in ["add a.wav to the tracks", "play a.wav", "play this folder", "the folder above (Backspace)"]
    {
        find(&of_files, name);
    }
    assert_eq!(find(&of_files, "keep this folder among the shortcuts (Ctrl+D)"), Some(Toggled::False));
}

#[test]
fn messages_do_not_cover_the_track_list() {
    let files: Vec<std::path::PathBuf> = (0..4).map(|n| format!("/nowhere/{n}.wav").into()).collect();
    let with_tracks = super::open(OpenPanel::Tracks(tracks(&files, TagLibrary::default())));
    for screen in [SCREEN, Vec2::new(640.0, 360.0)] {
        let content = || OverlayContent { hint: Some("undone: remove x.wav"), ..with_tracks() };
        let (laid_out, _) = texts(&mut Stage::new(screen), &content);
        let is_message = |shape: &&egui::Shape| matches!(shape, Shape::Text(text) if text.galley.text().starts_with("undone"));
        let mut shapes = laid_out.output.shapes.iter().map(|clipped| &clipped.shape);
        let message = shapes.find(is_message).expect("a message").visual_bounding_rect();
        assert!(!message.intersects(laid_out.panels[0]), "{screen:?}: {message:?} {:?}", laid_out.panels[0]);
    }
}
