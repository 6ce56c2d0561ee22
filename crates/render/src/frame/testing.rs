//! Worlds for tests.

use mariana_field::world::World;

pub(crate) const SPEAKERS: &str = include_str!("../../../../tests/oracle/speakers.scene");

pub(crate) fn world_of(text: &str) -> World {
    World::parse("test", text).unwrap()
}
