use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::programs::Linked;

/// Formats a Markdown table with a row per program. For each GPU, a row has registers/waves, spills and scratch memory
/// if there are any, the code size, and the CPU time of compiling.
pub(super) fn table(all: &[(String, Vec<Linked>)]) -> String {
    let mut text = String::new();
    let drivers: BTreeSet<&str> =
        all.iter().flat_map(|(_, programs)| programs).map(|program| program.driver.as_str()).collect();
    for driver in drivers {
        let _ = writeln!(text, "{driver}");
    }
    let heads = all.iter().map(|(gpu, _)| format!(" {gpu}: registers/waves | code | s |"));
    let _ = writeln!(text, "\n| program |{}", heads.collect::<String>());
    let _ = writeln!(text, "|---|{}", "---|---|---|".repeat(all.len()));
    let Some((_, first)) = all.first() else { return text };
    for program in first {
        let _ = write!(text, "| {} |", program.name);
        for (_, programs) in all {
            match programs.iter().find(|other| other.name == program.name) {
                Some(Linked { counts: Some(counts), seconds, .. }) => {
                    let _ = write!(text, " {}/{}", counts.registers, counts.waves);
                    if counts.spills > 0 {
                        let _ = write!(text, ", {} spills", counts.spills);
                    }
                    if counts.scratch > 0 {
                        let _ = write!(text, ", {} scratch", counts.scratch);
                    }
                    let _ = write!(text, " | {} | {seconds:.2} |", counts.code);
                }
                Some(Linked { seconds, .. }) => {
                    let _ = write!(text, " no figures | | {seconds:.2} |");
                }
                None => text.push_str(" | | |"),
            }
        }
        text.push('\n');
    }
    text
}
