//! The limits of this crate.

/// Maximum number of open documents. Further documents get a message instead of diagnostics.
pub const DOCUMENTS_MAX: usize = 256;
/// Maximum number of lines above a call's argument in which the call's name is searched.
pub const SIGNATURE_LINES_MAX: usize = 40;
/// Maximum length of a new name, in bytes.
pub const NAME_BYTES_MAX: usize = 200;
