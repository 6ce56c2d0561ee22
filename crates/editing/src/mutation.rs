//! Random variations of a scene's text: other values of its parameters, and other hues of its colours.

use std::ops::Range;

use mariana_field::lang::{Word, WordKind};

use crate::buffer::Buffer;
use crate::colors::Colors;
use crate::numbers::Number;
use crate::triples::{TripleKind, triples};

/// Largest difference between the turn of one colour and the turn of all colours, as a fraction of the hue circle.
const HUE_SPREAD: f64 = 0.06;
/// A colour's saturation is multiplied by a number between these.
const SATURATION: (f64, f64) = (0.7, 1.4);
/// Written numbers have this many decimals.
const DECIMALS: i32 = 4;

/// Returns a variation of a scene's text, or `None` if the text has no parameter and no colour to change. Equal texts
/// and seeds give equal variations.
///
/// Each parameter gets a value in its range. Colours keep their brightness, so that no variation is darker.
pub fn mutated(text: &str, seed: u64) -> Option<String> {
    let (buffer, mut colors) = (Buffer::new(text.as_bytes().to_vec()), Colors::default());
    let mut random = Random(seed);
    let turn = random.unit();
    let mut changes: Vec<(Range<usize>, String)> = Vec::new();
    for line in 0..buffer.line_count() {
        let start = buffer.line_start(line);
        let mut change = |range: Range<usize>, value: f64| {
            changes.push((start + range.start..start + range.end, written(value)));
        };
        let words = colors.words(&buffer, line);
        if let Some((range, (least, most))) = param_of(buffer.line(line), &words) {
            change(range, least + (most - least) * random.unit());
        }
        for triple in triples(&buffer, &mut colors, line) {
            if triple.kind != TripleKind::Color {
                continue;
            }
            let hue = turn + HUE_SPREAD * (2.0 * random.unit() - 1.0);
            let saturation = SATURATION.0 + (SATURATION.1 - SATURATION.0) * random.unit();
            let color = turned(triple.values(), hue, saturation);
            for (number, value) in triple.numbers.iter().zip(color) {
                change(number.range.clone(), value);
            }
        }
    }
    let mut new = text.to_owned();
    changes.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    for (range, value) in changes {
        if new.get(range.clone()).is_some() {
            new.replace_range(range, &value);
        }
    }
    (new != text).then_some(new)
}

/// Returns the range of the default value of a parameter declared in this line, and the parameter's range.
fn param_of(line: &[u8], words: &[Word]) -> Option<(Range<usize>, (f64, f64))> {
    let text = |at: usize| words.get(at).and_then(|word| line.get(word.start..word.end));
    if text(0)? != b"param" || text(2)? != b"=" {
        return None;
    }
    let numbers: Vec<Number> = words
        .iter()
        .take_while(|word| word.kind != WordKind::Comment)
        .filter(|word| word.kind == WordKind::Number)
        .filter_map(|word| Number::at(line, words, word.start))
        .collect();
    let range = match &numbers[..] {
        [default] => (default.value.min(0.0), default.value.max(1.0)),
        [_, least, most] if least.value < most.value => (least.value, most.value),
        _ => return None,
    };
    Some((numbers.first()?.range.clone(), range))
}

/// Turns the hue of a colour by a fraction of the circle. The greatest component stays the same.
fn turned([r, g, b]: [f64; 3], turn: f64, saturation: f64) -> [f64; 3] {
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    if most <= 0.0 || least < 0.0 || most - least <= 0.0 {
        return [r, g, b];
    }
    let spread = most - least;
    let sixth = if most == r {
        (g - b) / spread
    } else if most == g {
        2.0 + (b - r) / spread
    } else {
        4.0 + (r - g) / spread
    };
    let hue = (sixth / 6.0 + turn).rem_euclid(1.0);
    let share = (spread / most * saturation).min(1.0);
    [5.0, 3.0, 1.0].map(|offset: f64| {
        let k = (offset + 6.0 * hue).rem_euclid(6.0);
        most * (1.0 - share * k.min(4.0 - k).clamp(0.0, 1.0))
    })
}

fn written(value: f64) -> String {
    let grain = 10_f64.powi(DECIMALS);
    let rounded = (value * grain).round() / grain;
    // No "-0".
    format!("{}", rounded + 0.0)
}

/// A random generator (splitmix64; Steele et al. 2014).
struct Random(u64);

impl Random {
    /// A number from 0 up to 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# size = 7\nparam size = 1 in 0.5 .. 2  # how large: 3\nparam turn = -0.2 in -1 .. 1\n\
        material paint { color = vec3(0.2, 0.4, 0.1)  roughness = 0.5 }\n\
        object ball { shape = sphere(p - vec3(1, 2, 3), size)  material = paint }\n";

    #[test]
    fn variations_change_parameters_in_their_ranges_and_colours_but_no_positions() {
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..50 {
            let text = mutated(TEXT, seed).unwrap();
            assert_eq!(mutated(TEXT, seed).unwrap(), text);
            assert!(text.contains("p - vec3(1, 2, 3)") && text.contains("# how large: 3"), "{text}");
            assert!(text.contains(" in 0.5 .. 2  #") && text.starts_with("# size = 7\n"), "{text}");
            let compiled = mariana_field::lang::compile("test", &text, &mut |_: &str| Err(String::new()));
            let scene = compiled.scene.unwrap_or_else(|| panic!("{text}"));
            assert_eq!(scene.params.len(), 2, "{text}");
            for param in &scene.params {
                assert!((param.min..=param.max).contains(&param.default), "{text}");
            }
            let color = text.split_once("color = vec3(").unwrap().1.split_once(')').unwrap().0;
            let most = color.split(", ").map(|part| part.parse::<f64>().unwrap()).fold(0.0, f64::max);
            assert!((most - 0.4).abs() < 1e-3, "{text}");
            seen.insert(text);
        }
        assert_eq!(seen.len(), 50);
        assert_eq!(mutated("length(p) - 1", 3), None);
    }

    #[test]
    fn hues_turn_around_the_circle() {
        assert_eq!(turned([1.0, 0.0, 0.0], 1.0 / 3.0, 1.0).map(|part| part.round()), [0.0, 1.0, 0.0]);
        assert_eq!(turned([2.0, 1.0, 1.0], 0.0, 1.0), [2.0, 1.0, 1.0]);
        assert_eq!(turned([0.5, 0.5, 0.5], 0.3, 2.0), [0.5, 0.5, 0.5]);
        assert_eq!(turned([0.0, 0.0, 0.0], 0.3, 2.0), [0.0, 0.0, 0.0]);
    }
}
