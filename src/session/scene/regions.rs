//! The regions of the shown scene: requests trees from the builder, and decides whether to wait for a late tree. See
//! [`super::region_builder`].

use std::time::Duration;

use super::prepared_scene::PreparedScene;
use super::region_builder::{BuiltTree, RegionBuilder, TreeJob, longest_wait};
use crate::faults::{self, Fault};
use crate::frame::Frame;
use crate::frame::orbit_controls::OrbitControls;
use crate::gpu::{BuiltRegions, CellUse, EdgeSamples, Mode, SceneResources};
use mariana_music::Sound;
use mariana_player::Moment;

/// A build up to this time is always awaited, even if a frame takes less time.
const WAITED_FOR: Duration = Duration::from_millis(17);

/// The identity of a frame: two frames with equal values look the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shown {
    pub moment: Moment,
    pub size: (u32, u32),
    pub edges: EdgeSamples,
    pub revision: u64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct DrawOptions<'a> {
    pub params: &'a [f32],
    /// Index of a named camera; `None` for the scene's own.
    pub camera: Option<usize>,
    pub orbit: OrbitControls,
    pub cells: CellUse,
    /// True if the scene has never had a tree. Its first build is cancelled at the time limit.
    pub is_untried: bool,
    pub fades_away: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct TreeRequest {
    id: u64,
    shown: Shown,
    /// True for the outgoing scene of a fade. Both frames of a fade may have the same moment and
    /// scene, but each needs its own tree: cameras and parameters differ.
    fades_away: bool,
}

pub(crate) struct SceneRegions {
    /// True if frames wait for every tree, even a slow one.
    pub(crate) insists: bool,
    builder: RegionBuilder<TreeRequest>,
    asked: Option<TreeRequest>,
    /// The compiled scene that is drawn without a tree, because drawing is faster than the build.
    pub(crate) late_for: Option<(u64, Mode)>,
    /// The compiled scene that was not faster without a tree.
    waited_for: Option<(u64, Mode)>,
    waited: bool,
    tree_time: Duration,
    /// The scene whose frame was abandoned because of its slow tree.
    pub(crate) given_up: Option<u64>,
}

impl SceneRegions {
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Ok(Self {
            insists: false,
            builder: RegionBuilder::start(wake)?,
            asked: None,
            late_for: None,
            waited_for: None,
            waited: false,
            tree_time: Duration::ZERO,
            given_up: None,
        })
    }

    /// Returns a frame of the scene `id` that can be drawn now, and its identity: `wanted` with `sound`, or an
    /// earlier frame whose tree is now finished. Returns `None` if no frame can be drawn.
    pub(super) fn drawable(
        &mut self,
        id: u64,
        mode: Mode,
        scene: &SceneResources,
        wanted: Shown,
        sound: Sound,
        draw_options: DrawOptions<'_>,
    ) -> Option<(Frame, Shown)> {
        let cells = self.uses_cells((id, mode), scene, draw_options.cells);
        scene.set_cells(cells, mode);
        let time = wanted.moment.song_time;
        let mut frame = Frame::with_params(scene.world(), time, sound, wanted.size, draw_options.params);
        frame.seen_by(scene.world(), draw_options.camera);
        let frame = frame.by_hand(scene.world(), draw_options.orbit);
        let request = scene.region_request(&frame);
        // No new tree is needed without cells, or if its inputs are unchanged. The first frame of a scene waits for its
        // tree, because the tree of another scene cannot be used.
        if !cells || scene.regions().is_some_and(|built| built.request == request) {
            self.waited = false;
            if self.asked.take().is_some() {
                self.builder.forget();
            }
            return Some((frame, wanted));
        }
        let tag = TreeRequest { id, shown: wanted, fades_away: draw_options.fades_away };
        if self.asked.is_some_and(|asked| asked.id != id) {
            // Cancel the tree of another scene, which is no longer needed and may be slow.
            self.builder.forget();
        }
        if self.asked != Some(tag) {
            let patience = match draw_options.is_untried {
                true if faults::lasts(Fault::SlowTree) => Duration::ZERO,
                true => longest_wait(),
                false => Duration::MAX,
            };
            let maker = scene.region_maker();
            self.builder.request(TreeJob { tag, frame, maker, request, patience });
            self.asked = Some(tag);
        }
        let BuiltTree { tag, mut frame, regions } = self.builder.poll()?;
        let TreeRequest { id: of, mut shown, fades_away } = tag;
        if self.asked == Some(tag) {
            self.asked = None;
        }
        if regions.is_none() {
            (self.given_up, self.asked) = (Some(of), None);
        }
        let is_of_use = (of, fades_away) == (id, draw_options.fades_away);
        let regions = regions.filter(|regions| is_of_use && regions.request.options.cells == cells)?;
        if shown.size != wanted.size {
            shown.size = wanted.size;
            frame = frame.resized(scene.world(), wanted.size);
        }
        scene.upload_regions(regions);
        self.waited = true;
        Some((frame, shown))
    }

    fn uses_cells(&self, drawn: (u64, Mode), scene: &SceneResources, change: CellUse) -> bool {
        let change = match change {
            CellUse::Never => CellUse::Never,
            _ if self.insists => CellUse::Always,
            _ if self.late_for == Some(drawn) => CellUse::Never,
            change => change,
        };
        scene.uses_cells(change, drawn.1)
    }

    pub(crate) fn have_come(&self) -> bool {
        self.builder.has_built()
    }

    /// Notes the time of a frame drawn with `built`. Returns `true` if the use of trees has changed.
    pub(super) fn record_frame_time(
        &mut self,
        drawn: (u64, Mode),
        built: &BuiltRegions,
        time: Duration,
        change: CellUse,
    ) -> bool {
        if drawn.1 != Mode::Compiled || change == CellUse::Never {
            return false;
        }
        let now = Some(drawn);
        if built.request.options.cells {
            self.tree_time = built.time;
            let late = self.waited && built.time > time.max(WAITED_FOR) && self.waited_for != now;
            if late {
                self.late_for = now;
            }
            return late;
        }
        // The frame was drawn without a tree. Use trees again if it took longer than the last tree.
        let no_sooner = self.late_for == now && time > self.tree_time;
        if no_sooner {
            (self.late_for, self.waited_for) = (None, now);
        }
        no_sooner
    }

    /// Returns the setting that turns cells off if they are in use now, and on otherwise.
    pub(super) fn toggle(&mut self, drawn: Option<(&PreparedScene, Mode)>, change: CellUse) -> CellUse {
        let used = match drawn {
            Some((scene, mode)) if !scene.resources.world().non_lipschitz => {
                self.uses_cells((scene.id, mode), &scene.resources, change)
            }
            _ => change != CellUse::Never,
        };
        self.late_for = None;
        if used { CellUse::Never } else { CellUse::Always }
    }

    pub(super) fn about(&self, drawn: (u64, Mode), last: Option<&BuiltRegions>, change: CellUse) -> String {
        match last {
            _ if change == CellUse::Never => "no regions".to_owned(),
            _ if self.late_for == Some(drawn) => {
                format!("no regions: building a tree takes {:.0} ms", milliseconds(self.tree_time))
            }
            Some(built) if !built.request.options.cells => "no regions: they would not save time".to_owned(),
            Some(built) => {
                let stats = &built.regions.stats;
                let time = milliseconds(built.time);
                format!("regions in {time:.1} ms, {} cells, {} tapes", stats.cells, stats.tapes)
            }
            None => "regions are being built".to_owned(),
        }
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;
    use crate::gpu::headless::Headless;
    use mariana_field::region::RegionPlan;
    use mariana_field::world::World;
    use mariana_music::Features;

    /// A tree of infinitely repeated balls depends on the camera's position.
    const TWO_CAMERAS: &str = "camera near { position = vec3(0, 2, -5)  target = vec3(0) }\n\
                               camera far { position = vec3(0, 2, -95)  target = vec3(0) }\n\
                               object balls { shape = sphere(mod(p, 4) - 2, 0.5) }";

    #[test]
    fn both_cameras_of_a_fade_within_one_scene_get_a_tree() {
        let context = Headless::new(false).unwrap();
        let world = World::parse("test", TWO_CAMERAS).unwrap();
        let (buffers, plan) = (world.tape_buffers(), RegionPlan::new(&world));
        let scene =
            SceneResources::upload(context.gl(), None, world.into(), buffers.into(), plan.into()).unwrap();
        let (woken, wakes) = channel();
        let mut regions = SceneRegions::start(move || woken.send(()).unwrap_or_default()).unwrap();
        let size = (16, 9);
        let shown = Shown { moment: Moment::default(), size, edges: EdgeSamples::Four, revision: 0 };
        let mut eyes = Vec::new();
        for (camera, fades_away) in [(0, true), (1, false)] {
            let (camera, orbit) = (Some(camera), OrbitControls::OFF);
            let draw_options = DrawOptions {
                params: &[],
                camera,
                orbit,
                cells: CellUse::Always,
                is_untried: false,
                fades_away,
            };
            let mut picture = || {
                let sound = Features::SILENCE.into();
                regions.drawable(7, Mode::Compiled, &scene, shown, sound, draw_options)
            };
            let (frame, of) = loop {
                if let Some(found) = picture() {
                    break found;
                }
                wakes.recv_timeout(Duration::from_secs(20)).expect("no request for the tree of this camera");
            };
            assert_eq!(of, shown);
            eyes.push(frame.camera.position.z);
        }
        assert_eq!(eyes, [-5.0, -95.0]);
    }
}
