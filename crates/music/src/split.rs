//! Harmonic and percussive parts: tones are ridges along time, strokes are ridges along frequency (Fitzgerald 2010).
//! The median along time uses past spectra only, so that live input needs no delay.

/// The split is measured once every this many hops, which is half of the middle window.
const EVERY: u32 = 2;

/// The length of the medians, in spectra and in bins.
const TIME: usize = 9;
const BINS: usize = 17;

/// The range in hertz. Above it, tones and strokes look alike in the middle window.
const RANGE_HZ: (f64, f64) = (60.0, 6_000.0);

/// A bin belongs to a part if the part's median exceeds the other by this factor (Driedger, Müller and Disch 2014). In
/// noise most bins belong to neither.
const FACTOR: f32 = 2.0;

/// Total power below this (-70 dB) is silent.
const POWER_MIN: f32 = 1e-7;

/// A median of the last values of a sequence, kept in order.
#[derive(Clone, Copy, Debug)]
struct Sorted<const N: usize>([f32; N]);

impl<const N: usize> Sorted<N> {
    /// Replaces the value `old`, which is in the list, by `new`.
    fn replace(&mut self, old: f32, new: f32) {
        let values = &mut self.0;
        let mut place = values.partition_point(|value| *value < old).min(N - 1);
        while place + 1 < N && values[place + 1] < new {
            values[place] = values[place + 1];
            place += 1;
        }
        while place > 0 && values[place - 1] > new {
            values[place] = values[place - 1];
            place -= 1;
        }
        values[place] = new;
    }

    fn median(&self) -> f32 {
        self.0[N / 2]
    }
}

/// Measures the fractions of the power that tones and strokes have.
pub(super) struct Split {
    first: usize,
    /// The last spectra of each bin, a ring and the same values in order.
    past: Vec<([f32; TIME], Sorted<TIME>)>,
    spectra: usize,
    hops: u32,
    parts: [f32; 2],
}

impl Split {
    /// Creates a split for spectra of `bins` bins of `bin_hz` hertz.
    pub(super) fn new(bins: usize, bin_hz: f64) -> Self {
        let bin = |hz: f64| ((hz / bin_hz).round() as usize).clamp(1, bins);
        let (first, end) = (bin(RANGE_HZ.0), bin(RANGE_HZ.1));
        let past = vec![([0.0; TIME], Sorted([0.0; TIME])); end - first];
        Self { first, past, spectra: 0, hops: 0, parts: [0.0; 2] }
    }

    pub(super) fn restart(&mut self) {
        self.past.fill(([0.0; TIME], Sorted([0.0; TIME])));
        (self.spectra, self.hops, self.parts) = (0, 0, [0.0; 2]);
    }

    /// Returns the fractions of the power that belong to tones and to strokes, 0..1. Their sum is at most 1.
    pub(super) fn follow(&mut self, power: &[f32]) -> [f32; 2] {
        self.hops += 1;
        if !self.hops.is_multiple_of(EVERY) {
            return self.parts;
        }
        let power = power.get(self.first..self.first + self.past.len()).unwrap_or_default();
        let total: f32 = power.iter().sum();
        let place = self.spectra % TIME;
        self.spectra = self.spectra.wrapping_add(1);
        let at = |bin: usize| power.get(bin).copied().unwrap_or(0.0);
        // The window of the median along frequency, centred on the bin; it begins half outside the range.
        let mut around = Sorted([0.0; BINS]);
        (0..BINS / 2).for_each(|bin| around.replace(0.0, at(bin)));
        let mut sums = [0.0; 2];
        for (bin, (ring, sorted)) in self.past.iter_mut().enumerate() {
            let leaving = bin.checked_sub(BINS / 2 + 1).map_or(0.0, at);
            around.replace(leaving, at(bin + BINS / 2));
            let now = at(bin);
            sorted.replace(std::mem::replace(&mut ring[place], now), now);
            let (tone, stroke) = (sorted.median(), around.median());
            if tone > FACTOR * stroke {
                sums[0] += now;
            } else if stroke > FACTOR * tone {
                sums[1] += now;
            }
        }
        self.parts = if total > POWER_MIN { sums.map(|sum| (sum / total).clamp(0.0, 1.0)) } else { [0.0; 2] };
        self.parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorted_values_stay_sorted() {
        let (mut sorted, mut ring, mut state) = (Sorted([0.0; 5]), [0.0; 5], 1_u32);
        for n in 0..200 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let new = (state >> 28) as f32;
            sorted.replace(std::mem::replace(&mut ring[n % 5], new), new);
            let mut expected = ring;
            expected.sort_by(f32::total_cmp);
            assert_eq!(sorted.0, expected);
        }
    }
}
