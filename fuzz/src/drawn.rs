//! Files that become shapes and words: drawings, fonts and lyrics.

use mariana::scenes::{SceneError, SceneSource};
use mariana_music::SongMoment;
use mariana_player::limits;
use mariana_player::lyrics::Lyrics;

use super::files::{contain_panics, file};

/// Bakes a drawing as a scene does.
pub(crate) fn drawings(data: &[u8]) {
    file("drawings", "a.svg", data);
    bake("drawings", "image(\"a.svg\", p.xy)");
}

/// Bakes letters of a font.
pub(crate) fn fonts(data: &[u8]) {
    contain_panics();
    file("fonts", "a.ttf", data);
    bake("fonts", "text(\"ab\", p.xy, \"a.ttf\")");
}

fn bake(folder: &str, shape: &str) {
    let text = format!("object a {{ shape = extrude({shape}, p.z, 1) }}\n");
    match SceneSource::File(file(folder, "main.scene", text.as_bytes())).ready() {
        Ok(ready) => {
            for shape in ready.world.scene.atlas.shapes() {
                assert!(shape.grid.values().iter().all(|value| value.is_finite()));
                assert!(shape.grid.steepest() <= 1.0 + 1e-4, "{}", shape.grid.steepest());
            }
        }
        Err(SceneError::Mistakes { found, .. }) => assert!(!found.diagnostics.is_empty()),
        Err(error) => panic!("{error}"),
    }
}

/// Reads lyrics, and marks words at some moments.
pub(crate) fn lyrics(data: &[u8]) {
    let lyrics = Lyrics::parse(&String::from_utf8_lossy(data));
    assert!(lyrics.line(limits::LYRICS_LINES_MAX).is_none());
    for number in 0..200 {
        let Some(line) = lyrics.line(number) else { break };
        assert!(line.words.len() <= limits::LYRICS_LINE_BYTES_MAX, "{line:?}");
        for time in [line.start, 0.5 * (line.start + line.end), -1e9] {
            let Some((_, line)) = lyrics.at(time) else { continue };
            let mut moment = SongMoment::UNKNOWN;
            lyrics.mark(time, &mut moment);
            assert!((1.0..=line.word_starts.len() as f32).contains(&moment.word), "{moment:?} {line:?}");
            assert!((0.0..=1.0).contains(&moment.line_phase), "{moment:?}");
        }
    }
}
