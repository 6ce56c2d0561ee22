//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that obeys a limit reads it here, an error that reports one names the number from here, and
//! a test reaches it.

use std::time::Duration;

/// Ceilings on what comes from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of the head of a request.
    pub head_bytes_max: usize,
    /// Most header fields of it.
    pub head_fields_max: usize,
    /// How long a request may take to come in, and its answer to go out.
    pub head_time_max: Duration,
    /// Most connections at a time, phones among them.
    pub connections_max: usize,
    /// Most of them from one address.
    pub connections_per_address_max: usize,
    /// Most phones at a time.
    pub phones_max: usize,
    /// Most bytes of a message of a phone.
    pub message_bytes_max: usize,
    /// Most messages of one phone in a second, for longer than a moment; one that sends more is sent away.
    pub messages_per_second_max: u32,
    /// Most messages that come at once, after the network has held them up.
    pub messages_at_once_max: u32,
    /// A phone of which nothing is heard for this long is gone; it is asked for a sign of life before.
    pub silence_max: Duration,
    /// A phone that takes nothing of what it is told for this long is gone.
    pub unread_time_max: Duration,
    /// Least time between two states that a phone is told.
    pub delta_interval: Duration,
    /// Most small pictures that phones can look at.
    pub pictures_max: usize,
    /// Most bytes of one.
    pub picture_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    head_bytes_max: 8 << 10,
    head_fields_max: 64,
    head_time_max: Duration::from_secs(5),
    connections_max: 48,
    connections_per_address_max: 24,
    phones_max: 8,
    message_bytes_max: 1 << 10,
    messages_per_second_max: 600,
    messages_at_once_max: 3_000,
    silence_max: Duration::from_secs(30),
    unread_time_max: Duration::from_secs(10),
    delta_interval: Duration::from_millis(50),
    pictures_max: 512,
    picture_bytes_max: 128 << 10,
};
