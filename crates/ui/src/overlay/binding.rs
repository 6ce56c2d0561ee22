//! The sound that moves a slider: a button in the slider's row, and the list of sounds below the row.

use egui::{Pos2, Rect, Sense, Shape, Stroke, Ui, pos2};

use super::acts::Acts;
use super::chips::{self, Chip};
use super::{assisted, params, style};
use mariana_commands::{Bind, Command};
use mariana_control::{Bound, ChangedBy, Curve, Slider, SoundBinding};
use mariana_field::graph::{UnitInput, Wave};

/// The smoothing times to choose from, in seconds.
const TIMES: [(f32, &str); 5] =
    [(0.0, "at once"), (0.1, "0.1 s"), (0.3, "0.3 s"), (1.0, "1 s"), (3.0, "3 s")];

/// Length of a new wave in beats.
const USUAL_BEATS: u8 = 4;

/// The slider whose sounds are listed.
#[derive(Debug, Default)]
pub(super) struct OpenBinding {
    name: Option<String>,
    lists_all: bool,
}

impl OpenBinding {
    pub(super) fn is_of(&self, name: &str) -> bool {
        self.name.as_deref() == Some(name)
    }

    fn toggle(&mut self, name: &str) {
        *self = Self { name: (!self.is_of(name)).then(|| name.to_owned()), lists_all: false };
    }
}

/// The name of the sound that moves the slider; `None` if no sound moves it.
pub(super) fn words(slider: &Slider) -> Option<String> {
    let bound = slider.bound.as_ref().filter(|_| slider.changed_by == ChangedBy::Sound)?;
    Some(UnitInput::named(&bound.binding.input).map_or_else(|| bound.binding.input.clone(), UnitInput::label))
}

/// Draws the button that opens the list of sounds.
pub(super) fn button(ui: &Ui, rect: Rect, slider: &Slider, open: &mut OpenBinding) {
    let response = ui.interact(rect, ui.scope_id().with("bind"), Sense::click());
    let is_active = slider.bound.as_ref().is_some_and(|bound| bound.is_active);
    let is_open = open.is_of(&slider.name);
    let color = style::lit(is_active, response.hovered() || is_open, style::DIM);
    style::light(ui.painter(), rect, is_open);
    ui.painter().add(Shape::line(wave(rect.shrink(2.0)), Stroke::new(1.6, color)));
    let name = format!("bind {} to a sound", slider.name);
    assisted::selected(&response, egui::Role::Button, is_open, name);
    if response.clicked() {
        open.toggle(&slider.name);
    }
}

fn wave(rect: Rect) -> Vec<Pos2> {
    let at = |step: u8| {
        let x = f32::from(step) / 16.0;
        let y = (x * std::f32::consts::TAU).sin();
        pos2(rect.left() + x * rect.width(), rect.center().y - 0.4 * y * rect.height())
    };
    (0..=16).map(at).collect()
}

/// Draws the settings of the slider's binding, and the list of sounds.
pub(super) fn show(ui: &mut Ui, slider: &Slider, open: &mut OpenBinding, acts: &mut Acts) {
    let bind = |binding| Command::Bind(Bind { name: slider.name.clone(), binding });
    if let Some(bound) = &slider.bound {
        if let Some(changed) = settings(ui, slider, &bound.binding) {
            acts.commands.push(bind(Some(changed)));
        }
        match chips::row(ui, "acts", chips_of(slider, bound)) {
            Some(0) if bound.is_active => {
                acts.commands.push(bind(None));
                *open = OpenBinding::default();
            }
            Some(0) => acts.commands.push(bind(Some(bound.binding.clone()))),
            Some(_) => acts.commands.push(Command::WriteBinding(slider.name.clone())),
            None => {}
        }
        ui.add_space(2.0);
    }
    let chosen = slider.bound.as_ref().filter(|bound| bound.is_active).map(|bound| &*bound.binding.input);
    if let Some(input) = inputs(ui, &slider.name, chosen, open) {
        let before = slider.bound.as_ref().map(|bound| bound.binding.clone());
        let (low, high) = range_of(slider);
        let (curve, smoothing, release) = (Curve::Linear, 0.0, None);
        let plain = SoundBinding { input: String::new(), low, high, curve, smoothing, release };
        acts.commands.push(bind(Some(SoundBinding { input: input.name(), ..before.unwrap_or(plain) })));
    }
    ui.add_space(6.0);
}

/// The range of a new binding: from the present value to the greatest value, so that silence changes nothing.
fn range_of(slider: &Slider) -> (f32, f32) {
    let value = slider.param().clamped(slider.value);
    if value < slider.max { (value, slider.max) } else { (slider.min, slider.max) }
}

fn chips_of(slider: &Slider, bound: &Bound) -> [Chip<'static>; 2] {
    let name = &slider.name;
    let first = match bound.is_active {
        true => Chip::new("unbind", format!("end the binding of {name}"), false),
        false => Chip::new("bind again", format!("bind {name} again"), false),
    };
    [first, Chip::new("write into the scene", format!("write the binding of {name} into the scene"), false)]
}

/// Draws range, curve and smoothing. Returns the binding if one of them changed.
fn settings(ui: &mut Ui, slider: &Slider, binding: &SoundBinding) -> Option<SoundBinding> {
    let mut new = binding.clone();
    for (end, value, default) in [("low", &mut new.low, slider.min), ("high", &mut new.high, slider.max)] {
        let mut rail = Slider {
            name: format!("{} of {}", end, slider.name),
            value: slider.param().clamped(*value),
            default,
            bound: None,
            ..slider.clone()
        };
        caption(ui, end, &rail.value_text());
        let before = rail.value;
        ui.push_id(end, |ui| params::rail(ui, &mut rail, params::STEP, false));
        if rail.value.to_bits() != before.to_bits() {
            *value = rail.value;
        }
    }
    let curve = |curve: Curve| {
        Chip::new(curve.name(), format!("curve of {}: {}", slider.name, curve.name()), curve == binding.curve)
    };
    new.curve = chips::choose(ui, "curve", &Curve::ALL, curve).unwrap_or(new.curve);
    // The times stay equal until the user chooses the second one.
    new.smoothing = time(ui, slider, "rises", binding.smoothing).unwrap_or(new.smoothing);
    if let Some(release) = time(ui, slider, "falls", binding.release.unwrap_or(binding.smoothing)) {
        new.release = Some(release).filter(|release| *release != binding.smoothing);
    }
    (new != *binding).then_some(new)
}

/// Draws the smoothing times of one direction. Returns the clicked one, in seconds.
fn time(ui: &mut Ui, slider: &Slider, way: &str, present: f32) -> Option<f32> {
    let chip = |(seconds, words): (f32, &'static str)| {
        Chip::new(words, format!("{} {way}: {words}", slider.name), seconds == present)
    };
    caption(ui, way, "");
    chips::choose(ui, way, &TIMES, chip).map(|(seconds, _)| seconds)
}

/// Draws a line of small text above a row.
pub(super) fn caption(ui: &mut Ui, left: &str, right: &str) {
    let font = style::proportional(style::SMALL_SIZE);
    let (line, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 14.0), Sense::hover());
    let painter = ui.painter();
    painter.text(line.left_center(), egui::Align2::LEFT_CENTER, left, font, style::DIM);
    let font = style::monospace(style::SMALL_SIZE);
    painter.text(line.right_center(), egui::Align2::RIGHT_CENTER, right, font, style::DIM);
}

/// Draws the list of sounds and waves. Returns the clicked one.
fn inputs(ui: &mut Ui, name: &str, chosen: Option<&str>, open: &mut OpenBinding) -> Option<UnitInput> {
    let others = UnitInput::others().filter(|input| open.lists_all || chosen == Some(&*input.name()));
    let listed: Vec<UnitInput> = UnitInput::first().chain(others).collect();
    let chip = |input: &UnitInput| {
        let label = input.label();
        let name_of_chip = format!("bind {name} to {label}");
        Chip::new(label, name_of_chip, chosen == Some(&*input.name()))
    };
    let more = (!open.lists_all).then(|| Chip::new("more…", format!("more sounds for {name}"), false));
    let place = chips::row(ui, "sounds", listed.iter().map(chip).chain(more));
    let input = place.and_then(|place| listed.get(place).copied());
    open.lists_all |= place.is_some() && input.is_none();
    input.or_else(|| waves(ui, name, chosen.and_then(UnitInput::named)))
}

/// Draws the shapes of waves and, if one is chosen, their lengths. Returns the clicked wave.
fn waves(ui: &mut Ui, name: &str, chosen: Option<UnitInput>) -> Option<UnitInput> {
    let chosen = chosen.and_then(|input| match input {
        UnitInput::Wave(wave, beats) => Some((wave, beats)),
        UnitInput::Sound(_) => None,
    });
    caption(ui, "waves in beats", "");
    let shape = |wave: Wave| {
        let is_chosen = chosen.is_some_and(|(chosen, _)| chosen == wave);
        Chip::new(wave.name(), format!("move {name} in a wave: {}", wave.name()), is_chosen)
    };
    let mut wanted = chips::choose(ui, "waves", &Wave::ALL, shape)
        .map(|wave| UnitInput::Wave(wave, chosen.map_or(USUAL_BEATS, |(_, beats)| beats)));
    if let Some((wave, present)) = chosen {
        let length = |beats: u8| {
            Chip::new(beats.to_string(), format!("wave of {name}: {beats} beats"), beats == present)
        };
        let beats = chips::choose(ui, "beats", &Wave::BEATS, length);
        wanted = beats.map(|beats| UnitInput::Wave(wave, beats)).or(wanted);
    }
    wanted
}
