//! The clipboard, accessed on its own thread, because a paste waits for the program that owns the copied text.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

/// A handle to the clipboard thread, which starts at the first use.
pub(crate) struct Clipboard {
    orders: Option<Sender<Order>>,
    pub(crate) pasted: Receiver<String>,
    /// The answer channel and wake function for the thread; `None` once the thread has started.
    start: Option<(Sender<String>, Wake)>,
}

type Wake = Box<dyn Fn() + Send>;

enum Order {
    Copy(String),
    Paste,
}

impl Clipboard {
    /// Creates the handle; the thread starts later. `wake` is called when pasted text has arrived.
    pub(crate) fn new(wake: impl Fn() + Send + 'static) -> Self {
        let (answers, pasted) = channel();
        Self { orders: None, pasted, start: Some((answers, Box::new(wake))) }
    }

    pub(crate) fn copy(&mut self, text: String) {
        self.order(Order::Copy(text));
    }

    pub(crate) fn paste(&mut self) {
        self.order(Order::Paste);
    }

    fn order(&mut self, order: Order) {
        if let Some((answers, wake)) = self.start.take() {
            let (orders, inbox) = channel();
            let started =
                Builder::new().name("clipboard".into()).spawn(move || serve(&inbox, &answers, &*wake));
            match started {
                Ok(_) => self.orders = Some(orders),
                Err(error) => {
                    tracing::warn!("cannot start the clipboard, so copy and paste do not work: {error}")
                }
            }
        }
        if let Some(orders) = &self.orders {
            // A send fails only after the thread has ended and logged the reason.
            let _ = orders.send(order);
        }
    }
}

/// Serves requests until the handle is dropped. Without a system clipboard, copied text stays within Mariana.
fn serve(inbox: &Receiver<Order>, answers: &Sender<String>, wake: &dyn Fn()) {
    let mut system = arboard::Clipboard::new()
        .inspect_err(|error| {
            tracing::warn!("cannot open the clipboard, so copied text stays within Mariana: {error}")
        })
        .ok();
    let mut own = String::new();
    for order in inbox {
        match order {
            Order::Copy(text) => {
                if let Some(Err(error)) = system.as_mut().map(|system| system.set_text(text.clone())) {
                    tracing::warn!("cannot write to the clipboard: {error}");
                }
                own = text;
            }
            Order::Paste => {
                let text = match system.as_mut().map(arboard::Clipboard::get_text) {
                    Some(Ok(text)) => text,
                    Some(Err(arboard::Error::ContentNotAvailable)) => continue,
                    Some(Err(_)) | None => own.clone(),
                };
                if answers.send(text).is_err() {
                    return;
                }
                wake();
            }
        }
    }
}
