//! Stands in where there is no PulseAudio: none of its connections has to be ended.

/// A connection as the server knows it: there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ServerConnection {}

/// The result of `open`.
pub(super) fn opened_by<T, E>(
    open: impl FnOnce() -> Result<T, E>,
) -> Result<(T, Option<ServerConnection>), E> {
    Ok((open()?, None))
}

impl ServerConnection {
    /// Never called.
    pub(crate) fn end(self) {
        match self {}
    }
}
