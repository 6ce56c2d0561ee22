//! What screen readers are told beyond what egui tells of its widgets, and what they may change.

use std::ops::RangeInclusive;

use egui::accesskit::{Action, ActionData, Live, Role};
use egui::{Context, Id, Response, Ui, accesskit_root_id};

/// Names the window.
pub(super) fn window(context: &Context) {
    let _ = context.accesskit_node_builder(accesskit_root_id(), |node| node.set_label("Mariana"));
}

/// Tells a text that is drawn without a widget, under a name of its own; `news` is read out when it comes up.
pub(super) fn text(context: &Context, name: &str, words: &str, news: bool) {
    let _ = context.accesskit_node_builder(Id::unique(("text", name)), |node| {
        node.set_role(Role::Label);
        node.set_value(words);
        if news {
            node.set_live(Live::Polite);
        }
    });
}

/// Tells a rail with a value that can be changed by `step`; returns the value that it is set to, if any.
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
    let wanted = ui.input(|input| {
        let count = |action| input.num_accesskit_action_requests(response.id, action) as f64;
        let set =
            input.accesskit_action_requests(response.id, Action::SetValue).filter_map(
                |request| match request.data {
                    Some(ActionData::NumericValue(value)) if value.is_finite() => Some(value),
                    _ => None,
                },
            );
        let steps = count(Action::Increment) - count(Action::Decrement);
        set.last().or_else(|| (steps != 0.0).then_some(value + steps * step))
    });
    wanted.map(|wanted| wanted.max(least).min(greatest))
}
