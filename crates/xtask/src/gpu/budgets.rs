//! What was accepted: the file `gpu-budgets.txt` of this crate, made by `cargo xtask gpu --accept`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context as _;

use super::counts::Counts;
use super::programs::Linked;

const FILE: &str = "crates/xtask/gpu-budgets.txt";

/// How much longer a program may get, as a factor, before it is called worse.
const LONGER: f64 = 1.05;

/// Mesa's version in a driver's description, of which another is another compiler.
fn mesa(driver: &str) -> &str {
    let version = driver.rsplit("Mesa ").next().unwrap_or_default();
    version.split(' ').next().unwrap_or_default()
}

/// A GPU and a program.
type Key = (String, String);

fn read() -> anyhow::Result<(String, BTreeMap<Key, Counts>)> {
    let text = std::fs::read_to_string(Path::new(crate::root::ROOT).join(FILE)).context(FILE)?;
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let version = lines.next().unwrap_or_default().trim_start_matches("Mesa ").to_owned();
    let rows = lines.map(|line| row(line).with_context(|| format!("{FILE}: {line}")));
    Ok((version, rows.collect::<anyhow::Result<_>>()?))
}

fn row(line: &str) -> Option<(Key, Counts)> {
    let mut parts = line.split('\t');
    let (gpu, program) = (parts.next()?.to_owned(), parts.next()?.to_owned());
    let mut number = || parts.next()?.parse().ok();
    let (registers, waves, spills) = (number()?, number()?, number()?);
    let counts = Counts { registers, waves, spills, scratch: number()?, code: number()? };
    Some(((gpu, program), counts))
}

/// Writes what there is as what is accepted; what was accepted of other programs stays.
///
/// # Errors
/// A file that cannot be read or written.
pub(super) fn accept(all: &[(String, Vec<Linked>)]) -> anyhow::Result<()> {
    let Some(driver) = all.iter().flat_map(|(_, programs)| programs).map(|program| &program.driver).next()
    else {
        return Ok(());
    };
    let mut rows = match read() {
        Ok((version, rows)) if version == mesa(driver) => rows,
        _ => BTreeMap::new(),
    };
    for (gpu, programs) in all {
        let reported = programs.iter().filter_map(|program| Some((program.name.clone(), program.counts?)));
        rows.extend(reported.map(|(name, counts)| ((gpu.clone(), name), counts)));
    }
    let mut text = String::from("# Made by `cargo xtask gpu --accept`.\n");
    let _ = writeln!(text, "# GPU, program, registers, waves, spills, scratch, bytes of code");
    let _ = writeln!(text, "Mesa {}", mesa(driver));
    for ((gpu, name), Counts { registers, waves, spills, scratch, code }) in rows {
        let _ = writeln!(text, "{gpu}\t{name}\t{registers}\t{waves}\t{spills}\t{scratch}\t{code}");
    }
    Ok(std::fs::write(Path::new(crate::root::ROOT).join(FILE), text)?)
}

/// Which programs got worse, and how. Those of another version of Mesa are not compared, which is said.
///
/// # Errors
/// A file of budgets that cannot be read.
pub(super) fn worse(all: &[(String, Vec<Linked>)]) -> anyhow::Result<Vec<String>> {
    let (version, accepted) = read()?;
    let programs =
        || all.iter().flat_map(|(gpu, programs)| programs.iter().map(move |program| (gpu, program)));
    if let Some((_, other)) = programs().find(|(_, program)| mesa(&program.driver) != version) {
        println!("Not compared: this is Mesa {}, accepted was what {version} makes.", mesa(&other.driver));
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for (gpu, program) in programs() {
        let key = (gpu.clone(), program.name.clone());
        let what = match (program.counts, accepted.get(&key)) {
            (None, _) => Some("its compiler tells nothing".to_owned()),
            (Some(_), None) => Some("nothing was accepted for it".to_owned()),
            (Some(counts), Some(accepted)) => worse_by(*accepted, counts),
        };
        found.extend(what.map(|what| format!("{gpu}, {}: {what}", program.name)));
    }
    Ok(found)
}

/// How `counts` are worse than `accepted`.
fn worse_by(accepted: Counts, counts: Counts) -> Option<String> {
    let is_worse = counts.waves < accepted.waves
        || counts.spills > accepted.spills
        || counts.scratch > accepted.scratch
        || f64::from(counts.code) > LONGER * f64::from(accepted.code);
    is_worse.then(|| format!("{counts}; accepted: {accepted}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_waves_spills_and_longer_code_are_worse() {
        let accepted = Counts { registers: 84, waves: 3, spills: 0, scratch: 0, code: 1_000 };
        assert_eq!(worse_by(accepted, Counts { registers: 90, code: 1_050, ..accepted }), None);
        for counts in [
            Counts { waves: 2, ..accepted },
            Counts { spills: 1, ..accepted },
            Counts { scratch: 4, ..accepted },
            Counts { code: 1_051, ..accepted },
        ] {
            assert!(worse_by(accepted, counts).is_some(), "{counts}");
        }
    }

    #[test]
    fn what_is_accepted_can_be_read() {
        let (version, rows) = read().unwrap();
        assert!(!version.is_empty() && rows.len() > 70, "{version}, {} rows", rows.len());
        let driver = "AMD Radeon (vega10, LLVM 15.0.6), 3.3 (Core Profile) Mesa 22.3.6";
        assert_eq!(mesa(driver), "22.3.6");
    }
}
