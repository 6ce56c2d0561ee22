//! Records a performance as a show, with all changes to the song's frames, made by the user, a controller or a show.
//!
//! Each track has its own file. A change is written within a second, so that a crash loses at most one second.

use std::time::{Duration, Instant};

use crate::config::PerformanceFiles;
use crate::scenes::SceneSource;
use crate::session::direction::OfTrack;
use crate::session::scene::{Performed, named};
use crate::show::{Finish, OnStage, Performance, TimedTransition, TransitionKind, print};
use mariana_field::lang::TransitionStyle;
use mariana_player::Moment;

/// Interval at which a changing performance is written.
const KEPT_EVERY: Duration = Duration::from_secs(1);

struct Take {
    number: u64,
    track: OfTrack,
    /// The segment and the lap of the last frame.
    heard: (u64, u32),
    title: String,
    performance: Performance,
    kept: Instant,
    has_changed: bool,
    shown: Option<Showing>,
    reported_full: bool,
    is_held: bool,
}

struct Showing {
    source: SceneSource,
    /// The scene's name in shows.
    scene: String,
    /// Name of its camera, if not the default one.
    camera: Option<String>,
    transition: TimedTransition,
    /// Start in seconds of the song.
    start: f64,
}

pub(crate) struct Recording {
    files: PerformanceFiles,
    take: Option<Take>,
    pub(crate) is_on: bool,
    /// True if the track had ended at the last call of `follow`, or before recording started.
    has_ended: bool,
    count: u64,
    /// True if the next saved file is to be reported.
    tells: bool,
}

impl Recording {
    pub(crate) fn new(files: PerformanceFiles) -> Self {
        Self { files, take: None, is_on: false, has_ended: false, count: 0, tells: false }
    }

    /// Starts or stops recording. Stopping saves the performance. Returns `true` if it starts.
    pub(crate) fn toggle(&mut self, now: Instant) -> bool {
        self.is_on = !self.is_on;
        self.has_ended = true;
        if !self.is_on {
            self.finish(now);
        }
        self.is_on
    }

    pub(crate) fn finish(&mut self, now: Instant) {
        let Some(mut take) = self.take.take() else { return };
        self.tells = true;
        keep(&self.files, &mut take, now);
    }

    /// Stops recording at the end of the track, so that another lap of the track does not replace its recording.
    pub(crate) fn follow(&mut self, track: OfTrack, at: &Moment, has_ended: bool, now: Instant) {
        let ends = !std::mem::replace(&mut self.has_ended, has_ended) && has_ended;
        let Some(take) = self.take.as_mut().filter(|take| take.track == track) else { return };
        let heard = (at.segment, at.lap);
        let (segment, lap) = std::mem::replace(&mut take.heard, heard);
        if ends || (segment == at.segment && lap != at.lap) {
            self.toggle(now);
        }
    }

    /// Records a frame of a track at this moment. Returns a message when the performance is too long.
    pub(crate) fn record(
        &mut self,
        track: OfTrack,
        title: &str,
        at: &Moment,
        seen: Performed<'_>,
        now: Instant,
    ) -> Option<&'static str> {
        self.follow(track, at, self.has_ended, now);
        if !self.is_on || track.is_none() {
            return None;
        }
        if self.take.as_ref().is_some_and(|take| take.track != track) {
            self.finish(now);
        }
        let count = &mut self.count;
        let take = self.take.get_or_insert_with(|| {
            *count += 1;
            let (title, performance) = (title.to_owned(), Performance::default());
            Take {
                number: *count,
                track,
                heard: (at.segment, at.lap),
                title,
                performance,
                kept: now,
                has_changed: true,
                shown: None,
                reported_full: false,
                is_held: false,
            }
        });
        take.record(at.song_time, seen);
        take.has_changed = true;
        let is_news = take.performance.is_full && !std::mem::replace(&mut take.reported_full, true);
        is_news.then_some("the recording has reached the maximum length of a show: the rest is not recorded")
    }

    /// Records that the last frame of a track is still shown at this moment, with the state of the master output.
    pub(crate) fn record_picture(
        &mut self,
        track: OfTrack,
        at: &Moment,
        picture: &Finish,
        is_held: bool,
        now: Instant,
    ) {
        self.follow(track, at, self.has_ended, now);
        let Some(take) = self.take.as_mut().filter(|take| take.track == track) else { return };
        if is_held && !take.is_held {
            take.performance.hold(picture);
        }
        take.is_held = is_held;
        take.has_changed = true;
        take.performance.record_picture(at.song_time, picture);
    }

    /// Writes a changed performance, at most once per [`KEPT_EVERY`] and only after the last write has finished.
    pub(crate) fn update(&mut self, now: Instant) {
        let is_due =
            |take: &&mut Take| take.has_changed && now.saturating_duration_since(take.kept) >= KEPT_EVERY;
        if let Some(take) = self.take.as_mut().filter(is_due)
            && self.files.is_idle()
        {
            keep(&self.files, take, now);
        }
    }

    pub(crate) fn news(&mut self) -> Option<String> {
        let kept = self.files.poll()?;
        match kept {
            Ok(path) if self.tells => {
                self.tells = false;
                Some(format!("recorded: {}; render it with `mariana video SONG --show FILE`", path.display()))
            }
            Ok(_) => None,
            Err(error) => Some(format!("{error}: the recording is not saved; {}", error.remedy())),
        }
    }
}

impl Take {
    fn record(&mut self, time: f64, seen: Performed<'_>) {
        self.is_held = false;
        let changes = match seen.faded {
            Some((seconds, start)) => (TimedTransition::new(TransitionStyle::Fade, seconds), start),
            None => (TimedTransition::CUT, time),
        };
        let (transition, start) = match (&self.shown, seen.directed) {
            (None, Some(directed)) => directed,
            (Some(_), Some(directed)) if directed.0.by_fader => directed,
            (Some(shown), Some(directed)) if directed.1 >= shown.start => directed,
            (None, None) => (TimedTransition::CUT, time),
            // Continue the entry of a scene that stays when the show stops directing it, or joins it later.
            (Some(shown), _) if shown.goes_on_in(&seen, time) => (shown.transition, shown.start),
            (Some(shown), _) if shown.source == *seen.source => (TimedTransition::CUT, time),
            (Some(_), _) => changes,
        };
        let scene = match self.shown.take().filter(|shown| shown.source == *seen.source) {
            Some(shown) => shown.scene,
            None => named(seen.source),
        };
        let Performed { source, camera, params, moves, turns, picture, other, .. } = seen;
        let is_on_decks = other.is_some();
        let on_stage =
            OnStage { scene: &scene, camera, transition, start, params, moves, turns, picture, other };
        self.performance.record(time, &on_stage);
        if is_on_decks {
            // When the decks end, the scene that stays has a new entry.
            self.shown = None;
            return;
        }
        let camera = camera.map(str::to_owned);
        self.shown = Some(Showing { source: source.clone(), scene, camera, transition, start });
    }
}

impl Showing {
    fn goes_on_in(&self, seen: &Performed<'_>, time: f64) -> bool {
        let is_same = self.source == *seen.source && self.camera.as_deref() == seen.camera;
        // Freezing ends a manual fade, because only one scene is drawn behind the frozen frame.
        let fades =
            self.transition.kind == TransitionKind::Fade && time < self.start + self.transition.seconds;
        is_same && self.start <= time && (seen.directed.is_some() || seen.fades || !fades)
    }
}

fn keep(files: &PerformanceFiles, take: &mut Take, now: Instant) {
    (take.kept, take.has_changed) = (now, false);
    if take.performance.is_empty() {
        return;
    }
    let comments = [
        format!("Recorded while {} played.", take.title),
        "Render it with `mariana video SONG --show FILE`.".to_owned(),
    ];
    // A long performance is a long text, so it is printed on the file thread.
    let performance = take.performance.clone();
    if !files.keep(take.number, &take.title, move || print(&performance.cue_list(), &comments)) {
        tracing::warn!("cannot save the recording: there is no folder for recordings");
    }
}

#[cfg(test)]
mod tests {
    use mariana_testing::process::wait_until;

    use super::*;
    use crate::frame::orbit_controls::OrbitControls;

    fn at(song_time: f64) -> Moment {
        Moment { song_time, ..Moment::default() }
    }

    fn seen(source: &SceneSource, directed: Option<(TimedTransition, f64)>) -> Performed<'_> {
        Performed {
            source,
            camera: None,
            directed,
            faded: None,
            fades: false,
            params: Vec::new(),
            moves: &[],
            turns: OrbitControls::OFF.turns(),
            picture: Finish::NOTHING,
            other: None,
        }
    }

    #[test]
    fn each_track_has_its_file_with_scenes_and_transitions() {
        let folder = tempfile::tempdir().unwrap();
        let mut recording = Recording::new(PerformanceFiles::in_folder(Some(folder.path().to_owned())));
        let now = Instant::now();
        let [orb, city, heart] = ["orb", "city", "heart"].map(|name| SceneSource::Shipped(name.to_owned()));
        recording.record(Some(0), "one", &at(1.0), seen(&orb, None), now);
        assert!(recording.take.is_none(), "recording has not been started");
        assert!(recording.toggle(now));
        for (time, scene, faded) in
            [(2.0, &orb, None), (3.0, &orb, None), (4.0, &city, Some((0.5, 3.75))), (5.0, &city, None)]
        {
            recording.record(
                Some(0),
                "one",
                &at(time),
                Performed { faded, fades: faded.is_some(), ..seen(scene, None) },
                now,
            );
        }
        let held = Finish { numbers: [0.5, 1.0], is_shown: false };
        recording.record_picture(Some(0), &at(6.0), &held, true, now);
        recording.record_picture(Some(2), &at(7.0), &Finish::NOTHING, false, now);
        let melt = (TimedTransition::new(TransitionStyle::Melt, 2.0), 0.5);
        recording.record(Some(1), "two", &at(1.5), seen(&heart, Some(melt)), now);
        recording.record(None, "an input", &at(9.0), seen(&city, None), now);
        assert!(!recording.toggle(now));
        drop(recording);
        let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(
            text("one.show").ends_with(
                "at 0:02     orb  cut\nat 0:03.75  city  fade over 0.5 s\n\
                 \x20 set picture brightness = 1 -> 1 over 1.25 s -> 1 over 1 s -> 0.5 over 0 s\n\
                 \x20 set picture freeze = 0 -> 0 over 1.25 s -> 1 over 0 s\n"
            ),
            "{}",
            text("one.show")
        );
        assert!(text("two.show").ends_with("\nat 0:00.5  heart  melt over 2 s\n"), "{}", text("two.show"));
    }

    #[test]
    fn the_end_of_the_track_stops_the_recording_before_the_next_lap_replaces_it() {
        let now = Instant::now();
        let [orb, city] = ["orb", "city"].map(|name| SceneSource::Shipped(name.to_owned()));
        let begun = || {
            let folder = tempfile::tempdir().unwrap();
            let mut recording = Recording::new(PerformanceFiles::in_folder(Some(folder.path().to_owned())));
            recording.toggle(now);
            recording.record(Some(0), "one", &at(2.0), seen(&orb, None), now);
            recording.record(Some(0), "one", &at(8.0), seen(&city, None), now);
            (recording, folder)
        };
        let next = Moment { lap: 1, ..at(0.01) };
        type Act = fn(&mut Recording, &Moment, &SceneSource, Instant);
        let acts: [Act; 4] = [
            |recording, next, of, now| {
                recording.record(Some(0), "one", next, seen(of, None), now);
            },
            |recording, next, _, now| recording.record_picture(Some(0), next, &Finish::NOTHING, false, now),
            |recording, next, _, now| recording.follow(Some(0), next, false, now),
            |recording, _, _, now| {
                recording.follow(Some(0), &at(8.0), false, now);
                recording.follow(Some(0), &at(9.0), true, now);
            },
        ];
        for act in acts {
            let (mut recording, folder) = begun();
            act(&mut recording, &next, &orb, now);
            assert!(!recording.is_on);
            drop(recording);
            let text = std::fs::read_to_string(folder.path().join("one.show")).unwrap();
            assert!(text.ends_with("\nat 0:02  orb  cut\nat 0:08  city  cut\n"), "{text}");
        }
        // A seek back, or a start after the end, does not stop the recording.
        let (mut recording, _folder) = begun();
        recording.record(Some(0), "one", &Moment { segment: 1, ..next }, seen(&orb, None), now);
        recording.follow(Some(0), &Moment { segment: 1, ..next }, true, now);
        assert!(recording.is_on);
    }

    #[test]
    fn a_recording_is_written_while_it_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let mut recording = Recording::new(PerformanceFiles::in_folder(Some(folder.path().to_owned())));
        let start = Instant::now();
        let orb = SceneSource::Shipped("orb".to_owned());
        recording.toggle(start);
        recording.record(Some(0), "one", &at(2.0), seen(&orb, None), start);
        recording.update(start);
        assert!(recording.files.is_idle(), "not every frame is written");
        // The frame does not change, so the file is not written.
        recording.update(start + KEPT_EVERY);
        assert!(!recording.files.is_idle());
        let mut path = None;
        wait_until("the file", || {
            path = recording.files.poll();
            path.is_some()
        });
        let path = path.unwrap().unwrap();
        assert!(std::fs::read_to_string(path).unwrap().ends_with("\nat 0:02  orb  cut\n"));
        recording.update(start + 9 * KEPT_EVERY);
        assert!(recording.files.is_idle(), "it has not changed");
    }

    #[test]
    fn the_end_of_a_fade_and_another_camera_begin_new_entries() {
        let now = Instant::now();
        let orb = SceneSource::Shipped("orb".to_owned());
        let city = SceneSource::Shipped("city".to_owned());
        type Seen<'a> = (f64, &'a SceneSource, Option<(f64, f64)>, bool, Option<&'static str>);
        let reported = |pictures: &[Seen<'_>]| {
            let mut recording = Recording::new(PerformanceFiles::in_folder(None));
            recording.toggle(now);
            for (time, scene, faded, fades, camera) in pictures.iter().copied() {
                let seen = Performed { faded, fades, camera, ..seen(scene, None) };
                recording.record(Some(0), "one", &at(time), seen, now);
            }
            let cue_list = recording.take.map(|take| take.performance.cue_list()).unwrap_or_default();
            print(&cue_list, &[]).lines().map(str::to_owned).collect::<Vec<_>>()
        };
        let fade = Some((4.0, 2.0));
        let begins = [(1.0, &orb, None, false, None), (2.0, &city, fade, true, None)];
        let with = |more: &[_]| reported(&[&begins[..], more].concat());
        let usual = ["at 0:01  orb  cut", "at 0:02  city  fade over 4 s"];
        assert_eq!(with(&[(3.0, &city, fade, true, None), (7.0, &city, None, false, None)]), usual);
        // A show's fade continues even if the scene is no longer directed.
        assert_eq!(with(&[(3.0, &city, None, true, None)]), usual);
        let held = with(&[(3.0, &city, None, false, None), (4.0, &city, None, false, None)]);
        assert_eq!(held, [usual[0], "at 0:02  city  fade over 4 s unfinished", "at 0:03  city  cut"]);
        let aside = with(&[(7.0, &city, None, false, Some("low")), (8.0, &city, None, false, Some("low"))]);
        assert_eq!(aside, [usual[0], usual[1], "at 0:07  city  camera low  cut"]);
    }
}
