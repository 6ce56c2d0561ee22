//! Draws the scene on the stage, each picture in as many goes as it takes, and takes back a scene that is too
//! expensive.

use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::fading::Begun;
use super::mixing::Place;
use super::regions::{Shown, Wishes};
use super::scenery::Pictured;
use super::{Cast, FirstTree, SceneStage};
use crate::config::SdfChoice;
use crate::gpu::edge_samples::EdgeSamples;
use crate::gpu::error::GpuError;
use crate::gpu::program::Program;
use crate::gpu::renderer::{Progress, Renderer};
use crate::gpu::scene_program::Mode;
use crate::gpu::scene_resources::BuiltRegions;
use crate::limits::LIMITS;
use crate::view::ViewChoice;
use crate::view::legend::LegendPicture;
use mariana_music::Sound;
use mariana_player::Moment;

/// What is told of a scene that is not shown because of its tree.
const TREE_TOO_LONG: &str = "its tree of regions would take too long for each picture";

/// The picture that should be shown next.
pub(crate) struct WantedPicture {
    /// The moment of the song.
    pub moment: Moment,
    /// What it sounds like.
    pub sound: Sound,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Width of the window for each of its height.
    pub aspect: f64,
    /// The shaders' `frame_quality`.
    pub quality: f32,
    /// Further samples of pixels at edges.
    pub edges: EdgeSamples,
    /// Whether the song runs.
    pub runs: bool,
}

/// A picture that was finished.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawn {
    /// What it shows.
    pub shown: Shown,
    /// How long it took.
    pub spent: Duration,
}

/// A picture that was begun.
pub(super) struct Making {
    /// The scene, its mode and its view.
    of: (u64, Mode, Option<ViewChoice>),
    /// Where the scene is found that is drawn first, because it fades away under it; none if that is done.
    under: Option<Place>,
    program: Rc<Program>,
    legend: Option<Arc<LegendPicture>>,
    shown: Shown,
    /// How long it will take, in seconds, as far as is known.
    seconds: Option<f64>,
    /// How long what lies under it took.
    spent: Duration,
}

impl SceneStage {
    /// Draws the scene on the stage as it was at a moment for which its regions are built, or continues a picture
    /// that was begun. None if no picture was finished. What `picture` needs is requested.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(crate) fn draw(
        &mut self,
        renderer: &mut Renderer,
        picture: WantedPicture,
    ) -> Result<Option<Drawn>, GpuError> {
        let shown = self.on_stage.as_ref().map(|cast| cast.id).zip(self.mode());
        let Some((id, mode)) = shown else { return Ok(None) };
        let now = (id, mode, self.views.choice());
        let (size, edges) = (picture.size, picture.edges);
        let is_of_use =
            |making: &Making| (making.shown.size, making.shown.edges) == (size, edges) && making.of == now;
        if !self.making.as_ref().is_some_and(is_of_use) {
            if self.making.take().is_some_and(|making| making.of.0 != id) {
                self.awaited_edit.note_picture(true);
            }
            self.end_fade(&picture.moment);
        }
        let drawn = loop {
            if self.making.is_none() {
                self.making = self.begin(renderer, now, &picture)?;
            }
            let Some(Making { under, program, .. }) = &self.making else { return Ok(None) };
            let (under, cast) = (*under, under.map_or(self.on_stage.as_ref(), |place| self.cast_at(place)));
            let Some(cast) = cast else { return Ok(None) };
            let progress = renderer.go_on(&cast.resources, program, self.length_of_go())?;
            let Some(making) = &mut self.making else { return Ok(None) };
            match (progress, under) {
                (Progress::Finished { spent }, Some(_)) => {
                    renderer.keep_light()?;
                    self.mixing.note_light(spent);
                    self.making = None;
                }
                (Progress::Finished { spent }, None) => {
                    break Drawn { shown: making.shown, spent: making.spent + spent };
                }
                (Progress::Going { seconds }, under) => {
                    making.seconds = seconds.filter(|_| under.is_none());
                    return Ok(None);
                }
            }
        };
        self.mixing.end();
        self.awaited_edit.note_picture(false);
        if let Some(Making { legend, .. }) = self.making.take() {
            renderer.put_legend(legend.as_deref())?;
        }
        self.pictured = self.on_stage.as_ref().map(|cast| cast.id);
        self.seen_picture = self.begun_picture.take();
        self.pictures_seen += 1;
        self.pictures_took = [drawn.spent, self.pictures_took[0]];
        if self.fading.goes_on_by_itself() {
            self.revision += 1;
        }
        self.let_go_of_the_one_before(&drawn.shown.moment);
        Ok(Some(drawn))
    }

    /// Begins a picture of the scene on the stage, or first of what fades away under it. None if its regions are
    /// awaited.
    fn begin(
        &mut self,
        renderer: &mut Renderer,
        of: (u64, Mode, Option<ViewChoice>),
        picture: &WantedPicture,
    ) -> Result<Option<Making>, GpuError> {
        let WantedPicture { moment, size, aspect, quality, edges, .. } = *picture;
        let wanted = Shown { moment, size, edges, revision: self.revision };
        let (wanted, sound) = self.mixing.resume(wanted, picture.sound.clone());
        let time = wanted.moment.song_time;
        let under = self.under(&wanted.moment);
        let lit = self.mixing.lit().filter(|_| under.is_some());
        // What fades away is drawn first.
        let beneath = under.as_ref().filter(|_| lit.is_none());
        if beneath.is_some() {
            self.mixing.begin(wanted, sound.clone());
            self.fading.announce();
        }
        let place = beneath.map_or(Place::OnStage, |under| under.place);
        // By fields, so that the regions can change meanwhile.
        let cast = place.find(self.on_stage.as_ref(), self.before.as_ref(), &self.mixing);
        let Some((cast, mode)) = cast.and_then(|cast| Some((cast, self.mode_of(cast)?))) else {
            return Ok(None);
        };
        let (params, camera) = match beneath {
            Some(under) => self.staged_under(cast, under, time),
            None => self.staged(cast, time),
        };
        let hand = beneath.map_or_else(|| self.hand_at(time), |under| self.hand_under(under, time));
        self.shown_hand = hand;
        let is_untried = cast.tree == FirstTree::Untried;
        let fades_away = beneath.is_some();
        let wishes = Wishes { params: &params, camera, hand, is_untried, fades_away };
        let drawable = self.regions.drawable((cast.id, mode), &cast.resources, wanted, sound, wishes);
        let Some((frame, shown)) = drawable else {
            if self.regions.has_given_up(of.0) {
                self.take_back(TREE_TOO_LONG);
            }
            return Ok(None);
        };
        if under.is_some() && shown != wanted {
            // An older tree has come; both scenes are drawn at one moment.
            return Ok(None);
        }
        let frame = frame.in_window(cast.resources.world(), aspect, quality);
        let making = |program| Making {
            of,
            under: beneath.map(|under| under.place),
            program,
            legend: None,
            shown,
            seconds: None,
            spent: lit.unwrap_or_default(),
        };
        if beneath.is_some() {
            renderer.set_edge_samples(shown.edges);
            renderer.begin_light(&frame, &cast.resources)?;
            return Ok(cast.program(mode).cloned().map(making));
        }
        self.own_pitch = frame.own_pitch();
        match &under {
            Some(under) if under.stay.is_some() => renderer.set_fade(Some(under.share)),
            _ => {
                let (now, runs, is_live) = (Instant::now(), picture.runs, under.is_some());
                self.fading.begin_picture(renderer, Begun { now, moment: &wanted.moment, runs, is_live });
            }
        }
        // Only now: another number of samples leaves no light of the last picture to be kept.
        renderer.set_edge_samples(shown.edges);
        let begun = match self.views.program(cast, mode) {
            None => {
                renderer.begin(&frame, &cast.resources)?;
                cast.program(mode).cloned().map(making)
            }
            Some((view, mode, program)) => {
                let legend = self.views.begin(renderer, &frame, (cast, mode), view)?;
                Some(Making { legend, ..making(program) })
            }
        };
        self.begun_picture = Some(Pictured::of(cast, frame));
        Ok(begun)
    }

    /// Whether a picture was begun and is not finished.
    pub(crate) fn is_drawing(&self) -> bool {
        self.making.is_some()
    }

    /// How long the picture that was begun will take, in seconds, once that is known.
    pub(crate) fn seconds_of_picture(&self) -> Option<f64> {
        self.making.as_ref()?.seconds
    }

    /// Gives up the picture that was begun, because the next one is to be drawn in another way.
    pub(crate) fn give_picture_up(&mut self) {
        self.making = None;
    }

    /// Takes a scene from the stage whose first picture would take too long, and brings the previous one back, if there
    /// is one. If a program of the other mode is being made, the scene is drawn in that mode. `why` begins a sentence.
    pub(crate) fn take_back(&mut self, why: &str) {
        let Some((mode, before)) = self.mode().zip(self.before.take()) else { return };
        let Some(mut dear) = self.on_stage.replace(before) else { return };
        self.making = None;
        self.fading.cut();
        self.revision += 1;
        let other_way = mode == Mode::Interpreted
            && dear.compilable
            && (dear.compiled.is_some() || self.in_the_making(dear.id, Mode::Compiled));
        if other_way && self.choice != SdfChoice::Interpreted {
            (dear.interpreter, dear.interpreted) = (None, None);
            self.coming = Some(dear);
            return self.recast();
        }
        self.forget_obsolete();
        self.recast();
        self.tell_dear(&dear, why);
    }

    /// Takes the first tree of the scene that is coming, or the fact that there is none.
    pub(super) fn take_tree(&mut self, id: u64, tree: Option<Arc<BuiltRegions>>) {
        let is_first = self.on_stage.is_none();
        if self.ahead.casts().any(|cast| cast.id == id) {
            return self.take_tree_ahead(id, tree);
        }
        let Some(cast) = self.coming.as_mut().filter(|cast| cast.id == id) else { return };
        if let Some(tree) = tree {
            cast.resources.take_regions(tree);
            cast.tree = FirstTree::There;
            return;
        }
        // The first scene is drawn however long it takes: there is nothing else to show.
        cast.tree = FirstTree::TooLong;
        if is_first {
            return;
        }
        let needs_tree = cast.resources.world().steep || self.choice == SdfChoice::Interpreted;
        let has_program = cast.compiled.is_some() || self.in_the_making(id, Mode::Compiled);
        if needs_tree || !has_program {
            if let Some(dear) = self.coming.take() {
                self.forget_obsolete();
                self.tell_dear(&dear, TREE_TOO_LONG);
            }
            return;
        }
        if let Some(cast) = &mut self.coming {
            (cast.interpreter, cast.interpreted) = (None, None);
        }
        self.regions.do_without(id);
    }

    fn take_tree_ahead(&mut self, id: u64, tree: Option<Arc<BuiltRegions>>) {
        let Some(tree) = tree else { return self.ahead.leave_where(|cast| cast.id == id) };
        if let Some(cast) = self.cast_mut(id) {
            cast.resources.take_regions(tree);
            cast.tree = FirstTree::There;
        }
    }

    /// Lets the scene that goes fade into the one that comes. Views stand for numbers and are cut.
    pub(super) fn fade_if_it_can(&mut self) {
        if self.fades_with_both() {
            self.fading.cut();
        } else if self.views.choice().is_none() {
            self.fading.want();
        }
    }

    /// Lets the picture that was held fade into what comes next, for so many seconds. Views, and what a show mixes by
    /// itself, are cut.
    pub(crate) fn fade_from_held(&mut self, seconds: f64) {
        if self.views.choice().is_some() || self.fades_with_both() {
            self.fading.cut();
        } else {
            self.fading.release(seconds);
        }
        self.revision += 1;
    }

    /// The show holds another picture than before: the last one.
    pub(crate) fn hold_anew(&mut self) {
        self.fading.hold_anew();
    }

    /// Mixes this share of the picture that a show holds into what comes next, or none of it any more.
    pub(crate) fn mix_held(&mut self, share: Option<f32>) {
        if self.views.choice().is_none() {
            self.fading.tell(share);
        }
        self.revision += 1;
    }

    /// The share of a picture that was held in the last one.
    pub(crate) fn share_held(&self) -> f32 {
        self.fading.share_held()
    }

    /// Whether the next picture is the first one of a fade.
    pub(crate) fn begins_fade(&self) -> bool {
        self.fading.is_to_begin()
    }

    fn tell_dear(&mut self, dear: &Cast, why: &str) {
        let heading =
            format!("{} is too much for this machine; the last good scene stays", dear.source.title());
        // One line each: a small window has no room for long ones.
        let text = format!(
            "{why}; the limit is {:.0} s\n{}\nuse fewer or simpler parts, or make the window smaller",
            LIMITS.picture_seconds_max,
            what_is_dear(dear)
        );
        tracing::warn!("{heading}: {text}");
        self.refuse(dear.source.clone(), heading, text);
    }
}

/// Why a scene's pixels are so expensive.
fn what_is_dear(cast: &Cast) -> String {
    let world = cast.resources.world();
    let mut what = vec![format!("its distance has {} clauses", cast.resources.buffers().cost.distance)];
    if world.steep {
        what.push("its formula is not a distance, so rays take small steps".to_owned());
    }
    if world.scene.lights.len() > 1 {
        what.push(format!("it has {} lights", world.scene.lights.len()));
    }
    if world.traits.mirrors {
        what.push("it has mirrors".to_owned());
    }
    what.join(", ")
}
