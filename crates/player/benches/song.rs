//! Measures the analysis of a whole song: four minutes of mp3 with sections, decoded and analysed on one core.

use std::process::Command;

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_music::{SongListener, SongStructure};
use mariana_player::decode::Decoder;
use mariana_player::source::FrameSource;

/// Two alternating chords, and drums that change their level every half minute.
const MUSIC: &str = "aevalsrc=\
    (0.3+0.5*gt(mod(t\\,60)\\,30))*(0.5*(random(0)-0.5)*exp(-20*mod(t\\,0.5))+0.4*sin(345*mod(t\\,0.5))*exp(-9*mod(t\\,0.5)))+\
    0.12*sin((1382+345*gt(mod(t\\,8)\\,4))*t)+0.1*sin((1742+435*gt(mod(t\\,8)\\,4))*t):s=44100:d=240";

fn known(path: &std::path::Path) -> SongStructure {
    let mut decoder = Decoder::open(path).unwrap_or_else(|error| panic!("{error}"));
    let mut listener = SongListener::new(decoder.sample_rate());
    let mut block = Vec::new();
    loop {
        block.clear();
        match decoder.next_block(&mut block) {
            Ok(0) => return listener.finish(),
            Ok(_) => listener.push(&block),
            Err(error) => panic!("{error}"),
        }
    }
}

fn reading_ahead(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap_or_else(|error| panic!("{error}"));
    let path = folder.path().join("song.mp3");
    let mut encode = Command::new("ffmpeg");
    encode.args(["-v", "error", "-nostdin", "-y", "-f", "lavfi", "-i", MUSIC]);
    let run = encode.args(["-ac", "2", "-c:a", "libmp3lame", "-b:a", "192k"]).arg(&path).status();
    assert!(run.is_ok_and(|status| status.success()), "install ffmpeg with libmp3lame");
    let structure = known(&path);
    assert!(structure.beats.len() > 300 && structure.sections.len() > 3, "no structure was found");
    let mut group = criterion.benchmark_group("song");
    group.sample_size(10);
    group.bench_function("4 minutes of mp3 are known", |bencher| bencher.iter(|| known(&path)));
    group.finish();
}

criterion_group!(benches, reading_ahead);
criterion_main!(benches);
