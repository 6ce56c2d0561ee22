//! The subcommand `still`.

use std::cell::RefCell;
use std::ffi::OsString;
use std::path::PathBuf;
use std::rc::Rc;

use anyhow::bail;
use clap::Args;

use super::common::{
    CommonArguments, OneScene, SetArguments, ViewArguments, end_by_signals, finish_by_signals,
    refuse_a_terminal,
};
use super::controlled::draw_for_window;
use super::files::{Files, scene_of};
use super::light::LightArguments;
use super::parse::{blend_help, choice, parse_blend, parse_pixel, parse_seconds, parse_size};
use super::progress::Progress;
use super::projection::ProjectionArguments;
use super::show::{WantedShow, or_shipped, parse_show};
use crate::ending::asked_to_end;
use crate::export::paths::PathWatch;
use crate::export::still::{Blend, StillRequest, write_still};
use crate::export::video::{Preset, VideoPlace};
use crate::export::{Output, SceneChoice, Showing};
use mariana_field::world::BlendKind;

#[derive(Args)]
pub(super) struct StillArguments {
    /// The song, or '-' for standard input; if none is given, the built-in demo track. A .scene file is the scene to
    /// show
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The moment, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    at: f64,
    /// Use the size of a service; --size overrides it
    #[arg(long = "for", value_name = "PLACE", value_parser = choice::<VideoPlace>())]
    place: Option<VideoPlace>,
    /// Size of the whole picture in pixels, with both eyes of --stereo [default: 1280x720, or set by
    /// --for, --projection and --stereo]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,
    #[command(flatten)]
    projection: ProjectionArguments,
    #[command(flatten)]
    light: LightArguments,
    /// The PNG, JPEG or WebP file to write, or '-' for a PNG on standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    scene: OneScene,
    /// Leave out the sky, so that the image can be laid over another: in PNG and WebP, for scenes whose sky has no
    /// color
    #[arg(long, conflicts_with = "view")]
    alpha: bool,
    /// Show this moment of a show instead of a scene: 'auto' for a show that follows the song, or a .show file
    #[arg(long, value_name = "AUTO-OR-FILE", value_parser = parse_show, conflicts_with_all = ["alpha", "into", "scene"])]
    show: Option<WantedShow>,
    /// Show a blend of the scene with this second scene
    #[arg(long, value_name = "SCENE", allow_hyphen_values = true, conflicts_with = "alpha")]
    into: Option<OsString>,
    #[arg(long, value_name = "KIND:FRACTION", help = blend_help(), requires = "into", default_value = "melt:0.5", value_parser = parse_blend)]
    blend: (BlendKind, f32),
    /// Draw the path of the ray through this pixel over the image, with sections that show its steps, its shadow ray
    /// and its occlusion; 0,0 is the upper left pixel
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, conflicts_with_all = ["show", "into", "alpha", "projection", "stereo"], allow_hyphen_values = true)]
    ray: Option<(u32, u32)>,
    /// Draw a thumbnail for a window of Mariana, at the lowest priority, and end when standard input ends
    #[arg(long, hide = true)]
    controlled: bool,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    view: ViewArguments,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: StillArguments) -> anyhow::Result<()> {
    let common = arguments.common;
    common.start_log();
    match arguments.light.samples() {
        Some(_) => finish_by_signals(),
        None => end_by_signals(),
    }
    if arguments.controlled {
        draw_for_window()?;
    }
    if arguments.light.samples().is_some() && arguments.ray.is_some() {
        bail!(
            "--light path follows many rays through a pixel, and --ray draws one: leave out --ray or --light"
        );
    }
    let output = Output::from(arguments.output);
    refuse_a_terminal(&output, "mariana still -o - > frame.png")?;
    let (kind, fraction) = arguments.blend;
    let into = arguments.into.as_deref().map(scene_of).transpose()?;
    let (song, scene) = Files::of(arguments.files)?.song_and_scene()?;
    let projection = arguments.projection.projection()?;
    let request = StillRequest {
        song,
        at: arguments.at,
        size: arguments.size.unwrap_or(Preset::of(arguments.place).size_in(&projection)),
        gain: common.gain.unwrap_or_default(),
        output,
        scene: arguments.light.apply(SceneChoice {
            view: arguments.view.view,
            alpha: arguments.alpha,
            projection,
            ..arguments.scene.choose(scene, &common)?
        })?,
        show: arguments.show.flatten().map(|source| Showing::Show(source, or_shipped(Vec::new()))),
        blend: into.map(|into| Blend { into, kind, fraction }),
        set: arguments.set.set,
        ray: arguments.ray,
        shutter: arguments.light.shutter(),
    };
    let Some(samples) = arguments.light.samples() else {
        return Ok(write_still(&request, PathWatch::default())?);
    };
    let progress = Rc::new(RefCell::new(Progress::begin(false, "path")));
    let shown = progress.clone();
    let reach = Box::new(move |done: f64| {
        shown.borrow_mut().reach(done as u64, Some(samples));
        asked_to_end().is_none()
    });
    let written = write_still(&request, PathWatch { reach, ..PathWatch::default() });
    progress.borrow_mut().end();
    Ok(written?)
}
