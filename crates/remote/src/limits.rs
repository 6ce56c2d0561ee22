//! All limits of this crate. Code, error messages and tests read them from here.

use std::time::Duration;

use crate::http::HeadBounds;

/// Limits on input from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Of a request's head. The maximum time also limits the sending of the answer.
    pub head: HeadBounds,
    /// The maximum number of open connections, including phones.
    pub connections_max: usize,
    /// The maximum number of connections from one address.
    pub connections_per_address_max: usize,
    /// The maximum number of connected phones.
    pub phones_max: usize,
    /// The maximum size of a phone's message, in bytes.
    pub message_bytes_max: usize,
    /// The maximum sustained message rate of a phone, in messages a second. A phone above this rate is disconnected.
    pub messages_per_second_max: u32,
    /// The maximum burst of messages, for example after a network delay.
    pub messages_at_once_max: u32,
    /// The time without any message after which a phone is disconnected. The server pings the phone first.
    pub silence_max: Duration,
    /// The time after which a phone that does not read its data is disconnected.
    pub unread_time_max: Duration,
    /// The minimum time between two state updates for a phone.
    pub delta_interval: Duration,
    /// The maximum number of preview images.
    pub pictures_max: usize,
    /// The maximum size of a preview image, in bytes.
    pub picture_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    head: HeadBounds { bytes_max: 8 << 10, fields_max: 64, time_max: Duration::from_secs(5) },
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
