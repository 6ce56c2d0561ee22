//! The words of the panel that makes videos.

use std::path::{Path, PathBuf};

use super::video_making::{Form, SIZES, ShowChoice, Wish};
use crate::commands::{JobAction, VideoChoice};
use crate::config::Choice;
use crate::export::video::{Preset, VideoPlace};
use crate::file_names::numbered;
use crate::ui::overlay::clock_time;
use crate::ui::video_panel::{VideoOption, VideoRow};
use crate::videos::{Estimate, Job, JobState, Shown};

/// What the rows say about the window.
pub(super) struct Known {
    /// Letter and ends of the section that plays now.
    pub(super) section: Option<(String, [f64; 2])>,
    pub(super) marks: Option<[f64; 2]>,
    pub(super) duration: Option<f64>,
    /// The title of the shown scene.
    pub(super) scene: String,
    pub(super) show: ShowChoice,
    pub(super) window: Option<(u32, u32)>,
    pub(super) folder: Option<PathBuf>,
    /// The song's title.
    pub(super) title: String,
}

/// The rows of the panel.
pub(super) fn rows(form: &Form, known: &Known, shown: &Shown, wish: &Result<Wish, String>) -> Vec<VideoRow> {
    let choice = |what, name, options, chosen| VideoRow::Choice { what, name, options, chosen };
    let on_off = |what, name, is_on: bool, meaning: &str| {
        let options = ["on", "off"].map(|text| option(text, meaning));
        choice(what, name, options.into(), Some(usize::from(!is_on)))
    };
    let folder = known.folder.as_deref().map_or_else(|| "none".to_owned(), short);
    let mut folders = vec![option(&folder, "The folder for your videos; an existing file is never replaced")];
    if wish.as_ref().is_ok_and(|wish| wish.order.song.is_some()) {
        let meaning = "The folder of the song's file; an existing file is never replaced";
        folders.push(option("beside the song", meaning));
    }
    let marks = vec![
        option("start here (<)", "Begin the part at the present moment, or at a border of sections near it"),
        option("end here (>)", "End the part at the present moment, or at a border of sections near it"),
        option("none", "Remove the marks; you can also drag the brackets on the seek bar"),
    ];
    let draft = vec![
        option("full", "Drawn as stills are, in the best quality"),
        option("draft", "Coarser edges, for a first look in less than half of the time"),
    ];
    let choices = [
        choice(VideoChoice::Place, "For", places(known), Some(form.place)),
        choice(VideoChoice::Part, "Part", parts(form, known), Some(part_index(known))),
        choice(VideoChoice::Marks, "Marks", marks, None),
        choice(VideoChoice::Show, "Scenes", shows(known, shown), Some(known.show as usize)),
        on_off(
            VideoChoice::TitleCard,
            "Title card",
            form.title_card,
            "Title and artist during the first five seconds",
        ),
        on_off(
            VideoChoice::Captions,
            "Captions",
            form.captions,
            "The lyrics while they are sung, from the .lrc file beside the song or the song's tags",
        ),
        choice(VideoChoice::Draft, "Drawing", draft, Some(usize::from(form.draft))),
        choice(VideoChoice::Folder, "Folder", folders, Some(usize::from(form.beside))),
    ];
    let (about, is_bad) = about(wish, shown);
    let make = VideoRow::Make { about, is_bad, is_ready: wish.is_ok() };
    shown.jobs.iter().map(job_row).chain(choices).chain([make]).collect()
}

fn option(text: &str, meaning: &str) -> VideoOption {
    VideoOption { text: text.to_owned(), meaning: meaning.to_owned() }
}

fn places(known: &Known) -> Vec<VideoOption> {
    let services = VideoPlace::ALL.iter().map(|(_, name, meaning)| option(name, meaning));
    let sized = |(width, height): (u32, u32), of: &str| {
        let fps = Preset::PLAIN.fps;
        option(&format!("{of}{width}x{height}"), &format!("{width}x{height} at {fps} frames a second"))
    };
    let sizes = SIZES.iter().map(|size| sized(*size, ""));
    services.chain(sizes).chain(known.window.map(|size| sized(size, "window "))).collect()
}

fn parts(form: &Form, known: &Known) -> Vec<VideoOption> {
    let whole = match known.duration {
        Some(duration) => format!("whole song, {}", clock_time(duration.round())),
        None => "whole song".to_owned(),
    };
    let section = match &known.section {
        Some((letter, ends)) => format!("this section, {letter} {}", part(*ends)),
        None => "this section".to_owned(),
    };
    let marked = match known.marks {
        Some(ends) => format!("marked, {}", part(ends)),
        None => "marked part".to_owned(),
    };
    let longest = VideoPlace::ALL.get(form.place).and_then(|(place, ..)| Preset::of(Some(*place)).duration);
    let longest = longest.map_or(String::new(), |seconds| format!("; at most {seconds} s of it"));
    vec![
        option(&whole, &format!("From the start to the end{longest}; removes the marks")),
        option(&section, &format!("The section of the song that plays now, such as its chorus{longest}")),
        option(&marked, &format!("From the mark < to the mark > on the seek bar{longest}")),
    ]
}

fn part_index(known: &Known) -> usize {
    let section = known.section.as_ref().map(|(_, ends)| *ends);
    match known.marks {
        None => 0,
        marks if marks == section => 1,
        Some(_) => 2,
    }
}

fn shows(known: &Known, shown: &Shown) -> Vec<VideoOption> {
    let scene = format!("this scene, {}", known.scene);
    let mut options = vec![
        option(&scene, "The shown scene with its sliders as they are now"),
        option("the show", "Scenes that follow the song, as with key A"),
    ];
    let has_one = shown.performance.as_ref().is_some_and(|(title, _)| *title == known.title);
    if has_one || known.show == ShowChoice::Performance {
        options.push(option("my recording", "The last performance of this song that you recorded with F9"));
    }
    options
}

/// What is known about the video, and true for an error.
fn about(wish: &Result<Wish, String>, shown: &Shown) -> (String, bool) {
    let wish = match wish {
        Ok(wish) => wish,
        Err(reason) => return (reason.clone(), true),
    };
    let is_free = |path: &PathBuf| shown.jobs.iter().all(|job| job.file != *path);
    let place = numbered(&wish.file).find(is_free).map_or_else(String::new, |path| short(&path));
    let is_busy = shown
        .jobs
        .iter()
        .any(|job| !matches!(job.state, JobState::Done | JobState::Failed(_) | JobState::Unfinished));
    match &shown.estimate {
        Estimate::Failed(reason) => (reason.clone(), true),
        Estimate::Known { seconds, bytes, free } => {
            let size = bytes.map_or(String::new(), |bytes| format!(", about {}", size_words(bytes)));
            let lacks = bytes.zip(*free).filter(|(bytes, free)| bytes > free);
            let lacks = lacks.map(|(_, free)| format!("; the disk has only {} left", size_words(free)));
            let is_bad = lacks.is_some();
            let words = format!(
                "about {} to render{size}{} · {place}",
                time_words(*seconds),
                lacks.unwrap_or_default()
            );
            (words, is_bad)
        }
        Estimate::Measuring => (format!("measuring the time and size… · {place}"), false),
        Estimate::TooSlow => {
            (format!("time not measured: two frames take more than a minute · {place}"), false)
        }
        Estimate::Unknown if is_busy => (format!("it follows the videos above · {place}"), false),
        Estimate::Unknown => (place, false),
    }
}

fn job_row(job: &Job) -> VideoRow {
    use JobAction::{Continue, Pause, Remove, Show};
    let percent = |done: u64, of: Option<u64>| of.filter(|of| *of > 0).map(|of| 100 * done.min(of) / of);
    let fraction =
        |done: u64, of: Option<u64>| of.filter(|of| *of > 0).map(|of| done.min(of) as f32 / of as f32);
    let (about, fraction, actions) = match &job.state {
        JobState::Waiting => ("waiting".to_owned(), None, vec![(Remove, "cancel")]),
        JobState::Unfinished => {
            let words = "unfinished when Mariana ended: it begins again".to_owned();
            (words, None, vec![(Continue, "continue"), (Remove, "cancel")])
        }
        JobState::Rendering { done, of, left } => {
            let left = left.map_or(String::new(), |left| format!(", {} left", time_words(left)));
            let words = match percent(*done, *of) {
                _ if *done == 0 => "preparing".to_owned(),
                Some(percent) => format!("{percent} %{left}"),
                None => format!("{done} frames"),
            };
            (words, Some(fraction(*done, *of).unwrap_or(0.0)), vec![(Pause, "pause"), (Remove, "cancel")])
        }
        JobState::Paused { done, of } => {
            let words =
                percent(*done, *of).map_or("paused".to_owned(), |percent| format!("paused at {percent} %"));
            (
                words,
                Some(fraction(*done, *of).unwrap_or(0.0)),
                vec![(Continue, "continue"), (Remove, "cancel")],
            )
        }
        JobState::Failed(reason) => {
            (reason.clone(), None, vec![(Continue, "try again"), (Remove, "remove from the list")])
        }
        JobState::Done => {
            ("ready".to_owned(), None, vec![(Show, "show in folder"), (Remove, "remove from the list")])
        }
    };
    let name = job.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    VideoRow::Job {
        id: job.id,
        name,
        about,
        fraction,
        is_bad: matches!(job.state, JobState::Failed(_)),
        actions,
    }
}

/// A part of a song, such as "1:02–1:24".
pub(super) fn part([start, end]: [f64; 2]) -> String {
    format!("{}–{}", clock_time(start.round()), clock_time(end.round()))
}

fn time_words(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 90.0 => format!("{:.0} s", seconds.max(1.0)),
        seconds if seconds < 5_400.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3_600.0),
    }
}

fn size_words(bytes: u64) -> String {
    match bytes as f64 / 1e6 {
        megabytes if megabytes < 1.0 => "1 MB".to_owned(),
        megabytes if megabytes < 1_000.0 => format!("{megabytes:.0} MB"),
        megabytes => format!("{:.1} GB", megabytes / 1_000.0),
    }
}

/// A path with ~ for the home folder.
fn short(path: &Path) -> String {
    let home = std::env::var_os("HOME").filter(|home| !home.is_empty());
    match home.and_then(|home| path.strip_prefix(home).ok().map(Path::to_owned)) {
        Some(rest) => format!("~/{}", rest.display()),
        None => path.display().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_sizes_are_rounded() {
        let times = [0.2, 42.4, 200.0, 7_200.0].map(time_words);
        assert_eq!(times, ["1 s", "42 s", "3 min", "2.0 h"]);
        let sizes = [10, 25_400_000, 3_210_000_000].map(size_words);
        assert_eq!(sizes, ["1 MB", "25 MB", "3.2 GB"]);
        assert_eq!(part([62.4, 83.6]), "1:02–1:24");
    }
}
