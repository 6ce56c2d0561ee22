//! What there is to report of the scene on the stage.

use std::time::Instant;

use super::views::ViewsOf;
use super::{SceneStage, Task};
use crate::scenes::SceneSource;
use mariana_control::Slider;

/// What is shown over the picture.
pub(crate) struct SceneWords<'a> {
    /// What is wrong: a heading, and the messages.
    pub problem: Option<(&'a str, &'a str)>,
    /// A line that fades, and when it came up.
    pub notice: Option<(&'a str, Instant)>,
    /// A line that stays for as long as it is given.
    pub hint: Option<&'a str>,
    /// The parameters of the scene, which the user may move.
    pub sliders: &'a mut [Slider],
}

impl SceneStage {
    /// The name of the scene on the stage.
    pub(crate) fn name(&self) -> Option<String> {
        self.on_stage.as_ref().map(|cast| cast.source.title())
    }

    /// Where the scene on the stage comes from.
    pub(crate) fn shown_source(&self) -> Option<&SceneSource> {
        self.on_stage.as_ref().map(|cast| &cast.source)
    }

    /// The scene that the next show begins with: the one on the stage, and before there is any the one asked for.
    pub(crate) fn source_to_leave(&self) -> &SceneSource {
        self.shown_source().unwrap_or(&self.source)
    }

    /// A scene's name with its place among those that the keys go through, such as "terrain, 3 of 17". Reads a folder.
    pub(crate) fn placed_name(&self, source: &SceneSource) -> String {
        let (at, count) = self.list.place(source);
        format!("{}, {} of {count}", source.title(), at + 1)
    }

    /// The name of the scene that was asked for last.
    pub(crate) fn wanted_title(&self) -> String {
        self.source.title()
    }

    /// Shows what is wrong with something that the scenes follow.
    pub(crate) fn set_problem(&mut self, heading: String, text: String) {
        self.problem = Some((heading, text));
    }

    /// What the title says of the scene: its name, its mode, its view.
    pub(crate) fn notes(&self) -> Vec<String> {
        let Some((name, mode)) = self.name().zip(self.mode()) else { return Vec::new() };
        let view = self.view().map(|view| format!("view {view}"));
        [name, mode.to_string()].into_iter().chain(view).collect()
    }

    /// A line about the scene on the stage. First what people ask: its name, the rate and size of its pictures as
    /// `pictures` has them, its mode. Then the numbers: clauses, regions, and `quality`. Then what the driver is at.
    pub(crate) fn corner(&self, pictures: &str, quality: &str) -> Option<String> {
        let (cast, mode) = self.on_stage.as_ref().zip(self.mode())?;
        let cost = cast.resources.buffers().cost;
        let regions = self.regions.about((cast.id, mode), cast.resources.regions().as_deref());
        let name = cast.source.title();
        let numbers = format!("{pictures} · {mode} · {} clauses · {regions} · {quality}", cost.distance);
        let remarks = self.remarks();
        Some([name, numbers].into_iter().chain(remarks).collect::<Vec<_>>().join(" · "))
    }

    /// Says of each program that the driver is at for long that it is, once.
    pub(super) fn tell_slow_compiling(&mut self) {
        for id in self.compiler.slow() {
            let Some(task) = self.tasks.get(&id) else { continue };
            // Nobody waits for what is prepared ahead.
            if matches!(task, Task::Compiled { id: of, .. } if self.ahead.casts().any(|cast| cast.id == *of))
            {
                continue;
            }
            let what = match task {
                Task::Compiled { id: of, .. } => self.cast(*of).map(|cast| cast.source.title()),
                Task::Views(ViewsOf::Compiled(of)) => {
                    self.cast(*of).map(|cast| format!("the views of {}", cast.source.title()))
                }
                Task::Views(ViewsOf::Interpreted(_)) => Some("the interpreter's views".to_owned()),
                Task::Interpreter(_) | Task::Universal { .. } => Some("an interpreter".to_owned()),
            };
            let Some(what) = what else { continue };
            let meanwhile = match self.on_stage {
                Some(_) => "the show goes on without it",
                None => "nothing can be shown before",
            };
            let sentence = format!("the driver is still compiling {what}: {meanwhile}");
            tracing::warn!("{sentence}");
            if self.user_waits_for(id) {
                self.tell(sentence.clone());
            }
            self.quiet.note(sentence, Some(id));
        }
    }

    /// What there is to say over the picture, and the sliders of the scene on the stage.
    pub(crate) fn words(&mut self) -> SceneWords<'_> {
        let sliders = self.on_stage.as_mut().map_or(&mut [][..], |cast| cast.sliders.as_mut_slice());
        SceneWords {
            problem: self.problem.as_ref().map(|(heading, text)| (&**heading, &**text)),
            notice: self.notice.as_ref().map(|(text, since)| (&**text, *since)),
            hint: self.awaited.as_deref(),
            sliders,
        }
    }
}
