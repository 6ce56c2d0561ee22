//! Draws scenes at moments of a song on one sheet, a row for each scene, and prints how much its quietest and its
//! loudest part differ. A change of a scene is judged on songs that were not used to make it.

use std::path::PathBuf;

use anyhow::Context as _;
use image::imageops::{FilterType, replace, resize};
use image::{DynamicImage, RgbImage, Rgba32FImage};
use mariana::export::song_features::SongFeatures;
use mariana::scenes::{SceneSource, shipped_names};
use mariana_music::SongStructure;
use mariana_player::song::Song;

use crate::animation::still;

const SIZE: (u32, u32) = (320, 180);
/// Pictures are compared in this size: what counts is where light is, not what is drawn with it.
const COMPARED_SIZE: (u32, u32) = (32, 18);
/// Moments this near to the start or the end of a song are no use: it fades in or out, in seconds.
const EDGE: f64 = 5.0;

/// Draws the named scenes or files, or all shipped scenes.
pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let [song, sheet_file, scenes @ ..] = arguments else {
        anyhow::bail!("expected a song and the file of the sheet");
    };
    let song = Song::File(PathBuf::from(song));
    let moments = moments(SongFeatures::open(&song, 0.0)?.structure()).context("the song is too short")?;
    let scenes = if scenes.is_empty() { shipped_names() } else { scenes.to_vec() };
    let mut sheet = RgbImage::new(SIZE.0 * moments.len() as u32, SIZE.1 * scenes.len() as u32);
    println!("{}", moments.map(|(name, at)| format!("{name} {at:.1} s")).join(", "));
    println!("scene · brightness quiet, loud, change · hue apart · layout alike");
    for (row, name) in scenes.iter().enumerate() {
        let source = SceneSource::find(name)?;
        let mut seen = Vec::new();
        for (column, (_, at)) in moments.into_iter().enumerate() {
            let picture =
                still(&song, source.clone(), at, SIZE).with_context(|| format!("drawing {name}"))?;
            let place = [column as u32 * SIZE.0, row as u32 * SIZE.1].map(i64::from);
            let picture = DynamicImage::from(picture);
            seen.push(PictureFigures::of(&picture.to_rgba32f()));
            replace(&mut sheet, &picture.into_rgb8(), place[0], place[1]);
        }
        let [quiet, loud, ..] = &seen[..] else { continue };
        println!("{:14} {}", source.title(), quiet.beside(loud));
    }
    Ok(sheet.save(sheet_file)?)
}

/// The middle of the quietest and of the loudest section, the end of a build and a drop, or else other sections.
fn moments(song: &SongStructure) -> Option<[(&'static str, f64); 4]> {
    let middle = |index: usize| {
        song.sections.get(index).map(|section| ((section.start + section.end) / 2.0, section.energy))
    };
    let mut middles: Vec<(f64, f32)> = (0..song.sections.len()).filter_map(middle).collect();
    middles.retain(|(at, _)| (EDGE..song.seconds - EDGE).contains(at));
    middles.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let (first, last) = (middles.first()?.0, middles.last()?.0);
    let between = |share: usize| middles[(middles.len() - 1) * share / 3].0;
    let build = song.builds.first().map_or(between(1), |build| build.end - 1.0);
    let drop = song.drops.first().map_or(between(2), |drop| drop + 0.5);
    let within = |at: f64| at.clamp(0.0, song.seconds);
    Some([("quiet", first), ("loud", last), ("build", within(build)), ("drop", within(drop))])
}

/// What a picture looks like from afar.
struct PictureFigures {
    brightness: Vec<f32>,
    /// The mean colour as a point of the colour circle: its direction is the hue, its length the saturation.
    color: [f32; 2],
}

impl PictureFigures {
    fn of(picture: &Rgba32FImage) -> Self {
        let small = resize(picture, COMPARED_SIZE.0, COMPARED_SIZE.1, FilterType::Triangle);
        let brightness = small.pixels().map(|pixel| pixel.0[..3].iter().sum::<f32>() / 3.0).collect();
        let mut color = [0.0; 2];
        for [red, green, blue, _] in small.pixels().map(|pixel| pixel.0) {
            color[0] += red - (green + blue) / 2.0;
            color[1] += (green - blue) * 0.75_f32.sqrt();
        }
        Self { brightness, color }
    }

    fn mean(&self) -> f32 {
        self.brightness.iter().sum::<f32>() / self.brightness.len() as f32
    }

    fn beside(&self, other: &Self) -> String {
        let (ours, theirs) = (self.mean(), other.mean());
        let covariance = |a: &Self, b: &Self| -> f32 {
            a.brightness.iter().zip(&b.brightness).map(|(x, y)| (x - a.mean()) * (y - b.mean())).sum()
        };
        let spread = (covariance(self, self) * covariance(other, other)).sqrt();
        let alike = covariance(self, other) / spread.max(f32::MIN_POSITIVE);
        let turn = |seen: &Self| seen.color[1].atan2(seen.color[0]).to_degrees();
        let apart = (turn(self) - turn(other)).rem_euclid(360.0);
        format!(
            "{:4.0} {:4.0} {:+5.0} % {:5.0}° {alike:6.2}",
            255.0 * ours,
            255.0 * theirs,
            100.0 * (theirs / ours.max(f32::MIN_POSITIVE) - 1.0),
            apart.min(360.0 - apart),
        )
    }
}

#[cfg(test)]
mod tests {
    use image::Rgba;

    use super::*;

    fn seen(color: impl Fn(u32) -> [f32; 3]) -> PictureFigures {
        PictureFigures::of(&Rgba32FImage::from_fn(64, 36, |x, _| {
            let [red, green, blue] = color(x);
            Rgba([red, green, blue, 1.0])
        }))
    }

    #[test]
    fn brightness_hue_and_layout_are_told_apart() {
        let left = seen(|x| if x < 32 { [0.4, 0.0, 0.0] } else { [0.1, 0.0, 0.0] });
        let words = left.beside(&left);
        assert_eq!(words.split_whitespace().collect::<Vec<_>>(), ["21", "21", "+0", "%", "0°", "1.00"]);
        let brighter = seen(|x| if x < 32 { [0.8, 0.0, 0.0] } else { [0.2, 0.0, 0.0] });
        assert!(left.beside(&brighter).contains("+100 %"), "{}", left.beside(&brighter));
        let right = seen(|x| if x < 32 { [0.0, 0.1, 0.0] } else { [0.0, 0.4, 0.0] });
        let words = left.beside(&right);
        assert!(words.contains("+0 %") && words.contains("120°") && words.contains("-1.00"), "{words}");
    }
}
