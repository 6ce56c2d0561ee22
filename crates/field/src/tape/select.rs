//! GLSL that selects a register or an operator's result by the bits of a clause, for renderers that never skip a
//! branch.
//!
//! If all cases are computed anyway, n - 1 selections on at most seven bits distinguish n cases. That takes half as
//! many instructions as n comparisons. For an array with a variable index, llvmpipe reads lane by lane and writes with
//! a branch per lane, which takes about sixty instructions. Selecting takes two instructions per register. Selections
//! use `mix`, because Mesa turns nested `?:` into branches, and llvmpipe computes a mask of lanes for each branch.
//!
//! Tried: a single square root, whose operand is selected, for all operators with a square root. Lattice takes 3 % less
//! time, city and kaleidoscope no less.

use std::fmt::Write as _;

use super::interpreter::{IMMEDIATE, REGISTERS_WITHOUT_BIT};
use crate::graph::FIRST_BINARY;

/// Maximum number of registers that are variables if every case is computed. If there are more, all are in an array.
/// Tried on llvmpipe: with 32, moonrise takes 15 % longer, city and wave_tank 5 %. With 20, letters takes 18 % less.
const SELECTED_MAX: usize = 20;
/// Maximum number of registers that are variables on GPUs.
const SELECTED_BY_GPUS_MAX: usize = 8;

/// Returns the number of registers in a variant for tapes that need `needed` registers. It is a multiple of two if
/// registers are variables, else a power of two, so that few variants serve many scenes.
pub(crate) fn rounded_registers(needed: usize) -> usize {
    if needed <= SELECTED_MAX { needed.next_multiple_of(2) } else { needed.next_power_of_two() }
}

/// Defines macros that access the registers of `file`. `NAMEREAD(word, place)` reads the register whose number is a
/// byte of a clause's word, `NAMEWRITE(at, value)` writes a register, and `NAMEOPERAND` reads a register or an
/// immediate.
pub(super) fn write_registers(text: &mut String, name: &str, file: &str, count: usize, every_case: bool) {
    let selected_max = if every_case { SELECTED_MAX } else { SELECTED_BY_GPUS_MAX };
    let (read, put) = if count <= selected_max {
        let last_bit = count.next_power_of_two().trailing_zeros();
        let put: Vec<String> =
            (0..count).map(|i| format!("{file}[{i}] = mix({file}[{i}], (value), (at) == {i}u)")).collect();
        (register(file, count, 0, last_bit), put.join("; "))
    } else {
        let mask = count - 1;
        (format!("{file}[BYTE(word, place) & {mask}u]"), format!("{file}[(at) & {mask}u] = (value)"))
    };
    let is_immediate = if count <= REGISTERS_WITHOUT_BIT {
        format!("HAS(word, place, {})", IMMEDIATE.trailing_zeros())
    } else {
        "form_is_immediate(word, place)".to_owned()
    };
    let _ = writeln!(text, "#define {name}READ(word, place) ({read})\n#define {name}WRITE(at, value) {put}");
    let (number, register) = ("uintBitsToFloat(immediate)", format!("{name}READ(word, place)"));
    let operand = if every_case {
        format!("mix({register}, {number}, {is_immediate})")
    } else {
        format!("({is_immediate} ? {number} : {register})")
    };
    let _ = writeln!(text, "#define {name}OPERAND(word, place, immediate) {operand}");
}

/// Selects a register by the lowest `bits` bits of its number. The higher bits are equal to the bits of `first`.
fn register(file: &str, count: usize, first: usize, bits: u32) -> String {
    let Some(bit) = bits.checked_sub(1) else { return format!("{file}[{first}]") };
    let (middle, low) = (first + (1 << bit), register(file, count, first, bit));
    if middle >= count {
        return low;
    }
    format!("mix({low}, {}, HAS(word, place, {bit}))", register(file, count, middle, bit))
}

/// Returns the expression that selects the operator of `word` among `cases`. The cases are numbers in rising order,
/// each with its value, and must not be empty. Any other number selects one of these values.
pub(super) fn operator(cases: &[(u8, String)]) -> String {
    let split = cases.partition_point(|(number, _)| *number < FIRST_BINARY);
    let (unary, binary) = cases.split_at(split);
    match (by_bits(unary, 5), by_bits(binary, 5)) {
        (Some(unary), Some(binary)) => format!("mix({unary}, {binary}, (word & 192u) != 0u)"),
        (one, other) => one.or(other).unwrap_or_else(|| "a".to_owned()),
    }
}

fn by_bits(cases: &[(u8, String)], bit: u32) -> Option<String> {
    if let [] | [_] = cases {
        return cases.first().map(|(_, value)| value.clone());
    }
    let split = cases.partition_point(|(number, _)| number & (1 << bit) == 0);
    let (zeros, ones) = cases.split_at(split);
    let below = bit.saturating_sub(1);
    match (by_bits(zeros, below), by_bits(ones, below)) {
        (Some(zeros), Some(ones)) => Some(format!("mix({zeros}, {ones}, HAS(word, 0, {bit}))")),
        (one, other) => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluates an expression of `mix(zero, one, condition)` and `HAS(word, place, bit)` for `word`.
    fn value_of(expression: &str, word: u32) -> &str {
        let Some(inner) = expression.strip_prefix("mix(") else { return expression };
        let inner = inner.strip_suffix(')').unwrap();
        let mut depth = 0;
        let commas: Vec<usize> = inner
            .char_indices()
            .filter(|(_, letter)| {
                depth += i32::from(*letter == '(') - i32::from(*letter == ')');
                *letter == ',' && depth == 0
            })
            .map(|(at, _)| at)
            .collect();
        let [first, second] = commas[..] else { panic!("{expression}") };
        let is_set = match inner[second + 1..].trim().strip_prefix("HAS(word, ") {
            Some(at) => {
                let (place, bit) = at.trim_end_matches(')').split_once(", ").unwrap();
                let place = if place == "place" { 0 } else { place.parse::<u32>().unwrap() };
                word >> (8 * place + bit.parse::<u32>().unwrap()) & 1 == 1
            }
            None => word & 192 != 0,
        };
        value_of(if is_set { inner[first + 1..second].trim() } else { inner[..first].trim() }, word)
    }

    #[test]
    fn each_register_is_selected_by_its_number() {
        for count in [4, 8, 10, 12, 16, 20] {
            let mut text = String::new();
            write_registers(&mut text, "", "file", count, true);
            let [read, written, operand] = text.lines().collect::<Vec<_>>()[..] else { panic!("{text}") };
            let read = read.strip_prefix("#define READ(word, place) (").unwrap();
            let read = read.strip_suffix(')').unwrap();
            for number in 0..count {
                assert_eq!(value_of(read, number as u32), format!("file[{number}]"), "{count}");
                assert!(
                    written.contains(&format!(
                        "file[{number}] = mix(file[{number}], (value), (at) == {number}u)"
                    ))
                );
            }
            assert_eq!(written.matches("(value)").count(), count);
            assert!(
                operand.ends_with("mix(READ(word, place), uintBitsToFloat(immediate), HAS(word, place, 7))")
            );
        }
    }

    #[test]
    fn large_register_files_recognize_immediates_by_the_form() {
        for (count, by_form) in [(128, false), (256, true)] {
            let mut text = String::new();
            write_registers(&mut text, "", "file", count, true);
            assert_eq!(text.contains("form_is_immediate"), by_form, "{count}");
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
    fn few_registers_are_a_multiple_of_two_and_many_a_power_of_two() {
        assert_eq!([1, 4, 5, 9, 16, 17, 21, 33].map(rounded_registers), [2, 4, 6, 10, 16, 18, 32, 64]);
    }
}
