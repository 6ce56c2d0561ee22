//! Draws the track list: a click plays a track, a drag moves a track, and the cross removes a track.

use egui::{Id, Order, Painter, Rect, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};
use mariana_commands::Command;

use super::acts::{Acts, PanelAct, Pass, on};
use super::icons::{self, Icon};
use super::now_playing::clock_time;
use super::{assisted, kept, style, words};
use crate::track_panel::TrackPanel;

/// The narrowest and the widest panel in points, and its part of the window.
const WIDTH: (f32, f32) = (400.0, 640.0);
const PART: f32 = 0.45;
const ROW: f32 = 24.0;
/// Room for the length of a track.
const LENGTH: f32 = 54.0;
/// The part of the texts' width for the title.
const TITLE_PART: f32 = 0.58;
/// Near the ends of the list, a drag scrolls by this many points in a frame.
const DRAG_SCROLL: f32 = 9.0;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, panel: &TrackPanel) -> Rect {
    let Pass { context, acts } = pass;
    let place = style::right_part(space, (PART * space.width()).clamp(WIDTH.0, WIDTH.1));
    style::panel(context, "tracks", Order::Middle, place, |ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
        heading(ui, panel, acts);
        let height = (space.height() - 2.0 * style::PADDING.y - 2.0 * ROW - words::BUTTON).max(ROW);
        rows(ui, height, panel, acts);
        buttons(ui, panel, acts);
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let keys = if panel.is_searching() {
            "type to search · Enter plays · Esc shows all tracks"
        } else {
            "Enter plays · Delete removes · Alt+arrow moves · / searches"
        };
        words::hint(ui, place, keys);
    })
}

fn heading(ui: &mut Ui, panel: &TrackPanel, acts: &mut Acts) {
    let (title, hint) = match panel.query() {
        None => (panel.totals(clock_time), String::new()),
        Some(query) => (format!("search: {query}"), format!("{} tracks", panel.rows())),
    };
    if words::heading(ui, ROW, &title, &hint, panel.is_searching(), "close the list of tracks") {
        acts.commands.push(Command::TogglePanel(mariana_commands::Panel::Tracks));
    }
    let words = format!("{title} {hint}");
    assisted::text(ui.ctx(), "length of the list", words.trim_end(), panel.is_searching());
}

fn rows(ui: &mut Ui, height: f32, panel: &TrackPanel, acts: &mut Acts) {
    let count = panel.rows();
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    if count == 0 {
        let sentence = if panel.is_filtered() {
            "no track matches"
        } else {
            "no tracks: drop music here, or press O to choose some"
        };
        words::hint(ui, Rect::from_min_size(place.min, vec2(place.width(), 2.0 * ROW)), sentence);
        return;
    }
    let builder = egui::UiBuilder::new().max_rect(place).scope_id(Id::unique("rows of tracks"));
    let ui = &mut ui.new_child(builder);
    let mut scroll = ScrollArea::vertical().id_salt("tracks").max_height(height).auto_shrink([false, false]);
    if kept::replace(ui.ctx(), Id::unique("selected track"), panel.selected) != Some(panel.selected) {
        scroll = scroll.vertical_scroll_offset(style::scrolled_to(panel.selected, ROW, height));
    }
    let shown = scroll.show_rows(ui, ROW, count, |ui, rows| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let width = (ui.available_width() - style::LANE).max(0.0);
        let drawn = rows.clone();
        acts.on_panels.push(PanelAct::Tracks(on(move |tracks: &mut TrackPanel| tracks.record_drawn(drawn))));
        rows.for_each(|at| row(ui, width, panel, at, acts));
        scroll_during_drag(ui);
    });
    // A track that is dropped below the last row becomes the last track.
    drop_below(ui, shown.inner_rect, shown.content_size.y, count, acts);
}

/// Scrolls while a track is dragged near the ends of the visible part.
fn scroll_during_drag(ui: &mut Ui) {
    let Some(pointer) = ui.ctx().pointer_interact_pos() else { return };
    if !egui::DragAndDrop::has_payload_of_type::<usize>(ui.ctx()) {
        return;
    }
    let visible = ui.clip_rect();
    let speed = if pointer.y < visible.top() + ROW {
        DRAG_SCROLL
    } else if pointer.y > visible.bottom() - ROW {
        -DRAG_SCROLL
    } else {
        return;
    };
    ui.scroll_with_delta(vec2(0.0, speed));
    ui.ctx().request_repaint();
}

fn drop_below(ui: &Ui, visible: Rect, content: f32, count: usize, acts: &mut Acts) {
    let is_released = ui.input(|input| input.pointer.any_released());
    let Some(pointer) = ui.ctx().pointer_interact_pos().filter(|_| is_released) else { return };
    let is_below = visible.contains(pointer) && pointer.y > visible.top() + content;
    if let Some(from) = is_below.then(|| egui::DragAndDrop::take_payload::<usize>(ui.ctx())).flatten()
        && *from + 1 < count
    {
        move_track(*from, count - 1, acts);
    }
}

fn move_track(from: usize, to: usize, acts: &mut Acts) {
    acts.commands.push(Command::MoveTrack((from, to)));
    acts.on_panels.push(PanelAct::Tracks(on(move |tracks: &mut TrackPanel| tracks.select(to))));
}

fn row(ui: &mut Ui, width: f32, panel: &TrackPanel, at: usize, acts: &mut Acts) {
    let Some(index) = panel.track_in(at) else { return };
    let (place, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click_and_drag());
    let cross = Rect::from_center_size(place.right_center() - vec2(0.5 * ROW, 0.0), vec2(ROW, ROW));
    let crossed = ui.interact(cross, response.id.with("remove"), Sense::click());
    let over = response.contains_pointer() || crossed.contains_pointer();
    let painter = ui.painter().clone();
    let is_selected = at == panel.selected;
    if over || is_selected {
        painter.rect_filled(place, 4.0, style::RAIL);
        let color = if crossed.hovered() { style::TEXT } else { style::DIM };
        icons::draw(&painter, Icon::CROSS, cross, 11.0, color);
    }
    let words = Words::of(panel, index);
    words.draw(&painter, place, cross.left(), index == panel.present);
    let spoken = words.spoken(index, index == panel.present);
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_selected, &spoken));
    if is_selected {
        assisted::text(ui.ctx(), "selected track", &spoken, true);
    }
    crossed.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("remove {}", words.title)));
    if crossed.clicked() {
        acts.commands.push(Command::RemoveTrack(index));
    } else if response.clicked() {
        acts.commands.push(Command::PlayTrack(index));
        acts.on_panels.push(PanelAct::Tracks(on(move |tracks: &mut TrackPanel| tracks.select(at))));
    }
    if !panel.is_filtered() {
        drag(&painter, place, &response, index, &words, acts);
    }
}

/// Lets the user drag a row, and shows where another row would be dropped.
fn drag(
    painter: &Painter,
    place: Rect,
    response: &egui::Response,
    index: usize,
    words: &Words,
    acts: &mut Acts,
) {
    response.dnd_set_drag_payload(index);
    let pointer = response.ctx.pointer_interact_pos();
    if let Some(pointer) = pointer.filter(|_| response.dragged()) {
        let front =
            response.ctx.layer_painter(egui::LayerId::new(Order::Tooltip, Id::unique("dragged track")));
        let name = style::line(&front, &words.title, style::TEXT_SIZE, style::TEXT, 0.7 * place.width());
        let ground = Rect::from_min_size(pointer + vec2(12.0, -0.5 * ROW), name.size() + vec2(14.0, 8.0));
        style::ground(&front, ground);
        front.galley(ground.min + vec2(7.0, 4.0), name, style::TEXT);
    }
    let Some(pointer) = pointer.filter(|_| response.contains_pointer()) else { return };
    let below = pointer.y > place.center().y;
    if response.dnd_hover_payload::<usize>().is_some() {
        let y = if below { place.bottom() } else { place.top() };
        painter.hline(place.x_range(), y, egui::Stroke::new(2.0, style::ACCENT));
    }
    if let Some(from) = response.dnd_release_payload::<usize>() {
        let gap = index + usize::from(below);
        let to = if gap > *from { gap - 1 } else { gap };
        if to != *from {
            move_track(*from, to, acts);
        }
    }
}

/// The texts of a row.
struct Words {
    number: String,
    /// The width of the widest number of the list, in digits.
    digits: usize,
    title: String,
    artist: Option<String>,
    length: String,
}

impl Words {
    fn of(panel: &TrackPanel, index: usize) -> Self {
        let list = &panel.list;
        let tags = panel.tags_of(index);
        let name = list.entries.get(index).map(|track| track.name.clone()).unwrap_or_default();
        Self {
            number: (index + 1).to_string(),
            digits: list.entries.len().to_string().len(),
            artist: tags.artist.filter(|_| tags.title.is_some()),
            title: tags.title.unwrap_or(name),
            length: tags.duration.map(clock_time).unwrap_or_default(),
        }
    }

    fn draw(&self, painter: &Painter, place: Rect, end: f32, is_present: bool) {
        let put = |text: &str, left: f32, width: f32, size: f32, color| {
            style::put(painter, pos2(left, place.center().y), text, size, color, width)
        };
        let indent = 10.0 + 7.5 * self.digits as f32;
        if is_present {
            let sign = Rect::from_min_size(place.min, vec2(indent, ROW));
            icons::draw(painter, Icon::PLAY, sign, 10.0, style::ACCENT);
        } else {
            put(&self.number, place.left() + 2.0, indent, style::SMALL_SIZE, style::DIM);
        }
        let at = pos2(end - 4.0, place.center().y);
        style::put_right(painter, at, &self.length, style::SMALL_SIZE, style::DIM, LENGTH);
        let left = place.left() + indent;
        let room = end - LENGTH - 4.0 - left;
        let color = if is_present { style::ACCENT } else { style::TEXT };
        let Some(artist) = &self.artist else {
            put(&self.title, left, room, style::TEXT_SIZE, color);
            return;
        };
        put(&self.title, left, TITLE_PART * room - 10.0, style::TEXT_SIZE, color);
        put(artist, left + TITLE_PART * room, (1.0 - TITLE_PART) * room, style::SMALL_SIZE, style::DIM);
    }

    /// The accessible name of a row.
    fn spoken(&self, index: usize, is_present: bool) -> String {
        let mut name = format!("{}, {}", index + 1, self.title);
        name.extend(self.artist.iter().map(|artist| format!(", {artist}")));
        if !self.length.is_empty() {
            name.push_str(&format!(", {}", self.length));
        }
        if is_present {
            name.push_str(", playing");
        }
        name
    }
}

fn buttons(ui: &mut Ui, panel: &TrackPanel, acts: &mut Acts) {
    let list = &panel.list;
    ui.horizontal(|ui| {
        if words::button(ui, "add music", true).on_hover_text("O, or drop files onto the window").clicked() {
            acts.commands.push(TrackPanel::ADD);
        }
        if words::button(ui, "search", !list.entries.is_empty()).on_hover_text("/ or Ctrl+F").clicked() {
            acts.on_panels.push(PanelAct::Tracks(on(TrackPanel::toggle_search)));
        }
        if words::button(ui, "clear", !list.entries.is_empty()).on_hover_text("remove all tracks").clicked() {
            acts.commands.push(Command::ClearTracks);
        }
        let undo = list.undo.as_deref();
        let words = undo.map_or_else(|| "undo".to_owned(), |edit| format!("undo: {edit}"));
        if words::button(ui, &words, undo.is_some()).on_hover_text("Ctrl+Z").clicked() {
            acts.commands.push(Command::UndoTracks);
        }
    });
}
