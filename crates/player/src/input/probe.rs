//! Searches for an input with a signal while the current input has none.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use super::listener::has_signal;
use super::port::open;
use crate::device::Target;
use crate::device_list::ListedDevice;
use crate::worker::Worker;

const LISTENING: Duration = Duration::from_millis(400);

const ANSWER_LIMIT: Duration = Duration::from_millis(1500);

const CANDIDATES_MAX: usize = 8;

/// Wait after the first search without success. The wait doubles with each further search, up to [`PAUSE_MAX`].
const PAUSE: Duration = Duration::from_secs(2);

const PAUSE_MAX: Duration = Duration::from_secs(30);

pub(super) struct Prober {
    search: Option<(Worker, Receiver<Option<ListedDevice>>)>,
    found: Option<ListedDevice>,
    /// True if the answer of the running search must be ignored.
    stale: bool,
    next: Option<Instant>,
    pause: Duration,
}

impl Prober {
    pub(super) fn new() -> Self {
        Self { search: None, found: None, stale: false, next: None, pause: PAUSE }
    }

    pub(super) fn reset(&mut self) {
        // A running search would answer for the previous input.
        self.stale = self.search.is_some();
        (self.found, self.next, self.pause) = (None, None, PAUSE);
    }

    /// Returns the input with a signal that a search has found. Starts a search of `candidates` if a search is due.
    pub(super) fn search(&mut self, candidates: impl FnOnce() -> Vec<ListedDevice>) -> Option<&ListedDevice> {
        if let Some((worker, answer)) = &self.search {
            if let Ok(found) = answer.try_recv() {
                self.found = found.filter(|_| !std::mem::take(&mut self.stale));
                self.next = Some(Instant::now() + self.pause);
                self.pause = (2 * self.pause).min(PAUSE_MAX);
            }
            if !worker.has_ended() {
                return self.found.as_ref();
            }
            (self.search, self.stale) = (None, false);
        }
        if self.next.is_none_or(|next| next <= Instant::now()) {
            let candidates = candidates();
            let (answer, answers) = channel();
            let worker = Worker::spawn("sound search", move || search(candidates, &answer));
            self.search = worker.ok().map(|worker| (worker, answers));
        }
        self.found.as_ref()
    }
}

/// Sends the first of `candidates` that has a signal to `found`. Returns only after all devices are closed, so that a
/// hanging input delays the next search, and searches do not accumulate.
fn search(mut candidates: Vec<ListedDevice>, found: &Sender<Option<ListedDevice>>) {
    candidates.truncate(CANDIDATES_MAX);
    let (answer, answers) = channel();
    let mut workers: Vec<Worker> = candidates
        .iter()
        .enumerate()
        .filter_map(|(index, entry)| {
            let (id, answer) = (entry.id.clone(), answer.clone());
            Worker::spawn("sound probe", move || probe(&id, index, &answer)).ok()
        })
        .collect();
    drop(answer);
    let start = Instant::now();
    let mut best = None;
    while let Ok((index, heard)) = answers.recv_timeout(ANSWER_LIMIT.saturating_sub(start.elapsed())) {
        if heard && best.is_none_or(|best| index < best) {
            best = Some(index);
        }
    }
    // The send fails if the receiver was dropped.
    let _ = found.send(best.and_then(|index| candidates.into_iter().nth(index)));
    for worker in &mut workers {
        while !worker.has_ended() {
            worker.join_within(ANSWER_LIMIT);
        }
    }
}

fn probe(id: &str, index: usize, answer: &Sender<(usize, bool)>) {
    let heard = match open(&Target::Named(id.to_owned()), &std::thread::current(), &(Arc::new(|_| {}) as _)) {
        Ok((stream, mut opened)) => {
            let start = Instant::now();
            let mut heard = false;
            while !heard && start.elapsed() < LISTENING {
                std::thread::park_timeout(LISTENING.saturating_sub(start.elapsed()));
                let ring = &mut opened.link.ring;
                if let Ok(chunk) = ring.read_chunk(ring.slots()) {
                    let (front, back) = chunk.as_slices();
                    heard = has_signal(front) || has_signal(back);
                    chunk.commit_all();
                }
            }
            drop(stream);
            heard
        }
        Err((error, _)) => {
            tracing::debug!("{error}");
            false
        }
    };
    // If the search has ended, the answer is ignored.
    let _ = answer.send((index, heard));
}
