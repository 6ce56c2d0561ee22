//! Colours of the views, shared by the shaders and the legends, and formatting of numbers. Colours are the displayed
//! values, bytes divided by 255, without exposure or tone mapping.

use super::VIEWS;

/// A displayed colour, 0..1.
pub type Color = [f32; 3];

/// Colours from blue for low values to red for high values, in steps of the same width.
pub const HEAT: [Color; 6] = [
    [0.07, 0.13, 0.50],
    [0.10, 0.45, 0.90],
    [0.20, 0.78, 0.62],
    [0.93, 0.88, 0.28],
    [0.96, 0.52, 0.12],
    [0.78, 0.07, 0.09],
];

/// Colour of pixels without data.
pub const NOTHING: Color = [0.11, 0.12, 0.18];
/// Colour of a surface that faces away from every light, whether or not the surface is in shadow.
pub const FACES_AWAY: Color = [0.20, 0.25, 0.45];
/// Colour of a cell without surfaces.
pub const EMPTY_CELL: Color = [0.27, 0.29, 0.34];
/// Colour of a point outside all cells.
pub const NO_CELL: Color = [0.16, 0.16, 0.16];
/// Colour of positive distances: points outside a shape.
pub const OUTSIDE: Color = [0.93, 0.66, 0.33];
/// Colour of negative distances: points inside a shape.
pub const INSIDE: Color = [0.32, 0.55, 0.86];
/// Colour of the line where the distance is zero.
pub const ZERO: Color = [1.0, 1.0, 1.0];

/// Colours of objects, in order. After the last colour, the first follows again.
pub const OBJECTS: [Color; 12] = [
    [0.90, 0.62, 0.20],
    [0.34, 0.71, 0.91],
    [0.16, 0.62, 0.45],
    [0.94, 0.89, 0.30],
    [0.20, 0.40, 0.74],
    [0.84, 0.36, 0.16],
    [0.80, 0.52, 0.70],
    [0.62, 0.80, 0.38],
    [0.55, 0.35, 0.65],
    [0.72, 0.58, 0.44],
    [0.45, 0.80, 0.78],
    [0.86, 0.30, 0.42],
];

/// The colour at a position on a scale, 0..1.
pub fn heat(fraction: f32) -> Color {
    let along = fraction.clamp(0.0, 1.0) * (HEAT.len() - 1) as f32;
    let left = (along as usize).min(HEAT.len() - 2);
    let x = along - left as f32;
    std::array::from_fn(|channel| HEAT[left][channel] * (1.0 - x) + HEAT[left + 1][channel] * x)
}

/// The colour of the object with this number.
pub fn of_object(number: usize) -> Color {
    OBJECTS[number % OBJECTS.len()]
}

/// The text of `view_scales.glsl`: the views' numbers and colours for the shaders.
pub fn glsl() -> String {
    let color = |[r, g, b]: Color| format!("vec3({r:?}, {g:?}, {b:?})");
    let list = |colors: &[Color]| colors.iter().map(|of| color(*of)).collect::<Vec<_>>().join(", ");
    let mut text = String::new();
    for (number, row) in VIEWS.iter().enumerate() {
        text.push_str(&format!("const float VIEW_{} = {number}.0;\n", row.name.to_uppercase()));
    }
    for (name, value) in [
        ("NOTHING", NOTHING),
        ("FACES_AWAY", FACES_AWAY),
        ("EMPTY_CELL", EMPTY_CELL),
        ("NO_CELL", NO_CELL),
        ("OUTSIDE", OUTSIDE),
        ("INSIDE", INSIDE),
        ("ZERO", ZERO),
    ] {
        text.push_str(&format!("const vec3 COLOR_{name} = {};\n", color(value)));
    }
    for (name, colors) in [("HEAT", &HEAT[..]), ("OBJECT", &OBJECTS[..])] {
        let count = colors.len();
        text.push_str(&format!("const int {name}_COLORS = {count};\n"));
        text.push_str(&format!("const vec3 {name}_COLOR[{count}] = vec3[{count}]({});\n", list(colors)));
    }
    text
}

/// The text of `view_dispatch.glsl`, which calls the function `view_NAME` of the chosen view.
pub fn dispatch_glsl() -> String {
    let mut text = String::from("vec3 view_color(vec3 direction) {\n");
    for row in &VIEWS {
        let name = row.name;
        text.push_str(&format!(
            "    if (view_choice.x == VIEW_{}) return view_{name}(direction);\n",
            name.to_uppercase()
        ));
    }
    text.push_str("    return COLOR_NOTHING;\n}\n");
    text
}

/// Rounds `value` up to a number of the series 1, 2, 5, 10, 20 ..., which also contains 0.5, 0.2, 0.1 ...
pub fn nice(value: f32) -> f32 {
    let value = if value.is_finite() { value.clamp(1e-6, 1e9) } else { 1.0 };
    let decade = 10_f64.powi(f64::from(value).log10().floor() as i32);
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| (decade * step) as f32);
    steps.into_iter().find(|step| *step >= value * 0.9999).unwrap_or(value)
}

/// Returns the number after `value` in the series of [`nice`] if `larger`, otherwise the number before `value`.
pub fn beside(value: f32, larger: bool) -> f32 {
    if larger {
        return nice(value * 1.01);
    }
    // Start at a twelfth of the value and go up to the largest number below the value.
    let mut below = nice(value / 12.0);
    while nice(below * 1.01) < value * 0.999 {
        below = nice(below * 1.01);
    }
    below
}

/// Formats a number for display: three significant digits, thousands separated.
pub fn written(value: f32) -> String {
    let decimals = match value.abs() {
        size if size >= 100.0 || size.fract() == 0.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        size if size >= 0.1 => 3,
        _ => 5,
    };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let (sign, digits) = text.strip_prefix('-').map_or(("", text), |digits| ("-", digits));
    let whole = digits.find('.').unwrap_or(digits.len());
    let mut grouped = String::from(sign);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && index < whole && (whole - index).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_goes_from_blue_to_red_through_its_colours() {
        for (index, color) in HEAT.iter().enumerate() {
            let found = heat(index as f32 / (HEAT.len() - 1) as f32);
            assert!(
                (0..3).all(|channel| (found[channel] - color[channel]).abs() < 1e-5),
                "{index}: {found:?}"
            );
        }
        assert_eq!((heat(-1.0), heat(9.0)), (HEAT[0], HEAT[5]));
        assert!(heat(0.0)[2] > heat(0.0)[0] && heat(1.0)[0] > heat(1.0)[2]);
    }

    #[test]
    fn nice_numbers_and_their_neighbours() {
        assert_eq!([0.03, 0.1, 1.0, 3.0, 51.0, 100.0].map(nice), [0.05, 0.1, 1.0, 5.0, 100.0, 100.0]);
        let up = [0.001, 0.5, 1.0, 20.0, 30.0].map(|value| beside(value, true));
        assert_eq!(up, [0.002, 1.0, 2.0, 50.0, 50.0]);
        let down = [0.002, 1.0, 2.0, 50.0, 30.0].map(|value| beside(value, false));
        assert_eq!(down, [0.001, 0.5, 1.0, 20.0, 20.0]);
        assert!(nice(f32::NAN).is_finite() && nice(0.0) > 0.0);
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 0.001, 0.125, 2.5, 12.34, 100.0, 20_000.0, 1_234_567.0, -2.0].map(written);
        assert_eq!(
            texts,
            ["0", "0.001", "0.125", "2.5", "12.3", "100", "20\u{a0}000", "1\u{a0}234\u{a0}567", "-2"]
                .map(|text| text.replace('\u{a0}', " "))
        );
    }
}
