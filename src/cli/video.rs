//! The subcommand `video`.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{ArgAction, Args};

use super::common::{
    CommonArguments, DEFAULT_SCENE, SetArguments, ViewArguments, end_by_signals, end_by_signals_and,
    refuse_a_terminal,
};
use super::controlled::Controlled;
use super::files::{Files, scene_of};
use super::light::LightArguments;
use super::parse::{choice, parse_duration, parse_fps, parse_part, parse_seconds, parse_size};
use super::progress::Progress;
use super::projection::ProjectionArguments;
use super::show::{WantedShow, or_shipped, parse_show};
use crate::export::output::is_folder;
use crate::export::print::counted;
use crate::export::video::{
    Codec, EncodingQuality, Preset, VideoPart, VideoPlace, VideoRequest, Written, join_parts, write_video,
};
use crate::export::{Output, SceneChoice, Showing, print_line};
use crate::gpu::edge_samples::EdgeSamples;
use crate::scenes::is_scene_file;
use mariana_player::lyrics::Lyrics;

#[derive(Args)]
pub(super) struct VideoArguments {
    /// The song, or '-' for standard input; if none is given, the built-in demo track. A .scene file is the scene to
    /// show
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Use the size, rate and length of a service; other flags override them
    #[arg(long = "for", value_name = "PLACE", value_parser = choice::<VideoPlace>())]
    place: Option<VideoPlace>,
    /// Start, as 80 or 1:20.5
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = parse_seconds, allow_negative_numbers = true)]
    start: f64,
    /// Length, as 80 or 1:20.5 [default: to the end, or set by --for]
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Frames per second, such as 60, 23.976 or 30000/1001 [default: 30, or set by --for]
    #[arg(long, value_parser = parse_fps, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Size of the whole picture in pixels, with both eyes of --stereo [default: 1280x720, or set by
    /// --for, --projection and --stereo]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,
    #[command(flatten)]
    projection: ProjectionArguments,
    #[command(flatten)]
    light: LightArguments,
    /// Video codec [default: chosen by the extension of the file's name]
    #[arg(long, value_name = "CODEC", value_parser = choice::<Codec>())]
    codec: Option<Codec>,
    /// Quality of the encoding
    #[arg(long, value_name = "HOW", default_value = "high", value_parser = choice::<EncodingQuality>())]
    quality: EncodingQuality,
    /// Draw faster, with coarser edges, for a first look
    #[arg(long)]
    draft: bool,
    /// Show the song's title and artist during the first five seconds, or less in a short video
    #[arg(long, conflicts_with_all = ["projection", "stereo"])]
    title_card: bool,
    /// Show the lyrics while they are sung: from FILE, or from song.lrc or the tags of the song
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, conflicts_with_all = ["projection", "stereo"])]
    lyrics: Option<Option<PathBuf>>,
    /// Dim flashes if there are more than three a second, as WCAG 2.3.1 requires
    #[arg(long, value_name = "ON-OFF", default_value = "on", value_parser = choice::<bool>(), action = ArgAction::Set)]
    flash_limiter: bool,
    /// The scene to show, as for 'still'; give several with the time in the song at which each begins, such as --scene
    /// orb --scene city@1:20 [default: speakers]
    #[arg(long, value_name = "SCENE[@TIME]", allow_hyphen_values = true)]
    scene: Vec<OsString>,
    /// Leave out the sky, so that the video can be laid over another video: in webm, mov, mkv, webp and PNGs, for
    /// scenes whose sky has no color
    #[arg(long, conflicts_with_all = ["codec", "view", "show"])]
    alpha: bool,
    /// A show instead of scenes: 'auto' for a show that follows the song with the scenes of --scene, or with all
    /// shipped scenes; 'demo' for the demo track's show; or a .show file
    #[arg(long, value_name = "AUTO-OR-FILE", value_parser = parse_show)]
    show: Option<WantedShow>,
    #[command(flatten)]
    set: SetArguments,
    /// The video to write (mp4, mkv, mov, webm, or gif and webp without sound), a folder ending in '/' for numbered
    /// PNGs, or '-' for y4m without sound on standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Render one part of the video, such as 3/8, without sound: for several machines. Continues an interrupted part
    #[arg(long, value_name = "NUMBER/PARTS", value_parser = parse_part)]
    part: Option<VideoPart>,
    /// Join parts into the video without encoding again, and add the sound of FILE
    #[arg(long, value_name = "PART", num_args = 1.., conflicts_with = "part")]
    join: Vec<PathBuf>,
    /// Print only errors
    #[arg(short, long)]
    quiet: bool,
    /// Render for a window of Mariana, at a low priority: print reports as JSON on standard output, obey the lines
    /// 'pause' and 'continue' on standard input, end when standard input ends, and never replace a file
    #[arg(long, hide = true)]
    controlled: bool,
    #[command(flatten)]
    view: ViewArguments,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: VideoArguments) -> anyhow::Result<()> {
    let common = arguments.common;
    common.start_log();
    if arguments.part.is_some() && !is_folder(&arguments.output) {
        end_by_signals_and("run the same command again to continue the part");
    } else {
        end_by_signals();
    }
    let controlled = arguments.controlled.then(Controlled::begin).transpose()?;
    let output = Output::from(arguments.output);
    refuse_a_terminal(&output, "mariana video -o - | mpv -")?;
    let Files { songs, scene } = Files::of(arguments.files)?;
    let (song, _) = Files { songs, scene: None }.song_and_scene()?;
    let preset = Preset::of(arguments.place);
    let show = arguments.show.flatten();
    let mut scenes = Vec::new();
    for (from, scene) in timed(&arguments.scene, scene.as_deref(), show.is_some())? {
        scenes.push((from, scene_of(&scene)?));
    }
    let showing = match show {
        Some(show) => Showing::Show(show, or_shipped(scenes.into_iter().map(|(_, scene)| scene).collect())),
        None => Showing::Scenes(scenes),
    };
    let scene = common.scene(OsStr::new(DEFAULT_SCENE))?;
    let lyrics = arguments.lyrics.map(|file| match file {
        Some(file) => Lyrics::read(&file),
        None => Lyrics::of_song(&song),
    });
    let lyrics = lyrics.transpose()?;
    let projection = arguments.projection.projection()?;
    let request = VideoRequest {
        song,
        start: arguments.start,
        duration: arguments.duration.or(preset.duration),
        fps: arguments.fps.unwrap_or(preset.fps),
        size: arguments.size.unwrap_or(preset.size_in(&projection)),
        gain: common.gain.unwrap_or_default(),
        limit_flashes: arguments.flash_limiter,
        output,
        keeps_others: arguments.controlled,
        showing,
        scene: arguments.light.apply(SceneChoice {
            view: arguments.view.view,
            alpha: arguments.alpha,
            projection,
            edges: if arguments.draft { EdgeSamples::Two } else { scene.edges },
            ..scene
        })?,
        set: arguments.set.set,
        codec: arguments.codec,
        quality: arguments.quality,
        sound: preset.sound,
        sound_rate: preset.sound_rate,
        title_card: arguments.title_card,
        lyrics,
        seam: preset.seam,
        shutter: arguments.light.shutter(),
        part: arguments.part,
    };
    if let Some(controlled) = controlled {
        let written = write_video(&request, &mut |done, of| controlled.reach(done, of))?;
        return controlled.finish(&written);
    }
    let mut progress = Progress::begin(arguments.quiet, "frame");
    let written = match &arguments.join[..] {
        [] => write_video(&request, &mut |done, of| progress.reach(done, of)),
        parts => join_parts(&request, parts),
    };
    progress.end();
    let Written { frames, .. } = written?;
    if arguments.quiet || request.output == Output::Standard {
        return Ok(());
    }
    let frames = counted(frames, "frame");
    Ok(print_line(&format!("{frames} in {}", request.output))?)
}

/// Returns the scenes with their start times in seconds, sorted by time. If the director chooses among the scenes
/// (`is_choice`), times are ignored.
fn timed(flags: &[OsString], file: Option<&Path>, is_choice: bool) -> anyhow::Result<Vec<(f64, OsString)>> {
    let mut scenes = flags.iter().map(|flag| with_time(flag)).collect::<anyhow::Result<Vec<_>>>()?;
    if is_choice {
        return Ok(scenes.into_iter().chain(file.map(|file| (0.0, file.into()))).collect());
    }
    if let (Some(file), [(_, first), ..]) = (file, &scenes[..]) {
        bail!(
            "two scenes were given, {} and {}: give each scene with --scene and a start time",
            first.display(),
            file.display()
        );
    }
    if scenes.is_empty() {
        let scene = file.map_or(OsStr::new(DEFAULT_SCENE), Path::as_os_str);
        scenes.push((0.0, scene.to_owned()));
    }
    scenes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    if let Some([(time, first), (_, second)]) = scenes.array_windows().find(|[(a, _), (b, _)]| a == b) {
        bail!(
            "the scenes {} and {} both begin at {time} s: give one of them a time, such as --scene {}@1:20",
            first.display(),
            second.display(),
            second.display()
        );
    }
    Ok(scenes)
}

/// Splits a flag into a start time and a scene. Does not split the path of a scene at an @.
fn with_time(flag: &OsStr) -> anyhow::Result<(f64, OsString)> {
    let path = Path::new(flag);
    match flag.to_str().and_then(|text| text.rsplit_once('@')) {
        Some((scene, time)) if !path.exists() && !is_scene_file(path) => match parse_seconds(time) {
            Ok(seconds) => Ok((seconds, scene.into())),
            Err(problem) => bail!("--scene {}: {problem}", flag.display()),
        },
        _ => Ok((0.0, flag.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(flags: &[&str], file: Option<&str>) -> Result<Vec<(f64, String)>, String> {
        let flags: Vec<OsString> = flags.iter().map(Into::into).collect();
        let scenes = timed(&flags, file.map(Path::new), false).map_err(|error| error.to_string())?;
        Ok(scenes.into_iter().map(|(from, scene)| (from, scene.to_string_lossy().into_owned())).collect())
    }

    #[test]
    fn scenes_are_in_the_order_of_their_times() {
        let wanted = vec![(0.0, "orb".to_owned()), (80.5, "city".to_owned())];
        assert_eq!(names(&["city@1:20.5", "orb"], None), Ok(wanted));
        assert_eq!(names(&[], None), Ok(vec![(0.0, "speakers".into())]));
        assert_eq!(names(&[], Some("my.scene")), Ok(vec![(0.0, "my.scene".into())]));
    }

    #[test]
    fn two_scenes_at_one_time_are_refused() {
        assert!(names(&["city", "orb"], None).unwrap_err().contains("both begin at 0 s"));
        assert!(names(&["city@3"], Some("my.scene")).unwrap_err().contains("my.scene"));
    }
}
