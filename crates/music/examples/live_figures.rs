//! Measures what is heard in live input: `cargo run --release -p mariana-music --example live_figures` prints figures
//! for generated songs with known keys, builds and drops. With songs as arguments, which are files that `ffmpeg` can
//! read, it compares each song with the reading of the whole song.
//!
//! A drop is found if it is reported from 0.3 s before to 1.5 s after its time. A key is right if root and mode are
//! right; the first 30 s do not count. The chroma is compared by the cosine of the angle between both.

#[allow(dead_code)]
#[path = "../tests/music/events.rs"]
mod events;
#[allow(dead_code)]
#[path = "../tests/music/forms.rs"]
mod forms;
#[allow(dead_code)]
#[path = "../tests/music/songs.rs"]
mod songs;

use std::error::Error;
use std::path::Path;
use std::process::Command;

use forms::{Form, club_song};
use mariana_music::{Alignment, Analyzer, LiveSong, Mode, StereoFrame, Tonality};
use songs::{Kind, Song, Style, Swell, breaks, club, pop, structure};

const RATE: u32 = 48_000;
/// The time before which keys do not count, in seconds.
const SETTLED: f64 = 30.0;

/// What is heard at each moment, with its time in seconds.
type Heard = Vec<(f64, LiveSong)>;

fn listen(rate: u32, frames: &[StereoFrame]) -> Heard {
    let mut heard = Vec::new();
    Analyzer::new(rate, Alignment::Trailing)
        .push(frames, &mut |moment| heard.push((moment.time, moment.features.live)));
    heard
}

fn drops(heard: &Heard) -> Vec<f64> {
    heard.windows(2).filter(|pair| pair[1].1.drop > pair[0].1.drop).map(|pair| pair[1].0).collect()
}

/// Returns the fractions of the time after [`SETTLED`] in which a key is known and in which it is `key`, and the number
/// of changes.
fn key_figures(heard: &Heard, key: Option<Tonality>) -> [f64; 3] {
    let late: Vec<_> = heard.iter().filter(|(time, _)| *time >= SETTLED).map(|(_, song)| song.key).collect();
    let part = |count: usize| count as f64 / late.len().max(1) as f64;
    let known = late.iter().filter(|heard| heard.is_some()).count();
    let right = late.iter().filter(|heard| heard.is_some() && **heard == key).count();
    [part(known), part(right), late.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64]
}

/// Found and true drops, false drops, songs, the sum of the delays of found drops in seconds.
#[derive(Default)]
struct DropFigures {
    found: usize,
    all: usize,
    wrong: usize,
    songs: usize,
    late: f64,
}

impl DropFigures {
    fn add(&mut self, heard: &[f64], truth: &[f64]) {
        let near = |heard: f64, truth: f64| (-0.3..1.5).contains(&(heard - truth));
        for truth in truth {
            if let Some(heard) = heard.iter().find(|heard| near(**heard, *truth)) {
                (self.found, self.late) = (self.found + 1, self.late + heard - truth);
            }
        }
        self.all += truth.len();
        self.songs += 1;
        self.wrong += heard.iter().filter(|heard| !truth.iter().any(|truth| near(**heard, *truth))).count();
    }

    fn print(&self, name: &str) {
        println!(
            "== drops in {} {name}: {} of {}, {:.2} s late on average, {} false",
            self.songs,
            self.found,
            self.all,
            self.late / self.found.max(1) as f64,
            self.wrong
        );
    }
}

/// Sums of the value of builds: in the last seconds of builds, and the time outside of builds with more than 0.3.
#[derive(Default)]
struct BuildFigures {
    ends: Vec<f64>,
    outside: f64,
    seconds: f64,
}

impl BuildFigures {
    fn add(&mut self, heard: &Heard, truth: &[(f64, f64)]) {
        let mean = |from: f64, to: f64| {
            let values: Vec<f64> = heard
                .iter()
                .filter(|(t, _)| (from..to).contains(t))
                .map(|(_, s)| f64::from(s.build))
                .collect();
            values.iter().sum::<f64>() / values.len().max(1) as f64
        };
        self.ends.extend(truth.iter().map(|(_, end)| mean(end - 2.5, end - 0.6)));
        for pair in heard.windows(2) {
            let (time, song) = pair[0];
            if !truth.iter().any(|(start, end)| (start - 1.0..end + 1.5).contains(&time)) {
                self.seconds += pair[1].0 - time;
                self.outside += if song.build > 0.3 { pair[1].0 - time } else { 0.0 };
            }
        }
    }

    fn print(&self, name: &str) {
        println!(
            "== builds in {name}: {} builds end at {:.2} on average; outside, {:.2} % of the time is above 0.3",
            self.ends.len(),
            self.ends.iter().sum::<f64>() / self.ends.len().max(1) as f64,
            100.0 * self.outside / self.seconds.max(1.0)
        );
    }
}

fn measure(name: &str, songs: impl IntoIterator<Item = Song>) {
    let (mut of_drops, mut of_builds, mut keys) =
        (DropFigures::default(), BuildFigures::default(), Vec::new());
    for song in songs {
        let (frames, truth) = song.play(RATE);
        let heard = listen(RATE, &frames);
        of_drops.add(&drops(&heard), &truth.drops_and_returns());
        let is_build = |part: &(f64, f64, char)| {
            part.2 == 'U' && song.form.iter().any(|p| p.letter == 'U' && p.kind == Kind::Build)
        };
        let builds: Vec<(f64, f64)> =
            truth.letters.iter().filter(|part| is_build(part)).map(|part| (part.0, part.1)).collect();
        of_builds.add(&heard, &builds);
        keys.push(key_figures(&heard, Some(song.key)));
    }
    of_drops.print(name);
    of_builds.print(name);
    let mean = |column: usize| keys.iter().map(|row| row[column]).sum::<f64>() / keys.len().max(1) as f64;
    println!("== keys in {name}: known {:.2}, right {:.2}, {:.1} changes", mean(0), mean(1), mean(2));
}

/// Generated songs. The constants were chosen with the tuned songs.
fn generated() {
    let styles = [Style::FourOnTheFloor, Style::Syncopated, Style::Rock, Style::HalfTime];
    let slow = [Style::Ballad, Style::SixEight, Style::Rock];
    let both = || [Mode::Major, Mode::Minor].into_iter().enumerate();
    for (set, seed, fast_tempos, slow_tempos) in [
        ("tuned", 301, [100.0, 110.0, 124.0, 128.0, 140.0, 150.0], [62.0, 70.0, 78.0, 92.0]),
        ("others", 601, [104.0, 115.0, 121.0, 133.0, 145.0, 156.0], [59.0, 66.0, 74.0, 86.0]),
    ] {
        let club_songs = (0..24).map(|n| club_song(styles[n / 2 % 4], seed + n as u32));
        measure(&format!("clubs, {set}"), club_songs);
        for (name, form) in [("club", club as fn(Mode) -> _), ("breaks", breaks)] {
            let of_mode = |(index, mode): (usize, Mode)| {
                fast_tempos.into_iter().enumerate().map(move |(n, tempo)| {
                    let key = Tonality { root: (n * 2 + index) as u8, mode };
                    Song::new(styles[(n / 2 + index) % 4], tempo, key, form(mode))
                })
            };
            measure(&format!("the form {name}, {set}"), both().flat_map(of_mode));
        }
        let of_swell = |(number, swell): (usize, Swell)| {
            (0..12).map(move |n| {
                let (mode, root) = ([Mode::Major, Mode::Minor][n % 2], ((n + number) * 5 % 12) as u8);
                let (style, tempo) = (slow[n % 3], slow_tempos[n / 3]);
                Song::new(style, tempo, Tonality { root, mode }, swell.ballad(mode))
            })
        };
        measure(&format!("ballads, {set}"), Swell::ALL.into_iter().enumerate().flat_map(of_swell));
        let songs = (0..28_usize).map(|n| Form::ALL[n % 7].song(Style::ALL[n % 8], seed + 100 + n as u32));
        measure(&format!("songs without drops, {set}"), songs);
    }
    let keys = [Mode::Major, Mode::Minor].into_iter().flat_map(|mode| (0..12).map(move |root| (mode, root)));
    measure(
        "24 keys",
        keys.map(|(mode, root)| {
            let song = Song::new(Style::Rock, 112.0, Tonality { root, mode }, pop(mode));
            Song { cents: f64::from(root) * 6.0 - 30.0, ..song }
        }),
    );
}

fn decoded(song: &Path) -> Result<Vec<StereoFrame>, Box<dyn Error>> {
    let output = Command::new("ffmpeg")
        .args(["-nostdin", "-v", "error", "-protocol_whitelist", "file"])
        .args(["-format_whitelist", "aac,aiff,caf,flac,matroska,mov,mp3,ogg,wav", "-i"])
        .arg(song)
        .args(["-f", "f32le", "-ac", "2", "-ar", "48000", "-"])
        .output()?;
    let sample = |four: &[u8; 4]| f32::from_le_bytes(*four);
    let samples: Vec<f32> = output.stdout.as_chunks::<4>().0.iter().map(sample).collect();
    Ok(samples.as_chunks::<2>().0.to_vec())
}

fn compare(songs: &[String]) -> Result<(), Box<dyn Error>> {
    let (mut of_drops, mut of_builds) = (DropFigures::default(), BuildFigures::default());
    let (mut keys, mut cosines) = (Vec::new(), Vec::new());
    for song in songs {
        let frames = decoded(Path::new(song))?;
        let (heard, whole) = (listen(RATE, &frames), structure(RATE, &frames));
        let found = drops(&heard);
        let builds: Vec<(f64, f64)> = whole.builds.iter().map(|build| (build.start, build.end)).collect();
        of_drops.add(&found, &whole.drops);
        of_builds.add(&heard, &builds);
        let figures = key_figures(&heard, whole.key);
        let cosine = chroma_cosine(&heard, |time| whole.moment(time).chroma);
        println!(
            "{:40} key known {:.2} as read {:.2} changes {:2} chroma {cosine:.2} drops {found:.1?} read {:.1?}",
            Path::new(song).file_stem().unwrap_or_default().display(),
            figures[0],
            figures[1],
            figures[2],
            whole.drops
        );
        cosines.push(cosine);
        if whole.key.is_some() && whole.seconds > SETTLED {
            keys.push(figures);
        }
    }
    of_drops.print("songs, compared with the reading");
    of_builds.print("songs, compared with the reading");
    let mean = |column: usize| keys.iter().map(|row| row[column]).sum::<f64>() / keys.len().max(1) as f64;
    println!(
        "== keys of {} songs: known {:.2}, as read {:.2}; chroma {:.2}",
        keys.len(),
        mean(0),
        mean(1),
        cosines.iter().sum::<f64>() / cosines.len().max(1) as f64
    );
    Ok(())
}

/// Returns the mean cosine of the angle between the chroma, where both are known.
fn chroma_cosine(heard: &Heard, read: impl Fn(f64) -> [f32; 12]) -> f64 {
    let product = |a: &[f32; 12], b: &[f32; 12]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>();
    let cosine = |(time, song): &(f64, LiveSong)| {
        // The windows of live input end at their moment, and the chroma is averaged over 0.3 s.
        let read = read(time - 0.3);
        let length = (product(&read, &read) * product(&song.chroma, &song.chroma)).sqrt();
        (length > 1e-3).then(|| product(&read, &song.chroma) / length)
    };
    let cosines: Vec<f64> = heard.iter().step_by(20).filter_map(cosine).collect();
    cosines.iter().sum::<f64>() / cosines.len().max(1) as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let songs: Vec<String> = std::env::args().skip(1).collect();
    if songs.is_empty() {
        generated();
        return Ok(());
    }
    compare(&songs)
}
