//! Tests of the panels in a simulated window.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, Vec2};

use super::panels::{LaidOut, Panels};
use super::{
    Acts, Bar, Notice, NowPlaying, OverlayContent, PanelAct, PanelSwitches, Problem, SourceList, style,
};
use crate::editor::Editor;
use crate::help_panel::HelpPanel;
use crate::open_panel::OpenPanel;
use crate::track_panel::TrackPanel;
use mariana_commands::{Command, Delay, Panel, Switch};
use mariana_control::{ChangedBy, Slider};
use mariana_files::Folders;
use mariana_player::tags::TagLibrary;
use mariana_player::{ListedTrack, ListedTracks};
use mariana_render::system_fonts::SystemFonts;
use mariana_scenes::{Drafts, SceneSource};
use mariana_settings::{Choices, QualityChoice};
use mariana_testing::process::wait_until;
use mariana_testing::tiny_font::{TinyFont, folder_of};

mod assisted;
mod binding;
mod controllers;
mod decks;
mod help;
mod lists;
mod video;
mod wrapping;

type Content = OverlayContent<'static>;

const SCREEN: Vec2 = Vec2::new(1280.0, 720.0);

struct Stage {
    panels: Panels,
    wakes: Receiver<()>,
    screen: Rect,
    seconds: f64,
}

impl Stage {
    fn new(screen: Vec2) -> Self {
        Self::with_fonts(screen, Path::new("no such folder"))
    }

    fn with_fonts(screen: Vec2, folder: &Path) -> Self {
        let (waker, wakes) = channel();
        let fonts = SystemFonts::in_folder(Some(folder.to_owned()));
        let panels = Panels::new(fonts, move || waker.send(()).unwrap());
        Self { panels, wakes, screen: Rect::from_min_size(Pos2::ZERO, screen), seconds: 0.0 }
    }

    fn frame(&mut self, events: Vec<Event>, content: OverlayContent<'_>) -> LaidOut {
        self.seconds += 0.02;
        let time = Some(self.seconds);
        let input = RawInput { screen_rect: Some(self.screen), time, events, ..Default::default() };
        let mut laid_out = self.panels.lay_out(input, &content, Instant::now());
        // egui panics if a test drops texture changes without clearing them.
        laid_out.output.textures_delta.clear();
        laid_out
    }

    fn click(&mut self, place: Pos2, sliders: &mut [Slider]) -> bool {
        let mut moved = false;
        for events in click_at(place) {
            let content = OverlayContent { params: Some(sliders), ..Default::default() };
            for command in self.frame(events, content).acts.commands {
                let Command::MoveSlider((place, value)) = command else { panic!("{command:?}") };
                (sliders[place].value, moved) = (value, true);
            }
        }
        moved
    }
}

/// Content with this panel.
fn open(panel: OpenPanel) -> impl Fn() -> Content + Copy {
    let panel: &'static OpenPanel = Box::leak(Box::new(panel));
    move || OverlayContent { panel: Some(panel), ..Default::default() }
}

/// The events of the frames of a click.
fn click_at(place: Pos2) -> [Vec<Event>; 4] {
    let button = |pressed| Event::PointerButton {
        pos: place,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    [vec![Event::PointerMoved(place)], vec![button(true)], vec![button(false)], vec![]]
}

fn sliders(count: usize) -> Vec<Slider> {
    let slider = |i| Slider {
        name: format!("knob {i}"),
        value: 0.0,
        min: 0.0,
        max: 4.0,
        default: 1.0,
        changed_by: ChangedBy::Text,
        bound: None,
    };
    (0..count).map(slider).collect()
}

/// The bounds of everything drawn, and the texts with their areas.
fn drawn(laid_out: &LaidOut) -> (Rect, Vec<(String, Rect)>) {
    let mut texts = Vec::new();
    let mut bounds = Rect::NOTHING;
    for clipped in &laid_out.output.shapes {
        bounds |= clipped.shape.visual_bounding_rect().intersect(clipped.clip_rect);
        if let Shape::Text(text) = &clipped.shape {
            let rect = Rect::from_min_size(text.pos, text.galley.size());
            texts.push((text.galley.text().to_owned(), rect.intersect(clipped.clip_rect)));
        }
    }
    (bounds, texts)
}

fn place_of(texts: &[(String, Rect)], wanted: &str) -> Rect {
    let found = texts.iter().find(|(text, _)| text.trim() == wanted);
    found.unwrap_or_else(|| panic!("no '{wanted}' in {texts:?}")).1
}

#[test]
fn everything_shows_at_once_and_inside_the_window() {
    let text = "error: no\n --> a.scene:1:1\n".repeat(100);
    for screen in [SCREEN, Vec2::new(533.0, 400.0), Vec2::new(2560.0, 1440.0), Vec2::new(60.0, 40.0)] {
        let (sliders, help) = (sliders(64), HelpPanel::default());
        let content = OverlayContent {
            corner: Some("speakers · interpreted · 230 clauses"),
            problem: Some(Problem { heading: "a.scene has mistakes", text: &text }),
            notice: Some(Notice { text: "compiled", fraction: None, since: Instant::now() }),
            params: Some(&sliders),
            help: Some(&help),
            hint: Some("no sound from a long name; the monitor of another long name has a signal: press D"),
            sources: Some(SourceList { names: vec!["the song".into(), "Mic".into()], present: Some(1) }),
            ..OverlayContent::default()
        };
        let mut stage = Stage::new(screen);
        let laid_out = stage.frame(Vec::new(), content);
        let (bounds, texts) = drawn(&laid_out);
        assert_eq!(laid_out.panels.len(), 4, "{:?}", laid_out.panels);
        if screen.y > 100.0 {
            assert!(stage.screen.contains_rect(bounds), "{screen:?}: {bounds:?}");
            for panel in &laid_out.panels {
                assert!(stage.screen.contains_rect(*panel), "{screen:?}: {panel:?}");
            }
            for wanted in ["a.scene has mistakes", "compiled", "knob 0", help::PAUSE, "> Mic"] {
                assert!(place_of(&texts, wanted).area() > 50.0, "{wanted} does not show");
            }
            assert!(texts.iter().any(|(text, _)| text.contains("more lines")), "{texts:?}");
            assert!(texts.iter().any(|(text, _)| text.ends_with("press D")), "{texts:?}");
        }
    }
}

#[test]
fn underlines_are_below_their_words() {
    let text = "1 | let größe = 球 + nonsense(2)\n  |                  ^^^^^^^^ here\n";
    let problem = Some(Problem { heading: "a", text });
    let laid_out = Stage::new(SCREEN).frame(Vec::new(), OverlayContent { problem, ..Default::default() });
    let (_, texts) = drawn(&laid_out);
    let (source, marks) = (place_of(&texts, "+ nonsense(2)"), place_of(&texts, "^^^^^^^^ here"));
    // The text of the source begins with one space, the text of the marks with 18 spaces.
    let cell = source.width() / " + nonsense(2)".len() as f32;
    let (name, mark) = (source.left() + 3.0 * cell, marks.left() + 18.0 * cell);
    assert!((name - mark).abs() < 0.05 * cell, "the name begins at {name}, its marks at {mark}");
}

#[test]
fn a_slider_follows_the_pointer_and_a_double_click_resets_it() {
    let mut stage = Stage::new(SCREEN);
    let mut sliders = sliders(2);
    let content = OverlayContent { params: Some(&sliders), ..Default::default() };
    let laid_out = stage.frame(Vec::new(), content);
    let (panel, texts) = (laid_out.panels[0], drawn(&laid_out).1);
    assert!(laid_out.acts.commands.is_empty() && panel.right() > SCREEN.x - 20.0);
    let rail_y = place_of(&texts, "knob 1").bottom() + 14.0;
    assert!(stage.click(Pos2::new(panel.right() - 30.0, rail_y), &mut sliders));
    assert_eq!([sliders[0].value, sliders[1].value], [0.0, 4.0]);
    stage.seconds += 2.0;
    let middle = Pos2::new(panel.center().x, rail_y);
    assert!(stage.click(middle, &mut sliders));
    assert!((1.0..3.0).contains(&sliders[1].value), "{}", sliders[1].value);
    assert!(stage.click(middle, &mut sliders));
    assert_eq!([sliders[0].value, sliders[1].value], [0.0, 1.0]);
    stage.seconds += 2.0;
    let content = OverlayContent { params: Some(&sliders), ..Default::default() };
    let (_, texts) = drawn(&stage.frame(Vec::new(), content));
    assert!(stage.click(place_of(&texts, "↺").center(), &mut sliders));
    assert_eq!([sliders[0].value, sliders[1].value], [1.0, 1.0]);
    assert!(!stage.click(Pos2::new(panel.left() - 20.0, rail_y), &mut sliders));
}

fn playing() -> NowPlaying {
    NowPlaying {
        title: "a title".into(),
        artist: Some("an artist".into()),
        place: (2, 7),
        position: 50.0,
        duration: Some(100.0),
        volume: 0.5,
        ..NowPlaying::default()
    }
}

fn bar(now: &NowPlaying) -> Bar<'_> {
    Bar {
        now,
        cover: None,
        shape: None,
        song: None,
        marks: None,
        level: 0.5,
        scene: "city, 2 of 17",
        panels: PanelSwitches::default(),
        fullscreen: false,
        follows: true,
        decks: false,
        seen: true,
    }
}

/// What a click does.
fn acts(stage: &mut Stage, place: Pos2, mut content: impl FnMut() -> Content) -> Acts {
    let mut all = Acts::default();
    for events in click_at(place) {
        let Acts { on_panels, commands } = stage.frame(events, content()).acts;
        all.on_panels.extend(on_panels);
        all.commands.extend(commands);
    }
    all
}

/// The commands of a click.
fn commands(stage: &mut Stage, place: Pos2, content: impl FnMut() -> Content) -> Vec<Command> {
    acts(stage, place, content).commands
}

#[test]
fn the_bar_is_inside_the_window_and_seeks_where_it_is_clicked() {
    let now: &'static NowPlaying = Box::leak(Box::new(playing()));
    let content = || OverlayContent { bar: Some(bar(now)), ..Default::default() };
    for screen in [SCREEN, Vec2::new(560.0, 315.0), Vec2::new(2560.0, 1440.0), Vec2::new(60.0, 40.0)] {
        let mut stage = Stage::new(screen);
        // egui finds the size of the bar in its first frame.
        stage.frame(Vec::new(), content());
        let laid_out = stage.frame(Vec::new(), content());
        let rect = laid_out.panels[0];
        if screen.y < 100.0 {
            continue;
        }
        assert!(stage.screen.contains_rect(rect), "{screen:?}: {rect:?}");
        let (bounds, texts) = drawn(&laid_out);
        assert!(stage.screen.contains_rect(bounds), "{screen:?}: {bounds:?}");
        let words = place_of(&texts, "a title · an artist · 3 of 7");
        let inner = rect.shrink2(style::PADDING);
        let place = Pos2::new(inner.left() + 0.25 * inner.width(), words.bottom() + 18.0);
        let events = commands(&mut stage, place, content);
        let [Command::SeekTo(seconds)] = events[..] else { panic!("{screen:?}: {events:?}") };
        assert!((seconds - 25.0).abs() < 1.0, "{screen:?}: {seconds} s");
    }
}

#[test]
fn every_button_of_the_bar_has_a_tooltip_and_its_own_command() {
    let now: &'static NowPlaying = Box::leak(Box::new(playing()));
    let content = || OverlayContent { bar: Some(bar(now)), ..Default::default() };
    let mut stage = Stage::new(SCREEN);
    stage.frame(Vec::new(), content());
    let rect = stage.frame(Vec::new(), content()).panels[0];
    let mut met = Vec::new();
    let y = rect.bottom() - style::PADDING.y - 15.0;
    let mut x = rect.left() + style::PADDING.x + 15.0;
    while x < rect.right() - style::PADDING.x {
        for request in commands(&mut stage, Pos2::new(x, y), content) {
            if !met.contains(&request) && !matches!(request, Command::Volume(_)) {
                met.push(request);
            }
        }
        x += 8.0;
        stage.seconds += 1.0;
    }
    let expected = [
        Command::PreviousTrack,
        Command::Pause(Switch::Toggle),
        Command::NextTrack,
        Command::Shuffle(Switch::Toggle),
        Command::NextRepeat,
        Command::Mute(Switch::Toggle),
        Command::TogglePanel(Panel::Video),
        Command::TogglePanel(Panel::Files),
        Command::TogglePanel(Panel::Tracks),
        Command::TogglePanel(Panel::Sources),
        Command::Follow(Switch::Toggle),
        Command::Decks(Switch::Toggle),
        Command::TogglePanel(Panel::Scenes),
        Command::TogglePanel(Panel::Editor),
        Command::ToggleSliders,
        Command::TogglePanel(Panel::Settings),
        Command::ToggleHelp,
        Command::Fullscreen(Switch::Toggle),
    ];
    assert_eq!(met, expected);
    for command in expected {
        assert!(!super::bar::words_of(&command).is_empty(), "{command:?} has no words");
    }
}

#[test]
fn of_ten_thousand_tracks_only_the_visible_rows_are_laid_out() {
    let entry =
        |i| ListedTrack { name: format!("track {i}"), duration: Some(60.0), ..ListedTrack::default() };
    let list = ListedTracks { revision: 1, entries: (0..10_000).map(entry).collect(), undo: None };
    let content = open(OpenPanel::Tracks(TrackPanel::new(Arc::new(list), 1, TagLibrary::default())));
    let mut stage = Stage::new(SCREEN);
    stage.frame(Vec::new(), content());
    let laid_out = stage.frame(Vec::new(), content());
    assert!(stage.screen.contains_rect(laid_out.panels[0]), "{:?}", laid_out.panels);
    let (_, texts) = drawn(&laid_out);
    assert!(texts.len() < 200, "{} texts are laid out", texts.len());
    let third = place_of(&texts, "track 2").center();
    assert_eq!(commands(&mut stage, third, content), [Command::PlayTrack(2)]);
    let cross = Pos2::new(laid_out.panels[0].right() - style::PADDING.x - 10.0 - 12.0, third.y);
    assert_eq!(commands(&mut stage, cross, content), [Command::RemoveTrack(2)]);
}

#[test]
fn settings_are_inside_the_window_and_a_click_chooses() {
    use crate::settings_panel::tests::panel;
    let choices = Choices { quality: QualityChoice::High, ..Choices::default() };
    let content = open(OpenPanel::Settings(panel(&choices, Some("tv"))));
    let rows = panel(&choices, Some("tv")).rows;
    let place = |wanted: &str| rows.iter().position(|row| row.name == wanted).unwrap();
    let set = |acts: Acts| {
        let mut own = panel(&choices, Some("tv"));
        let act = |act| match act {
            PanelAct::Settings(act) => act(&mut own),
            _ => panic!("an act on another panel"),
        };
        let commands: Vec<Command> = acts.on_panels.into_iter().flat_map(act).collect();
        (own, commands)
    };
    for screen in [SCREEN, Vec2::new(560.0, 315.0), Vec2::new(2560.0, 1440.0), Vec2::new(60.0, 40.0)] {
        let mut stage = Stage::new(screen);
        stage.frame(Vec::new(), content());
        let laid_out = stage.frame(Vec::new(), content());
        if screen.y < 100.0 {
            continue;
        }
        assert!(stage.screen.contains_rect(laid_out.panels[0]), "{screen:?}: {:?}", laid_out.panels);
        let (bounds, texts) = drawn(&laid_out);
        assert!(stage.screen.contains_rect(bounds), "{screen:?}: {bounds:?}");
        assert!(texts.iter().any(|(text, _)| text == "this run"), "{texts:?}");
        for (name, row, value) in [
            ("medium", "Quality", 2),
            ("· USB", "USB", 0),
            ("film", "Colours", 1),
            ("+ Advanced", "Advanced", 0),
        ] {
            let is_seen = |(text, at): &&(String, Rect)| text == name && at.height() > 12.0;
            let Some((_, at)) = texts.iter().find(is_seen) else { continue };
            let mut expected = panel(&choices, Some("tv"));
            let picked = Vec::from_iter(expected.pick(place(row), value));
            let (own, commands) = set(acts(&mut stage, at.center(), content));
            assert_eq!((own.rows, own.selected), (expected.rows, place(row)), "{screen:?}: {name}");
            assert_eq!(commands, picked, "{screen:?}: {name}");
        }
        let rail = Pos2::new(place_of(&texts, "+35 ms").left() - 40.0, place_of(&texts, "+35 ms").center().y);
        let (_, commands) = set(acts(&mut stage, rail, content));
        let Some(Command::Delay(Delay { milliseconds: shift, settled: true })) = commands.last() else {
            panic!("{screen:?}: {commands:?}")
        };
        assert!(*shift > 300.0, "{screen:?}: {shift}");
    }
}

#[test]
fn a_notice_covered_the_heading_of_a_panel() {
    use crate::settings_panel::tests::panel;
    let rows = OpenPanel::Settings(panel(&Choices::default(), None));
    for screen in [SCREEN, Vec2::new(560.0, 315.0)] {
        let mut stage = Stage::new(screen);
        let since = Instant::now() + Duration::from_secs(60); // A busy machine must not let it fade.
        let notice = Some(Notice { text: "orb is being prepared", fraction: None, since });
        let content =
            || OverlayContent { panel: Some(&rows), notice, hint: Some("press D"), ..Default::default() };
        stage.frame(Vec::new(), content());
        let laid_out = stage.frame(Vec::new(), content());
        let (bounds, texts) = drawn(&laid_out);
        assert!(stage.screen.contains_rect(bounds), "{screen:?}: {bounds:?}");
        let heading = place_of(&texts, "Settings");
        for words in ["orb is being prepared", "press D"] {
            assert!(place_of(&texts, words).top() > heading.bottom() + 12.0, "{screen:?}: {texts:?}");
        }
    }
}

#[test]
fn the_selected_setting_is_visible_in_a_small_window() {
    use crate::settings_panel::tests::panel;
    use mariana_commands::input::{Key, Modifiers as Held, NamedKey};
    let mut rows = OpenPanel::Settings(panel(&Choices::default(), None));
    let mut stage = Stage::new(Vec2::new(560.0, 200.0));
    stage.frame(Vec::new(), OverlayContent { panel: Some(&rows), ..Default::default() });
    let ways = [NamedKey::ArrowDown; 12].into_iter().chain([NamedKey::ArrowUp; 12]);
    for key in ways {
        let _ = rows.handle_key(&Key::Named(key), Held::empty());
        stage.frame(Vec::new(), OverlayContent { panel: Some(&rows), ..Default::default() });
        let laid_out = stage.frame(Vec::new(), OverlayContent { panel: Some(&rows), ..Default::default() });
        let OpenPanel::Settings(settings) = &rows else { unreachable!() };
        let row = &settings.rows[settings.selected];
        let (_, texts) = drawn(&laid_out);
        let at = texts.iter().find(|(text, _)| text.ends_with(&row.name)).map(|(_, at)| *at);
        assert!(at.is_some_and(|at| at.height() > 12.0), "{} is not seen: {texts:?}", row.name);
    }
}

#[test]
fn special_characters_are_in_the_fonts() {
    let stage = Stage::new(SCREEN);
    let mut output = stage.panels.context.run_pass(RawInput::default(), |context| {
        for (font, text) in [(style::monospace(12.0), "…↺^|`äß"), (style::proportional(12.0), "…·äß")]
        {
            let missing = |c: &char| !context.fonts_mut(|fonts| fonts.has_glyph(&font, *c));
            assert_eq!(text.chars().filter(missing).collect::<String>(), "", "{font:?}");
        }
    });
    output.textures_delta.clear();
}

/// The letters of a drawn text, each with the size and position of its glyph.
fn letters_of(laid_out: &LaidOut, wanted: &str) -> Vec<(char, [u16; 2])> {
    let texts = laid_out.output.shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Text(text) if text.galley.text() == wanted => Some(text),
        _ => None,
    });
    let rows = texts.flat_map(|text| &text.galley.rows);
    let glyphs = rows.flat_map(|row| &row.glyphs);
    glyphs
        .map(|glyph| (glyph.chr, [glyph.uv_rect.max[0] - glyph.uv_rect.min[0], glyph.uv_rect.max[1]]))
        .collect()
}

fn noticed(text: &str) -> OverlayContent<'_> {
    let notice = Some(Notice { text, fraction: None, since: Instant::now() });
    OverlayContent { notice, ..Default::default() }
}

/// Maximum time of a font search on a busy system.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn missing_letters_come_from_the_fonts_of_the_system() {
    let title = "日本語";
    let bytes = TinyFont::new("Tiny", title).bytes();
    let folder = folder_of(&[("damaged.ttf", bytes[..200].to_vec()), ("tiny.ttf", bytes)]);
    let mut stage = Stage::with_fonts(SCREEN, folder.path());
    let boxes = letters_of(&stage.frame(Vec::new(), noticed(title)), title);
    assert_eq!(boxes.len(), 3);
    assert!(boxes.iter().all(|(_, place)| *place == boxes[0].1), "the same box three times: {boxes:?}");
    stage.wakes.recv_timeout(PATIENCE).expect("no font was found");
    assert!(stage.panels.fallback.has_found());
    let letters = letters_of(&stage.frame(Vec::new(), noticed(title)), title);
    assert!(!stage.panels.fallback.has_found());
    let mut widths: Vec<u16> = letters.iter().map(|(_, place)| place[0]).collect();
    widths.dedup();
    assert_eq!(widths.len(), 3, "{letters:?} instead of {boxes:?}");
}

#[test]
fn missing_letters_are_searched_for_once() {
    let folder = folder_of(&[("tiny.ttf", TinyFont::new("Tiny", "日").bytes())]);
    let mut stage = Stage::with_fonts(SCREEN, folder.path());
    stage.frame(Vec::new(), noticed("日本"));
    stage.wakes.recv_timeout(PATIENCE).expect("no font was found");
    for _ in 0..3 {
        stage.frame(Vec::new(), noticed("日本"));
    }
    // Only the third letter is new, so only this letter is searched for. No font contains the letter.
    assert_eq!(stage.panels.fallback().missed(), 2);
    stage.frame(Vec::new(), noticed("日本語"));
    assert_eq!(stage.panels.fallback().missed(), 3);
}

#[test]
fn letters_of_the_built_in_fonts_are_not_searched_for() {
    let mut stage = Stage::new(SCREEN);
    stage.frame(Vec::new(), noticed("Hadal Lanterns — größer, Ελλάδα, Привет!\n\t\u{a0}\u{200d}"));
    let (sliders, help) = (sliders(3), HelpPanel::default());
    let (now, panels) = (playing(), PanelSwitches { help: true, sliders: true, ..Default::default() });
    let bar = Bar { scene: "speakers, 1 of 17", panels, follows: false, ..bar(&now) };
    let content = OverlayContent {
        corner: Some("speakers · 60 fps · 1280x720 · compiled"),
        params: Some(&sliders),
        help: Some(&help),
        bar: Some(bar),
        ..Default::default()
    };
    stage.frame(Vec::new(), content);
    assert_eq!(stage.panels.fallback().missed(), 0);
    assert!(!stage.panels.fallback().has_started(), "the thread has started");
}

#[test]
fn text_grows_with_large_windows_and_stays_readable_in_small_ones() {
    for (window, text) in [((640.0, 360.0), 12.5), ((1920.0, 1080.0), 12.5), ((3840.0, 2160.0), 25.0)] {
        let zoom = style::zoom(Vec2::new(window.0, window.1));
        assert_eq!(style::SMALL_SIZE * zoom, text, "{window:?}");
    }
    let smallest = style::SMALL_SIZE * style::zoom(Vec2::new(1.0, 1.0));
    assert!((smallest - 9.0).abs() < 1e-3, "{smallest}");
}

#[test]
fn a_bar_for_screen_readers_alone_is_neither_seen_nor_in_the_way() {
    let now = NowPlaying { title: "song".into(), duration: Some(60.0), ..NowPlaying::default() };
    let mut stage = Stage::new(SCREEN);
    stage.panels.context.enable_accesskit();
    let mut places = Vec::new();
    for seen in [true, false] {
        let bar = Some(Bar { seen, ..bar(&now) });
        stage.frame(vec![], OverlayContent { bar, ..Default::default() });
        let mut laid_out = stage.frame(vec![], OverlayContent { bar, ..Default::default() });
        let controls = laid_out.output.platform_output.accesskit_update.take().expect("no tree of controls");
        assert!(
            controls.nodes.iter().any(|(_, node)| node.label().is_some_and(|name| name.contains("Space")))
        );
        places.push((laid_out.panels.len(), drawn(&laid_out).1.len()));
        let content = OverlayContent { bar, ..Default::default() };
        assert_eq!(content.is_interactive(), seen);
    }
    assert_eq!(places[0].0, 1);
    assert_eq!(places[1], (0, 0));
}

#[test]
fn songs_had_no_level_below_the_source_button() {
    let now = playing();
    let lit = |level: f32| {
        let mut stage = Stage::new(SCREEN);
        let content = || OverlayContent { bar: Some(Bar { level, ..bar(&now) }), ..Default::default() };
        stage.frame(vec![], content());
        let shapes = stage.frame(vec![], content()).output.shapes;
        let widths = shapes.into_iter().filter_map(|clipped| match clipped.shape {
            Shape::Rect(rect) if rect.fill == style::ACCENT && rect.rect.height() < 3.0 => {
                Some(rect.rect.width())
            }
            _ => None,
        });
        widths.sum::<f32>()
    };
    assert_eq!(lit(0.0), 0.0);
    assert!(lit(0.5) > 5.0 && (lit(1.0) - 2.0 * lit(0.5)).abs() < 1e-3, "{} {}", lit(0.5), lit(1.0));
}

#[test]
fn an_input_method_did_not_know_where_letters_are_typed() {
    let (folder, waker) = (tempfile::tempdir().unwrap(), channel().0);
    let file = folder.path().join("own.scene");
    fs::write(&file, "object ball { shape = sphere(p, 1) }").unwrap();
    let mut editor = Editor::start(Drafts::default(), &Folders::within(folder.path()), move || {
        waker.send(()).unwrap_or_default()
    })
    .unwrap();
    editor.show_scene(&SceneSource::File(file));
    let mut stage = Stage::new(SCREEN);
    let mut typed_at = |editor: &Editor| {
        let laid_out = stage.frame(vec![], OverlayContent { editor: Some(editor), ..Default::default() });
        laid_out.output.platform_output.ime.map(|ime| ime.cursor_rect)
    };
    assert_eq!(typed_at(&editor), None, "keys belong to the show");
    editor.set_focus(true);
    wait_until("the text", || {
        editor.update();
        editor.document().is_some_and(|document| document.disk.is_some())
    });
    let before = typed_at(&editor).unwrap();
    editor.type_text("abc");
    let after = typed_at(&editor).unwrap();
    assert!(after.left() > before.left() + 3.0 && after.top() == before.top(), "{before:?} {after:?}");
    assert!(
        after.height() > 5.0 && Rect::from_min_size(Pos2::ZERO, SCREEN).contains_rect(after),
        "{after:?}"
    );
}
