//! The scene list: a tile with a thumbnail for each scene, the search text, and filters.

use std::ops::Range;
use std::sync::Arc;

use egui::{Align, Id, Order, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};

use super::acts::{Acts, PanelAct, Pass, on};
use super::chips::{self, Chip};
use super::icons::{self, Icon};
use super::{assisted, kept, picture, style, words};
use image::RgbaImage;

use crate::scene_browser::{ENERGIES, SceneBrowser, SceneFilter, Tile, TilePicture};
use mariana_commands::{Command, Panel};
use mariana_scenes::thumbnails::LOOP_RATE;

/// Minimum width of a tile, in points. A row has as many tiles as fit.
const TILE_MIN: f32 = 168.0;
const GAP: f32 = 10.0;
const NAME: f32 = 22.0;
const LINE: f32 = 24.0;
const WIDTH_MAX: f32 = 1180.0;
/// Space below the filters.
const FILTERS_GAP: f32 = 6.0;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, browser: &SceneBrowser) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "scenes", Order::Foreground, style::middle(space, WIDTH_MAX), |ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, 0.0);
        let bottom = space.bottom() - style::PADDING.y - LINE;
        heading(ui, browser, acts);
        filters(ui, browser, acts);
        tiles(ui, (bottom - ui.cursor().top()).max(0.0), browser, acts);
        comment(ui, browser);
    })
}

fn heading(ui: &mut Ui, browser: &SceneBrowser, acts: &mut Acts) {
    let found = match browser.found() {
        all if all == browser.count() => format!("{all} scenes"),
        some => format!("{some} of {} scenes", browser.count()),
    };
    let keys = "type to search (B closes, a space and B search) · Enter or a click shows a scene · Tab or the star marks \
                it · Ctrl+M mood · Ctrl+E energy";
    let (title, hint) = match browser.query() {
        "" => (found.as_str(), keys),
        query => (query, found.as_str()),
    };
    if words::heading(ui, LINE, title, hint, !browser.query().is_empty(), "close the list of scenes") {
        acts.commands.push(Command::TogglePanel(Panel::Scenes));
    }
}

/// Draws a button for each mood and each energy.
fn filters(ui: &mut Ui, browser: &SceneBrowser, acts: &mut Acts) {
    let filters = &browser.filters;
    if filters.moods.is_empty() {
        return;
    }
    let energies = ENERGIES.iter().enumerate().map(|(at, (name, _))| (*name, SceneFilter::Energy(at)));
    let moods = filters.moods.iter().enumerate();
    let moods = moods.map(|(at, mood)| (mood.as_str(), SceneFilter::Mood(at)));
    let all: Vec<_> = energies.chain(moods).collect();
    let chips = all.iter().map(|(name, filter)| {
        let kind = match filter {
            SceneFilter::Mood(_) => "mood",
            SceneFilter::Energy(_) => "energy",
        };
        Chip::new(*name, format!("{kind}: {name}"), filters.is_on(*filter))
    });
    let clicked = chips::row(ui, "filters", chips).and_then(|at| all.get(at));
    if let Some((_, filter)) = clicked.copied() {
        let act = on(move |scenes: &mut SceneBrowser| scenes.filter(filter));
        acts.on_panels.push(PanelAct::Scenes(act));
    }
    ui.add_space(FILTERS_GAP);
}

fn tiles(ui: &mut Ui, height: f32, browser: &SceneBrowser, acts: &mut Acts) {
    let lane = 10.0;
    let room = ui.available_width() - lane;
    let columns = ((room + GAP) / (TILE_MIN + GAP)).floor().max(1.0);
    let width = (room - (columns - 1.0) * GAP) / columns;
    let tile_height = width * 9.0 / 16.0 + NAME;
    let columns = columns as usize;
    let count = browser.found();
    let rows = count.div_ceil(columns);
    let mut scroll = ScrollArea::vertical().max_height(height.max(tile_height)).auto_shrink([false, true]);
    let before = kept::replace(ui.ctx(), Id::unique("selected scene"), browser.selected);
    if before != Some(browser.selected) {
        let offset = style::scrolled_to(browser.selected / columns, tile_height, height);
        scroll = scroll.vertical_scroll_offset(offset);
    }
    let mut seen: Range<usize> = 0..0;
    let mut pointed = None;
    scroll.show_rows(ui, tile_height, rows, |ui, rows| {
        seen = rows.start * columns..(rows.end * columns).min(count);
        for row in rows {
            let (line, _) = ui.allocate_exact_size(vec2(room, tile_height), Sense::hover());
            for column in 0..columns {
                let place = row * columns + column;
                let Some(tile) = browser.tile(place) else { break };
                let left = line.left() + column as f32 * (width + GAP);
                let rect = Rect::from_min_size(pos2(left, line.top()), vec2(width, tile_height));
                if draw_tile(ui, rect, tile, place, browser, acts) {
                    pointed = Some(place);
                }
            }
        }
    });
    let moving = Some(pointed.unwrap_or(browser.selected));
    let record_drawn = on(move |scenes: &mut SceneBrowser| scenes.record_drawn(seen, columns, moving));
    acts.on_panels.push(PanelAct::Scenes(record_drawn));
}

/// Draws a tile. Returns true if the pointer rests on it.
fn draw_tile(
    ui: &mut Ui,
    rect: Rect,
    tile: &Tile,
    place: usize,
    browser: &SceneBrowser,
    acts: &mut Acts,
) -> bool {
    let area = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - NAME));
    let response = ui.interact(area, ui.scope_id().with(("tile", place)), Sense::click());
    let star =
        Rect::from_center_size(pos2(rect.right() - 10.0, rect.bottom() - 0.5 * NAME), vec2(22.0, NAME));
    let marks = ui.interact(star, ui.scope_id().with(("star", place)), Sense::click());
    let painter = ui.painter();
    painter.rect_filled(area, 4.0, style::RAIL);
    match &tile.picture {
        TilePicture::There(image) => {
            let frame = present_frame(ui, browser.frames(place));
            let texture = picture::texture(ui.ctx(), frame.unwrap_or(image));
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(texture, area, whole, egui::Color32::WHITE);
        }
        TilePicture::Missing(reason) => {
            let width = area.width() - 12.0;
            let galley =
                style::paragraph(painter, reason, style::SMALL_SIZE, style::ERROR, width, 4, Align::Center);
            painter.galley(area.center() - galley.rect.center().to_vec2(), galley, style::ERROR);
        }
        TilePicture::Unseen | TilePicture::Coming => {
            for dot in -1..=1 {
                painter.circle_filled(area.center() + vec2(9.0 * dot as f32, 0.0), 2.5, style::DIM);
            }
        }
    }
    let is_selected = browser.selected == place;
    let edge = match (is_selected, response.hovered()) {
        (true, _) => Some(Stroke::new(2.5, style::ACCENT)),
        (false, true) => Some(Stroke::new(1.5, style::TEXT)),
        (false, false) => None,
    };
    if let Some(edge) = edge {
        painter.rect_stroke(area, 4.0, edge, StrokeKind::Inside);
    }
    let color = if browser.is_present(place) { style::ACCENT } else { style::TEXT };
    let left = pos2(rect.left() + 2.0, star.center().y);
    style::put(painter, left, &tile.name, style::TEXT_SIZE, color, rect.width() - 26.0);
    if tile.favourite || marks.hovered() || response.hovered() {
        let color = if tile.favourite { style::ACCENT } else { style::DIM };
        icons::draw(painter, Icon::STAR, star, 12.0, color);
    }
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_selected, &tile.name));
    assisted::selected(&marks, egui::Role::CheckBox, tile.favourite, format_args!("mark {}", tile.name));
    if marks.clicked() {
        acts.on_panels.push(PanelAct::Scenes(Box::new(move |scenes| scenes.mark(place))));
    } else if response.clicked() {
        let close = response.double_clicked();
        acts.on_panels.push(PanelAct::Scenes(Box::new(move |scenes| scenes.show(place, close))));
    }
    let is_pointed = response.hovered();
    if !tile.about.comment.is_empty() {
        response.on_hover_text(&tile.about.comment);
    }
    is_pointed
}

/// The frame of a moving thumbnail at this moment. Requests the next drawing.
fn present_frame<'a>(ui: &Ui, frames: &'a [Arc<RgbaImage>]) -> Option<&'a Arc<RgbaImage>> {
    if frames.is_empty() {
        return None;
    }
    let each = 1.0 / f64::from(LOOP_RATE);
    let passed = ui.input(|input| input.time) / each;
    let left = each * (1.0 - passed.fract());
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(left.clamp(0.001, each)));
    frames.get(passed as usize % frames.len())
}

fn comment(ui: &mut Ui, browser: &SceneBrowser) {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    let words = match browser.tile(browser.selected) {
        Some(tile) if tile.about.comment.is_empty() => tile.name.clone(),
        Some(tile) => format!("{}: {}", tile.name, tile.about.comment),
        None => "no scene matches; press Esc to see all scenes".to_owned(),
    };
    let galley = style::line(ui.painter(), &words, style::SMALL_SIZE, style::DIM, place.width());
    ui.painter().galley(pos2(place.left(), place.bottom() - galley.size().y), galley, style::DIM);
}
