//! The command without a subcommand: plays and shows music in a window.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgAction, Args};

use super::common::{CommonArguments, DEFAULT_SCENE, OneScene, ViewArguments};
use super::files::{Files, is_standard, song_or_demo};
use super::frame_options::StagingArguments;
use super::parse::{choice, number, parse_fade, parse_fps, parse_percent, parse_size};
use super::projection::ProjectionArguments;
use super::setting_flags::SettingFlags;
use super::show::{WantedShow, parse_show};
use crate::config::{
    Choice, Choices, ControllerSettings, Folders, FollowChoice, LastShow, ListenChoice, Memory, PlaySettings,
    SettingsFile,
};
use crate::demo_track::DEMO_TRACK;
use crate::export::{SceneChoice, print_line, print_message};
use crate::limits;
use crate::program_cache::ProgramCache;
use crate::scenes::SceneSource;
use crate::session::Prepared;
use crate::shell;
use crate::show::ShowSource;
use mariana_control::limits::{OSC_RATE_MAX, OSC_RATE_MIN};
use mariana_control::osc::Place;
use mariana_player::limits::LATENCY_MS_MAX;
use mariana_player::playlist::{Opened, Playlist};
use mariana_player::track::Repeat;
use mariana_remote::RemotePlace;

#[derive(Args)]
pub(super) struct PlayArguments {
    /// Songs, folders and lists (m3u, m3u8, pls, cue), and a .scene to show; '-' is standard input. Without a song the
    /// built-in demo track plays
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Show the sound of a microphone or another input, instead of a song
    #[arg(long, conflicts_with_all = ["files", "system", "silent", "once"])]
    mic: bool,
    /// Show the sound that the computer plays, instead of a song
    #[arg(long, conflicts_with_all = ["files", "silent", "once"])]
    system: bool,
    /// Play the tracks in random order
    #[arg(long)]
    shuffle: bool,
    /// Tracks to repeat
    #[arg(long, value_name = "WHAT", default_value = "all", value_parser = choice::<Repeat>())]
    repeat: Repeat,
    /// Output device, or input with --mic and --system: an id or name from 'mariana devices', a part of an id or name,
    /// or 'default' for the system's device [default: the last choice in the window, at first the system's device]
    #[arg(long, value_name = "NAME", conflicts_with = "silent")]
    device: Option<String>,
    /// Play without sound, in real time
    #[arg(long)]
    silent: bool,
    /// Exit after the last track instead of starting over
    #[arg(long, conflicts_with = "repeat")]
    once: bool,
    /// Volume at the start, in percent [default: the last volume, at first 100]
    #[arg(long, value_name = "PERCENT", value_parser = parse_percent, allow_negative_numbers = true)]
    volume: Option<u8>,
    /// Additional delay of the sound, beyond the delay that the device reports; negative for less [default: the last
    /// delay set with the keys [ and ]]
    #[arg(long, value_name = "MS", value_parser = number(-LATENCY_MS_MAX, LATENCY_MS_MAX, "milliseconds"), allow_negative_numbers = true)]
    latency: Option<f64>,
    /// Maximum frames per second [default: the monitor's rate]
    #[arg(long, value_name = "FPS", value_parser = parse_fps, allow_negative_numbers = true)]
    fps_cap: Option<f64>,
    /// Duration of the fade between scenes with N and P, in seconds; 0 cuts
    #[arg(long, value_name = "SECONDS", default_value = "0.5", value_parser = parse_fade, allow_negative_numbers = true)]
    fade: f64,
    /// Start in full screen
    #[arg(long)]
    fullscreen: bool,
    /// Show only requested panels and errors over the image: no hints, messages or bar
    #[arg(long)]
    clean: bool,
    /// Size of the window in pixels [default: the last size, at first 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,
    /// Let a show change the scenes: 'auto' to follow the song, 'off', or a .show file [default: the last choice in the
    /// window, at first auto unless a scene is named]
    #[arg(long, value_name = "AUTO-OFF-FILE", value_parser = parse_show)]
    show: Option<WantedShow>,
    /// Receive OSC messages on this port from this computer only, or on a network address given as ADDRESS:PORT;
    /// docs/osc.md lists the messages
    #[arg(long, value_name = "PORT")]
    osc: Option<Place>,
    /// Send the features of the sound to another program or to lights, by OSC
    #[arg(long, value_name = "HOST:PORT")]
    osc_send: Option<Place>,
    /// OSC messages sent per second
    #[arg(long, value_name = "HZ", default_value = "30", value_parser = number(OSC_RATE_MIN, OSC_RATE_MAX, "times a second"), allow_negative_numbers = true, requires = "osc_send")]
    osc_rate: f64,
    /// Listen to MIDI devices; key J maps them
    #[arg(long, value_name = "ON-OFF", default_value = "on", value_parser = choice::<bool>(), action = ArgAction::Set)]
    midi: bool,
    /// Serve a page that lets phones on the network control the show, on this port, or only on a network address
    /// given as ADDRESS:PORT. Key J shows the code to scan; docs/remote.md describes the protection
    #[arg(long, value_name = "PORT")]
    remote: Option<RemotePlace>,
    /// Do not continue the last show, and do not save this show; choices from the settings panel still apply
    #[arg(long)]
    new: bool,
    /// Open a window even if Mariana is running. Without options, the running one opens the files
    #[arg(long)]
    new_window: bool,
    /// Prepare the next and the previous scene while the current scene is shown
    #[arg(long, value_name = "ON-OFF", default_value = "on", overrides_with = "prepare_ahead", value_parser = choice::<bool>(), action = ArgAction::Set)]
    prepare_ahead: bool,
    /// Keep the driver's compiled programs in the user's cache folder
    #[arg(long, value_name = "ON-OFF", default_value = "on", value_parser = choice::<bool>(), action = ArgAction::Set)]
    program_cache: bool,
    /// Print the available OpenGL version, and exit
    #[arg(long)]
    gl_info: bool,
    #[command(flatten)]
    chosen: SettingFlags,
    #[command(flatten)]
    frame_options: StagingArguments,
    #[command(flatten)]
    scene: OneScene,
    #[command(flatten)]
    view: ViewArguments,
    #[command(flatten)]
    projection: ProjectionArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Scale factors at which a window is still readable.
const SCALE_FACTORS: std::ops::RangeInclusive<f64> = 0.1..=20.0;

/// Refuses scale factors at which winit or egui panics. On X11, winit reads the scale factor from a variable.
fn check_scale_factor() -> anyhow::Result<()> {
    const NAME: &str = "WINIT_X11_SCALE_FACTOR";
    let value = std::env::var(NAME).unwrap_or_default();
    let is_number = value.parse().is_ok_and(|factor: f64| SCALE_FACTORS.contains(&factor));
    if value.is_empty() || value.eq_ignore_ascii_case("randr") || is_number {
        return Ok(());
    }
    let (least, most) = (SCALE_FACTORS.start(), SCALE_FACTORS.end());
    anyhow::bail!(
        "the variable {NAME} is '{value}': set it to a number from {least} to {most} or to randr, or unset it"
    )
}

pub(super) fn run(arguments: PlayArguments) -> anyhow::Result<()> {
    arguments.common.start_log();
    check_scale_factor()?;
    if arguments.frame_options.output.as_deref() == Some("list") {
        return list_monitors();
    }
    if is_plain() && hands_over(&arguments.files) {
        print_message("the running Mariana opens this; --new-window opens another window");
        return Ok(());
    }
    shell::run(prepare(arguments, Folders::of_user())?)
}

/// True for a start without options, as by a double click on a song.
fn is_plain() -> bool {
    let is_option = |argument: OsString| argument.as_encoded_bytes().starts_with(b"-");
    !std::env::args_os().skip(1).any(is_option) && std::env::var_os("XSCREENSAVER_WINDOW").is_none()
}

/// Lets a running instance open the files. Returns false without such an instance.
fn hands_over(files: &[PathBuf]) -> bool {
    let absolute: Option<Vec<PathBuf>> =
        files.iter().map(|file| std::path::absolute(file).ok().filter(|file| file.exists())).collect();
    absolute.is_some_and(|files| shell::hand_over(&files))
}

pub(super) fn prepare(arguments: PlayArguments, folders: Folders) -> anyhow::Result<Prepared> {
    let system = arguments.system.then_some(ListenChoice::System);
    let listen = arguments.mic.then_some(ListenChoice::Microphone).or(system);
    // An error in the settings file is reported when the window opens.
    let (file, trouble) = SettingsFile::among(&folders);
    let choices = choices_of(&arguments, &file.settings().choices);
    let common = arguments.common;
    let last = match arguments.new {
        true => LastShow::default(),
        false => file.settings().last_show.clone().unwrap_or_default(),
    };
    arguments.frame_options.check()?;
    let repeat = if arguments.once { Repeat::Off } else { arguments.repeat };
    let files = Files::of(arguments.files)?;
    let names_scene = files.scene.is_some() || !arguments.scene.is_default();
    let projection = arguments.projection.projection()?;
    let goes_on = files.songs.is_empty() && !arguments.new && !arguments.once && choices.last_tracks;
    let last_tracks = file.last_tracks().filter(|_| goes_on && listen.is_none());
    let resumed = last_tracks.and_then(|list| resume_list(list, &last, repeat, arguments.shuffle));
    let begin_at = resumed.as_ref().map_or(0.0, |(_, begin_at)| *begin_at);
    let tracks = match (listen, resumed) {
        (Some(_), _) => None,
        (None, Some((opened, _))) => Some(opened),
        (None, None) => Some(open_songs(&files.songs, repeat, arguments.shuffle)?),
    };
    // Import a shader after the songs are opened, because this writes files.
    let scene = files.with_imported_shader(&folders)?.scene;
    let (chosen, resumed_scene_or) = match last.scene.as_deref().filter(|_| !names_scene) {
        Some(name) => resumed_scene(name, &common)?,
        None => (arguments.scene.choose(scene, &common)?, None),
    };
    let scene = SceneChoice { view: arguments.view.view, projection, ..chosen };
    let moved = (!arguments.new).then(|| file.settings().moved(&scene.source.title()));
    let settings = PlaySettings {
        choices,
        show: arguments.show.flatten().filter(|source| *source != ShowSource::Auto),
        names_scene,
        device: arguments.device,
        silent: arguments.silent,
        once: arguments.once,
        volume: arguments.volume.map(|percent| f32::from(percent) / 100.0).or(last.volume).unwrap_or(1.0),
        latency: arguments.latency.map(|milliseconds| milliseconds / 1000.0),
        listen,
        fps_cap: arguments.fps_cap,
        fade: arguments.fade,
        prepare_ahead: arguments.prepare_ahead,
        program_cache: folders.cache.as_deref().filter(|_| arguments.program_cache).map(ProgramCache::within),
        fullscreen: arguments.fullscreen || (arguments.size.is_none() && last.fullscreen),
        begin_at,
        controllers: ControllerSettings {
            osc: arguments.osc,
            osc_send: arguments.osc_send,
            osc_rate: arguments.osc_rate,
            midi: arguments.midi,
            remote: arguments.remote,
        },
        moved: moved.unwrap_or_default(),
        resumed_scene_or,
        remembered: !arguments.new && !arguments.gl_info,
        size: arguments.size.or(last.size.filter(|size| fits(*size))).unwrap_or(SIZE),
        // Ignore the saved position if the size was given, because the position fits only the saved size.
        place: last.place.filter(|_| arguments.size.is_none()),
        wallpaper: arguments.frame_options.wallpaper,
        sends: arguments.frame_options.send,
        send_size: arguments.frame_options.send_size,
        send_fps: arguments.frame_options.send_fps,
        gl_info: arguments.gl_info,
    };
    Ok(Prepared { tracks, settings, scene, memory: Memory { file, trouble, folders } })
}

fn choices_of(arguments: &PlayArguments, remembered: &Choices) -> Choices {
    let mut choices = arguments.chosen.over(remembered);
    choices.tone_map = arguments.common.tone_map.unwrap_or(choices.tone_map);
    choices.gain = arguments.common.gain.unwrap_or(choices.gain);
    if let Some(show) = &arguments.show {
        choices.follow_song = if show.is_some() { FollowChoice::On } else { FollowChoice::Off };
    }
    choices.hints &= !arguments.clean;
    choices.stage.output = arguments.frame_options.output(choices.stage.output);
    choices
}

/// Returns the playlist of the last show, and the position in its first track in seconds; `None` if no track can be
/// played any more.
fn resume_list(list: PathBuf, last: &LastShow, repeat: Repeat, shuffle: bool) -> Option<(Opened, f64)> {
    let repeat = last.repeat.as_deref().and_then(Repeat::named).unwrap_or(repeat);
    let opened = Playlist::open_at(&[list], repeat, last.shuffled || shuffle, Some(last.track)).ok();
    let Some(opened) = opened.filter(|opened| opened.playable) else {
        print_message("the tracks of the last show can no longer be played: the demo track plays instead");
        return None;
    };
    let is_same = opened.first.info.entry == last.track && last.seconds.is_finite();
    let begin_at = if is_same { last.seconds.max(0.0) } else { 0.0 };
    Some((opened, begin_at))
}

fn list_monitors() -> anyhow::Result<()> {
    let monitors =
        shell::monitors::present().map_err(|reason| anyhow::anyhow!("{reason}: start Mariana there"))?;
    for (number, monitor) in monitors.iter().enumerate() {
        let (x, y) = monitor.place;
        print_line(&format!("{} {monitor} at {x},{y}", number + 1))?;
    }
    Ok(())
}

const SIZE: (u32, u32) = (1280, 720);

fn fits(size: (u32, u32)) -> bool {
    let (width, height) = size;
    let sides = limits::PICTURE_SIDE_MIN.max(64)..=limits::PICTURE_SIDE_MAX;
    let pixels = u64::from(width) * u64::from(height);
    sides.contains(&width) && sides.contains(&height) && pixels <= limits::PICTURE_PIXELS_MAX
}

/// Returns the scene of the last show, and the scene to show if that one cannot be loaded.
fn resumed_scene(name: &str, common: &CommonArguments) -> anyhow::Result<(SceneChoice, Option<SceneSource>)> {
    let default = common.scene(DEFAULT_SCENE.as_ref())?;
    let substitute = Some(default.source.clone());
    let resumed = common.scene(name.as_ref()).unwrap_or_else(|error| {
        print_message(&format!("{error:#}; {DEFAULT_SCENE} is shown instead"));
        default
    });
    Ok((resumed, substitute))
}

fn open_songs(songs: &[PathBuf], repeat: Repeat, shuffle: bool) -> anyhow::Result<Opened> {
    let missing: Vec<String> = songs
        .iter()
        .filter(|song| !is_standard(song) && !song.exists())
        .map(|song| song.display().to_string())
        .collect();
    match &missing[..] {
        [] => {}
        [one] => anyhow::bail!("{one} does not exist; check the spelling of the path"),
        several => {
            anyhow::bail!("these paths do not exist; check their spelling: {}", several.join(", "))
        }
    }
    match songs {
        [] => Ok(Playlist::of_song(DEMO_TRACK, repeat)),
        [one] if is_standard(one) => {
            let song = song_or_demo(Some(one.clone()))?;
            // Open the song to report the complete error.
            song.open()?;
            Ok(Playlist::of_song(song, repeat))
        }
        several if several.iter().any(|song| is_standard(song)) => {
            anyhow::bail!("standard input ('-') cannot be combined with other songs: leave out one of them")
        }
        files => Ok(Playlist::open(files, repeat, shuffle)?),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: PlayArguments,
    }

    fn parsed(words: &[&str]) -> Option<PlayArguments> {
        let line = [&["mariana"], words].concat();
        Line::try_parse_from(line).ok().map(|line| line.arguments)
    }

    #[test]
    fn rates_of_osc_are_those_of_the_limits() {
        let rate = |rate: f64| {
            let arguments = parsed(&["--osc-send", "127.0.0.1:9000", "--osc-rate", &rate.to_string()]);
            arguments.map(|arguments| arguments.osc_rate)
        };
        assert_eq!([OSC_RATE_MIN, OSC_RATE_MAX].map(rate), [Some(OSC_RATE_MIN), Some(OSC_RATE_MAX)]);
        for wrong in [OSC_RATE_MIN / 2.0, OSC_RATE_MAX + 1.0, f64::NAN] {
            assert_eq!(rate(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn delays_are_those_of_the_limits() {
        let latency =
            |ms: f64| parsed(&["--latency", &ms.to_string()]).and_then(|arguments| arguments.latency);
        assert_eq!([-LATENCY_MS_MAX, -180.0].map(latency), [Some(-LATENCY_MS_MAX), Some(-180.0)]);
        assert_eq!([-LATENCY_MS_MAX - 1.0, LATENCY_MS_MAX + 1.0].map(latency), [None, None]);
    }
}
