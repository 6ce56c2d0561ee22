//! Measures controllers: the latency from a MIDI or OSC message to the frame that shows the change, and the effect of
//! message floods on frames and memory.
//!
//! The tool starts the program in a window of this desktop, with simulated MIDI ports in a folder (feature
//! `fake-midi`), sends messages, and reads the program's log after it ends.

use std::fs;
use std::net::UdpSocket;
use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};

/// A scene that moves with time and has a parameter.
const SCENE: &str = "param size = 1 in 0.5 .. 1.5\n\
    material paint { color = vec3(0.6, 0.3, 0.2)  roughness = 0.6 }\n\
    object ball { shape = length(p - vec3(0.3 * sin(t), size, 0)) - size  material = paint }\n\
    object floor { shape = p.y  material = paint }\n";
/// Messages per second: a low rate, to measure the latency of each message, and a flood.
const RATES: [(&str, f64); 2] = [("17 a second", 17.0), ("10,000 a second", 10_000.0)];
const FPS: &str = "60";

/// Measures each case for the given number of seconds.
pub fn run(arguments: &[String]) -> anyhow::Result<()> {
    let program = arguments
        .first()
        .context("expected a program: target/release/mariana, built with --features fake-midi")?;
    let seconds =
        arguments.get(1).map_or(Ok(60.0), |text| text.parse()).context("the seconds are not a number")?;
    ensure!(Path::new(program).is_file(), "there is no {program}: build it with --features fake-midi");
    let folder = std::env::temp_dir().join(format!("mariana-controllers-{}", std::process::id()));
    fs::create_dir_all(folder.join("midi"))?;
    fs::write(folder.join("ball.scene"), SCENE)?;
    fs::write(folder.join("midi/desk.port"), "")?;
    let config = folder.join(".config/mariana");
    fs::create_dir_all(&config)?;
    fs::write(
        config.join("knobs.toml"),
        "[[knob]]\ndevice = \"desk (fake port)\"\nturned = \"cc 1 on channel 1\"\nscene = \"ball\"\nparam = \"size\"\n",
    )?;
    println!("{seconds} s each, at most {FPS} frames per second\n");
    let of_decks = folder.join("decks");
    fs::create_dir_all(&of_decks)?;
    fs::write(of_decks.join("ball.scene"), SCENE)?;
    fs::write(
        of_decks.join("box.scene"),
        SCENE.replace("length(p - vec3(0.3 * sin(t), size, 0)) - size", "box(p, 0.7)"),
    )?;
    measure(program, &folder, "no messages", seconds, |_| Ok(()))?;
    for (words, rate) in RATES {
        let socket = UdpSocket::bind("127.0.0.1:0")?;
        measure(program, &folder, &format!("OSC, {words}"), seconds, |until| {
            send(rate, until, |number| {
                let value = 0.5 + (number % 128) as f32 / 127.0;
                let message = [&b"/param/size\0,f\0\0"[..], &value.to_be_bytes()].concat();
                socket.send_to(&message, ("127.0.0.1", PORT)).map(drop)
            })
        })?;
        let socket = UnixDatagram::unbound()?;
        let place = folder.join("midi/desk.socket");
        measure(program, &folder, &format!("MIDI, {words}"), seconds, |until| {
            send(rate, until, |number| socket.send_to(&[0xb0, 1, (number % 128) as u8], &place).map(drop))
        })?;
        let socket = UdpSocket::bind("127.0.0.1:0")?;
        measure(program, &of_decks, &format!("crossfader by OSC, {words}"), seconds, |until| {
            send(rate, until, |number| {
                let position = 0.5 - 0.5 * (0.1 * number as f32).cos();
                let message = [&b"/crossfade\0\0,f\0\0"[..], &position.to_be_bytes()].concat();
                socket.send_to(&message, ("127.0.0.1", PORT)).map(drop)
            })
        })?;
    }
    Ok(fs::remove_dir_all(&folder)?)
}

const PORT: u16 = 47_911;

/// Sends messages at `rate` until `until`. The period of the messages is not a multiple of the frame time.
fn send(rate: f64, until: Instant, mut one: impl FnMut(u64) -> std::io::Result<()>) -> anyhow::Result<()> {
    let (start, mut number) = (Instant::now(), 0);
    while Instant::now() < until {
        // Dropped messages are not sent again.
        let _ = one(number);
        number += 1;
        let due = start + Duration::from_secs_f64(number as f64 / rate);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    let reached = number as f64 / start.elapsed().as_secs_f64();
    ensure!(reached > 0.9 * rate, "only {reached:.0} of {rate} messages per second were sent");
    Ok(())
}

fn measure(
    program: &str,
    folder: &Path,
    what: &str,
    seconds: f64,
    act: impl FnOnce(Instant) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let log = folder.join("log.txt");
    let mut child = start(program, folder, &log)?;
    wait_for(&log, "is shown, compiled")?;
    if has_decks(folder) {
        let socket = UdpSocket::bind("127.0.0.1:0")?;
        socket.send_to(&[&b"/decks\0\0,f\0\0"[..], &1.0_f32.to_be_bytes()].concat(), ("127.0.0.1", PORT))?;
        wait_for_times(&log, "is ready ahead", 2)?;
    }
    // Wait until drivers and caches have settled.
    std::thread::sleep(Duration::from_secs(3));
    let before = memory_mib(&child)?;
    let (until, worked) = (Instant::now() + Duration::from_secs_f64(seconds), processor_seconds(&child)?);
    act(until)?;
    std::thread::sleep(until.saturating_duration_since(Instant::now()));
    let (after, worked) = (memory_mib(&child)?, processor_seconds(&child)? - worked);
    Command::new("kill").arg(child.id().to_string()).status()?;
    child.wait()?;
    let log = fs::read_to_string(&log)?;
    // Find the last line of each kind in the log: about all frames, and about messages.
    let said = |of_messages: bool| {
        let words = if of_messages { "from message to frame: " } else { "frames: " };
        let line = log.lines().rfind(|line| line.contains(words)).unwrap_or("  ");
        line.rsplit_once("session::running: ").map_or(line, |(_, words)| words).to_owned()
    };
    println!(
        "{what}: memory {before:.1} to {after:.1} MiB, {:.0} % of a processor",
        100.0 * worked / seconds
    );
    println!("  {}\n  {}", said(false), said(true));
    Ok(())
}

/// True if the scenes in `folder` are mixed on two decks, which need scenes prepared in advance.
fn has_decks(folder: &Path) -> bool {
    folder.join("box.scene").exists()
}

pub fn wait_for(log: &Path, words: &str) -> anyhow::Result<()> {
    wait_for_times(log, words, 1)
}

fn wait_for_times(log: &Path, words: &str, times: usize) -> anyhow::Result<()> {
    let begun = Instant::now();
    loop {
        let said = fs::read_to_string(log)?;
        if said.matches(words).count() >= times {
            return Ok(());
        }
        ensure!(begun.elapsed() < Duration::from_secs(120), "the window did not appear: {said}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn start(program: &str, folder: &Path, log: &PathBuf) -> anyhow::Result<Child> {
    let log = fs::File::create(log)?;
    Ok(Command::new(program)
        .args([
            "--silent",
            "--new",
            "--clean",
            "-v",
            "--prepare-ahead",
            if has_decks(folder) { "on" } else { "off" },
            "--size",
            "320x180",
            "--fps-cap",
            FPS,
        ])
        .args(["--osc", &PORT.to_string(), "--scene"])
        .arg(folder.join("ball.scene"))
        .env("MARIANA_MIDI_FOLDER", folder.join("midi"))
        .env("HOME", folder)
        .env_remove("XDG_CONFIG_HOME")
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()?)
}

fn memory_mib(child: &Child) -> anyhow::Result<f64> {
    let text = fs::read_to_string(format!("/proc/{}/status", child.id()))?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:")).context("the program has ended")?;
    Ok(line.trim().trim_end_matches(" kB").trim().parse::<f64>()? / 1024.0)
}

fn processor_seconds(child: &Child) -> anyhow::Result<f64> {
    let text = fs::read_to_string(format!("/proc/{}/stat", child.id()))?;
    let (_, fields) = text.rsplit_once(')').context("/proc/PID/stat has no fields")?;
    let ticks = fields.split_whitespace().skip(11).take(2);
    Ok(ticks.map(|field| field.parse::<f64>().unwrap_or_default()).sum::<f64>() / 100.0)
}
