//! GLSL that selects by the bits of a clause, for renderers that never skip a branch: registers that are variables, and
//! the operator's result among those of all operators.
//!
//! Where all cases are computed anyway, n cases are told apart by n - 1 selections on at most seven bits, which take
//! half the instructions of n comparisons with as many selections. llvmpipe reads an array that is indexed by a variable
//! lane by lane, and writes it with a branch for each lane: some sixty instructions, where a selected register of a file
//! of twelve takes two for each of them.

use std::fmt::Write as _;

use crate::graph::FIRST_BINARY;

/// Most registers that are variables. More are an array.
pub(super) const SELECTED_MAX: usize = 16;

/// The number of registers in a variant whose tapes need this many: a multiple of four where registers are variables,
/// else a power of two, so that few variants serve many scenes.
pub(crate) fn rounded_registers(needed: usize) -> usize {
    if needed <= SELECTED_MAX { needed.next_multiple_of(4) } else { needed.next_power_of_two() }
}

/// Defines how the registers of `file` are read and written: `NAMEREAD(word, place)` is that of a byte of a clause's
/// word, `NAMEWRITE(at, value)` puts a value into one.
pub(super) fn write_registers(
    text: &mut String,
    (name, file): (&str, &str),
    count: usize,
    as_variables: bool,
) {
    let (read, put) = if as_variables {
        let last_bit = count.next_power_of_two().trailing_zeros();
        let put: Vec<String> =
            (0..count).map(|i| format!("{file}[{i}] = (at) == {i}u ? (value) : {file}[{i}]")).collect();
        (register(file, count, 0, last_bit), put.join("; "))
    } else {
        let mask = count - 1;
        (format!("{file}[BYTE(word, place) & {mask}u]"), format!("{file}[(at) & {mask}u] = (value)"))
    };
    // Writing to a String cannot fail.
    let _ = writeln!(text, "#define {name}READ(word, place) ({read})\n#define {name}WRITE(at, value) {put}");
}

/// The register whose number begins with that of `first`, above its lowest `bits` bits.
fn register(file: &str, count: usize, first: usize, bits: u32) -> String {
    let Some(bit) = bits.checked_sub(1) else { return format!("{file}[{first}]") };
    let (middle, low) = (first + (1 << bit), register(file, count, first, bit));
    if middle >= count {
        return low;
    }
    format!("(HAS(word, place, {bit}) ? {} : {low})", register(file, count, middle, bit))
}

/// The expression for the operator of `word` among `cases`, of which there is one at least: numbers in rising order, with
/// what they give. Any other number gives one of these values.
pub(super) fn operator(cases: &[(u8, String)]) -> String {
    let split = cases.partition_point(|(number, _)| *number < FIRST_BINARY);
    let (unary, binary) = cases.split_at(split);
    match (by_bits(unary, 5), by_bits(binary, 5)) {
        (Some(unary), Some(binary)) => format!("((word & 192u) != 0u ? {binary} : {unary})"),
        (one, other) => one.or(other).unwrap_or_else(|| "a".to_owned()),
    }
}

/// The value among cases whose numbers differ in their lowest bits, up to this one, alone.
fn by_bits(cases: &[(u8, String)], bit: u32) -> Option<String> {
    if let [] | [_] = cases {
        return cases.first().map(|(_, value)| value.clone());
    }
    let split = cases.partition_point(|(number, _)| number & (1 << bit) == 0);
    let (zeros, ones) = cases.split_at(split);
    let below = bit.saturating_sub(1);
    match (by_bits(zeros, below), by_bits(ones, below)) {
        (Some(zeros), Some(ones)) => Some(format!("(HAS(word, 0, {bit}) ? {ones} : {zeros})")),
        (one, other) => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of an expression of `HAS(word, place, bit)` and selections, for a word.
    fn value_of(expression: &str, word: u32) -> &str {
        let Some(inner) = expression.strip_prefix('(') else { return expression };
        let inner = inner.strip_suffix(')').unwrap();
        let (test, rest) = inner.split_once(" ? ").unwrap();
        let is_set = match test.strip_prefix("HAS(word, ") {
            Some(at) => {
                let (place, bit) = at.trim_end_matches(')').split_once(", ").unwrap();
                let place = if place == "place" { 0 } else { place.parse::<u32>().unwrap() };
                word >> (8 * place + bit.parse::<u32>().unwrap()) & 1 == 1
            }
            None => word & 192 != 0,
        };
        // The colon of this selection is the first outside of brackets.
        let mut depth = 0;
        let is_colon = |(_, letter): &(usize, char)| {
            depth += i32::from(*letter == '(') - i32::from(*letter == ')');
            *letter == ':' && depth == 0
        };
        let (colon, _) = rest.char_indices().find(is_colon).unwrap();
        value_of(if is_set { rest[..colon].trim() } else { rest[colon + 1..].trim() }, word)
    }

    #[test]
    fn each_register_is_selected_by_its_number() {
        for count in [4, 8, 12, 16] {
            let mut text = String::new();
            write_registers(&mut text, ("", "file"), count, true);
            let (read, written) = text.split_once('\n').unwrap();
            let read = read.strip_prefix("#define READ(word, place) ").unwrap();
            let read = read.strip_prefix('(').unwrap().strip_suffix(')').unwrap();
            for number in 0..count {
                assert_eq!(value_of(read, number as u32), format!("file[{number}]"), "{count}");
                assert!(written.contains(&format!("file[{number}] = (at) == {number}u ? (value)")));
            }
            assert_eq!(written.matches("? (value)").count(), count);
        }
    }

    #[test]
    fn each_operator_is_selected_in_every_form() {
        for numbers in [&[0, 2][..], &[64], &[0, 2, 17, 23, 64, 65, 70, 96, 113], &[63, 64, 127]] {
            let cases: Vec<(u8, String)> =
                numbers.iter().map(|number| (*number, format!("v{number}"))).collect();
            let text = operator(&cases);
            for number in numbers {
                let forms: &[u32] = if *number < FIRST_BINARY { &[0] } else { &[64, 128, 192] };
                for form in forms {
                    let word = u32::from(*number) & 63 | form | 0xABCD_EF00;
                    assert_eq!(value_of(&text, word), format!("v{number}"), "{text}");
                }
            }
        }
    }

    #[test]
    fn few_registers_are_a_multiple_of_four_and_many_a_power_of_two() {
        assert_eq!([1, 4, 5, 9, 16, 17, 33].map(rounded_registers), [4, 4, 8, 12, 16, 32, 64]);
    }
}
