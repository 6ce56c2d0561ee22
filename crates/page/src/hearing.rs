//! What is heard: samples of a song or of live input become the sound of a moment.

use mariana_music::{
    Alignment, Analyzer, FeatureTrack, Features, LiveEnergy, Recent, SongListener, SongMoment, SongStructure,
    Sound, StereoFrame,
};

/// The span of the sound that is kept, in seconds: frames of feedback ask for earlier moments.
const KEPT_SECONDS: f64 = 20.0;

#[derive(Default)]
pub(crate) struct Hearing {
    stream: Option<Stream>,
}

struct Stream {
    analyzer: Analyzer,
    track: FeatureTrack,
    /// The energy of live input; `None` for a song.
    live: Option<LiveEnergy>,
    /// Hears the whole song; `None` for live input, and once the song is known.
    listener: Option<SongListener>,
    song: Option<SongStructure>,
}

impl Hearing {
    pub(crate) fn new(rate: u32, live: bool) -> Self {
        let alignment = if live { Alignment::Trailing } else { Alignment::Centred };
        Self {
            stream: Some(Stream {
                analyzer: Analyzer::new(rate, alignment),
                track: FeatureTrack::new(KEPT_SECONDS),
                live: live.then(LiveEnergy::default),
                listener: (!live).then(|| SongListener::new(rate)),
                song: None,
            }),
        }
    }

    pub(crate) fn seek(&mut self, sample: u64) {
        if let Some(stream) = &mut self.stream {
            stream.analyzer.restart(sample);
            stream.track.clear();
        }
    }

    pub(crate) fn push(&mut self, left: &[f32], right: &[f32]) {
        if let Some(Stream { analyzer, track, .. }) = &mut self.stream {
            analyzer.push(&frames_of(left, right), &mut |moment| track.push(moment));
        }
    }

    pub(crate) fn push_whole(&mut self, left: &[f32], right: &[f32]) {
        if let Some(listener) = self.stream.as_mut().and_then(|stream| stream.listener.as_mut()) {
            listener.push(&frames_of(left, right));
        }
    }

    pub(crate) fn finish_whole(&mut self) {
        if let Some(stream) = &mut self.stream {
            stream.song = stream.listener.take().map(SongListener::finish);
        }
    }

    /// The sound at `time` seconds; silence before a sound has begun.
    pub(crate) fn at(&mut self, time: f64) -> Sound {
        let Some(stream) = &mut self.stream else { return Sound::default() };
        let sound = stream.track.sound_at(time);
        if let Some(energy) = &mut stream.live {
            let energy = energy.at(time, sound.features.level_db);
            let song = SongMoment::of_live(energy, &sound.features);
            return Sound { recent: stream.track.recent(time).into(), song, ..sound };
        }
        let Some(song) = &stream.song else { return sound };
        let guided = |time: f64, mut features: Features| {
            features.follow_song(song, time);
            features
        };
        let recent = stream.track.recent(time).into_iter().filter(|one| one.age <= time).map(|one| Recent {
            song: song.moment(time - one.age),
            features: guided(time - one.age, one.features),
            ..one
        });
        Sound {
            features: guided(time, sound.features),
            song: song.moment(time),
            recent: recent.collect(),
            ..sound
        }
    }
}

fn frames_of(left: &[f32], right: &[f32]) -> Vec<StereoFrame> {
    left.iter().zip(right).map(|(left, right)| [*left, *right]).collect()
}
