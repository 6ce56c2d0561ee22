//! Draws the table of keys in groups, side by side where the window is wide enough.

use std::sync::Arc;

use egui::text::LayoutJob;
use egui::{CornerRadius, Galley, Id, Order, Painter, Rect, Response, ScrollArea, Sense, Ui, pos2, vec2};

use super::acts::{PanelAct, Pass};
use super::{assisted, kept, style, words};
use crate::help_panel::HelpPanel;
use mariana_commands::{Binding, Command, Group};

const LINE: f32 = 26.0;
const ROW: f32 = 21.0;
/// Height of a group's heading, with the space above the heading.
const HEADING: f32 = 28.0;
const COLUMN_GAP: f32 = 26.0;
const CAP_HEIGHT: f32 = 18.0;
const CAP_PADDING: f32 = 5.0;
const CAP_GAP: f32 = 5.0;
const COLUMNS_MAX: usize = 2;

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, help: &HelpPanel) -> Rect {
    let Pass { context, acts } = pass;
    let painter = context.layer_painter(egui::LayerId::new(Order::Foreground, Id::unique("keys measured")));
    let room = (space.width() - 2.0 * style::PADDING.x - style::LANE).max(1.0);
    let widths = Widths::new(&painter, room);
    let panel = style::middle(space, widths.table() + style::LANE + 2.0 * style::PADDING.x);
    style::panel(context, "keys", Order::Foreground, panel, |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let is_search = !help.query().is_empty();
        let (title, hint) = match help.query() {
            "" => ("Keys", "type to search · Enter or a click does it · Esc closes"),
            query => (query, ""),
        };
        if words::heading(ui, LINE, title, hint, is_search, "close the table of keys") {
            acts.commands.push(Command::ToggleHelp);
        }
        let before = kept::replace(ui.ctx(), Id::unique("selected key"), help.selected);
        let moved = before.is_some_and(|before| before != help.selected);
        let height = (space.height() - 2.0 * style::PADDING.y - LINE).max(ROW);
        let area = ScrollArea::vertical().max_height(height).auto_shrink([false, true]).animated(false);
        let picked = area.show(ui, |ui| table(ui, help, &widths, moved)).inner;
        if let Some(place) = picked {
            acts.on_panels.push(PanelAct::Help(Box::new(move |help| help.pick(place))));
        }
    })
}

/// The widths of the table's parts in points. All rows are measured, so that a search does not move the columns.
struct Widths {
    columns: usize,
    caps: f32,
    column: f32,
}

impl Widths {
    /// Fits the table into `room` points. Meanings break into lines in a narrow window.
    fn new(painter: &Painter, room: f32) -> Self {
        let all = HelpPanel::default().found();
        let widest = |width_of: &dyn Fn(&'static Binding) -> f32| {
            all.iter().flat_map(|(_, rows)| rows).map(|binding| width_of(binding)).fold(0.0, f32::max)
        };
        let caps = widest(&|binding| {
            caps(painter, binding).map(|cap| cap.size().x + 2.0 * CAP_PADDING + CAP_GAP).sum()
        });
        let natural =
            caps + CAP_GAP + widest(&|binding| meaning(painter, binding.help, f32::INFINITY).size().x);
        let fits = |columns: usize| columns as f32 * (natural + COLUMN_GAP) - COLUMN_GAP <= room;
        let columns = (1..=COLUMNS_MAX).rev().find(|columns| fits(*columns)).unwrap_or(1);
        Self { columns, caps, column: natural.min(room) }
    }

    fn table(&self) -> f32 {
        self.columns as f32 * (self.column + COLUMN_GAP) - COLUMN_GAP
    }
}

type Rows = (Group, Vec<&'static Binding>);

/// Draws the table. Returns the index of the clicked row among all rows.
fn table(ui: &mut Ui, help: &HelpPanel, widths: &Widths, moved: bool) -> Option<usize> {
    let groups = help.found();
    if groups.is_empty() {
        let (place, _) = ui.allocate_exact_size(vec2(widths.table(), ROW), Sense::hover());
        words::hint(ui, place, "no key does this; press Backspace to shorten the search");
    }
    let (mut place, mut picked) = (0, None);
    ui.set_width(widths.table());
    ui.spacing_mut().item_spacing = vec2(COLUMN_GAP, 0.0);
    ui.horizontal_top(|ui| {
        for column in balanced(groups, widths.columns) {
            ui.vertical(|ui| {
                for (group, rows) in column {
                    draw_heading(ui, widths.column, group.name());
                    for binding in rows {
                        let is_selected = place == help.selected;
                        let response = draw_row(ui, binding, widths, is_selected);
                        if is_selected && moved {
                            // Show a row or heading beyond the selected row, too.
                            ui.scroll_to_rect(response.rect.expand2(vec2(0.0, HEADING)), None);
                        }
                        picked = picked.or(response.clicked().then_some(place));
                        place += 1;
                    }
                }
            });
        }
    });
    picked
}

/// Divides the groups among at most two columns so that the longest column is as short as possible.
fn balanced(mut groups: Vec<Rows>, columns: usize) -> Vec<Vec<Rows>> {
    let height =
        |groups: &[Rows]| -> f32 { groups.iter().map(|(_, rows)| HEADING + rows.len() as f32 * ROW).sum() };
    let longest = |split: usize| {
        let (left, right) = groups.split_at(split);
        height(left).max(height(right))
    };
    let splits = 1..groups.len() * usize::from(columns > 1);
    let split = splits.min_by(|a, b| longest(*a).total_cmp(&longest(*b))).unwrap_or(groups.len());
    let rest = groups.split_off(split);
    [groups, rest].into_iter().filter(|column| !column.is_empty()).collect()
}

fn draw_heading(ui: &mut Ui, width: f32, words: &str) {
    let (place, _) = ui.allocate_exact_size(vec2(width, HEADING), Sense::hover());
    let galley = style::line(ui.painter(), words, style::TEXT_SIZE, style::ACCENT, width);
    let at = place.left_bottom() - vec2(0.0, galley.size().y + 4.0);
    ui.painter().galley(at, galley, style::ACCENT);
    assisted::text(ui.ctx(), words, words, false);
}

fn draw_row(ui: &mut Ui, binding: &'static Binding, widths: &Widths, is_selected: bool) -> Response {
    let room = (widths.column - widths.caps - CAP_GAP).max(1.0);
    let meaning = meaning(ui.painter(), binding.help, room);
    let size = vec2(widths.column, meaning.size().y.max(ROW));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let painter = ui.painter();
    style::light(painter, rect.expand2(vec2(4.0, 0.0)), is_selected || response.hovered());
    let mut left = rect.left();
    for cap in caps(painter, binding) {
        let size = vec2(cap.size().x + 2.0 * CAP_PADDING, CAP_HEIGHT);
        let place = Rect::from_min_size(pos2(left, rect.top() + 0.5 * (ROW - CAP_HEIGHT)), size);
        painter.rect_filled(place, CornerRadius::same(4), style::RAIL);
        painter.galley(place.center() - 0.5 * cap.size(), cap, style::TEXT);
        left = place.right() + CAP_GAP;
    }
    let top = rect.center().y - 0.5 * meaning.size().y;
    painter.galley(pos2(rect.left() + widths.caps + CAP_GAP, top), meaning, style::TEXT);
    let name = format_args!("{}, key {}", binding.help, binding.written);
    assisted::selected(&response, egui::Role::Button, is_selected, name);
    response
}

fn caps<'a>(painter: &'a Painter, binding: &'static Binding) -> impl Iterator<Item = Arc<Galley>> + use<'a> {
    binding.caps().map(|cap| style::line(painter, cap, style::SMALL_SIZE, style::TEXT, f32::INFINITY))
}

fn meaning(painter: &Painter, words: &str, width: f32) -> Arc<Galley> {
    let font = style::proportional(style::TEXT_SIZE);
    painter.layout_job(LayoutJob::simple(words.to_owned(), font, style::TEXT, width))
}
