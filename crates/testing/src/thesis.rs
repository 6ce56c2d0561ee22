//! Data printed in the thesis, as the expected results of tests.

/// Table 1 (Abt 2022, section 4.3; Keeter 2020, Table 1): opcode, input A, input B, output.
pub const TABLE_1: [[&str; 4]; 9] = [
    ["X", "-", "-", "slot 0"],
    ["Y", "-", "-", "slot 1"],
    ["SQUARE", "slot 0", "-", "slot 0"],
    ["SQUARE", "slot 1", "-", "slot 1"],
    ["ADD", "slot 0", "slot 1", "slot 1"],
    ["SQRT", "slot 1", "-", "slot 1"],
    ["SUB", "slot 1", "1.0f", "slot 0"],
    ["SUB", "0.5f", "slot 1", "slot 1"],
    ["MAX", "slot 0", "slot 1", "slot 1"],
];
