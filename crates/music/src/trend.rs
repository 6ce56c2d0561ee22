//! The straight line that fits values at equal distances best.

pub(crate) struct Trend {
    /// The rise from one value to the next.
    pub(crate) slope: f32,
    /// The correlation of the values and their places.
    pub(crate) straight: f32,
}

impl Trend {
    pub(crate) fn of(values: impl ExactSizeIterator<Item = f32> + Clone) -> Self {
        let count = values.len() as f32;
        let (x_mean, y_mean) = ((count - 1.0) / 2.0, values.clone().sum::<f32>() / count);
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in values.enumerate() {
            let (x, y) = (x as f32 - x_mean, y - y_mean);
            xy += x * y;
            xx += x * x;
            yy += y * y;
        }
        Self { slope: xy / xx, straight: xy / (xx * yy).sqrt().max(1e-9) }
    }
}
