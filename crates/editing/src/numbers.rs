//! Numbers of a text that can be turned like knobs.

use std::ops::Range;

use mariana_field::graph::LevelList;
use mariana_field::lang::{Word, WordKind, number_place};

/// The speed of a turn. It determines a factor on the pointer's movement and the number of written decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TurnSpeed {
    /// A tenth of the usual speed.
    Fine,
    /// 100 points of pointer movement change the number's first digit by two.
    #[default]
    Usual,
    /// Ten times the usual speed.
    Coarse,
}

/// A number literal. A minus sign belongs to the literal, a minus operator does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Byte range in the line.
    pub range: Range<usize>,
    /// Start of the digits in the line, after the sign.
    pub digits: usize,
    /// Value.
    pub value: f64,
    decimals: usize,
    /// True for a count, such as a range's end. A count stays an integer.
    whole: bool,
}

/// Change per point of pointer movement for a number from 1 to 10. A number from 10 to 100 changes ten times as fast.
const FRACTION_OF_POINT: f64 = 0.02;
/// Points of pointer movement that change an integer by one.
const POINTS_OF_STEP: f64 = 12.0;
const DECIMALS_MAX: usize = 6;
/// Largest magnitude of a number that can be turned.
const LARGEST: f64 = 1e6;

impl TurnSpeed {
    /// Factor on the pointer's movement.
    pub fn factor(self) -> f64 {
        match self {
            Self::Fine => 0.1,
            Self::Usual => 1.0,
            Self::Coarse => 10.0,
        }
    }
}

impl Number {
    /// Returns the number in `line` that contains byte `at` or ends there. `words` are the line's words.
    pub fn at(line: &[u8], words: &[Word], at: usize) -> Option<Self> {
        let index = words
            .iter()
            .position(|word| word.kind == WordKind::Number && (word.start..=word.end).contains(&at))?;
        let word = words.get(index)?;
        let text = std::str::from_utf8(line.get(word.start..word.end)?).ok()?;
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite() && value.abs() <= LARGEST)?;
        let text_of = |index: Option<usize>| {
            let word = words.get(index?)?;
            Some((word.kind, line.get(word.start..word.end)?, word.end))
        };
        let before = text_of(index.checked_sub(1));
        // A minus is a sign if no operand precedes it.
        let is_sign = before.is_some_and(|(_, text, end)| text == b"-" && end == word.start)
            && match text_of(index.checked_sub(2)) {
                None => true,
                Some((WordKind::Sign, text, _)) => !matches!(text, b")" | b"}"),
                Some((kind, _, _)) => kind == WordKind::Keyword,
            };
        let counts = |neighbour: Option<(WordKind, &[u8], usize)>| {
            neighbour.is_some_and(|(_, text, _)| text == b".." || text == b"^")
        };
        let reads_level = |(_, text, _): (WordKind, &[u8], usize)| {
            LevelList::ALL.into_iter().any(|list| list.name().as_bytes() == text)
        };
        let of_level = before.is_some_and(|(_, text, _)| text == b"(")
            && text_of(index.checked_sub(2)).is_some_and(reads_level);
        let decimals =
            text.split_once('.').map_or(0, |(_, rest)| rest.bytes().take_while(u8::is_ascii_digit).count());
        let is_plain = !text.contains(['.', 'e', 'E']);
        Some(Self {
            range: word.start - usize::from(is_sign)..word.end,
            digits: word.start,
            value: if is_sign { -value } else { value },
            decimals: decimals.min(DECIMALS_MAX),
            whole: is_plain && (of_level || counts(before) || counts(text_of(Some(index + 1)))),
        })
    }

    /// Returns the value after the pointer has moved right by `points`, already scaled by [`TurnSpeed::factor`].
    pub fn turned(&self, points: f64, speed: TurnSpeed) -> f64 {
        if self.whole {
            return (self.value + (points / POINTS_OF_STEP).round()).clamp(0.0, LARGEST);
        }
        let turned = self.value + points * FRACTION_OF_POINT * self.decade();
        let grain = 10_f64.powi(-(self.decimals_at(speed) as i32));
        ((turned / grain).round() * grain).clamp(-LARGEST, LARGEST)
    }

    /// Formats `value` for the text, with at least as many decimals as the number has now.
    pub fn written(&self, value: f64, speed: TurnSpeed) -> String {
        if self.whole {
            return format!("{value:.0}");
        }
        let mut text = format!("{value:.*}", self.decimals_at(speed));
        let least = text.find('.').map_or(text.len(), |point| point + 1 + self.decimals);
        while text.len() > least && text.ends_with('0') && text.contains('.') {
            text.pop();
        }
        let text = text.trim_end_matches('.');
        if text.trim_start_matches('-').trim_matches(['0', '.']).is_empty() {
            return text.trim_start_matches('-').to_owned();
        }
        text.to_owned()
    }

    /// Returns the range in which the digits can be turned without parsing the text again. The range never crosses 0,
    /// so that divisions by the number stay finite.
    pub fn room(digits: f32) -> (f32, f32) {
        if digits == 0.0 {
            return (-1.0, 1.0);
        }
        let ends = (digits / 8.0, digits * 4.0);
        (ends.0.min(ends.1), ends.0.max(ends.1))
    }

    fn decade(&self) -> f64 {
        let of_digits = 10_f64.powi(-(self.decimals as i32));
        if self.value == 0.0 {
            return of_digits.max(0.1);
        }
        10_f64.powf(self.value.abs().log10().floor()).max(1e-4)
    }

    fn decimals_at(&self, speed: TurnSpeed) -> usize {
        let of_step = 2.0 - self.decade().log10().round() + if speed == TurnSpeed::Fine { 1.0 } else { 0.0 };
        self.decimals.max(of_step.clamp(0.0, DECIMALS_MAX as f64) as usize)
    }
}

/// Returns the index, from 0 among the text's numbers, of the number whose digits begin at byte `digits`.
pub fn numbers_before(text: &[u8], digits: usize) -> Option<usize> {
    number_place(std::str::from_utf8(text).ok()?, digits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::words;

    fn number(line: &str, text: &str) -> Option<Number> {
        let at = line.find(text)?;
        Number::at(line.as_bytes(), &words(line, false).0, at)
    }

    #[test]
    fn steps_depend_on_the_size_of_the_number() {
        let turned = |text: &str, points: f64, speed: TurnSpeed| {
            let number = number(text, text).unwrap();
            number.written(number.turned(points * speed.factor(), speed), speed)
        };
        use TurnSpeed::{Coarse, Fine, Usual};
        assert_eq!(turned("0.5", 100.0, Usual), "0.7");
        assert_eq!(turned("0.5", 100.0, Fine), "0.52");
        assert_eq!(turned("0.5", 1.0, Usual), "0.502");
        assert_eq!(turned("0.50", 0.0, Usual), "0.50");
        assert_eq!(turned("1", 10.0, Usual), "1.2");
        assert_eq!(turned("1", 5.0, Coarse), "2");
        assert_eq!(turned("12", -10.0, Usual), "10");
        assert_eq!(turned("0", 50.0, Usual), "1");
        assert_eq!(turned("0.2", -100.0, Usual), "0.0");
        assert_eq!(turned("0.2", -150.0, Usual), "-0.1");
    }

    #[test]
    fn counts_stay_integers_and_minus_is_a_sign_or_an_operator() {
        let of = |line, text| number(line, text).unwrap();
        for (line, text) in [("for i in 0..32: i", "32"), ("x^3", "3"), ("band(4)", "4")] {
            let number = of(line, text);
            assert_eq!(
                number.written(number.turned(24.0, TurnSpeed::Usual), TurnSpeed::Usual),
                (number.value + 2.0).to_string()
            );
        }
        for (line, range, value) in [
            ("vec3(-0.5, 1, 2)", 5..9, -0.5),
            ("p - 0.5", 4..7, 0.5),
            ("p -0.5", 3..6, 0.5),
            ("-0.5", 0..4, -0.5),
            ("f(x) -0.5", 6..9, 0.5),
            ("k = -0.5", 4..8, -0.5),
            ("if a then -0.5 else 1", 10..14, -0.5),
        ] {
            let found = of(line, "0.5");
            assert_eq!((found.range.clone(), found.value), (range, value), "{line}");
        }
        assert_eq!(number("a + b", "a"), None);
        assert_eq!(number("1e30", "1"), None, "too large to be turned");
    }

    #[test]
    fn the_range_before_parsing_again_never_crosses_zero() {
        for digits in [0.5_f32, -2.0, 1e-3, 4e5] {
            let (least, most) = Number::room(digits);
            assert!(least < digits && digits < most && least * most > 0.0, "{digits}: {least} .. {most}");
        }
        assert_eq!(Number::room(0.0), (-1.0, 1.0));
    }

    #[test]
    fn numbers_are_counted_as_the_language_counts_them() {
        let text = "let a = 1 # 2\n/* 3 */ b(4.5, \"6\") - 7";
        let place = |number: &str| numbers_before(text.as_bytes(), text.find(number).unwrap());
        assert_eq!(
            ["1", "2", "3", "4.5", "6", "7"].map(place),
            [Some(0), None, None, Some(1), None, Some(2)]
        );
        assert_eq!(numbers_before(b"\xff 1", 2), None);
    }
}
