//! How well the times of events are found.

/// Returns true positives, found and true events, when each event is matched within `tolerance` seconds.
pub(crate) fn matches(found: &[f64], truth: &[f64], tolerance: f64) -> [usize; 3] {
    let (mut hits, mut next) = (0, 0);
    for time in truth {
        while found.get(next).is_some_and(|found| *found < time - tolerance) {
            next += 1;
        }
        if found.get(next).is_some_and(|found| *found <= time + tolerance) {
            hits += 1;
            next += 1;
        }
    }
    [hits, found.len(), truth.len()]
}

/// Returns the F-measure of counts from [`matches`].
pub(crate) fn f_of([hits, found, truth]: [usize; 3]) -> f64 {
    2.0 * hits as f64 / (found + truth).max(1) as f64
}
