//! Figures of a compiled shader, parsed from the driver's debug messages.

use std::fmt;

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Counts {
    /// Vector registers per thread; 0 if unknown.
    pub(super) registers: u32,
    /// Maximum number of waves per SIMD unit; 0 if unknown. More waves hide memory latency better.
    pub(super) waves: u32,
    /// Registers spilled to memory (Intel: number of spills).
    pub(super) spills: u32,
    /// Scratch memory per thread, in bytes.
    pub(super) scratch: u32,
    /// Code size: in bytes on AMD GPUs, in instructions on other GPUs.
    pub(super) code: u32,
}

/// Parses the number after `name` in `text`.
fn number(text: &str, name: &str) -> Option<u32> {
    let rest = text[text.find(name)? + name.len()..].trim_start();
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    rest[..end].parse().ok()
}

/// Parses the number before `name` in `text`.
fn number_before(text: &str, name: &str) -> Option<u32> {
    let before = text[..text.find(name)?].trim_end();
    let start = before.rfind(|c: char| !c.is_ascii_digit()).map_or(0, |at| at + 1);
    before[start..].parse().ok()
}

impl Counts {
    /// Parses a message of Mesa's drivers for AMD (radeonsi), Intel (iris) or NVIDIA (nouveau). Returns `None`
    /// for other messages.
    pub(super) fn read(message: &str) -> Option<Self> {
        if message.contains("VGPRS: ") {
            return Some(Self {
                registers: number(message, " VGPRS:")?,
                waves: number(message, "Max Waves:")?,
                spills: number(message, "Spilled VGPRs:")?,
                scratch: number(message, "Scratch:")?,
                code: number(message, "Code Size:")?,
            });
        }
        if message.contains("spills:fills") {
            let spills = message.split(" spills:fills").next()?.rsplit(' ').next()?.split(':').next()?;
            let code = number_before(message, " inst")?;
            return Some(Self { spills: spills.parse().ok()?, code, ..Self::default() });
        }
        if message.contains("gpr:") {
            let (registers, code) = (number(message, "gpr:")?, number(message, "inst:")?);
            return Some(Self { registers, code, scratch: number(message, "local:")?, ..Self::default() });
        }
        None
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { registers, waves, spills, scratch, code } = self;
        write!(f, "{registers:3} registers, {waves:2} waves, {spills} spills, {scratch} scratch, {code} code")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_three_compilers_are_parsed() {
        let amd = "OpenGL note 1: Shader Stats: SGPRS: 112 VGPRS: 144 Code Size: 18344 LDS: 0 Scratch: 64 Max Waves: 3 \
                   Spilled SGPRs: 10 Spilled VGPRs: 7 PrivMem VGPRs: 0 DivergentLoop: 1, (PS, W32)";
        let counts = Counts { registers: 144, waves: 3, spills: 7, scratch: 64, code: 18_344 };
        assert_eq!(Counts::read(amd), Some(counts));
        let intel =
            "OpenGL note 2: FS SIMD8 shader: 3234 inst, 6 loops, 9041 cycles, 18:26 spills:fills, 71 sends";
        assert_eq!(Counts::read(intel), Some(Counts { spills: 18, code: 3_234, ..Counts::default() }));
        let nvidia =
            "OpenGL note 3: type: 1, local: 16, shared: 0, gpr: 36, inst: 300, loops: 1, bytes: 2400";
        let counts = Counts { registers: 36, scratch: 16, code: 300, ..Counts::default() };
        assert_eq!(Counts::read(nvidia), Some(counts));
        assert_eq!(Counts::read("OpenGL note 4: buffer usage hint"), None);
    }
}
