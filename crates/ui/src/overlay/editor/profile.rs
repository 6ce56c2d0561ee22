//! Draws the table of the objects' costs, most expensive object first.

use egui::{Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::editor::{Editor, parts_of};
use crate::overlay::acts::Acts;
use crate::overlay::{assisted, style};

const ROW: f32 = 16.0;
/// Maximum number of objects that are listed individually. The next constant limits the listed parts of an object.
const OBJECTS_MAX: usize = 7;
const PARTS_MAX: usize = 3;
const COUNTED: &str = "shape, material: operations of the object's own formulas. seen: fraction of the image \
                       where the object is in front. steps: mean number of distances that a ray to the object \
                       evaluates. work: fraction of the operations of all camera rays that rays to the object \
                       take. Shadows, mirrors and ambient light are not counted.";

struct Row {
    name: String,
    cells: [String; 5],
    place: Option<(usize, usize)>,
    is_part: bool,
}

fn leave_out_parts(rows: &mut Vec<Row>, rows_max: usize) {
    while rows.len() > rows_max
        && let Some(last) = rows.iter().rposition(|row| row.is_part)
    {
        rows.remove(last);
    }
}

/// Draws the table at the bottom of `space`. Returns the table's top edge.
pub(super) fn show(ui: &Ui, space: Rect, editor: &Editor, acts: &mut Acts) -> f32 {
    if !editor.picture.profiles {
        return space.bottom();
    }
    let mut rows = rows(editor);
    // Leave out parts of objects to make room for the text.
    leave_out_parts(&mut rows, (0.45 * space.height() / ROW) as usize);
    let height = ROW * (rows.len() + 1) as f32 + 8.0;
    let table = Rect::from_min_max(pos2(space.left(), (space.bottom() - height).max(space.top())), space.max);
    let painter = ui.painter().with_clip_rect(table.intersect(ui.clip_rect()));
    painter.hline(space.x_range(), table.top(), egui::Stroke::new(1.0, style::RAIL));
    let column = (0.13 * space.width()).clamp(46.0, 76.0);
    let names = space.width() - 5.0 * column;
    let draw = |y: f32, name: &str, cells: &[String; 5], color| {
        let galley = style::line(&painter, name, style::SMALL_SIZE, color, names - 8.0);
        painter.galley(pos2(table.left() + 4.0, y), galley, color);
        for (number, cell) in cells.iter().enumerate() {
            let galley = style::line(&painter, cell, style::SMALL_SIZE, color, column);
            let right = table.left() + names + (number + 1) as f32 * column - 4.0;
            painter.galley(pos2(right - galley.size().x, y), galley, color);
        }
    };
    let mut y = table.top() + 4.0;
    let heads = ["shape", "material", "seen", "steps", "work"].map(str::to_owned);
    draw(y, "cost of camera rays", &heads, style::DIM);
    let head = Rect::from_min_size(pos2(table.left(), y), vec2(table.width(), ROW));
    ui.interact(head, Id::unique("profile head"), Sense::hover()).on_hover_text(COUNTED);
    for (number, row) in rows.iter().enumerate() {
        y += ROW;
        let place = Rect::from_min_size(pos2(table.left(), y), vec2(table.width(), ROW));
        if let Some((text, byte)) = row.place {
            let response = ui.interact(place, Id::unique(("profile row", number)), Sense::click());
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &row.name));
            if response.hovered() {
                painter.rect_filled(place, 3.0, style::RAIL);
            }
            if response.clicked() {
                acts.on_editor(move |editor| editor.jump_to(text, byte));
            }
        }
        draw(y, &row.name, &row.cells, style::TEXT);
    }
    let reported: Vec<String> =
        rows.iter().map(|row| format!("{} {}", row.name, row.cells.join(" "))).collect();
    assisted::text(ui.ctx(), "profile", &reported.join("; "), false);
    table.top() - 4.0
}

fn rows(editor: &Editor) -> Vec<Row> {
    let nothing = || std::array::from_fn(|_| String::new());
    let Some((ray_statistics, objects)) = editor.picture.profile() else {
        return vec![Row { name: "measuring ...".to_owned(), cells: nothing(), place: None, is_part: false }];
    };
    let (all, run) = (ray_statistics.cells.len().max(1) as f64, ray_statistics.run().max(1) as f64);
    let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
    let counted = |rays: u32, evaluations: u64, run_of_it: u64| {
        let steps = evaluations as f64 / f64::from(rays.max(1));
        [percent(f64::from(rays) / all), format!("{steps:.1}"), percent(run_of_it as f64 / run)]
    };
    let mut rows = Vec::new();
    for object in objects.iter().take(OBJECTS_MAX) {
        let [seen, steps, work] = counted(object.rays, object.evaluations, object.run);
        let [shape, material] = [object.clauses.0, object.clauses.1].map(|clauses| clauses.to_string());
        let cells = [shape, material, seen, steps, work];
        rows.push(Row { name: object.name.clone(), cells, place: object.place, is_part: false });
        for (number, words, part) in parts_of(object, &editor.texts).into_iter().take(PARTS_MAX) {
            let [seen, steps, work] = counted(part.rays, part.evaluations, part.run);
            let cells = [String::new(), String::new(), seen, steps, work];
            let (file, bytes) = part.written;
            let name = format!("    line {number}: {words}");
            rows.push(Row { name, cells, place: Some((file, bytes.start)), is_part: true });
        }
    }
    let mut add = |name: String, rays: u32, of_it: u64| {
        let mut cells: [String; 5] = nothing();
        (cells[2], cells[4]) = (percent(f64::from(rays) / all), percent(of_it as f64 / run));
        rows.push(Row { name, cells, place: None, is_part: false });
    };
    let others = objects.get(OBJECTS_MAX..).unwrap_or(&[]);
    if !others.is_empty() {
        let rays = others.iter().map(|object| object.rays).sum();
        add(format!("{} others", others.len()), rays, others.iter().map(|object| object.run).sum());
    }
    add("the sky".to_owned(), ray_statistics.sky.0, ray_statistics.sky.1);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_left_out_before_objects_where_there_is_little_room() {
        let row = |name: &str| Row {
            name: name.to_owned(),
            cells: Default::default(),
            place: None,
            is_part: name.starts_with("line"),
        };
        let left = |rows_max: usize| {
            let mut rows: Vec<Row> = ["one", "line 1", "line 2", "two", "line 3", "the sky"].map(row).into();
            leave_out_parts(&mut rows, rows_max);
            rows.into_iter().map(|row| row.name).collect::<Vec<_>>()
        };
        assert_eq!(left(6).len(), 6);
        assert_eq!(left(4), ["one", "line 1", "two", "the sky"]);
        assert_eq!(left(0), ["one", "two", "the sky"]);
    }
}
