//! Numbers of the picture as a whole and of the pointer over it, which scenes drawn in two dimensions read.

/// One of these numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ScreenInput {
    /// Width of the picture in pixels.
    Width,
    /// Height of the picture in pixels.
    Height,
    /// The pointer's position in pixels from the left edge.
    MouseX,
    /// The pointer's position in pixels from the lower edge.
    MouseY,
    /// 1 while the pointer's first button is held over the picture, else 0.
    MousePressed,
}

impl ScreenInput {
    /// Returns the name as printed in a tape.
    pub const fn name(self) -> &'static str {
        ["RESOLUTION.X", "RESOLUTION.Y", "MOUSE.X", "MOUSE.Y", "MOUSE.Z"][self as usize]
    }
}

/// The size of a picture and the pointer over it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screen {
    /// Width and height in pixels, each at least 1.
    pub size: [f32; 2],
    /// The pointer's position as fractions of the width from the left and of the height from below, 0..1.
    pub pointer: [f32; 2],
    /// True while the pointer's first button is held.
    pub pressed: bool,
}

impl Screen {
    pub(super) const NONE: Self = Self { size: [1.0; 2], pointer: [0.5; 2], pressed: false };

    /// Returns a picture with the pointer at its centre, as in stills and videos.
    pub fn of_size(size: (u32, u32)) -> Self {
        let (width, height) = size;
        Self { size: [width.max(1) as f32, height.max(1) as f32], ..Self::NONE }
    }

    /// Returns one of the numbers.
    pub fn value(&self, input: ScreenInput) -> f32 {
        match input {
            ScreenInput::Width => self.size[0],
            ScreenInput::Height => self.size[1],
            ScreenInput::MouseX => self.size[0] * self.pointer[0],
            ScreenInput::MouseY => self.size[1] * self.pointer[1],
            ScreenInput::MousePressed => f32::from(self.pressed),
        }
    }
}

impl Default for Screen {
    fn default() -> Self {
        Self::NONE
    }
}
