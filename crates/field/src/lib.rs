//! Signed distance functions as text, and everything that is known of them without a window or a GPU.

pub mod graph;
pub mod lang;
pub mod limits;
pub mod rays;
pub mod region;
pub mod tape;
pub mod world;
