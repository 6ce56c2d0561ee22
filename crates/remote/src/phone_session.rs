//! A WebSocket session with one phone. The phone's messages go to the input queue; the phone gets state updates.

use std::io::{self, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use mariana_control::osc::Asked;
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use crate::heartbeat::{Due, Heartbeat};
use crate::http;
use crate::message::understand;
use crate::server::Serving;
use crate::state_delta::SentState;

/// The message that is sent when there is no news, so that the page knows that the connection is alive.
const ALIVE: &str = "{}";
const READ_BYTES: usize = 4 << 10;

/// Completes the WebSocket handshake. Fails if the phone is gone.
pub(crate) fn accept(mut stream: &TcpStream, key: &str, within: Duration) -> io::Result<()> {
    stream.set_write_timeout(Some(within))?;
    // Nagle's algorithm would delay slider updates.
    stream.set_nodelay(true)?;
    let key = derive_accept_key(key.as_bytes());
    stream.write_all(
        format!(
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {key}\r\n\r\n"
        )
        .as_bytes(),
    )
}

pub(crate) struct PhoneSession<'a> {
    socket: WebSocket<TcpStream>,
    shared: &'a Serving,
    reported: SentState,
    heartbeat: Heartbeat,
    /// The time since which unread data has been waiting for the phone.
    unread: Option<Instant>,
}

type End = String;

impl<'a> PhoneSession<'a> {
    /// Starts a session after the handshake; `rest` are bytes that were already read.
    pub(crate) fn new(stream: TcpStream, rest: Vec<u8>, shared: &'a Serving) -> Self {
        let limits = shared.limits;
        let config = WebSocketConfig::default()
            .read_buffer_size(READ_BYTES)
            .max_message_size(Some(limits.message_bytes_max))
            .max_frame_size(Some(limits.message_bytes_max));
        let socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(config));
        let heartbeat = Heartbeat::new(limits, Instant::now());
        Self { socket, shared, reported: SentState::default(), heartbeat, unread: None }
    }

    pub(crate) fn run(mut self) -> End {
        let _ = self.socket.get_ref().set_write_timeout(Some(self.shared.limits.delta_interval));
        let mut due = Instant::now();
        let end = loop {
            if let Err(end) = self.send_if_due(&mut due).and_then(|()| self.listen(due)) {
                break end;
            }
        };
        http::part(self.socket.get_ref());
        end
    }

    fn send_if_due(&mut self, due: &mut Instant) -> Result<(), End> {
        let now = Instant::now();
        if now < *due {
            return Ok(());
        }
        *due = now + self.shared.limits.delta_interval;
        if self.shared.is_over() {
            return Err(self.close(CloseCode::Away, "Mariana has quit"));
        }
        if let Some(since) = self.unread {
            if now.saturating_duration_since(since) >= self.shared.limits.unread_time_max {
                return Err("the phone reads no data".to_owned());
            }
            // Do not add to unread data: the phone gets the newest state after it has read the old state.
            let flushed = self.socket.flush();
            return self.record_sent(flushed);
        }
        let state_delta = self.reported.state_delta(&self.shared.board.newest(), self.shared.album.count());
        match (self.heartbeat.due(now), state_delta) {
            (Due::GiveUp, _) => Err(self.close(CloseCode::Policy, "no message for too long")),
            (Due::Ask, state_delta) => {
                self.send(Message::Ping(Default::default()))?;
                self.send(Message::text(state_delta.unwrap_or_else(|| ALIVE.to_owned())))
            }
            (Due::Nothing, Some(state_delta)) => self.send(Message::text(state_delta)),
            (Due::Nothing, None) => Ok(()),
        }
    }

    fn send(&mut self, message: Message) -> Result<(), End> {
        let sent = self.socket.send(message);
        self.record_sent(sent)
    }

    fn record_sent(&mut self, sent: tungstenite::Result<()>) -> Result<(), End> {
        match sent {
            Ok(()) => self.unread = None,
            Err(Error::Io(error)) if is_patience(&error) => {
                self.unread.get_or_insert_with(Instant::now);
            }
            Err(error) => return Err(error.to_string()),
        }
        Ok(())
    }

    fn listen(&mut self, until: Instant) -> Result<(), End> {
        let left = until.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
        let _ = self.socket.get_ref().set_read_timeout(Some(left));
        let message = match self.socket.read() {
            Ok(message) => message,
            Err(Error::Io(error)) if is_patience(&error) => return Ok(()),
            Err(Error::Capacity(_)) => return Err(self.close(CloseCode::Size, "a message is too large")),
            Err(Error::Utf8(_)) => return Err(self.close(CloseCode::Invalid, "a message is not valid UTF-8")),
            Err(Error::Protocol(error)) => {
                let end = error.to_string();
                self.close(CloseCode::Protocol, "this is not a WebSocket");
                return Err(end);
            }
            Err(error) => return Err(error.to_string()),
        };
        if !self.heartbeat.count_message(Instant::now()) {
            self.shared.input_queue.refuse(1);
            return Err(self.close(CloseCode::Policy, "too many messages"));
        }
        match message {
            Message::Text(text) => {
                let input = &self.shared.input_queue;
                // Phones ask no queries.
                let _ = Asked::queue(understand(&text, self.shared.actions), input);
                input.count();
                Ok(())
            }
            Message::Binary(_) => {
                self.shared.input_queue.refuse(1);
                Err(self.close(CloseCode::Unsupported, "messages must be text"))
            }
            Message::Ping(_) | Message::Pong(_) | Message::Close(_) | Message::Frame(_) => Ok(()),
        }
    }

    fn close(&mut self, code: CloseCode, reason: &'static str) -> End {
        let _ = self.socket.close(Some(CloseFrame { code, reason: reason.into() }));
        let _ = self.socket.flush();
        reason.to_owned()
    }
}

/// True if a read or write timed out or was interrupted.
fn is_patience(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
