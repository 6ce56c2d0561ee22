//! The clipboard, on a thread of its own: asking for what another program copied waits for that program.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

/// See the module. The thread starts when it is used for the first time.
pub(crate) struct Clipboard {
    orders: Option<Sender<Order>>,
    pasted: Receiver<String>,
    /// What the thread answers with, and what it wakes.
    start: Option<(Sender<String>, Wake)>,
}

type Wake = Box<dyn Fn() + Send>;

enum Order {
    Copy(String),
    Paste,
}

impl Clipboard {
    /// One that nobody has used. `wake` is called when something has come that was asked for.
    pub(crate) fn new(wake: impl Fn() + Send + 'static) -> Self {
        let (answers, pasted) = channel();
        Self { orders: None, pasted, start: Some((answers, Box::new(wake))) }
    }

    /// Offers a text to all programs.
    pub(crate) fn copy(&mut self, text: String) {
        self.order(Order::Copy(text));
    }

    /// Asks for what was copied last: [`Clipboard::pasted`] gives it when it comes.
    pub(crate) fn paste(&mut self) {
        self.order(Order::Paste);
    }

    /// What was asked for and has come. Never blocks.
    pub(crate) fn pasted(&self) -> Option<String> {
        self.pasted.try_recv().ok()
    }

    fn order(&mut self, order: Order) {
        if let Some((answers, wake)) = self.start.take() {
            let (orders, inbox) = channel();
            let started =
                Builder::new().name("clipboard".into()).spawn(move || serve(&inbox, &answers, &*wake));
            match started {
                Ok(_) => self.orders = Some(orders),
                Err(error) => tracing::warn!("there is no clipboard: {error}"),
            }
        }
        if let Some(orders) = &self.orders {
            // A thread that has ended has told why.
            let _ = orders.send(order);
        }
    }
}

/// Serves until nobody asks any more. Without a clipboard of the system the program has one of its own.
fn serve(inbox: &Receiver<Order>, answers: &Sender<String>, wake: &dyn Fn()) {
    let mut system = arboard::Clipboard::new()
        .inspect_err(|error| tracing::warn!("the system's clipboard cannot be used: {error}"))
        .ok();
    let mut own = String::new();
    for order in inbox {
        match order {
            Order::Copy(text) => {
                if let Some(Err(error)) = system.as_mut().map(|system| system.set_text(text.clone())) {
                    tracing::warn!("the system's clipboard takes no text: {error}");
                }
                own = text;
            }
            Order::Paste => {
                let text = match system.as_mut().map(arboard::Clipboard::get_text) {
                    Some(Ok(text)) => text,
                    // Nothing that is text.
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
