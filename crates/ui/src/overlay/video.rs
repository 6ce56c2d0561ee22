//! Draws the panel that makes videos.

use std::sync::Arc;

use egui::{Align, Galley, Id, Order, Rect, Response, Sense, Ui, WidgetInfo, pos2, vec2};

use super::acts::Pass;
use super::chips::{self, Chip};
use super::{assisted, kept, style, words};
use crate::video_panel::{VideoPanel, VideoRow, choose, job};
use mariana_commands::{Command, Panel, VideoEdit};

const WIDTH_MAX: f32 = 640.0;
const LINE: f32 = 24.0;
const INDENT: f32 = 6.0;
/// Width of the choices' names in points.
const NAME: f32 = 92.0;
const RAIL_HEIGHT: f32 = 4.0;
const ABOUT_ROWS: usize = 2;
/// Width of the place for the button that makes a video.
const MAKE_WIDTH: f32 = 118.0;
const GAP: f32 = 4.0;
const MAKE: &str = "make the video";

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, panel: &VideoPanel) -> Rect {
    let Pass { context, acts } = pass;
    style::panel(context, "videos", Order::Foreground, style::middle(space, WIDTH_MAX), |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let mut ask = |command| acts.commands.push(command);
        let hint = "Enter makes it · choose with the arrows or a click";
        if words::heading(ui, LINE, "Make a video", hint, false, "close the videos") {
            ask(Command::TogglePanel(Panel::Video));
        }
        let foot = Foot::new(ui, panel);
        let height = (space.height() - 2.0 * style::PADDING.y - LINE - foot.height()).max(LINE);
        let jobs = panel.rows.iter().filter(|row| matches!(row, VideoRow::Job { .. })).count();
        let before = kept::replace(ui.ctx(), Id::unique("selected video"), (panel.selected, jobs));
        let moved = before.is_some_and(|(selected, _)| selected != panel.selected);
        // Show the queue, which is above the choices.
        let is_new = before.is_none_or(|(_, before)| before < jobs);
        style::scrolled(ui, height, is_new, |ui| rows(ui, panel, moved, &mut ask));
        foot.show(ui, panel, &mut ask);
    })
}

/// Draws the queue and the choices.
fn rows(ui: &mut Ui, panel: &VideoPanel, moved: bool, ask: &mut impl FnMut(Command)) {
    for (place, row) in panel.rows.iter().enumerate() {
        let selected = (place == panel.selected).then(|| panel.selected_button());
        let drawn = match row {
            VideoRow::Job { .. } => ui.push_id(place, |ui| draw_job(ui, row, selected, ask)).inner,
            VideoRow::Choice { .. } => ui.push_id(place, |ui| draw_choice(ui, row, selected, ask)).inner,
            VideoRow::Make { .. } => continue,
        };
        if selected.is_some() && moved {
            drawn.scroll_to_me(None);
        }
    }
}

fn draw_choice(
    ui: &mut Ui,
    row: &VideoRow,
    selected: Option<Option<usize>>,
    ask: &mut impl FnMut(Command),
) -> Response {
    let VideoRow::Choice { what, name, options, chosen } = row else { return ui.response() };
    let put_name = |ui: &Ui, place: Rect| {
        let color = if selected.is_some() { style::ACCENT } else { style::TEXT };
        let left = place.left_center() + vec2(INDENT, 0.0);
        style::put(ui.painter(), left, name, style::TEXT_SIZE, color, NAME - INDENT);
    };
    let drawn = words::named_row(ui, vec2(NAME, LINE), selected.is_some(), put_name, |ui| {
        let chips = options.iter().enumerate().map(|(index, option)| {
            let is_lit = *chosen == Some(index) || selected == Some(Some(index));
            Chip::new(&option.text, format!("{name}: {}", option.text), is_lit)
        });
        if let Some(option) = chips::row(ui, name, chips) {
            ask(choose(*what, option));
        }
    });
    drawn.response
}

fn draw_job(
    ui: &mut Ui,
    row: &VideoRow,
    selected: Option<Option<usize>>,
    ask: &mut impl FnMut(Command),
) -> Response {
    let VideoRow::Job { id, name, about, fraction, is_bad, actions } = row else { return ui.response() };
    let ground = ui.painter().add(egui::Shape::Noop);
    let drawn = ui.vertical(|ui| {
        let (place, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
        let color = if selected.is_some() { style::ACCENT } else { style::TEXT };
        let left = place.left_center() + vec2(INDENT, 0.0);
        let end = style::put(ui.painter(), left, name, style::TEXT_SIZE, color, 0.55 * place.width());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{name}, {about}")));
        if *is_bad {
            sentence(ui, about, style::ERROR);
        } else {
            let (left, room) = (pos2(end + 10.0, left.y), place.right() - end - 10.0);
            style::put(ui.painter(), left, about, style::SMALL_SIZE, style::DIM, room);
        }
        if let Some(fraction) = fraction {
            let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), RAIL_HEIGHT), Sense::hover());
            style::fraction(ui.painter(), place.shrink2(vec2(INDENT, 0.0)), *fraction);
        }
        ui.add_space(3.0);
        ui.horizontal(|ui| {
            ui.add_space(INDENT);
            let chips = actions.iter().enumerate().map(|(index, (_, words))| {
                Chip::new(*words, format!("{words}, {name}"), selected == Some(Some(index)))
            });
            if let Some((action, _)) = chips::row(ui, "actions", chips).and_then(|at| actions.get(at)) {
                ask(job(*id, *action));
            }
        });
        ui.add_space(5.0);
    });
    style::light_behind(ui, ground, drawn.response.rect, selected.is_some());
    drawn.response
}

/// Draws a sentence in at most [`ABOUT_ROWS`] lines.
fn sentence(ui: &mut Ui, text: &str, color: egui::Color32) {
    let galley = wrapped(ui, text, color, ui.available_width() - 2.0 * INDENT);
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), galley.size().y), Sense::hover());
    ui.painter().galley(pos2(place.left() + INDENT, place.top()), galley, color);
}

fn wrapped(ui: &Ui, text: &str, color: egui::Color32, width: f32) -> Arc<Galley> {
    style::paragraph(ui.painter(), text, style::SMALL_SIZE, color, width, ABOUT_ROWS, Align::LEFT)
}

/// The lower end of the panel: the explanation of the selected option, the button that makes a video, and what is
/// known about the video.
struct Foot {
    meaning: Option<Arc<Galley>>,
    about: Arc<Galley>,
}

impl Foot {
    fn new(ui: &Ui, panel: &VideoPanel) -> Self {
        let width = ui.available_width() - 2.0 * INDENT;
        let meaning = match panel.rows.get(panel.selected) {
            Some(VideoRow::Choice { options, chosen, .. }) => {
                let option = chosen.or(panel.selected_button()).and_then(|option| options.get(option));
                option.map(|option| wrapped(ui, &option.meaning, style::DIM, width))
            }
            _ => None,
        };
        let (about, is_bad) = match panel.rows.last() {
            Some(VideoRow::Make { about, is_bad, .. }) => (about.as_str(), *is_bad),
            _ => ("", false),
        };
        let color = if is_bad { style::ERROR } else { style::TEXT };
        Self { meaning, about: wrapped(ui, about, color, width - MAKE_WIDTH) }
    }

    fn line(&self) -> f32 {
        self.about.size().y.max(LINE)
    }

    fn height(&self) -> f32 {
        self.meaning.as_ref().map_or(0.0, |meaning| meaning.size().y) + self.line() + 2.0 * GAP
    }

    fn show(self, ui: &mut Ui, panel: &VideoPanel, ask: &mut impl FnMut(Command)) {
        let Some(VideoRow::Make { about, is_ready, .. }) = panel.rows.last() else { return };
        let line = self.line();
        ui.add_space(GAP);
        if let Some(meaning) = self.meaning {
            let (place, _) = ui.allocate_exact_size(meaning.size(), Sense::hover());
            ui.painter().galley(place.min + vec2(INDENT, 0.0), meaning, style::DIM);
        }
        ui.add_space(GAP);
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), line), Sense::hover());
        let button = Rect::from_min_size(place.min, vec2(MAKE_WIDTH, line)).shrink2(vec2(INDENT, 2.0));
        ui.scope_builder(egui::UiBuilder::new().max_rect(button), |ui| {
            let is_selected = matches!(panel.rows.get(panel.selected), Some(VideoRow::Make { .. }));
            let chip =
                Chip { is_dim: !is_ready, ..Chip::new(MAKE, MAKE.to_owned(), is_selected && *is_ready) };
            if chips::row(ui, MAKE, [chip]).is_some() && *is_ready {
                ask(Command::Video(VideoEdit::Make));
            }
        });
        assisted::text(ui.ctx(), "the video", about, true);
        let top = place.center().y - 0.5 * self.about.size().y;
        ui.painter().galley(pos2(place.left() + MAKE_WIDTH, top), self.about, style::TEXT);
    }
}
