//! The program as its users meet it, without a window: sessions that draw into memory.

mod stage;
mod walls;

#[path = "../support/mod.rs"]
mod support;
