//! The grid of cells in which flashes are counted.

/// Cells from left to right. A field of view spans a third of them.
pub const COLUMNS: usize = 48;
/// Cells from top to bottom.
pub const ROWS: usize = 36;
/// Cells of a grid.
pub const CELLS: usize = COLUMNS * ROWS;

/// Maximum number of flashes of a kind, general or red, that are allowed in one second.
pub const FLASHES_MAX: usize = 3;

/// The mean colour of each cell of an image: linear RGB, 0..1, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid(Vec<[f32; 3]>);

impl Grid {
    /// Builds a grid from the colours of [`CELLS`] cells. Missing colours and values that are not finite become black.
    pub fn new(colors: impl IntoIterator<Item = [f32; 3]>) -> Self {
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let mut cells: Vec<[f32; 3]> = colors.into_iter().take(CELLS).map(|color| color.map(unit)).collect();
        cells.resize(CELLS, [0.0; 3]);
        Self(cells)
    }

    /// The colours of the cells, row by row.
    pub fn colors(&self) -> &[[f32; 3]] {
        &self.0
    }
}
