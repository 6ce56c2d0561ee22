//! Seed inputs, a dictionary of the scene language, and reproducible mutations.

use std::path::{Path, PathBuf};
use std::process::Command;

use mariana_field::lang;
use mariana_testing::tiny_font::TinyFont;

use super::files::{LIST_ENDS, SOUND_ENDS};
use super::random::Random;

pub struct Seed {
    /// The file name.
    pub name: String,
    pub bytes: Vec<u8>,
}

fn seed(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Seed {
    Seed { name: name.into(), bytes: bytes.into() }
}

/// Returns the repository root. This file is compiled from `fuzz/` and from `tests/`.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    if here.join("assets").is_dir() { here.to_owned() } else { here.join("..") }
}

/// Short scenes with every kind of section and many shapes.
const SCENES: &[(&str, &str)] = &[
    ("formula", "length(p) - 1"),
    (
        "every-section",
        "param size = 0.6 in 0.2 .. 1\nlet q = p * 2\nfn bump(p, h) = sphere(p, h) + 0.1 * sin(9 * p.x)\n\
         material glow { color = vec3(0.9, 0.3, 0.1) emission = vec3(1.2, 0.3, 0.05) * band(4) roughness = 0.3 }\n\
         material mirror { color = 0.05 reflect = 0.4 metalness = 1 coat = 0.5 haze = 0.1 blur = 0.2 }\n\
         object ball { shape = bump(p - vec3(0, 1, 0), size + volume.x) material = glow }\n\
         object floor { shape = y material = mirror }\n\
         light lamp { position = vec3(2, 4, -3) color = vec3(30) radius = 0.2 }\n\
         camera { position = vec3(0, 2, -6) target = vec3(0, 1, 0) fov = 45 }\n\
         sky { color = mix(vec3(0.1), vec3(0.2, 0.3, 0.5), direction.y) }\n",
    ),
    (
        "many",
        "fn place(i) = vec3(5 * sin(12.9898 * i), 3 + 3 * sin(78.233 * i), 5 * sin(37.719 * i))\n\
         object boxes { shape = union(for i in 0..20: box(p - place(i), vec3(0.2 + 0.1 * sin(i), 0.3, 0.25))) }\n\
         object balls { shape = smooth_union(for i in 0..9: sphere(p - place(i), 0.4 + 0.2 * band(0)), 0.3) }\n",
    ),
    ("non-lipschitz", "object s { shape = x^4 + y^4 + z^4 - 5 * (x^2 + y^2 + z^2) + 11.8 }"),
    ("land", "object land { shape = (p.y - 0.6 * sin(p.x) * cos(p.z)) * 0.5 }"),
    ("noise", "object n { shape = length(p) - 1 + 0.1 * hash(floor(p)) + 0.2 * (t % 2) }"),
    ("include", "include \"a.scene\"\nobject o { shape = a(p) }"),
    ("mistake-circle", "include \"self.scene\"\nobject o { shape = x }"),
    ("mistake", "object { shape = (1 + } \"\n fn f(x = y for if then else 9..2 ^ # \u{e9}"),
    ("choice", "object o { shape = if x > 0 then if y < 1 then 2 else length(p) - 1 else min(abs(z), 2) }"),
];

/// Shaders with distances and pictures, as people write them for viewers of shaders.
const SHADERS: &[(&str, &str)] = &[
    ("distance", "float map(vec3 p) { return min(length(p) - 1.0, p.y + 1.0); }"),
    (
        "material",
        "const int N = 4;\nmat2 turn(float a) { return mat2(cos(a), -sin(a), sin(a), cos(a)); }\n\
         vec2 map(in vec3 p) {\n  vec2 r = vec2(1e9, 0.0);\n  for (int i = 0; i < N; i++) {\n    p.xz *= turn(0.3 * iTime);\n\
         \x20   float d = length(p - vec3(float(i), 0.0, 0.0)) - 0.4;\n    if (d < r.x) { r = vec2(d, float(i)); }\n  }\n  return r;\n}\n",
    ),
    (
        "picture",
        "void mainImage(out vec4 fragColor, in vec2 fragCoord) {\n  vec2 uv = fragCoord / iResolution.xy;\n\
         \x20 float w = fwidth(uv.x);\n  fragColor = vec4(smoothstep(0.5 - w, 0.5 + w, uv.x), uv.y, iMouse.z, 1.0);\n}\n",
    ),
    (
        "fragment",
        "#ifdef GL_ES\nprecision mediump float;\n#endif\nuniform vec2 u_resolution;\nuniform float u_time;\n#define PI 3.14159\n\
         float ring(vec2 p, float r) { return abs(length(p) - r); }\nvoid main() {\n\
         \x20 vec2 p = gl_FragCoord.xy / u_resolution - 0.5;\n  gl_FragColor = vec4(vec3(0.01 / ring(p, 0.2 + 0.1 * sin(u_time * PI))), 1.0);\n}\n",
    ),
    (
        "output",
        "#version 330 core\nlayout(location = 0) out vec4 color;\nstruct Hit { float d; int id; };\n\
         Hit nearer(Hit a, Hit b) { if (a.d < b.d) return a; return b; }\nvoid main() {\n\
         \x20 Hit h = nearer(Hit(gl_FragCoord.x, 1), Hit(gl_FragCoord.y, 2));\n\
         \x20 switch (h.id) { case 1: color = vec4(1.0); break; default: color = vec4(0.0, 0.0, 0.0, 1.0); }\n}\n",
    ),
    (
        "loops",
        "float de(vec3 z) {\n  float s = 1.0, w[3] = float[3](0.5, 0.3, 0.2);\n  int i = 0;\n  while (i < 8) {\n\
         \x20   z = clamp(z, -1.0, 1.0) * 2.0 - z;\n    if (dot(z, z) > 16.0) break;\n    s *= 2.0; ++i;\n  }\n\
         \x20 return length(z) * w[1] / s;\n}\n",
    ),
    (
        "components",
        "float map(vec3 p) { mat4 m = mat4(1.0); return p.xyz.zyx.xyz.x + m[0][1] + p[int(p.xy.yx[0])]; }\n",
    ),
    (
        "mistake",
        "float map(vec3 p { return q.x +; }\nvoid mainImage(out vec4 c) { c = vec4(map(1)); } #define A A A\n",
    ),
];

pub(crate) fn shaders() -> Vec<Seed> {
    SHADERS.iter().map(|(name, text)| seed(format!("{name}.glsl"), *text)).collect()
}

pub(crate) fn small_scenes() -> Vec<Seed> {
    SCENES.iter().map(|(name, text)| seed(*name, *text)).collect()
}

pub(crate) fn scenes() -> Vec<Seed> {
    let mut seeds = small_scenes();
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(root().join("assets/scenes")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    seeds.extend(
        files
            .iter()
            .map(|file| seed(file.file_name().unwrap().to_string_lossy(), std::fs::read(file).unwrap())),
    );
    seeds
}

/// Returns random expressions of many lengths.
pub(crate) fn steps() -> Vec<Seed> {
    let mut random = Random(5);
    let lengths = [0, 1, 30, 60, 100, 150, 200, 300, 400, 700, 1_000, 2_000];
    let of = |length: usize| {
        seed(format!("steps-{length}"), (0..length).map(|_| random.word() as u8).collect::<Vec<_>>())
    };
    lengths.map(of).into()
}

/// Returns sounds of at most a quarter of a second in every container and codec, made by ffmpeg. The first byte
/// selects the extension.
pub(crate) fn sounds() -> Vec<Seed> {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.wav");
    std::fs::write(&source, wave(44_100, 4_410)).unwrap();
    let mut seeds = Vec::new();
    for (name, codec) in [
        ("s16.wav", "pcm_s16le"),
        ("s24.wav", "pcm_s24le"),
        ("f32.wav", "pcm_f32le"),
        ("u8.wav", "pcm_u8"),
        ("adpcm.wav", "adpcm_ms"),
        ("ima.wav", "adpcm_ima_wav"),
        ("law.wav", "pcm_alaw"),
        ("s16.aiff", "pcm_s16be"),
        ("s16.caf", "pcm_s16le"),
        ("alac.caf", "alac"),
        ("a.flac", "flac"),
        ("flac.ogg", "flac"),
        ("alac.m4a", "alac"),
        ("a.mp3", "libmp3lame"),
        ("b.mp3", "mp2"),
        ("vorbis.ogg", "libvorbis"),
        ("a.opus", "libopus"),
        ("aac.m4a", "aac"),
        ("a.aac", "aac"),
        ("fragmented.mp4", "aac"),
        ("pcm.mkv", "pcm_s16le"),
        ("flac.mkv", "flac"),
        ("aac.mkv", "aac"),
        ("mp3.mkv", "libmp3lame"),
        ("vorbis.webm", "libvorbis"),
        ("opus.webm", "libopus"),
    ] {
        let path = folder.path().join(name);
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-v", "error", "-nostdin", "-y", "-i"]).arg(&source).args(["-c:a", codec]);
        ffmpeg.args([
            "-metadata",
            "title=Ebb",
            "-metadata",
            "artist=The Tide",
            "-metadata",
            "replaygain_track_gain=-3 dB",
        ]);
        match name {
            "fragmented.mp4" => {
                ffmpeg.args(["-movflags", "+frag_keyframe+delay_moov", "-frag_duration", "50000"]);
            }
            "b.mp3" => {
                ffmpeg.args(["-f", "mp2"]);
            }
            _ => {}
        }
        let run = ffmpeg.arg(&path).output().expect("ffmpeg makes the seeds: install it");
        assert!(run.status.success(), "{name}: {}", String::from_utf8_lossy(&run.stderr));
        let end = SOUND_ENDS.iter().position(|end| name.ends_with(end)).unwrap_or(0);
        let mut bytes = vec![end as u8];
        bytes.extend(std::fs::read(&path).unwrap());
        seeds.push(seed(name, bytes));
    }
    seeds
}

/// Returns a 16-bit stereo WAVE file with a tone and noise.
pub(crate) fn wave(rate: u32, frames: u32) -> Vec<u8> {
    let mut random = Random(3);
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((frames * 4 + 36).to_le_bytes());
    bytes.extend(b"WAVEfmt \x10\x00\x00\x00\x01\x00\x02\x00");
    bytes.extend(rate.to_le_bytes());
    bytes.extend((rate * 4).to_le_bytes());
    bytes.extend(b"\x04\x00\x10\x00data");
    bytes.extend((frames * 4).to_le_bytes());
    for frame in 0..frames {
        let tone = (frame as f32 * 0.06).sin() * 9_000.0;
        for _ in 0..2 {
            bytes.extend(((tone + random.between(-2_000.0, 2_000.0)) as i16).to_le_bytes());
        }
    }
    bytes
}

/// Encodes an OSC string: zero-terminated, padded to four bytes.
fn osc_text(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((text.len() / 4 + 1) * 4, 0);
    bytes
}

/// Encodes an OSC message. `arguments` are the encoded values for `tags`.
fn osc_message(address: &str, tags: &str, arguments: &[u8]) -> Vec<u8> {
    [osc_text(address), osc_text(tags), arguments.to_vec()].concat()
}

fn osc_bundle(time: [u32; 2], elements: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = [osc_text("#bundle"), time.map(u32::to_be_bytes).concat()].concat();
    for element in elements {
        bytes.extend((element.len() as u32).to_be_bytes());
        bytes.extend(element);
    }
    bytes
}

pub(crate) fn packets() -> Vec<Seed> {
    let half = 0.5_f32.to_be_bytes();
    let turn = osc_message("/param/size", ",ff", &[half, half].concat());
    let next = osc_message("/next", ",", &[]);
    let nested = osc_bundle(
        [0, 1],
        &[turn.clone(), osc_bundle([3_900_000_000, 7], std::slice::from_ref(&next)), next.clone()],
    );
    vec![
        seed("turn", turn),
        seed("share", osc_message("/share/size", ",d", &0.25_f64.to_be_bytes())),
        seed("next", next),
        seed("switch", osc_message("/pause", ",T", &[])),
        seed("scene", osc_message("/scene", ",s", &osc_text("orb"))),
        seed("number", osc_message("/scene", ",i", &3_u32.to_be_bytes())),
        seed("question", osc_message("/query/params", ",", &[])),
        seed("pattern", osc_message("/{param,share}/s[a-i!]*?", ",f", &half)),
        seed("lists", osc_message("/tempo", ",[[f]]N", &half)),
        seed("blob", osc_message("/tempo", ",b", &[0, 0, 0, 2, 1, 2, 0, 0])),
        seed("nested", nested),
    ]
}

pub(crate) fn midi() -> Vec<Seed> {
    let sysex = [&[0xF0, 0x7E][..], &[0x11; 40], &[0xF7]].concat();
    let song = [&[0xFA][..], &[0xF8; 50], &[0xFC, 0xF2, 0x10, 0x02, 0xFB], &[0xF8; 30]].concat();
    let interrupted = vec![0xB0, 7, 0xF8, 100, 8, 0xFE, 90, 0x90, 60, 0xF0, 1, 2, 0xF7, 64, 0x80, 60, 0];
    let pressed = vec![0x90, 60, 100, 60, 0, 0xA3, 60, 20, 0xD4, 99, 0xF6, 0x91, 1];
    vec![
        seed("notes", pressed),
        seed("fine", vec![0xB0, 1, 64, 33, 5, 1, 65, 33, 7, 0xB5, 98, 3, 99, 4, 6, 100, 38, 2]),
        seed("bend", vec![0xE2, 0, 64, 127, 127, 0xC1, 5, 6, 7]),
        seed("sysex", sysex),
        seed("clock", song),
        seed("interrupted", interrupted),
    ]
}

/// Returns playlists of all kinds. The first byte selects the extension.
pub(crate) fn lists() -> Vec<Seed> {
    let texts: [(&str, &str, &[u8]); 9] = [
        ("m3u", "plain", b"#EXTM3U\r\n#EXTINF:123,Some One - A Song\r\na.wav\r\n\r\nb.wav\nhttp://x/y\nmissing.mp3\n"),
        ("m3u8", "encoded", b"\xef\xbb\xbf#EXTM3U\nfile:///a%20b%C3%A9%zz\nlist.m3u8\n.\nb.wav\na\\b.wav"),
        ("m3u", "utf16", b"\xff\xfea\0.\0w\0a\0v\0\n\0b\0.\0w\0a\0v\0"),
        ("m3u", "latin", b"gr\xfcn.mp3\na.wav\nAC://DC\n"),
        ("m3u8", "stream", b"#EXTM3U\n#EXT-X-TARGETDURATION:10\nsegment1.ts\n"),
        ("pls", "plain", b"[playlist]\nFile1=a.wav\nTitle1=A\nFile2=b.wav\nLength2=7\nNumberOfEntries=2\nVersion=2\n"),
        ("pls", "odd", b"[Playlist]\nfile99999999999999999999=b.wav\nFileX=a.wav\nFile-1=a.wav\nFile3=\n"),
        (
            "cue",
            "disc",
            b"REM x\nPERFORMER \"The Band\"\nFILE \"a.wav\" WAVE\nTRACK 01 AUDIO\nTITLE \"One\"\nINDEX 01 00:00:00\n\
              TRACK 02 AUDIO\nPERFORMER \"Guest\"\nINDEX 00 00:00:10\nINDEX 01 00:00:20\n\
              FILE b.wav WAVE\nTRACK 03 AUDIO\nINDEX 01 00:00:05\n",
        ),
        ("cue", "odd", b"FILE \"a.wav\nTRACK 01 AUDIO\nINDEX 01 99999:59:74\nINDEX 01 0:0:1\nTRACK 2 MODE1\nINDEX 1 0:0:0"),
    ];
    let of = |(end, name, text): &(&str, &str, &[u8])| {
        let choice = LIST_ENDS.iter().position(|known| known == end).unwrap_or(0);
        seed(format!("{name}.{end}"), [&[choice as u8], *text].concat())
    };
    texts.iter().map(of).collect()
}

/// Returns request heads and messages of phones. The first byte selects the kind.
pub(crate) fn phones() -> Vec<Seed> {
    let texts: [(&str, u8, &str); 10] = [
        ("page", 0, "GET /35qf29r24hbredywj1tc8v84jb/ HTTP/1.1\r\nHost: 192.168.0.7:8080\r\n\r\n"),
        (
            "websocket",
            0,
            "GET /35qf29r24hbredywj1tc8v84jb/hands HTTP/1.1\r\nHost: [fe80::1]:8080\r\nOrigin: http://[fe80::1]:8080\r\n\
             Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\nrest",
        ),
        ("lines", 0, "\r\n\nGET / HTTP/1.0\nA:\nB: x\r\n y\r\n\r\n"),
        ("twice", 0, "POST * HTTP/1.1\r\nHost: a\r\nhost: b\r\nContent-Length: 99999999999\r\n\r\n"),
        ("next", 0, "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        ("turn", 1, r#"{"turn":"gr\u00f6\u00dfe","to":-1.5e3}"#),
        ("do", 1, r#"{"do":"scene","with":"orb"}"#),
        ("switch", 1, r#"{"with":true,"do":"pause"}"#),
        ("large", 1, r#"{"turn":"","to":1e308}"#),
        ("deep", 1, "[[[[[[[[[[[[[[[[{\"do\":[{\"turn\":null}]}"),
    ];
    texts.iter().map(|(name, kind, text)| seed(*name, [&[*kind], text.as_bytes()].concat())).collect()
}

/// Returns valid and broken show files. The first byte selects the song.
pub(crate) fn shows() -> Vec<Seed> {
    let texts: [(&str, u8, &str); 12] = [
        ("plain", 1, "at start ball.scene\nat section B bare.scene camera near melt over 2 bars\n"),
        (
            "moves",
            1,
            "at start ball.scene camera near\n set size = 0.5 -> 1.5 over 4 s after 1 bar\n -> 0.2 over 1 beat\n\
             at drop 1 - 1 beat bare.scene portal plane over 2 bars unfinished\nat end - 3 s ball.scene fade over 1 s\n",
        ),
        (
            "pictures",
            0,
            "at 0 ball.scene\n set picture brightness = 1 -> 0 over 2 s\n set picture freeze = 1 -> 0 over 2 s after 1 s\n\
             set camera yaw = 20 -> -360 over 3 s\n set camera pitch = 80\n set camera zoom = 0 -> 9 over 2 s\n",
        ),
        ("missing", 0, "at section A 2 ball.scene\nat drop 1 bare.scene\n"),
        ("cues", 1, "at cue ball.scene cut\nat cue + 1 bar bare.scene fade over 3 s\n"),
        ("cues-and-missing", 0, "at build 1 bare.scene\nat cue ball.scene\n"),
        ("backwards", 1, "at 9 s ball.scene\nat bar 2 bare.scene\nat 0:10.5 ball.scene cut\n"),
        (
            "broken-scene",
            0,
            "at start bad.scene\nat 1 s none.scene\nat 2 s bare.scene camera near\n set size = 1\n",
        ),
        ("mistakes", 0, "at start\nset = 3\n-> 1 over 1 s\nat 1:75 ball.scene flay\n"),
        ("shipped", 1, "at start orb\nat section B tunnel camera fast melt\n"),
        ("formula", 0, "# a comment\nat start \"length(p) - 1 - bass\"\nat 99999999 ball.scene\n"),
        (
            "numbers",
            1,
            "at 0.0000001 ball.scene melt over 86400 bars\n set size = 99999999999999999999999999999999999999999 -> \
             -99999999999999999999999999999999999999 over 0 s\nat bar 1000000 ball.scene\n",
        ),
    ];
    texts.iter().map(|(name, song, text)| seed(*name, [&[*song], text.as_bytes()].concat())).collect()
}

/// Returns valid and broken settings files.
pub(crate) fn settings() -> Vec<Seed> {
    let good =
        "microphone = \"p:mic\"\nsystem = \"p:a.monitor\"\n\n[latency_ms]\n\"p:head\" = 180.0\nb = -5e1\n";
    vec![
        seed("good", good),
        seed("out-of-range", "[latency_ms]\na = nan\nb = -inf\nc = 5000.1\nd = -1e300\ne = 5000\n"),
        seed("odd", "latency_ms = { a = 1e400, \"\\u0000\" = 1 }\nsystem = '''\nx'''\n"),
        seed("broken", "microphone = 3"),
        seed("cut", "[latency_ms"),
        seed("deep", "a = [[[[[[[[{b.c.d.e.f = 1979-05-27T07:32:00Z}]]]]]]]]"),
        seed("no-text", b"\xff\xfe\0".to_vec()),
    ]
}

/// Returns drawings with every kind of element and property that is read.
pub(crate) fn drawings() -> Vec<Seed> {
    let texts = [
        (
            "path",
            "<path d='M1 1 C2 3 4 5 6 1 S 9 9 5 5 Q 1 2 3 4 T 9 1 A3 3 0 0 1 2 2 h3 v-2 l1 1 Z' fill-rule='evenodd'/>",
        ),
        (
            "stroke",
            "<g transform='rotate(20 3 4) scale(2)' style='fill:none;stroke:#123;stroke-width:.5e0'><path d='M1 1 C 9 9 1 9 9 1'/></g>",
        ),
        (
            "joins",
            "<path d='M1 1 L9 9 1 9' fill='none' stroke='red' stroke-width='3' stroke-linejoin='round' stroke-linecap='square'/>",
        ),
        (
            "shapes",
            "<rect width='9' height='5' rx='2'/><circle cx='5' cy='5' r='4'/><ellipse rx='3' ry='1'/><polygon points='1,2 3-4,5.5.5'/>",
        ),
        (
            "styles",
            "<style>.no{fill:none} path,rect{fill:#fff;stroke:rgb(9,9,9)} #a{opacity:.9}</style><rect id='a' width='9' height='9'/>",
        ),
        (
            "uses",
            "<defs><symbol id='b'><circle r='3'/></symbol><g id='a'><use href='#b' x='3'/><use href='#b' y='4'/></g></defs><use href='#a'/>",
        ),
        (
            "huge",
            "<g transform='matrix(1e30 0 0 1e-30 5 5)'><path d='M0 0 S 1e8 1e8 0 0' stroke='black' stroke-width='1e30'/></g>",
        ),
    ];
    let of = |(name, body): (&str, &str)| seed(name, format!("<svg viewBox='0 0 10 10'>{body}</svg>"));
    let entity = "<!DOCTYPE svg [<!ENTITY s 'fill:red'>]><svg width='9mm' height='1cm'><rect width='9' height='9' style='&s;'/></svg>";
    texts.into_iter().map(of).chain([seed("entity", entity)]).collect()
}

/// Returns fonts whose letters are squares, or composed of each other.
pub(crate) fn fonts() -> Vec<Seed> {
    let of = |parts, letters: &str| {
        let font = TinyFont { parts, ..TinyFont::new("Seed", letters) };
        seed(format!("{parts}-parts-of-{}", letters.len()), font.bytes())
    };
    [(0, "ab"), (0, "a"), (1, "abc"), (2, "abcdefgh"), (9, "abcdefghijklm"), (99, "abc")]
        .into_iter()
        .map(|(parts, letters)| of(parts, letters))
        .collect()
}

/// Returns lyrics with times of lines and of words.
pub(crate) fn lyrics() -> Vec<Seed> {
    vec![
        seed(
            "lines",
            "[ar: Nobody]\n[00:10.50][00:30]Again\n[00:12.00]<00:12.10>two <00:12.90>words\n[00:14:50]\n",
        ),
        seed("words", "[00:02.00]<00:02.50>Tell <00:03.00>me now\n[00:04.00]aa bb\n[00:08.00]"),
        seed("offset", "[offset:+500]\n[00:02.00]a\n[offset:-1e9]\n[00:03.00]b"),
        seed("unsorted", "[9:59.99]c\n[00:01]a\n[00:01]b\n[4294967295:1e300]d"),
        seed("signs", "[00:01]<<<<a>>>\n[[00:02]]b\n[00:03\n<00:04>c"),
        seed("none", "just words\n"),
    ]
}

/// Returns the words of the scene language as a libFuzzer dictionary.
pub fn dictionary() -> String {
    const SIGNS: &[&str] = &[
        "(",
        ")",
        "{",
        "}",
        ",",
        "..",
        "=",
        "==",
        "<=",
        ">=",
        "!=",
        "^",
        "%",
        "-",
        "\\\"",
        "#",
        "##",
        "for i in 0..9: ",
        "let a = ",
        "fn f(p) = ",
        "if ",
        " then ",
        " else ",
        "true",
        "false",
        ".xyz",
        ".xx",
        "1e39",
        "1e-40",
        "9999",
        "0.5",
        "param a = 0.5 in 0 .. 1",
        "material m {",
        "object o {",
        "light l {",
        "camera {",
        "sky {",
        "picture {",
        "include \\\"a.scene\\\"",
        "include \\\"self.scene\\\"",
        "texture(\\\"a.png\\\", ",
        "shape = ",
        "bound = ",
        "color = ",
        "roughness = ",
        "metalness = ",
        "emission = ",
        "reflect = ",
        "blur = ",
        "coat = ",
        "haze = ",
        "position = ",
        "target = ",
        "fov = ",
        "radius = ",
        "direction = ",
        "exposure = ",
        "bloom = ",
        "tone_map = ",
        "vec2(",
        "vec3(",
        "vec4(",
    ];
    let functions = lang::entries();
    let words = SIGNS.iter().map(|sign| (*sign).to_owned());
    let words = words.chain(lang::inputs().map(|(name, _)| name.to_owned()));
    let words = words.chain(functions.iter().map(|entry| format!("{}(", entry.name)));
    words.map(|word| format!("\"{word}\"\n")).collect()
}

/// Returns a seed with some mutations: bytes changed, deleted, duplicated, inserted, or copied from another seed.
pub fn changed(seeds: &[Seed], number: usize) -> Vec<u8> {
    let mut random = Random(0x5EED ^ number as u64);
    let mut bytes = seeds[number % seeds.len()].bytes.clone();
    for _ in 0..1 + random.below(6) {
        let at = random.below(bytes.len() + 1);
        let end = (at + 1 + random.below(32)).min(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => {
                bytes.drain(at..end);
            }
            2 => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            3 => {
                let other = &seeds[random.below(seeds.len())].bytes;
                let from = random.below(other.len() + 1);
                let part = other[from..(from + random.below(64)).min(other.len())].to_vec();
                bytes.splice(at..at, part);
            }
            4 => bytes.insert(at, [0, 1, 0x7F, 0x80, 0xFF][random.below(5)]),
            _ => {
                for byte in &mut bytes[at..end] {
                    if random.below(8) == 0 {
                        *byte = if random.below(2) == 0 {
                            random.word() as u8
                        } else {
                            *byte ^ 1 << random.below(8)
                        };
                    }
                }
            }
        }
    }
    bytes
}
