//! Tests of arbitrary edits of lists.

use proptest::prelude::*;

use super::*;
use crate::listed::{Edit, SharedListing};
use crate::track::{Found, Repeat, TrackList, Wanted};

#[derive(Debug, Clone)]
enum Change {
    Move(usize, usize),
    Remove(usize),
    Append(usize),
    Shuffle(bool),
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        (0_usize..12, 0_usize..12).prop_map(|(from, to)| Change::Move(from, to)),
        (0_usize..12).prop_map(Change::Remove),
        (0_usize..4).prop_map(Change::Append),
        any::<bool>().prop_map(Change::Shuffle),
    ]
}

fn files(from: usize, count: usize) -> Vec<PathBuf> {
    (from..from + count).map(|n| PathBuf::from(format!("/nowhere/{n}.wav"))).collect()
}

fn names(shared: &SharedListing) -> Vec<String> {
    shared.tracks().entries.iter().map(|track| track.name.clone()).collect()
}

proptest! {
    #[test]
    fn after_any_changes_each_entry_is_in_the_order_once(
        start in 1_usize..10, changes in prop::collection::vec(change(), 0..30), playing in 0_usize..10,
    ) {
        let mut list = Playlist::new(gather(&files(0, start)).entries);
        let shared = SharedListing::default();
        list.fill_listing(shared.clone());
        let mut model: Vec<usize> = (0..start).collect();
        let mut next = start;
        let playing = (playing % start) as u64;
        let mut removed = false;
        for change in changes {
            let edit = match change {
                Change::Shuffle(shuffled) => {
                    list.set_order(Repeat::All, shuffled, playing);
                    continue;
                }
                Change::Move(from, to) => {
                    if from.max(to) < model.len() {
                        let moved = model.remove(from);
                        model.insert(to, moved);
                    }
                    Edit::Move { from, to }
                }
                Change::Remove(entry) => {
                    if entry < model.len() {
                        removed |= model.remove(entry) as u64 == playing;
                    }
                    Edit::Remove(entry)
                }
                Change::Append(count) => {
                    model.extend(next..next + count);
                    next += count;
                    Edit::Append(files(next - count, count))
                }
            };
            let edited = list.edit(&edit, playing, &mut |_| {});
            for gone in edited.removed {
                prop_assert!(shared.place(gone).is_none());
            }
            // The listing equals the list, and each entry is found by its id.
            prop_assert_eq!(names(&shared), model.iter().map(|n| format!("{n}.wav")).collect::<Vec<_>>());
            for (index, id) in model.iter().enumerate() {
                prop_assert_eq!(shared.place(*id as u64), Some((index, model.len())));
            }
            prop_assert_eq!(shared.place(playing).is_none(), removed);
            // In any order, one round from the playing (or removed) entry contains every entry once.
            let first = list.order.beside(playing, true, true);
            let mut round: Vec<usize> = std::iter::successors(first, |id| list.order.beside(*id, true, true))
                .take(model.len())
                .map(|id| id as usize)
                .collect();
            if list.ids().eq(0..model.len() as u64) && !removed && !round.is_empty() {
                prop_assert_eq!(round.last(), Some(&(playing as usize)));
            }
            for pair in round.windows(2) {
                prop_assert_eq!(list.order.beside(pair[1] as u64, false, true), Some(pair[0] as u64));
            }
            round.sort_unstable();
            let mut all = model.clone();
            all.sort_unstable();
            prop_assert_eq!(round, all);
        }
        list.set_order(Repeat::All, true, playing);
        list.set_order(Repeat::All, false, playing);
        let order: Vec<usize> = std::iter::successors(list.order.first(), |id| list.order.beside(*id, true, false))
            .map(|id| id as usize)
            .collect();
        prop_assert_eq!(order, model);
    }

    #[test]
    fn undo_returns_to_the_first_list_in_any_order(
        start in 1_usize..10, changes in prop::collection::vec(change(), 0..30), playing in 0_u64..10,
    ) {
        let mut list = Playlist::new(gather(&files(0, start)).entries);
        let shared = SharedListing::default();
        list.fill_listing(shared.clone());
        let mut states = vec![names(&shared)];
        for change in changes {
            let edit = match change {
                Change::Move(from, to) => Edit::Move { from, to },
                Change::Remove(entry) => Edit::Remove(entry),
                Change::Append(0) => Edit::Clear,
                Change::Append(count) => Edit::Append(files(0, count)),
                Change::Shuffle(shuffled) => {
                    list.set_order(Repeat::All, shuffled, playing);
                    continue;
                }
            };
            let before = shared.tracks().undo.clone();
            list.edit(&edit, playing, &mut |_| {});
            let changed = shared.tracks().undo != before || names(&shared) != states[states.len() - 1];
            if changed {
                states.push(names(&shared));
            }
        }
        while shared.tracks().undo.is_some() {
            let edited = list.edit(&Edit::Undo, playing, &mut |_| {});
            prop_assert!(edited.removed.iter().all(|gone| shared.place(*gone).is_none()));
            let mut round: Vec<u64> =
                std::iter::successors(list.order.first(), |id| list.order.beside(*id, true, false)).collect();
            round.sort_unstable();
            let mut all: Vec<u64> = list.ids().collect();
            all.sort_unstable();
            prop_assert_eq!(round, all, "each entry is in the order once");
        }
        prop_assert_eq!(names(&shared), states[0].clone());
    }

    #[test]
    fn an_unshuffled_order_follows_the_list(
        start in 1_usize..10, changes in prop::collection::vec(change(), 0..30),
    ) {
        let mut list = Playlist::new(gather(&files(0, start)).entries);
        for change in changes {
            let edit = match change {
                Change::Move(from, to) => Edit::Move { from, to },
                Change::Remove(entry) => Edit::Remove(entry),
                Change::Append(count) => Edit::Append(files(0, count)),
                Change::Shuffle(_) => continue,
            };
            list.edit(&edit, 0, &mut |_| {});
            let order: Vec<u64> =
                std::iter::successors(list.order.first(), |id| list.order.beside(*id, true, false)).collect();
            prop_assert_eq!(order, list.ids().collect::<Vec<_>>());
        }
    }
}

#[test]
fn appending_stops_at_the_limit() {
    let limit = limits::PLAYLIST_TRACKS_MAX;
    let mut list = Playlist::new(gather(&files(0, limit - 1)).entries);
    let mut reported = Vec::new();
    let edited = list.edit(&Edit::Append(files(0, 3)), 0, &mut |trouble| reported.push(trouble));
    assert!(edited.appended && !edited.resume);
    assert_eq!((list.slots.len(), reported.len()), (limit, 1));
    assert!(reported[0].contains("more than 20000 tracks"), "{reported:?}");
    let edited = list.edit(&Edit::Append(files(0, 3)), 0, &mut |_| {});
    assert_eq!(edited, Edited::default());
}

#[test]
fn silence_replaces_the_last_entry_until_another_is_appended() {
    let mut list = Playlist::new(gather(&files(0, 1)).entries);
    let edited = list.edit(&Edit::Remove(0), 0, &mut |_| {});
    assert_eq!(edited, Edited { removed: vec![0], ..Edited::default() });
    let Found::Track(silence) = list.find(&Wanted::InPlaceOf(0), &mut |_| {}) else {
        panic!("expected silence")
    };
    assert_eq!((silence.info.id, silence.info.count, silence.info.name.as_str()), (0, 0, "nothing to play"));
    for wanted in [Wanted::Skip { from: 0, steps: 1 }, Wanted::Entry(0)] {
        assert!(matches!(list.find(&wanted, &mut |_| {}), Found::Nothing));
    }
    assert!(list.edit(&Edit::Append(files(1, 2)), 0, &mut |_| {}).resume);
    assert_eq!(list.order.beside(0, true, false), Some(1));
}
