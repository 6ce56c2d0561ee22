//! The server's side of connections to PulseAudio, to end one that cpal cannot end.
//!
//! When an output is pulled out and no other is left, PulseAudio kills the stream that played on it. cpal's thread waits
//! for ever for a last word of that stream, and dropping the stream waits for the thread. What the thread does notice is
//! the end of its connection, and that the server can be asked for.

use std::collections::BTreeSet;
use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

use futures_executor::block_on;
use pulseaudio::{Client, ClientError};

/// The connection on which the server is asked about the others. It is kept: a connection ends with the server alone.
static ASKING: Mutex<Option<Client>> = Mutex::new(None);

/// A connection as the server knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ServerConnection {
    /// What tells one run of the server from another.
    server: u32,
    client: u32,
}

/// What `open` makes, and the connection that it made for that; none if the server does not say, or if there is more
/// than one that it could be. May block as long as the server likes.
pub(super) fn opened_by<T, E>(
    open: impl FnOnce() -> Result<T, E>,
) -> Result<(T, Option<ServerConnection>), E> {
    let mut asking = ASKING.lock().unwrap_or_else(PoisonError::into_inner);
    let before = own_connections(&mut asking);
    let made = open()?;
    let connection = before.and_then(|(server, before)| {
        let (same_server, after) = own_connections(&mut asking)?;
        let mut new = after.difference(&before);
        let only = new.next().filter(|_| new.next().is_none() && same_server == server);
        only.map(|client| ServerConnection { server, client: *client })
    });
    Ok((made, connection))
}

impl ServerConnection {
    /// Asks the server to end it; whoever waits on it hears that it is closed. May block as long as the server likes.
    pub(crate) fn end(self) {
        let mut asking = ASKING.lock().unwrap_or_else(PoisonError::into_inner);
        let is_there = own_connections(&mut asking)
            .is_some_and(|(server, own)| server == self.server && own.contains(&self.client));
        if let Some(client) = asking.as_ref().filter(|_| is_there)
            && let Err(error) = block_on(client.kill_client(self.client))
        {
            tracing::debug!("the sound server does not end a connection: {error}");
        }
    }
}

/// The run of the server, and the numbers of the connections that cpal made for this process.
fn own_connections(asking: &mut Option<Client>) -> Option<(u32, BTreeSet<u32>)> {
    if let Some(client) = asking
        && let Ok(answer) = ask(client)
    {
        return Some(answer);
    }
    // The first question, or the server was started anew.
    let client = Client::from_env(c"mariana").ok()?;
    let answer = ask(&client).ok();
    *asking = Some(client);
    answer
}

fn ask(client: &Client) -> Result<(u32, BTreeSet<u32>), ClientError> {
    // So cpal calls itself.
    let name = CString::new(format!("cpal-pulseaudio-{}", std::process::id())).unwrap_or_default();
    let server = block_on(client.server_info())?.cookie;
    let all = block_on(client.list_clients())?;
    Ok((server, all.into_iter().filter(|client| client.name == name).map(|client| client.index).collect()))
}
