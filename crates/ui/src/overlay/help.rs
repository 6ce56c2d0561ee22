//! Draws the table of keys in groups, side by side where the window is wide enough.

use std::sync::Arc;

use egui::text::LayoutJob;
use egui::{CornerRadius, Galley, Id, Order, Painter, Rect, ScrollArea, Sense, Ui, pos2, vec2};

use super::acts::{Acts, PanelAct, Pass};
use super::{assisted, style, words};
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

/// The selected row and the scroll position at the last drawing.
pub(super) struct Seen {
    selected: usize,
    offset: f32,
}

pub(super) fn show(pass: &mut Pass<'_>, space: Rect, help: &HelpPanel, seen: &mut Option<Seen>) -> Rect {
    let Pass { context, acts } = pass;
    let painter = context.layer_painter(egui::LayerId::new(Order::Foreground, Id::unique("keys measured")));
    let room = (space.width() - 2.0 * style::PADDING.x - style::LANE).max(1.0);
    let table = Table::new(&painter, help, room);
    let width = table.width() + style::LANE + 2.0 * style::PADDING.x;
    // Keep the panel's place while a search shortens the table.
    style::panel(context, "keys", Order::Foreground, style::middle(space, width), |ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
        let hint = "type to search · Enter or a click does it · Esc closes";
        if words::heading(ui, LINE, "Keys", hint, help.query(), "close the table of keys") {
            acts.commands.push(Command::ToggleHelp);
        }
        let height = (space.height() - 2.0 * style::PADDING.y - LINE).max(ROW);
        let mut scroll = ScrollArea::vertical().max_height(height).auto_shrink([false, true]);
        let selected = help.selected;
        let before = seen.as_ref().filter(|before| before.selected != selected);
        if let Some((before, (top, bottom))) = before.zip(table.span(selected)) {
            // Scroll as little as possible, and show a row or heading beyond the selected row.
            let offset = before.offset.min(top - HEADING).max(bottom + ROW - height);
            scroll = scroll.vertical_scroll_offset(offset.max(0.0));
        }
        let shown = scroll.show(ui, |ui| table.draw(ui, selected, acts));
        *seen = Some(Seen { selected, offset: shown.state.clamped_offset().y });
    })
}

struct KeyRow {
    binding: &'static Binding,
    caps: Vec<Arc<Galley>>,
    meaning: Arc<Galley>,
    /// Index among all rows of the table.
    place: usize,
}

impl KeyRow {
    fn height(&self) -> f32 {
        self.meaning.size().y.max(ROW)
    }
}

struct KeyGroup {
    heading: Arc<Galley>,
    group: Group,
    rows: Vec<KeyRow>,
}

impl KeyGroup {
    fn height(&self) -> f32 {
        HEADING + self.rows.iter().map(KeyRow::height).sum::<f32>()
    }
}

/// The laid out table. Lengths are in points.
struct Table {
    columns: Vec<Vec<KeyGroup>>,
    caps_width: f32,
    column_width: f32,
}

impl Table {
    /// Lays out the table in at most `room` points. Meanings break into lines in a narrow window.
    fn new(painter: &Painter, help: &HelpPanel, room: f32) -> Self {
        // Measure all rows, so that a search does not move the columns.
        let all = HelpPanel::default().found();
        let bindings = || all.iter().flat_map(|(_, rows)| rows).copied();
        let caps_width = bindings().map(|binding| width_of(&caps(painter, binding))).fold(0.0, f32::max);
        let meaning_width = bindings()
            .map(|binding| meaning(painter, binding.help, f32::INFINITY).size().x)
            .fold(0.0, f32::max);
        let natural = caps_width + CAP_GAP + meaning_width;
        let fits = |columns: usize| columns as f32 * (natural + COLUMN_GAP) - COLUMN_GAP <= room;
        let columns = (1..=COLUMNS_MAX).rev().find(|columns| fits(*columns)).unwrap_or(1);
        let column_width = natural.min(room);
        let meaning_room = (column_width - caps_width - CAP_GAP).max(1.0);
        let mut place = 0;
        let blocks = help.found().into_iter().map(|(group, rows)| KeyGroup {
            heading: style::line(painter, group.name(), style::TEXT_SIZE, style::ACCENT, column_width),
            group,
            rows: rows
                .into_iter()
                .map(|binding| {
                    let row = KeyRow {
                        binding,
                        caps: caps(painter, binding),
                        meaning: meaning(painter, binding.help, meaning_room),
                        place,
                    };
                    place += 1;
                    row
                })
                .collect(),
        });
        Self { columns: balanced(blocks.collect(), columns), caps_width, column_width }
    }

    fn width(&self) -> f32 {
        let columns = self.columns.len().max(1) as f32;
        columns * (self.column_width + COLUMN_GAP) - COLUMN_GAP
    }

    /// The upper and lower edge of a row, from the top of the table.
    fn span(&self, selected: usize) -> Option<(f32, f32)> {
        for column in &self.columns {
            let mut at = 0.0;
            for block in column {
                at += HEADING;
                for row in &block.rows {
                    if row.place == selected {
                        return Some((at, at + row.height()));
                    }
                    at += row.height();
                }
            }
        }
        None
    }

    fn draw(&self, ui: &mut Ui, selected: usize, acts: &mut Acts) {
        let height = |column: &Vec<KeyGroup>| column.iter().map(KeyGroup::height).sum::<f32>();
        let height = self.columns.iter().map(height).fold(0.0, f32::max).max(ROW);
        let (all, _) = ui.allocate_exact_size(vec2(self.width(), height), Sense::hover());
        for (number, column) in self.columns.iter().enumerate() {
            let left = all.left() + number as f32 * (self.column_width + COLUMN_GAP);
            let mut at = pos2(left, all.top());
            for block in column {
                let top = at.y + HEADING - block.heading.size().y - 4.0;
                ui.painter().galley(pos2(left, top), block.heading.clone(), style::ACCENT);
                super::assisted::text(ui.ctx(), block.group.name(), block.group.name(), false);
                at.y += HEADING;
                for row in &block.rows {
                    let rect = Rect::from_min_size(at, vec2(self.column_width, row.height()));
                    let is_selected = row.place == selected;
                    self.draw_row(ui, row, rect, is_selected, acts);
                    at.y += row.height();
                }
            }
        }
        if self.columns.iter().all(Vec::is_empty) {
            let words = "no key does this; press Backspace to shorten the search";
            let galley = style::line(ui.painter(), words, style::SMALL_SIZE, style::DIM, all.width());
            ui.painter().galley(all.min, galley, style::DIM);
        }
    }

    fn draw_row(&self, ui: &Ui, row: &KeyRow, rect: Rect, is_selected: bool, acts: &mut Acts) {
        let response = ui.interact(rect, ui.scope_id().with(row.binding.written), Sense::click());
        let painter = ui.painter();
        style::light(painter, rect.expand2(vec2(4.0, 0.0)), is_selected || response.hovered());
        let mut left = rect.left();
        for cap in &row.caps {
            let size = vec2(cap.size().x + 2.0 * CAP_PADDING, CAP_HEIGHT);
            let place = Rect::from_min_size(pos2(left, rect.top() + 0.5 * (ROW - CAP_HEIGHT)), size);
            painter.rect_filled(place, CornerRadius::same(4), style::RAIL);
            painter.galley(place.center() - 0.5 * cap.size(), cap.clone(), style::TEXT);
            left = place.right() + CAP_GAP;
        }
        let top = rect.center().y - 0.5 * row.meaning.size().y;
        let at = pos2(rect.left() + self.caps_width + CAP_GAP, top);
        painter.galley(at, row.meaning.clone(), style::TEXT);
        assisted::selected(
            &response,
            egui::Role::Button,
            is_selected,
            format_args!("{}, key {}", row.binding.help, row.binding.written),
        );
        if response.clicked() {
            let place = row.place;
            acts.on_panels.push(PanelAct::Help(Box::new(move |help| help.pick(place))));
        }
    }
}

/// Divides the groups among `columns` columns so that the longest column is as short as possible.
fn balanced(blocks: Vec<KeyGroup>, columns: usize) -> Vec<Vec<KeyGroup>> {
    let heights: Vec<f32> = blocks.iter().map(KeyGroup::height).collect();
    let (mut first, mut rest) = (blocks, Vec::new());
    if columns > 1 && first.len() > 1 {
        let longest = |split: &usize| {
            let (left, right) = heights.split_at((*split).min(heights.len()));
            left.iter().sum::<f32>().max(right.iter().sum::<f32>())
        };
        let split = (1..first.len()).min_by(|a, b| longest(a).total_cmp(&longest(b)));
        rest = first.split_off(split.unwrap_or(first.len()));
    }
    // A search that leaves one group keeps the width of the table.
    if columns > 1 { vec![first, rest] } else { vec![first] }
}

fn caps(painter: &Painter, binding: &'static Binding) -> Vec<Arc<Galley>> {
    let cap = |cap: &str| style::line(painter, cap, style::SMALL_SIZE, style::TEXT, f32::INFINITY);
    binding.caps().map(cap).collect()
}

fn width_of(caps: &[Arc<Galley>]) -> f32 {
    caps.iter().map(|cap| cap.size().x + 2.0 * CAP_PADDING + CAP_GAP).sum()
}

fn meaning(painter: &Painter, words: &str, width: f32) -> Arc<Galley> {
    let font = style::proportional(style::TEXT_SIZE);
    painter.layout_job(LayoutJob::simple(words.to_owned(), font, style::TEXT, width))
}
