//! The clipboard, accessed on its own thread, because a paste waits for the program that owns the copied text.

use mariana_work::{Worker, in_order};

/// The clipboard thread, which opens the clipboard at the first use and returns pasted text.
pub(crate) type Clipboard = Worker<Order, String>;

pub(crate) enum Order {
    Copy(String),
    Paste,
}

/// Starts the thread, which calls `wake` when pasted text has arrived.
pub(crate) fn start(wake: impl Fn() + Send + 'static) -> Clipboard {
    let thread = in_order("clipboard", wake, || {
        let mut clipboard = None;
        move |order| clipboard.get_or_insert_with(SystemClipboard::open).obey(order)
    });
    let thread = thread.inspect_err(|error| {
        tracing::warn!("cannot start the clipboard, so copy and paste do not work: {error}");
    });
    thread.unwrap_or_default()
}

/// Without a system clipboard, copied text stays within Mariana.
struct SystemClipboard {
    system: Option<arboard::Clipboard>,
    own: String,
}

impl SystemClipboard {
    fn open() -> Self {
        let system = arboard::Clipboard::new().inspect_err(|error| {
            tracing::warn!("cannot open the clipboard, so copied text stays within Mariana: {error}");
        });
        Self { system: system.ok(), own: String::new() }
    }

    fn obey(&mut self, order: Order) -> Option<String> {
        match order {
            Order::Copy(text) => {
                if let Some(Err(error)) = self.system.as_mut().map(|system| system.set_text(text.clone())) {
                    tracing::warn!("cannot write to the clipboard: {error}");
                }
                self.own = text;
                None
            }
            Order::Paste => match self.system.as_mut().map(arboard::Clipboard::get_text) {
                Some(Ok(text)) => Some(text),
                Some(Err(arboard::Error::ContentNotAvailable)) => None,
                Some(Err(_)) | None => Some(self.own.clone()),
            },
        }
    }
}
