//! Closes cpal's PulseAudio connections on the server's side when cpal cannot close them. When the last output is
//! unplugged, PulseAudio kills its stream. cpal's thread then waits forever for a last message, and dropping the stream
//! waits for this thread. But the thread notices when the server closes the connection, so Mariana asks the server to
//! close it.

use std::collections::BTreeSet;
use std::ffi::CString;
use std::sync::Mutex;

use futures_executor::block_on;
use mariana_work::lock;
use pulseaudio::{Client, ClientError};

/// The connection for queries about other connections. It stays open, because connections last as long as the server.
static ASKING: Mutex<Option<Client>> = Mutex::new(None);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ServerConnection(u32);

/// Returns the result of `open` and the connection that it made. The connection is `None` if the server does not answer
/// or if several connections appeared. This function may block as long as the server does.
pub(super) fn opened_by<T, E>(
    open: impl FnOnce() -> Result<T, E>,
) -> Result<(T, Option<ServerConnection>), E> {
    let mut asking = lock(&ASKING);
    let before = own_connections(&mut asking);
    let made = open()?;
    let connection = before.and_then(|before| {
        let after = own_connections(&mut asking)?;
        let mut new = after.difference(&before);
        new.next().filter(|_| new.next().is_none()).map(|client| ServerConnection(*client))
    });
    Ok((made, connection))
}

impl ServerConnection {
    /// Asks the server to close the connection. This wakes all threads that wait for it. May block like the server.
    pub(crate) fn end(self) {
        let mut asking = lock(&ASKING);
        // After a restart of the server, another connection may have this number. It is then opened again.
        let is_there = own_connections(&mut asking).is_some_and(|own| own.contains(&self.0));
        if let Some(client) = asking.as_ref().filter(|_| is_there)
            && let Err(error) = block_on(client.kill_client(self.0))
        {
            tracing::debug!("the sound server failed to close a connection: {error}");
        }
    }
}

fn own_connections(asking: &mut Option<Client>) -> Option<BTreeSet<u32>> {
    if let Some(client) = asking
        && let Ok(answer) = query(client)
    {
        return Some(answer);
    }
    // This is the first query, or the server has restarted.
    let client = Client::from_env(c"mariana").ok()?;
    let answer = query(&client).ok();
    *asking = Some(client);
    answer
}

fn query(client: &Client) -> Result<BTreeSet<u32>, ClientError> {
    // cpal gives its connections this name.
    let name = CString::new(format!("cpal-pulseaudio-{}", std::process::id())).unwrap_or_default();
    let all = block_on(client.list_clients())?;
    Ok(all.into_iter().filter(|client| client.name == name).map(|client| client.index).collect())
}
