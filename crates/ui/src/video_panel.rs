//! The state of the panel that makes videos: the queue, a row for each choice, and the button that makes a video. The
//! overlay draws the panel. Keys and the pointer make commands.

use mariana_commands::input::{Key, NamedKey};
use mariana_commands::{Command, JobAction, VideoChoice, VideoEdit};

/// A row of the panel.
#[derive(Debug, Clone, PartialEq)]
pub enum VideoRow {
    /// A video of the queue.
    Job {
        /// The video's number.
        id: u64,
        /// The name of its file.
        name: String,
        /// The progress, such as "42 %, 3 min left".
        about: String,
        /// The finished fraction, 0..1, of a video that is being rendered.
        fraction: Option<f32>,
        /// True if it failed.
        is_bad: bool,
        /// The actions, each with its words.
        actions: Vec<(JobAction, &'static str)>,
    },
    /// A choice among options.
    Choice {
        /// The choice.
        what: VideoChoice,
        /// Its name in one or two words.
        name: &'static str,
        /// The options.
        options: Vec<VideoOption>,
        /// The index of the chosen option; `None` for buttons.
        chosen: Option<usize>,
    },
    /// The button that makes a video.
    Make {
        /// The expected time and size, and the file; or the reason why no video can be made.
        about: String,
        /// True if `about` is an error.
        is_bad: bool,
        /// False if no video can be made.
        is_ready: bool,
    },
}

/// An option of a choice.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VideoOption {
    /// The text on the button.
    pub text: String,
    /// An explanation in one sentence.
    pub meaning: String,
}

/// The rows and the selection.
#[derive(Debug, Default)]
pub struct VideoPanel {
    /// The rows, from the top.
    pub rows: Vec<VideoRow>,
    /// The index of the selected row.
    pub selected: usize,
    /// The index of the selected action or option of a row with buttons.
    button: usize,
    /// A number that grows whenever the rows change.
    pub revision: u64,
}

impl VideoPanel {
    /// The index of the selected button of the selected row, if the row has buttons.
    pub fn selected_button(&self) -> Option<usize> {
        let count = self.rows.get(self.selected).map_or(0, buttons);
        (count > 0).then(|| self.button.min(count - 1))
    }

    /// Replaces the rows and keeps the same row selected. The first time, selects the last row, which makes a video.
    pub fn update(&mut self, rows: Vec<VideoRow>) {
        if rows == self.rows {
            return;
        }
        let before = self.rows.get(self.selected);
        let place = before.and_then(|before| rows.iter().position(|row| is_same(row, before)));
        let last = rows.len().saturating_sub(1);
        let fallback = if self.rows.is_empty() { last } else { self.selected.min(last) };
        self.selected = place.unwrap_or(fallback);
        self.rows = rows;
        self.revision += 1;
    }

    /// Handles a key: up and down select a row, left and right an option or a button, Enter presses. Returns the
    /// key's commands; `None` for a key that belongs to the show.
    pub fn handle_key(&mut self, key: &Key) -> Option<Vec<Command>> {
        let command = match key {
            Key::Named(NamedKey::ArrowUp) => self.select(self.selected.saturating_sub(1)),
            Key::Named(NamedKey::ArrowDown) => self.select(self.selected + 1),
            Key::Named(NamedKey::ArrowLeft) => self.step(false),
            Key::Named(NamedKey::ArrowRight) => self.step(true),
            Key::Named(NamedKey::Enter) => self.press(),
            Key::Named(NamedKey::Delete) => match self.rows.get(self.selected) {
                Some(VideoRow::Job { id, .. }) => Some(job(*id, JobAction::Remove)),
                _ => return None,
            },
            _ => return None,
        };
        Some(Vec::from_iter(command))
    }

    fn select(&mut self, row: usize) -> Option<Command> {
        let row = row.min(self.rows.len().saturating_sub(1));
        if row != self.selected {
            (self.selected, self.button) = (row, 0);
        }
        None
    }

    fn step(&mut self, forward: bool) -> Option<Command> {
        let row = self.rows.get(self.selected)?;
        let next = |now: usize, count: usize| {
            if forward { (now + 1).min(count.saturating_sub(1)) } else { now.saturating_sub(1) }
        };
        if let VideoRow::Choice { what, options, chosen: Some(chosen), .. } = row {
            let option = next(*chosen, options.len());
            return (option != *chosen).then_some(choose(*what, option));
        }
        self.button = next(self.button, buttons(row));
        None
    }

    fn press(&self) -> Option<Command> {
        match self.rows.get(self.selected)? {
            VideoRow::Job { id, actions, .. } => {
                actions.get(self.selected_button()?).map(|(action, _)| job(*id, *action))
            }
            VideoRow::Choice { what, options, chosen: Some(chosen), .. } => {
                Some(choose(*what, (chosen + 1) % options.len().max(1)))
            }
            VideoRow::Choice { what, chosen: None, .. } => Some(choose(*what, self.selected_button()?)),
            VideoRow::Make { is_ready, .. } => is_ready.then_some(Command::Video(VideoEdit::Make)),
        }
    }
}

/// The command that chooses an option.
pub fn choose(what: VideoChoice, option: usize) -> Command {
    Command::Video(VideoEdit::Choose { what, option })
}

/// The command that acts on a video.
pub fn job(id: u64, action: JobAction) -> Command {
    Command::Video(VideoEdit::Job { id, action })
}

/// The number of buttons among which the left and right keys select.
fn buttons(row: &VideoRow) -> usize {
    match row {
        VideoRow::Job { actions, .. } => actions.len(),
        VideoRow::Choice { options, chosen: None, .. } => options.len(),
        VideoRow::Choice { .. } | VideoRow::Make { .. } => 0,
    }
}

fn is_same(a: &VideoRow, b: &VideoRow) -> bool {
    match (a, b) {
        (VideoRow::Job { id: a, .. }, VideoRow::Job { id: b, .. }) => a == b,
        (VideoRow::Choice { what: a, .. }, VideoRow::Choice { what: b, .. }) => a == b,
        (VideoRow::Make { .. }, VideoRow::Make { .. }) => true,
        _ => false,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn rows(jobs: u64) -> Vec<VideoRow> {
        let jobs = (1..=jobs).map(|id| VideoRow::Job {
            id,
            name: format!("夜に駆ける {id}.mp4"),
            about: "42 %, 3 min left".to_owned(),
            fraction: Some(0.42),
            is_bad: false,
            actions: vec![(JobAction::Pause, "pause"), (JobAction::Remove, "cancel")],
        });
        let option = |text: &str| VideoOption { text: text.to_owned(), meaning: format!("{text} is meant") };
        let choice = |what, name, options: &[&str], chosen| VideoRow::Choice {
            what,
            name,
            options: options.iter().map(|text| option(text)).collect(),
            chosen,
        };
        let make = VideoRow::Make {
            about: "about 4 min, 25 MB · ~/Videos/one.mp4".to_owned(),
            is_bad: false,
            is_ready: true,
        };
        let choices = [
            choice(VideoChoice::Place, "For", &["youtube", "reel", "story"], Some(0)),
            choice(VideoChoice::Marks, "Marks", &["start here", "end here"], None),
            make,
        ];
        jobs.chain(choices).collect()
    }

    #[test]
    fn enter_makes_a_video_at_once_and_arrows_reach_everything_else() {
        use NamedKey::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Delete, Enter};
        let mut panel = VideoPanel::default();
        panel.update(rows(0));
        let mut press = |key| panel.handle_key(&Key::Named(key)).unwrap().pop();
        assert_eq!(press(Enter), Some(Command::Video(VideoEdit::Make)));
        assert_eq!((press(ArrowUp), press(ArrowRight)), (None, None));
        assert_eq!(press(Enter), Some(choose(VideoChoice::Marks, 1)));
        assert_eq!((press(ArrowUp), press(ArrowLeft)), (None, None), "the first option has none before it");
        assert_eq!(press(ArrowRight), Some(choose(VideoChoice::Place, 1)));
        // The queue appears above the choices, and the selected row stays.
        panel.update(rows(2));
        let mut press = |key| panel.handle_key(&Key::Named(key)).unwrap().pop();
        assert_eq!(press(ArrowRight), Some(choose(VideoChoice::Place, 1)));
        assert_eq!((press(ArrowUp), press(ArrowRight)), (None, None));
        assert_eq!(press(Enter), Some(job(2, JobAction::Remove)));
        assert_eq!((press(ArrowUp), press(Enter)), (None, Some(job(1, JobAction::Pause))));
        assert_eq!(press(Delete), Some(job(1, JobAction::Remove)));
        (0..9).for_each(|_| assert_eq!(press(ArrowDown), None));
        assert_eq!(press(Enter), Some(Command::Video(VideoEdit::Make)));
        for key in [Key::Character("q".into()), Key::Named(NamedKey::Escape), Key::Named(Delete)] {
            assert_eq!(panel.handle_key(&key), None, "{key:?} belongs to the show");
        }
    }
}
