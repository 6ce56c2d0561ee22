//! What the user asks of the stage: another scene, another way to draw it, other parameters.

use super::SceneStage;
use crate::config::SdfChoice;
use crate::gpu::scene_program::Mode;
use crate::scenes::SceneSource;

impl SceneStage {
    /// Changes between interpreted and compiled. A missing program is made; until then the picture stays.
    pub(crate) fn toggle_mode(&mut self) {
        let Some((mode, id)) = self.mode().zip(self.on_stage.as_ref().map(|cast| cast.id)) else { return };
        let other = match mode {
            Mode::Interpreted => Mode::Compiled,
            Mode::Compiled => Mode::Interpreted,
        };
        let waited_for = match self.choice {
            SdfChoice::Auto => None,
            SdfChoice::Interpreted => Some(Mode::Interpreted),
            SdfChoice::Compiled => Some(Mode::Compiled),
        };
        // A wish that is not fulfilled yet is withdrawn.
        let wanted = if waited_for == Some(other) && self.in_the_making(id, other) { mode } else { other };
        self.choice = match wanted {
            Mode::Interpreted => SdfChoice::Interpreted,
            Mode::Compiled => SdfChoice::Compiled,
        };
        // The scene that is coming also waits for what is wanted now.
        for id in [Some(id), self.coming.as_ref().map(|cast| cast.id)].into_iter().flatten() {
            match wanted {
                Mode::Interpreted => self.ask_for_interpreter(id),
                Mode::Compiled => self.ask_for_compiled(id),
            }
        }
        self.recast();
        let now = self.mode();
        self.asked_mode = Some(wanted).filter(|_| now != Some(wanted));
        let possible =
            self.on_stage.as_ref().is_some_and(|cast| wanted == Mode::Compiled || cast.interpreter.is_some());
        self.tell(match now {
            Some(now) if now == wanted => now.to_string(),
            _ if possible => format!("{wanted}: the driver is preparing it"),
            _ => "the tape does not fit this driver: the scene stays compiled".to_owned(),
        });
        self.revision += 1;
    }

    /// Lets fades from scene to scene take this many seconds from now on, and says so.
    pub(crate) fn set_fade(&mut self, seconds: f64) -> String {
        self.fading.set_seconds(seconds);
        match seconds > 0.0 {
            true => format!("scenes fade into each other for {seconds:.1} s"),
            false => "scenes are cut".to_owned(),
        }
    }

    /// Whether scenes are cut where hands change them.
    pub(crate) fn is_cut_by_hand(&self) -> bool {
        self.fading.cuts()
    }

    /// Cuts from scene to scene from now on, or fades as before, and says so.
    pub(crate) fn cut_by_hand(&mut self, cuts: bool) -> String {
        self.fading.set_cuts(cuts);
        match cuts {
            true => "scenes are cut".to_owned(),
            false => self.set_fade(self.fading.seconds()),
        }
    }

    /// Asks for the next or the previous scene.
    pub(crate) fn go(&mut self, forward: bool) {
        let next = if forward { self.list.next(&self.source) } else { self.list.previous(&self.source) };
        self.show_source(next);
    }

    /// Asks for a scene because the user wants it.
    pub(crate) fn show_source(&mut self, source: SceneSource) {
        self.overrule();
        self.ask_for_source(source);
    }

    /// Asks for a scene. One that is prepared needs no loader.
    pub(super) fn ask_for_source(&mut self, source: SceneSource) {
        let prepared = self.take_neighbour(&source);
        self.source = source.clone();
        self.await_scene();
        let Some(cast) = prepared else { return self.loader.request(source) };
        self.problem = None;
        self.bring(cast);
    }

    /// All scenes that the keys go through. Reads a folder.
    pub(crate) fn all_sources(&self) -> Vec<SceneSource> {
        self.list.all(&self.source)
    }

    /// Announces the scene that the user asked for until it is there.
    fn await_scene(&mut self) {
        let waits = self.shown_source() != Some(&self.source) && !self.is_as_directed();
        self.awaited = waits.then(|| format!("{} is being prepared", self.source.title()));
    }

    /// Uses the cells of regions from now on, or the whole tape everywhere.
    pub(crate) fn toggle_regions(&mut self) {
        let drawn = self.on_stage.as_ref().zip(self.mode());
        let drawn = drawn.map(|(cast, mode)| ((cast.id, mode), &cast.resources));
        let now = self.regions.toggle(drawn);
        self.tell(now.to_owned());
        self.revision += 1;
    }
}
