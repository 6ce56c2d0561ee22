//! The analysis: turns samples of a song or of live input into the sound of a moment.

use mariana_music::{
    Alignment, Analyzer, FeatureTrack, Features, LiveEnergy, Recent, SongListener, SongMoment, SongStructure,
    Sound, StereoFrame,
};

/// The span of the sound that is kept, in seconds: frames of feedback ask for earlier moments.
const KEPT_SECONDS: f64 = 20.0;

pub(crate) struct Hearing {
    analyzer: Analyzer,
    track: FeatureTrack,
    /// `None` for a song.
    live: Option<Live>,
    /// Hears the whole song; `None` for live input, and once the song is known.
    listener: Option<SongListener>,
    song: Option<SongStructure>,
}

impl Hearing {
    pub(crate) fn new(rate: u32, live: bool) -> Self {
        let alignment = if live { Alignment::Trailing } else { Alignment::Centred };
        Self {
            analyzer: Analyzer::new(rate, alignment),
            track: FeatureTrack::new(KEPT_SECONDS),
            live: live.then(Live::default),
            listener: (!live).then(|| SongListener::new(rate)),
            song: None,
        }
    }

    pub(crate) fn seek(&mut self, sample: u64) {
        self.analyzer.restart(sample);
        self.track.clear();
    }

    pub(crate) fn push(&mut self, left: &[f32], right: &[f32]) {
        self.analyzer.push(&frames_of(left, right), &mut |moment| self.track.push(moment));
    }

    pub(crate) fn push_song(&mut self, left: &[f32], right: &[f32]) {
        if let Some(listener) = &mut self.listener {
            listener.push(&frames_of(left, right));
        }
    }

    pub(crate) fn finish_song(&mut self) {
        if let Some(listener) = self.listener.take() {
            self.song = Some(listener.finish());
        }
    }

    /// Uses the structure of the whole song, which was heard before.
    pub(crate) fn know_song(&mut self, song: SongStructure) {
        (self.listener, self.song) = (None, Some(song));
    }

    /// The structure of the whole song, once it is known.
    pub(crate) fn song(&self) -> Option<&SongStructure> {
        self.song.as_ref()
    }

    /// Begins the next frame, at `time` seconds: live input has an energy of the frame.
    pub(crate) fn begin_frame(&mut self, time: f64) {
        if let Some(live) = &mut self.live {
            live.last = live.energy.at(time, self.track.at(time).level_db);
        }
    }

    /// The sound at `time` seconds, of the begun frame or earlier; silence before a sound has begun.
    pub(crate) fn at(&self, time: f64) -> Sound {
        let Self { track, live, song, .. } = self;
        let sound = track.sound_at(time);
        let guided = |time: f64, mut features: Features| {
            if let Some(song) = song {
                features.follow_song(song, time);
            }
            features
        };
        let place = |time: f64| match (song, live) {
            (Some(song), _) => song.moment(time),
            (None, Some(live)) => SongMoment::of_live(live.last, &sound.features),
            (None, None) => SongMoment::UNKNOWN,
        };
        let recent = track.recent(time).into_iter().filter(|one| one.age <= time).map(|one| Recent {
            song: place(time - one.age),
            features: guided(time - one.age, one.features),
            ..one
        });
        Sound { features: guided(time, sound.features), song: place(time), recent: recent.collect(), ..sound }
    }
}

/// The energy of live input.
#[derive(Default)]
struct Live {
    energy: LiveEnergy,
    /// The energy in the last frame.
    last: f32,
}

fn frames_of(left: &[f32], right: &[f32]) -> Vec<StereoFrame> {
    left.iter().zip(right).map(|(left, right)| [*left, *right]).collect()
}
