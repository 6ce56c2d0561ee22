//! A thread that carries out all orders one after the other.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use super::{Background, contained};

/// The owner of a thread that [`in_order`] has started. When this is dropped, the thread carries out the
/// remaining orders, and stops at the first answer that can no longer be delivered.
// The thread ends after the orders have gone, and its last answers are still sent meanwhile: the order of the fields.
#[derive(Debug)]
pub struct Worker<Order, Answer = ()> {
    orders: Option<Sender<Order>>,
    background: Background,
    answers: Receiver<Answer>,
    /// The number of orders that are not carried out, and of answers that are not polled.
    open: Arc<AtomicUsize>,
}

/// Starts a thread. It calls `prepare` and passes each order to the result, which may answer. It calls `wake` after each
/// answer. A panic of one order is logged, and the thread continues with the next order.
///
/// # Errors
/// Fails if the system cannot start a thread.
pub fn in_order<Order: Send + 'static, Answer: Send + 'static, Obey: FnMut(Order) -> Option<Answer>>(
    name: &str,
    wake: impl Fn() + Send + 'static,
    prepare: impl FnOnce() -> Obey + Send + 'static,
) -> io::Result<Worker<Order, Answer>> {
    let ((orders, inbox), (tell, answers)) = (channel(), channel());
    let open = Arc::<AtomicUsize>::default();
    let of_thread = open.clone();
    let background = Background::start(name, move || {
        let mut obey = prepare();
        for order in inbox {
            match contained(|| obey(order)).flatten().map(|answer| tell.send(answer)) {
                Some(Ok(())) => wake(),
                Some(Err(_)) => return,
                None => drop(of_thread.fetch_sub(1, Ordering::Relaxed)),
            }
        }
    })?;
    Ok(Worker { orders: Some(orders), background, answers, open })
}

impl<Order, Answer> Default for Worker<Order, Answer> {
    /// A worker without a thread, which accepts no order.
    fn default() -> Self {
        let background = Background::default();
        Self { orders: None, background, answers: channel().1, open: Arc::default() }
    }
}

impl<Order, Answer> Worker<Order, Answer> {
    /// Gives an order. Returns false if it is not carried out, because the thread has ended.
    pub fn send(&self, order: Order) -> bool {
        self.open.fetch_add(1, Ordering::Relaxed);
        let is_sent = self.orders.as_ref().is_some_and(|orders| orders.send(order).is_ok());
        self.open.fetch_sub(usize::from(!is_sent), Ordering::Relaxed);
        is_sent
    }

    /// Returns the next answer, if it has come.
    pub fn poll(&self) -> Option<Answer> {
        self.within(Duration::ZERO)
    }

    /// Waits at most `limit` for the next answer.
    pub fn within(&self, limit: Duration) -> Option<Answer> {
        let answer = self.answers.recv_timeout(limit).ok();
        self.open.fetch_sub(usize::from(answer.is_some()), Ordering::Relaxed);
        answer
    }

    /// True if all orders are carried out and all answers are polled.
    pub fn is_idle(&self) -> bool {
        self.open.load(Ordering::Relaxed) == 0
    }

    /// Waits at most `limit` until all orders are carried out, and returns true if they are. No more are accepted.
    pub fn finish(&mut self, limit: Duration) -> bool {
        self.orders = None;
        self.background.finish(limit)
    }

    /// Dropping this waits at most `limit` until all orders are carried out.
    #[must_use]
    pub fn finished_at_drop(mut self, limit: Duration) -> Self {
        self.background.wait = limit;
        self
    }
}
