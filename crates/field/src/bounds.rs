//! Boxes in space whose sides are parallel to the axes.

/// A box whose sides are parallel to the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The lower corner.
    pub low: [f32; 3],
    /// The upper corner.
    pub high: [f32; 3],
}

impl Bounds {
    /// True if a point is in the box.
    pub fn hold(&self, place: [f32; 3]) -> bool {
        (0..3).all(|axis| self.low[axis] <= place[axis] && place[axis] <= self.high[axis])
    }

    /// Half of the largest extent.
    pub fn half(&self) -> f32 {
        0.5 * self.size()
    }

    /// The largest extent.
    pub(super) fn size(&self) -> f32 {
        (0..3).map(|axis| self.side(axis)).fold(0.0, f32::max)
    }

    /// The centre.
    pub(super) fn middle(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }

    /// The sum of the extents along the axes.
    pub(crate) fn extents(&self) -> f32 {
        (0..3).map(|axis| self.side(axis)).sum()
    }

    /// The extent along an axis.
    pub(super) fn side(&self, axis: usize) -> f32 {
        self.high[axis] - self.low[axis]
    }

    /// The coordinate of a face: those at the low ends come first, then those at the high ends.
    pub(super) fn face_mut(&mut self, face: usize) -> &mut f32 {
        if face < 3 { &mut self.low[face] } else { &mut self.high[face % 3] }
    }

    /// Returns the smallest box around both boxes, enlarged by `margin` on each side.
    pub fn hull(&self, other: &Self, margin: f32) -> Self {
        Self {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis]) - margin),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis]) + margin),
        }
    }

    /// Returns the cube that extends `reach` from a point along each axis.
    pub fn around(place: [f32; 3], reach: f32) -> Self {
        Self { low: place.map(|v| v - reach), high: place.map(|v| v + reach) }
    }
}
