//! Accessibility: describes hand-drawn controls to screen readers, and lets screen readers change the controls.

use std::ops::RangeInclusive;

use egui::accesskit::{Action, ActionData, ActionRequest, Live, Role};
use egui::{
    Context, EventFilter, Id, Key, Painter, Response, Stroke, StrokeKind, Ui, WidgetInfo, accesskit_root_id,
};

use super::style;

/// An event of an assistive technology.
#[derive(Debug, Clone, PartialEq)]
pub enum Assistance {
    /// The assistive technology has started and needs the tree of controls.
    Begins,
    /// The assistive technology presses or changes a control.
    Act(ActionRequest),
    /// The assistive technology has ended.
    Ends,
}

pub(super) fn window(context: &Context) {
    let _ = context.accesskit_node_builder(accesskit_root_id(), |node| node.set_label("Mariana"));
}

/// Sets the accessible name of a control that is on or off.
pub(super) fn selected(response: &Response, role: Role, is_on: bool, name: impl ToString) {
    response.widget_info(|| WidgetInfo::selected(role, true, is_on, name.to_string()));
}

/// Exposes text without a widget to screen readers, under a unique name. If `news` is true, they announce its changes.
pub(super) fn text(context: &Context, name: &str, words: &str, news: bool) {
    let _ = context.accesskit_node_builder(Id::unique(("text", name)), |node| {
        node.set_role(Role::Label);
        node.set_value(words);
        if news {
            node.set_live(Live::Polite);
        }
    });
}

pub(super) fn describe(context: &Context, control: Id, words: &str) {
    let _ = context.accesskit_node_builder(control, |node| node.set_description(words));
}

pub(super) fn ring(context: &Context, painter: &Painter) {
    let focused = context.memory(|memory| memory.focused()).and_then(|id| context.read_response(id));
    if let Some(control) = focused {
        let stroke = Stroke::new(2.0, style::ACCENT);
        painter.rect_stroke(control.rect.expand(1.0), 4.0, stroke, StrokeKind::Outside);
    }
}

/// Number of arrow key presses while `response` has the focus; positive to the right.
fn steps_by_keys(ui: &Ui, response: &Response) -> f64 {
    if !response.has_focus() {
        return 0.0;
    }
    let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    ui.input(|input| {
        let count = |key| input.num_presses(key) as f64;
        count(Key::ArrowRight) - count(Key::ArrowLeft)
    })
}

/// Exposes a slider with steps of `step` to screen readers. Returns the value that keys or a screen reader set, if any.
pub(super) fn rail(
    ui: &Ui,
    response: &Response,
    name: &str,
    value: f64,
    range: RangeInclusive<f64>,
    step: f64,
) -> Option<f64> {
    let (least, greatest) = range.into_inner();
    let _ = ui.accesskit_node_builder(response.id, |node| {
        node.set_role(Role::Slider);
        node.set_label(name);
        node.set_numeric_value(value);
        node.set_min_numeric_value(least);
        node.set_max_numeric_value(greatest);
        node.set_numeric_value_step(step);
        for action in [Action::SetValue, Action::Increment, Action::Decrement] {
            node.add_action(action);
        }
    });
    let by_keys = steps_by_keys(ui, response);
    let wanted = ui.input(|input| {
        let count = |action| input.num_accesskit_action_requests(response.id, action) as f64;
        let set =
            input.accesskit_action_requests(response.id, Action::SetValue).filter_map(
                |request| match request.data {
                    Some(ActionData::NumericValue(value)) if value.is_finite() => Some(value),
                    _ => None,
                },
            );
        let steps = count(Action::Increment) - count(Action::Decrement) + by_keys;
        set.last().or_else(|| (steps != 0.0).then_some(value + steps * step))
    });
    wanted.map(|wanted| wanted.max(least).min(greatest))
}
