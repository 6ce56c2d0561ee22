//! The limits of this crate.

/// Limits on messages and documents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Maximum number of bytes of a message. A larger message is skipped and reported.
    pub message_bytes_max: usize,
    /// Maximum number of bytes of a message's header.
    pub header_bytes_max: usize,
    /// Maximum number of open documents. Further documents get a message instead of diagnostics.
    pub documents_max: usize,
    /// Maximum number of lines above a call's argument in which the call's name is searched.
    pub signature_lines_max: usize,
    /// Maximum length of a new name, in bytes.
    pub name_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    message_bytes_max: 16 << 20,
    header_bytes_max: 4_096,
    documents_max: 256,
    signature_lines_max: 40,
    name_bytes_max: 200,
};
