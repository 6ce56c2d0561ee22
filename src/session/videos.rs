//! Videos of the playing song: the panel, the marks on the seek bar, and the order for the next video.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::Session;
use super::video_making::{SETTLED, SIZES, ShowChoice, Wish};
use super::video_words::{Known, part, rows};
use crate::clock;
use crate::commands::{Edge, Mark, Panel, VideoChoice, VideoEdit};
use crate::config::Choice;
use crate::demo_track::is_demo;
use crate::export::video::VideoPlace;
use crate::file_names::plain_name;
use crate::session::direction::Playing;
use crate::session::frame_senders::even;
use crate::session::scene::named;
use crate::show::ShowSource;
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::near_border;
use crate::videos::{Order, OrderedShow};
use mariana_music::Section;
use mariana_player::song::Song;

/// A mark that a key sets snaps to a border within this time, in seconds.
const REACH: f64 = 1.0;
/// Minimum length of a marked part, in seconds.
const PART_MIN: f64 = 0.5;
/// A second request to quit within this time ends the program while a video is rendered.
const QUIT_AGAIN: Duration = Duration::from_secs(6);

/// A session that makes videos.
pub(super) struct VideoDesk<'a>(&'a mut Session);

impl Session {
    pub(super) fn video_desk(&mut self) -> VideoDesk<'_> {
        VideoDesk(self)
    }
}

impl VideoDesk<'_> {
    /// Finds what the panel offers when it opens.
    pub(super) fn begin(&mut self) {
        // Reads a folder, so only now.
        let all = self.0.playback.scene.preparation.library.all_sources();
        let has_files = all.iter().any(|source| source.file().is_some());
        self.0.videos.scenes = all.iter().filter(|_| has_files).map(named).collect();
        self.find_performance();
    }

    fn find_performance(&self) {
        if let Some(videos) = &self.0.videos.videos {
            videos.find_performance(self.0.playback.reports.playing.title.clone());
        }
    }

    /// Follows the track and the queue. Returns when to call again.
    pub(super) fn update(&mut self, now: Instant) -> Option<Instant> {
        let playing = &self.0.playback.reports.playing;
        if (self.0.videos.track.0, &self.0.videos.track.1) != (playing.place.0, &playing.title) {
            self.0.videos.track = (playing.place.0, playing.title.clone());
            self.0.interface.ui_state.marks = None;
            self.find_performance();
        }
        // A notice before the first frame would not be seen.
        let is_shown = self.0.playback.pace.shown.is_some();
        let videos = self.0.videos.videos.iter().filter(|_| is_shown);
        let news: Vec<String> = videos.flat_map(|videos| std::iter::from_fn(|| videos.news())).collect();
        news.into_iter().for_each(|words| self.0.playback.reports.announce(words));
        if self.0.interface.ui_state.panels.open != Some(Panel::Video) {
            self.0.videos.measure(None, now);
            return None;
        }
        let wish = self.wish();
        self.0.videos.measure(wish.as_ref().ok(), now);
        let known = self.known();
        let rows = match &self.0.videos.videos {
            Some(videos) => videos.with_shown(|shown| rows(&self.0.videos.form, &known, shown, &wish)),
            None => Vec::new(),
        };
        if let Some(OpenPanel::Video(panel)) = &mut self.0.interface.ui_state.panel {
            panel.update(rows);
        }
        let settles = self.0.videos.settling.as_ref().filter(|_| !self.0.videos.is_measured);
        settles.map(|(_, since)| *since + SETTLED)
    }

    /// What the rows of the panel say about the window.
    fn known(&self) -> Known {
        let playing = &self.0.playback.reports.playing;
        let song = self.0.playback.listening.present_structure();
        let section = song.as_ref().and_then(|song| {
            let at = |section: &&Section| (section.start..section.end).contains(&playing.position);
            let section = song.sections.iter().find(at)?;
            Some((section.letter.clone(), [section.start, section.end]))
        });
        Known {
            section,
            marks: self.0.interface.ui_state.marks,
            duration: playing.duration,
            scene: self.0.playback.scene.present_source().title(),
            show: self.show_choice(),
            window: self.window_size(),
            folder: self.0.interface.folders.videos.clone(),
            title: playing.title.clone(),
        }
    }

    fn show_choice(&self) -> ShowChoice {
        let follows = if self.0.playback.follows() { ShowChoice::Show } else { ShowChoice::Scene };
        self.0.videos.form.show.unwrap_or(follows)
    }

    /// The size of the window, with even sides as videos need.
    fn window_size(&self) -> Option<(u32, u32)> {
        self.0.screen.size().map(even)
    }

    /// Carries out a change in the panel.
    pub(super) fn edit(&mut self, edit: VideoEdit) {
        match edit {
            VideoEdit::Choose { what, option } => self.choose(what, option),
            VideoEdit::Make => match self.wish() {
                Ok(Wish { order, file, title, .. }) => {
                    if let Some(videos) = &self.0.videos.videos {
                        videos.add(title, file, &order);
                        // The next video is measured again once nothing is rendered.
                        self.0.videos.settling = None;
                    }
                }
                Err(words) => self.0.playback.reports.answer(words),
            },
            VideoEdit::Job { id, action } => {
                if let Some(videos) = &self.0.videos.videos {
                    videos.act(id, action);
                }
            }
        }
        self.update(clock::now());
    }

    fn choose(&mut self, what: VideoChoice, option: usize) {
        let form = &mut self.0.videos.form;
        match what {
            VideoChoice::Place => form.place = option,
            VideoChoice::Part => match option {
                0 => self.0.interface.ui_state.marks = None,
                1 => self.mark_section(),
                _ if self.0.interface.ui_state.marks.is_some() => {}
                _ => {
                    let words =
                        "mark a part first: press < at its start and > at its end, or drag the brackets";
                    self.0.playback.reports.answer(words);
                }
            },
            VideoChoice::Marks => match option {
                0 => self.mark(Mark { edge: Edge::Start, at: None }),
                1 => self.mark(Mark { edge: Edge::End, at: None }),
                _ => self.0.interface.ui_state.marks = None,
            },
            VideoChoice::Show => form.show = ShowChoice::ALL.get(option).copied(),
            VideoChoice::TitleCard => form.title_card = option == 0,
            VideoChoice::Captions => form.captions = option == 0,
            VideoChoice::Draft => form.draft = option == 1,
            VideoChoice::Folder => form.beside = option == 1,
        }
    }

    fn mark_section(&mut self) {
        match self.known().section {
            Some((_, ends)) => self.0.interface.ui_state.marks = Some(ends),
            None => {
                let words = "the sections are known once the song is analysed: try again in a moment";
                self.0.playback.reports.answer(words);
            }
        }
    }

    /// Moves a mark, and chooses the part between the marks.
    pub(super) fn mark(&mut self, Mark { edge, at }: Mark) {
        let playing = &self.0.playback.reports.playing;
        let Some(duration) = playing.duration.filter(|_| !playing.live) else {
            let words = "only a song of known length can be marked";
            return self.0.playback.reports.answer(words);
        };
        let song = self.0.playback.listening.present_structure();
        let time = at.unwrap_or_else(|| near_border(playing.position, song.as_deref(), duration, REACH));
        let [start, end] = self.0.interface.ui_state.marks.unwrap_or([0.0, duration]);
        let marks = moved([start, end], edge, time, duration);
        self.0.interface.ui_state.marks = Some(marks);
        if at.is_none() && self.0.interface.ui_state.panels.open != Some(Panel::Video) {
            let words = part(marks);
            self.0.playback.reports.answer(format!("marked {words}: press F10 to make a video of it"));
        }
        self.update(clock::now());
    }

    /// The video that the choices describe.
    ///
    /// # Errors
    /// A message if no video can be made of what plays now.
    fn wish(&mut self) -> Result<Wish, String> {
        let form = self.0.videos.form;
        let no_song = "a video needs a song: play a file, because an audio input cannot be rendered";
        let status = self.0.playback.listening.with_song(|player| player.status()).ok_or(no_song)?;
        if self.0.playback.listening.playing() == Playing::Input {
            return Err(no_song.to_owned());
        }
        if status.track.count == 0 {
            return Err("a video needs a song: open a file, because the list of tracks is empty".to_owned());
        }
        let unreadable = "this song cannot be read a second time: save it to a file and open the file";
        let content = status.track.content.as_ref().ok_or(unreadable)?;
        let song = match &content.song {
            song if is_demo(song) => None,
            Song::File(path) => Some(path_text(path)?),
            Song::Embedded { .. } => return Err(unreadable.to_owned()),
        };
        let offset = content.cut.map_or(0.0, |cut| cut.seconds().0);
        let length = status.track.duration;
        let (start, duration) = match self.0.interface.ui_state.marks {
            Some([start, end]) => (start, Some(end - start)),
            None => (0.0, length.filter(|_| content.cut.is_some())),
        };
        let place = VideoPlace::ALL.get(form.place).map(|(place, ..)| *place);
        let size = match place {
            Some(_) => None,
            None => SIZES.get(form.place - VideoPlace::ALL.len()).copied().or(self.window_size()),
        };
        let choice = self.show_choice();
        let mut order = Order {
            song,
            place,
            size,
            start: offset + start,
            duration,
            show: self.ordered_show(choice)?,
            set: Vec::new(),
            title_card: form.title_card,
            captions: form.captions,
            draft: form.draft,
            choices: self.0.choices.clone(),
        };
        let longest = order.preset().duration;
        order.duration = duration.into_iter().chain(longest).reduce(f64::min);
        if choice == ShowChoice::Scene {
            order.set = self.0.playback.scene.parameters_in_hand().moved().sliders.into_iter().collect();
        }
        let seconds = order.duration.or(length.map(|length| length - start)).unwrap_or(0.0);
        let title = self.0.playback.reports.playing.title.clone();
        let folder = self.video_folder(&content.song)?;
        // A song without a title has the name of its file.
        let stem = match status.track.title {
            Some(_) => title.as_str(),
            None => Path::new(&title).file_stem().and_then(|stem| stem.to_str()).unwrap_or(&title),
        };
        let file = folder.join(plain_name(stem, "video") + ".mp4");
        Ok(Wish { order, seconds, file, title })
    }

    fn video_folder(&self, song: &Song) -> Result<PathBuf, String> {
        let beside = match song {
            Song::File(path) if self.0.videos.form.beside => path.parent(),
            _ => None,
        };
        let folder = beside.or(self.0.interface.folders.videos.as_deref());
        let folder = folder.ok_or("there is no folder for videos: set XDG_VIDEOS_DIR or HOME")?;
        std::path::absolute(folder).map_err(|error| error.to_string())
    }

    fn ordered_show(&self, choice: ShowChoice) -> Result<OrderedShow, String> {
        Ok(match choice {
            ShowChoice::Scene => {
                let source = self.0.playback.scene.present_source();
                if self.0.surprises.is_unsaved(source) {
                    return Err(
                        "this variation is not saved: press F7 to keep it, then make the video".to_owned()
                    );
                }
                OrderedShow::Scene(named(source))
            }
            ShowChoice::Show => {
                match self.0.playback.direction.show_of(self.0.playback.listening.playing()) {
                    ShowSource::Auto => OrderedShow::Show("auto".to_owned(), self.0.videos.scenes.clone()),
                    ShowSource::Demo => OrderedShow::Show("demo".to_owned(), Vec::new()),
                    ShowSource::File(path) => OrderedShow::Show(path_text(&path)?, Vec::new()),
                }
            }
            ShowChoice::Performance => {
                let title = &self.0.playback.reports.playing.title;
                let videos = self.0.videos.videos.as_ref();
                let found = videos.and_then(|videos| videos.with_shown(|shown| shown.performance.clone()));
                let found = found.filter(|(of, _)| of == title);
                let (_, file) = found.ok_or("there is no recording of this song: press F9 to record one")?;
                OrderedShow::Show(path_text(&file)?, Vec::new())
            }
        })
    }

    /// Tells the window whether a letter key may end the program at once: not while keys type text, and not while a
    /// video is rendered.
    pub(super) fn allow_quitting(&mut self) {
        let holds_back = self.0.interface.takes_text() || self.0.videos.is_rendering();
        self.0.screen.set_keys_are_text(holds_back);
    }

    /// Returns true if a request to quit must be repeated, because a video is being rendered.
    pub(super) fn holds_back_quitting(&mut self) -> bool {
        let now = clock::now();
        if !self.0.videos.is_rendering() || self.0.videos.warned.is_some_and(|at| now - at < QUIT_AGAIN) {
            return false;
        }
        self.0.videos.warned = Some(now);
        let words =
            "a video is being rendered: press Q again to quit; the next start offers to begin it again";
        self.0.playback.reports.answer(words);
        true
    }
}

/// The marks after one of them has moved. The other mark gives way, to an end of the track if need be.
fn moved([start, end]: [f64; 2], edge: Edge, time: f64, duration: f64) -> [f64; 2] {
    match edge {
        Edge::Start => {
            let start = time.clamp(0.0, (duration - PART_MIN).max(0.0));
            [start, if end < start + PART_MIN { duration } else { end }]
        }
        Edge::End => {
            let end = time.clamp(PART_MIN.min(duration), duration);
            [if start > end - PART_MIN { 0.0 } else { start }, end]
        }
    }
}

/// The absolute path as text, because the queue is a text file.
fn path_text(path: &Path) -> Result<String, String> {
    let absolute = std::path::absolute(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let text = absolute.to_str().map(str::to_owned);
    text.ok_or_else(|| format!("the name {} is not UTF-8: rename the file", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_never_cross() {
        let whole = [0.0, 60.0];
        assert_eq!(moved(whole, Edge::Start, 20.0, 60.0), [20.0, 60.0]);
        assert_eq!(moved([20.0, 60.0], Edge::End, 40.0, 60.0), [20.0, 40.0]);
        assert_eq!(moved([20.0, 40.0], Edge::Start, 50.0, 60.0), [50.0, 60.0]);
        assert_eq!(moved([20.0, 40.0], Edge::End, 10.0, 60.0), [0.0, 10.0]);
        assert_eq!(moved(whole, Edge::Start, 99.0, 60.0), [59.5, 60.0]);
        assert_eq!(moved(whole, Edge::End, -1.0, 60.0), [0.0, 0.5]);
    }
}
