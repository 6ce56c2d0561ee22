//! A fuzz input as a sequence of choices.

/// The unread rest of an input. After the end of the input, each read gives 0.
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

/// Numbers that are special cases in arithmetic, and ordinary numbers.
const NUMBERS: [f32; 32] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -3.0,
    0.25,
    1.5,
    -7.25,
    10.0,
    31.5,
    100.0,
    -1000.0,
    0.499_999_97,
    16_777_216.0,
    8_388_609.0,
    -8_388_609.0,
    1e-20,
    -1e-20,
    1e20,
    -1e20,
    f32::MIN_POSITIVE,
    1e-45,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    std::f32::consts::PI,
    1e9,
];

impl Bytes<'_> {
    pub(crate) fn next(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// Returns a whole number below `end`, which is at most 256.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        usize::from(self.next()) % end
    }

    /// Returns one of [`NUMBERS`], an ordinary number, or any bit pattern.
    pub(crate) fn number(&mut self) -> f32 {
        match self.next() {
            choice @ 0..64 => NUMBERS[usize::from(choice) % NUMBERS.len()],
            choice @ 64..224 => (f32::from(choice) - 144.0) / 8.0 + f32::from(self.next()) / 2048.0,
            _ => f32::from_bits(u32::from_le_bytes([self.next(), self.next(), self.next(), self.next()])),
        }
    }

    pub(crate) fn finite(&mut self) -> f32 {
        let number = self.number();
        if number.is_finite() { number } else { 0.75 }
    }
}

/// Returns the FNV-1a hash of an input, which seeds a random generator.
pub(crate) fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01B3))
}
