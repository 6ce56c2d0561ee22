//! Draws the file list: shortcuts on the left, the entries of the folder with their tags on the right, and buttons for
//! the whole folder below.

use egui::{Id, Order, Painter, Rect, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::{On, PanelAct, Pass, on};
use super::icons::{self, Icon};
use super::now_playing::clock_time;
use super::{assisted, kept, style, words};
use crate::file_browser::{CLOSE, FileBrowser, FileEntry, FileKind, Place, PlaceKind};
use mariana_player::decode::TrackTags;

const WIDTH_MAX: f32 = 1400.0;
const ROW: f32 = 24.0;
const GAP: f32 = 12.0;
/// The narrowest and the widest column of shortcuts, and its part of the panel.
const PLACES_WIDTH: (f32, f32) = (96.0, 220.0);
const PLACES_PART: f32 = 0.22;
/// Room for the icon of an entry, for the length of a song, and for one button of a row.
const ICON: f32 = 22.0;
const LENGTH: f32 = 54.0;
/// Minimum width of the texts of a row that shows both the file's name and its tags.
const BOTH_MIN: f32 = 330.0;
/// The part of this width for the file's name.
const NAME_PART: f32 = 0.42;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, files: &FileBrowser) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "files", Order::Foreground, style::middle(space, WIDTH_MAX), |ui| {
        let inner = ui.available_width();
        ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
        let mut ask = |act| acts.on_panels.push(PanelAct::Files(act));
        heading(ui, files, &mut ask);
        let height = (space.height() - 2.0 * style::PADDING.y - 1.2 * ROW - words::BUTTON - ROW).max(ROW);
        let (body, _) = ui.allocate_exact_size(vec2(inner, height), Sense::hover());
        let column = (PLACES_PART * inner).clamp(PLACES_WIDTH.0, PLACES_WIDTH.1).min(0.5 * inner);
        let left = Rect::from_min_max(body.min, pos2(body.left() + column, body.bottom()));
        let right = Rect::from_min_max(pos2(left.right() + GAP, body.top()), body.max);
        let stroke = egui::Stroke::new(1.0, style::RAIL);
        ui.painter().vline(left.right() + 0.5 * GAP, body.y_range().shrink(4.0), stroke);
        let mut column = |area: Rect, name: &str, show: &mut dyn FnMut(&mut Ui)| {
            let builder = egui::UiBuilder::new().max_rect(area).scope_id(Id::unique(("files", name)));
            let mut ui = ui.new_child(builder.layout(egui::Layout::top_down(egui::Align::Min)));
            ui.set_clip_rect(area.intersect(ui.clip_rect()));
            show(&mut ui);
        };
        column(left, "places", &mut |ui| places(ui, files, &mut ask));
        column(right, "entries", &mut |ui| rows(ui, height, files, &mut ask));
        footing(ui, files, &mut ask);
    })
}

fn heading(ui: &mut Ui, files: &FileBrowser, ask: &mut impl FnMut(On<FileBrowser>)) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), 1.2 * ROW), Sense::hover());
    let cross = Rect::from_center_size(place.right_center() - vec2(0.5 * ROW, 2.0), vec2(ROW, ROW));
    if icons::closing_cross(ui, cross, "close the list of files") {
        ask(Box::new(|_| vec![CLOSE]));
    }
    let star = cross.translate(vec2(-ROW - 4.0, 0.0));
    let marks = ui.interact(star, ui.scope_id().with("mark"), Sense::click());
    let is_favourite = files.is_favourite();
    let color = style::lit(is_favourite, marks.hovered(), style::DIM);
    icons::draw(ui.painter(), Icon::STAR, star, 14.0, color);
    let name = "keep this folder among the shortcuts (Ctrl+D)";
    marks.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, is_favourite, name));
    if marks.clicked() {
        ask(Box::new(FileBrowser::mark));
    }
    let up = Rect::from_min_size(place.min - vec2(0.0, 2.0), vec2(ROW, ROW));
    let rises = ui.interact(up, ui.scope_id().with("up"), Sense::click());
    let color = if rises.hovered() { style::TEXT } else { style::ACCENT };
    icons::draw(ui.painter(), Icon::UP, up, 14.0, color);
    rises.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "the folder above (Backspace)"));
    if rises.clicked() {
        ask(on(FileBrowser::enter_parent));
    }
    let folder = files.folder.display().to_string().replace(char::is_control, " ");
    let (words, color) = match files.query() {
        "" => (folder.clone(), style::TEXT),
        query => (format!("{query}| in {folder}"), style::ACCENT),
    };
    let left = up.right_center() + vec2(8.0, 0.0);
    style::put(ui.painter(), left, &words, style::HEADING_SIZE, color, star.left() - left.x - 8.0);
    assisted::text(ui.ctx(), "folder", &words, false);
    rises.on_hover_text("the folder above (Backspace)");
    marks.on_hover_text(name);
}

fn places(ui: &mut Ui, files: &FileBrowser, ask: &mut impl FnMut(On<FileBrowser>)) {
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    let before = kept::replace(ui.ctx(), Id::unique("selected shortcut"), files.selected_place);
    let moved = before.flatten() != files.selected_place;
    ScrollArea::vertical().id_salt("places").auto_shrink([false, false]).show(ui, |ui| {
        let width = (ui.available_width() - style::LANE).max(0.0);
        let mut before = None;
        for (index, place) in files.places.iter().enumerate() {
            if before.replace(place.kind) != Some(place.kind) {
                let (line, _) = ui.allocate_exact_size(vec2(width, 0.8 * ROW), Sense::hover());
                words::hint(ui, line, group(place.kind));
            }
            let is_selected = files.selected_place == Some(index);
            let response = place_row(ui, width, place, is_selected, place.path == files.folder);
            if is_selected && moved {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                ask(on(move |files: &mut FileBrowser| files.enter_place(index)));
            }
            response.on_hover_text(place.path.display().to_string());
        }
    });
}

fn group(kind: PlaceKind) -> &'static str {
    match kind {
        PlaceKind::Favourite => "Favourites",
        PlaceKind::Common => "Folders",
        PlaceKind::Media => "Disks",
        PlaceKind::Recent => "Recent",
    }
}

fn place_row(ui: &mut Ui, width: f32, place: &Place, is_selected: bool, is_shown: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click());
    style::light(ui.painter(), rect, is_selected || response.hovered());
    if is_selected {
        let stroke = egui::Stroke::new(1.0, style::ACCENT);
        ui.painter().rect_stroke(rect, 4.0, stroke, egui::StrokeKind::Inside);
    }
    let color = if is_shown { style::ACCENT } else { style::TEXT };
    let left = rect.left_center() + vec2(6.0, 0.0);
    style::put(ui.painter(), left, &place.name, style::TEXT_SIZE, color, rect.width() - 10.0);
    let name = format!("{}, {}", place.name, group(place.kind));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_shown, &name));
    if is_selected {
        assisted::text(ui.ctx(), "selected shortcut", &name, true);
    }
    response
}

fn rows(ui: &mut Ui, height: f32, files: &FileBrowser, ask: &mut impl FnMut(On<FileBrowser>)) {
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    if let Some(trouble) = files.trouble() {
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), 2.0 * ROW), Sense::hover());
        style::put(ui.painter(), place.left_center(), trouble, style::TEXT_SIZE, style::DIM, place.width());
        assisted::text(ui.ctx(), "state of the folder", trouble, true);
        return;
    }
    let mut scroll = ScrollArea::vertical().id_salt("entries").max_height(height).auto_shrink([false, false]);
    if kept::replace(ui.ctx(), Id::unique("selected file"), files.selected) != Some(files.selected) {
        scroll = scroll.vertical_scroll_offset(style::scrolled_to(files.selected, ROW, height));
    }
    scroll.show_rows(ui, ROW, files.count(), |ui, places| {
        let width = (ui.available_width() - style::LANE).max(0.0);
        let drawn = places.clone();
        ask(on(move |files: &mut FileBrowser| files.record_drawn(drawn)));
        for place in places {
            let Some(entry) = files.entry(place) else { break };
            row(ui, width, files, place, entry, ask);
        }
    });
}

fn row(
    ui: &mut Ui,
    width: f32,
    files: &FileBrowser,
    place: usize,
    entry: &FileEntry,
    ask: &mut impl FnMut(On<FileBrowser>),
) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click());
    let button =
        |n: f32| Rect::from_center_size(rect.right_center() - vec2((n + 0.5) * ROW, 0.0), vec2(ROW, ROW));
    let has_adding = !matches!(entry.kind, FileKind::Scene);
    let adds = ui.interact(button(0.0), response.id.with("add"), Sense::click());
    let plays = ui.interact(button(1.0), response.id.with("play"), Sense::click());
    let is_selected = place == files.selected && files.selected_place.is_none();
    let over = [&response, &adds, &plays].iter().any(|part| part.contains_pointer());
    let painter = ui.painter().clone();
    style::light(&painter, rect, is_selected || over);
    let tags = Some(entry).filter(|entry| entry.kind == FileKind::Music);
    let tags = tags.and_then(|entry| files.tags.get(&entry.path));
    draw_entry(&painter, rect, entry, tags.as_deref(), is_selected);
    let name = spoken(entry, tags.as_deref());
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_selected, &name));
    if is_selected {
        assisted::text(ui.ctx(), "selected entry", &name, true);
    }
    let append = ui.input(|input| input.modifiers.shift);
    let open = |append: bool| -> On<FileBrowser> { Box::new(move |files| files.open(place, append)) };
    let mut clicked = response.clicked().then(|| open(append));
    let mut part = |part: &egui::Response, icon, words: String, act: On<FileBrowser>| {
        let color = if part.hovered() { style::TEXT } else { style::ACCENT };
        if is_selected || over {
            icons::draw(&painter, icon, part.rect, 12.0, color);
        }
        part.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &words));
        if part.clicked() {
            clicked = Some(act);
        }
    };
    if has_adding {
        part(&adds, Icon::PLUS, format!("add {} to the tracks", entry.name), open(true));
        let play = Box::new(move |files: &mut FileBrowser| files.play(place));
        part(&plays, Icon::PLAY, format!("play {}", entry.name), play);
        adds.on_hover_text("add to the tracks (Shift+Enter)");
        plays.on_hover_text("play");
    }
    clicked.into_iter().for_each(ask);
}

fn draw_entry(painter: &Painter, rect: Rect, entry: &FileEntry, tags: Option<&TrackTags>, is_selected: bool) {
    let color = match (is_selected, entry.kind) {
        (true, _) => style::ACCENT,
        (false, FileKind::Other) => style::DIM,
        (false, _) => style::TEXT,
    };
    let icon = match entry.kind {
        FileKind::Folder => Some(Icon::FOLDER),
        FileKind::List => Some(Icon::TRACKS),
        FileKind::Scene => Some(Icon::SCENES),
        FileKind::Music => Some(Icon::NOTE),
        FileKind::Other => None,
    };
    if let Some(icon) = icon {
        let place = Rect::from_min_size(rect.min, vec2(ICON, ROW));
        icons::draw(painter, icon, place, 12.0, if is_selected { style::ACCENT } else { style::DIM });
    }
    let put = |text: &str, left: f32, width: f32, size: f32, color| {
        style::put(painter, pos2(left, rect.center().y), text, size, color, width);
    };
    let left = rect.left() + ICON;
    let right = rect.right() - 2.0 * ROW;
    let Some(tags) = tags.filter(|tags| tags.title.is_some() || tags.duration.is_some()) else {
        return put(&entry.name, left, right - left, style::TEXT_SIZE, color);
    };
    let end = right - LENGTH;
    if let Some(seconds) = tags.duration {
        let at = pos2(right - 6.0, rect.center().y);
        style::put_right(painter, at, &clock_time(seconds), style::SMALL_SIZE, style::DIM, LENGTH);
    }
    match (in_one_line(tags), end - left >= BOTH_MIN) {
        (Some(words), true) => {
            let name = NAME_PART * (end - left);
            put(&entry.name, left, name - 10.0, style::TEXT_SIZE, color);
            put(&words, left + name, end - left - name, style::SMALL_SIZE, style::DIM);
        }
        (Some(words), false) => put(&words, left, end - left, style::TEXT_SIZE, color),
        (None, _) => put(&entry.name, left, end - left, style::TEXT_SIZE, color),
    }
}

fn in_one_line(tags: &TrackTags) -> Option<String> {
    let title = tags.title.as_deref()?;
    Some(match &tags.artist {
        Some(artist) => format!("{title} · {artist}"),
        None => title.to_owned(),
    })
}

/// The accessible name of an entry.
fn spoken(entry: &FileEntry, tags: Option<&TrackTags>) -> String {
    let kind = match entry.kind {
        FileKind::Folder => ", folder",
        FileKind::List => ", playlist",
        FileKind::Scene => ", scene",
        FileKind::Music | FileKind::Other => "",
    };
    let mut name = format!("{}{kind}", entry.name);
    if let Some(tags) = tags {
        name.extend(in_one_line(tags).map(|words| format!(", {words}")));
        name.extend(tags.duration.map(|seconds| format!(", {}", clock_time(seconds))));
    }
    name
}

fn footing(ui: &mut Ui, files: &FileBrowser, ask: &mut impl FnMut(On<FileBrowser>)) {
    let is_known = !files.folder.as_os_str().is_empty();
    ui.horizontal(|ui| {
        let play = words::button(ui, "play this folder", is_known);
        if play.clicked() {
            ask(Box::new(|files| files.open_folder(false)));
        }
        play.on_hover_text("Ctrl+Enter");
        let add = words::button(ui, "add this folder to the tracks", is_known);
        if add.clicked() {
            ask(Box::new(|files| files.open_folder(true)));
        }
        add.on_hover_text("Ctrl+Shift+Enter");
    });
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let keys = "type to search (O closes, a space and O search) · Enter opens, Shift+Enter adds, Ctrl+Enter plays the \
                folder · Tab: shortcuts · Backspace: up";
    words::hint(ui, place, keys);
}
