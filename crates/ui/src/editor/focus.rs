//! Whether keys are text, and the letters that are not typed yet.

/// Most letters that are shown while they are put together.
const PREEDIT_MAX: usize = 64;

/// See the module.
#[derive(Default)]
pub(super) struct Focus {
    is_on: bool,
    /// Whether a key is still held that was not meant for the text.
    ignores_repeats: bool,
    /// Letters that are being put together at the cursor.
    preedit: String,
}

impl Focus {
    pub(super) fn is_on(&self) -> bool {
        self.is_on
    }

    /// Gives keys to the text or to the show. Returns whether the other had them.
    pub(super) fn set(&mut self, on: bool) -> bool {
        let is_new = self.is_on != on;
        self.ignores_repeats |= on && is_new;
        self.is_on = on;
        if !on {
            self.preedit.clear();
        }
        is_new
    }

    /// Whether a key is left out: it is still held since before it was the text's.
    pub(super) fn leaves_out(&mut self, repeat: bool) -> bool {
        self.ignores_repeats &= repeat;
        self.ignores_repeats
    }

    /// Takes every key from now on.
    pub(super) fn take_repeats(&mut self) {
        self.ignores_repeats = false;
    }

    /// Shows letters that are being put together.
    pub(super) fn compose(&mut self, letters: &str) {
        self.preedit = letters.chars().filter(|letter| !letter.is_control()).take(PREEDIT_MAX).collect();
    }

    pub(super) fn preedit(&self) -> &str {
        &self.preedit
    }

    /// The letters were typed, or are given up.
    pub(super) fn end_composing(&mut self) {
        self.preedit.clear();
    }
}
