use super::*;

use std::fmt;
use std::sync::mpsc::{Sender, sync_channel};
use std::time::Instant;

const LIMIT: Duration = Duration::from_secs(20);

/// Collects what all threads log.
struct Log;

static LOGGED: Mutex<String> = Mutex::new(String::new());

impl tracing::Subscriber for Log {
    fn enabled(&self, _: &tracing::Metadata<'_>) -> bool {
        true
    }

    fn new_span(&self, _: &tracing::span::Attributes<'_>) -> tracing::span::Id {
        tracing::span::Id::from_u64(1)
    }

    fn event(&self, event: &tracing::Event<'_>) {
        event.record(&mut |_: &tracing::field::Field, value: &dyn fmt::Debug| {
            *lock(&LOGGED) += &format!("{value:?}\n");
        });
    }

    fn record(&self, _: &tracing::span::Id, _: &tracing::span::Record<'_>) {}
    fn record_follows_from(&self, _: &tracing::span::Id, _: &tracing::span::Id) {}
    fn enter(&self, _: &tracing::span::Id) {}
    fn exit(&self, _: &tracing::span::Id) {}
}

/// A wait that ends when the sender is dropped.
fn gate() -> (Sender<()>, impl Fn() + Send + 'static) {
    let (open, opened) = channel();
    (open, move || opened.recv_timeout(LIMIT).unwrap_or_default())
}

#[test]
fn an_answer_comes_once_after_waking() {
    let (woken, wakes) = sync_channel(1);
    let (open, waits) = gate();
    let work = move || {
        waits();
        7
    };
    let mut answer = once("test", move || woken.send(()).unwrap(), work).unwrap();
    assert_eq!((answer.poll(), answer.is_awaited()), (None, true));
    drop(open);
    wakes.recv_timeout(LIMIT).unwrap();
    assert_eq!(answer.poll(), Some(Ok(7)));
    assert_eq!((answer.poll(), answer.is_awaited()), (None, false));
    assert_eq!(Awaited::<u32>::default().poll(), None);
}

#[test]
fn a_panic_wakes_the_owner_and_gives_no_answer() {
    let _ = tracing::subscriber::set_global_default(Log);
    let (woken, wakes) = sync_channel(1);
    let panics = || -> u32 { panic!("on purpose") };
    let mut answer = once("clumsy", move || woken.send(()).unwrap(), panics).unwrap();
    wakes.recv_timeout(LIMIT).unwrap();
    assert_eq!(answer.poll(), Some(Err(NO_ANSWER)));
    let logged = lock(&LOGGED).clone();
    assert!(logged.contains("the thread 'clumsy' panicked"), "{logged}");
}

#[test]
fn all_orders_are_carried_out_in_order_before_a_patient_drop_returns() {
    let (reported, reports) = channel();
    let obey =
        move || move |order: u32| reported.send(order).ok().filter(|()| order != 2).map(|()| 2 * order);
    let worker = in_order("test", || {}, obey).unwrap().finished_at_drop(LIMIT);
    assert!((1..=3).all(|order| worker.send(order)));
    assert_eq!([worker.within(LIMIT), worker.within(LIMIT)], [Some(2), Some(6)]);
    assert!(worker.is_idle());
    assert!((4..=6).all(|order| worker.send(order)) && !worker.is_idle());
    drop(worker);
    assert_eq!(reports.iter().collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6]);
}

#[test]
fn answers_can_be_polled_after_the_end() {
    let mut worker = in_order("test", || {}, || |order: u32| Some(order)).unwrap();
    assert!(worker.send(1) && worker.send(2));
    assert!(worker.finish(LIMIT) && !worker.send(3));
    assert_eq!([worker.poll(), worker.poll(), worker.poll()], [Some(1), Some(2), None]);
    assert!(worker.is_idle());
}

#[test]
fn the_order_after_a_panic_is_carried_out() {
    let obey = || |order: u32| if order == 0 { panic!("on purpose") } else { Some(order) };
    let worker = in_order("test", || {}, obey).unwrap();
    assert!(worker.send(0) && worker.send(1));
    assert_eq!(worker.within(LIMIT), Some(1));
    assert!(worker.is_idle());
}

#[test]
fn only_the_latest_of_the_waiting_requests_counts() {
    let (done, jobs) = channel();
    let (begun, begins) = channel();
    let (open, waits) = gate();
    let work = move |job: u32, shared: &Shared<Option<u32>>| {
        begun.send(()).unwrap();
        waits();
        done.send((job, shared.lock().is_some())).unwrap();
    };
    let latest = latest("test", None, Option::take, work).unwrap();
    latest.change(|wanted| *wanted = Some(1));
    begins.recv_timeout(LIMIT).unwrap();
    (2..5).for_each(|job| latest.change(|wanted| *wanted = Some(job)));
    drop(open);
    assert_eq!(jobs.recv_timeout(LIMIT), Ok((1, true)), "the first job saw that it is outdated");
    assert_eq!(jobs.recv_timeout(LIMIT), Ok((4, false)));
}

#[test]
fn the_job_after_a_panic_is_done() {
    let (done, jobs) = channel();
    let work = move |job: u32, _: &_| if job == 0 { panic!("on purpose") } else { done.send(job).unwrap() };
    let latest = latest("test", Some(0), Option::take, work).unwrap();
    while latest.lock().is_some() {
        std::thread::yield_now();
    }
    latest.change(|wanted| *wanted = Some(1));
    assert_eq!(jobs.recv_timeout(LIMIT), Ok(1));
}

#[test]
fn dropping_the_owner_ends_a_thread_that_waits_and_one_that_looks() {
    let (held, dropped) = channel::<()>();
    drop(latest("test", None::<()>, Option::take, move |(), _| drop(held.clone())).unwrap());
    assert_eq!(dropped.recv_timeout(LIMIT), Err(RecvTimeoutError::Disconnected));
    let (begun, begins) = channel::<()>();
    let work = move |(), shared: &Shared<Option<()>>| {
        begun.send(()).unwrap();
        drop(shared.wait_while(LIMIT, |_| true));
        assert!(shared.is_over());
    };
    let latest = latest("test", Some(()), Option::take, work).unwrap().finished_at_drop(LIMIT);
    begins.recv_timeout(LIMIT).unwrap();
    drop(latest);
    assert_eq!(begins.try_recv(), Err(TryRecvError::Disconnected), "the drop waited for the end");
    let (held, dropped) = channel::<()>();
    drop(in_order("test", || {}, || move |()| held.send(()).ok()).unwrap());
    assert_eq!(dropped.recv_timeout(LIMIT), Err(RecvTimeoutError::Disconnected));
}

#[test]
fn a_loop_shares_its_state_and_rests_until_the_owner_is_gone() {
    let (ended, ends) = channel();
    let work = move |shared: &Shared<u32>| {
        while !shared.is_over() {
            shared.change(|rounds| *rounds += 1);
            shared.rest(LIMIT);
        }
        ended.send(*shared.lock()).unwrap();
    };
    let owner = looping("test", 0, work).unwrap();
    drop(owner.wait_while(LIMIT, |rounds| *rounds == 0));
    drop(owner);
    assert_eq!(ends.recv_timeout(LIMIT), Ok(1));
    assert_eq!(*Latest::<u32>::default().lock(), 0);
}

#[test]
fn the_owner_waits_no_longer_than_its_limit() {
    let (open, waits) = gate();
    let mut background = Background::start("test", waits).unwrap();
    let begun = Instant::now();
    assert!(!background.finish(Duration::from_millis(1)) && !background.has_ended());
    drop(background);
    assert!(begun.elapsed() < LIMIT / 2);
    drop(open);
}
