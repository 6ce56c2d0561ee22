//! Runs every fuzz target over all its seeds and many mutations of them. The mutations are the same in every run.
//!
//! `scripts/fuzz` uses libFuzzer to search for new inputs; see fuzz/README.md.

#![allow(clippy::unwrap_used, clippy::expect_used)]

#[path = "../fuzz/src/lib.rs"]
#[allow(dead_code, unreachable_pub, reason = "only libFuzzer uses the rest")]
mod fuzz;

fn survives(target: &fuzz::Target) {
    let seeds = (target.seeds)();
    assert!(seeds.len() >= 6, "{} has {} seeds", target.name, seeds.len());
    for seed in &seeds {
        (target.run)(&seed.bytes);
    }
    let asked = std::env::var("MARIANA_FUZZ_CHANGES").ok();
    let changes = asked.map_or(target.changes, |changes| changes.parse().unwrap());
    (0..changes).for_each(|number| (target.run)(&fuzz::changed(&seeds, number)));
    for nothing in [&[][..], &[0], &[0xFF; 3], &[0; 64], &[0xFF; 200]] {
        (target.run)(nothing);
    }
}

#[test]
fn seeds_fit_their_targets() {
    for seed in (fuzz::SCENE.seeds)() {
        let text = String::from_utf8(seed.bytes).unwrap();
        let mut include = |path: &str| match path {
            "a.scene" => Ok("fn a(p) = length(p) - 1".to_owned()),
            _ => Err("there is no such file".to_owned()),
        };
        let compiled = mariana_field::lang::compile(&seed.name, &text, &mut include);
        assert_eq!(compiled.scene.is_none(), seed.name.starts_with("mistake"), "{}", compiled.render(false));
    }
    let folder = tempfile::tempdir().unwrap();
    for seed in (fuzz::DECODE.seeds)() {
        let path = folder.path().join(&seed.name);
        std::fs::write(&path, &seed.bytes[1..]).unwrap();
        let mut decoder = mariana_player::decode::Decoder::open(&path).unwrap();
        let mut frames = Vec::new();
        while decoder.next_block(&mut frames).unwrap() > 0 {}
        assert!(frames.len() > 3_000, "{}: {} frames", seed.name, frames.len());
    }
}

macro_rules! targets {
    ($($name:ident $target:ident)+) => {
        $(
            #[test]
            fn $name() {
                survives(&fuzz::$target);
            }
        )+

        #[test]
        fn every_target_is_run_here_and_has_a_program() {
            let run: Vec<&str> = vec![$(stringify!($name)),+];
            let known: Vec<&str> = fuzz::TARGETS.iter().map(|target| target.name).collect();
            assert_eq!(run, known);
            let manifest = include_str!("../fuzz/Cargo.toml");
            let programs: Vec<&str> =
                manifest.lines().filter_map(|line| line.strip_prefix("path = \"src/bin/")).collect();
            let wanted: Vec<String> = known.iter().map(|name| format!("{name}.rs\"")).collect();
            assert_eq!(programs, wanted, "fuzz/Cargo.toml lists other programs than the targets");
        }
    };
}

targets! {
    syntax SYNTAX scene SCENE glsl GLSL regions REGIONS tape TAPE differential DIFFERENTIAL decode DECODE lists LISTS settings SETTINGS osc OSC midi MIDI
    phones PHONES shows SHOWS drawings DRAWINGS fonts FONTS lyrics LYRICS
}
