//! The house itself: its walls, its licences, its unsafe code, its front page.

mod architecture;
mod dependencies;
mod readme;
mod security;
mod shape;
mod walls;
