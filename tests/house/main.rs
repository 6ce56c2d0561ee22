//! Checks of the project itself: dependencies between modules, licences, unsafe code, documentation.

mod architecture;
mod dependencies;
mod readme;
mod releases;
mod security;
mod shape;
mod walls;
