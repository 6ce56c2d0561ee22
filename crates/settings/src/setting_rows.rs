//! Settings as a panel shows them: a row for each, with the values that can be chosen.

use super::{Choice, Setting};
use mariana_render::placement::Crop;

/// A row of the panel of settings.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingRow {
    /// The setting in a word or two.
    pub name: String,
    /// The purpose, in a sentence.
    pub purpose: String,
    /// The values that can be chosen.
    pub values: Values,
    /// Whether the value holds for this run only, because the command line says so.
    pub for_this_run: bool,
}

/// The values of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// The row is one of several, of which one is chosen.
    OneOfRows {
        /// Whether it is this one.
        chosen: bool,
        /// The setting that chooses it.
        setting: Setting,
    },
    /// One of several names.
    Names {
        /// The names, each with the setting that chooses it.
        options: Vec<(&'static str, Setting)>,
        /// The place of the chosen one; beyond the last if none of them is.
        chosen: usize,
    },
    /// A share of the light, in percent.
    Percent {
        /// 0..100.
        percent: f64,
        /// Makes the setting of a whole number of percent.
        setting: OfPercent,
    },
    /// The delay of the picture, in milliseconds; negative for earlier. It belongs to a device.
    Delay(f64),
}

/// Makes a setting of a whole number of percent.
#[derive(Debug, Clone, Copy)]
pub struct OfPercent(fn(u8) -> Setting);

impl OfPercent {
    /// Returns the setting; what is not 0..100 is clamped.
    pub fn at(self, percent: f64) -> Setting {
        (self.0)(percent.round().clamp(0.0, 100.0) as u8)
    }
}

impl PartialEq for OfPercent {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.0, other.0)
    }
}

/// A type whose values a row of the panel can show.
pub(super) trait Shown: Sized {
    /// Returns the values that can be chosen; `setting` makes a setting of one.
    fn values(&self, setting: fn(Self) -> Setting) -> Values;

    /// Returns the purpose of the row while this value is chosen.
    fn purpose(&self, purpose: &str) -> String {
        purpose.to_owned()
    }
}

impl<T: Choice> Shown for T {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        Values::Names {
            options: T::ALL.iter().map(|(value, name, _)| (*name, setting(*value))).collect(),
            chosen: T::ALL.iter().position(|(value, ..)| value == self).unwrap_or(T::ALL.len()),
        }
    }

    fn purpose(&self, purpose: &str) -> String {
        match T::ALL.iter().find(|(value, ..)| value == self) {
            Some((_, name, meaning)) if !meaning.is_empty() => format!("{purpose} · {name}: {meaning}"),
            _ => purpose.to_owned(),
        }
    }
}

/// Percent.
impl Shown for u8 {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        Values::Percent { percent: f64::from(*self), setting: OfPercent(setting) }
    }
}

/// Durations of fades that can be chosen, in seconds. The command line takes any.
const FADES: [(f64, &str); 5] = [(0.0, "0 s"), (0.5, "0.5 s"), (1.0, "1 s"), (2.0, "2 s"), (5.0, "5 s")];

/// Seconds of a fade.
impl Shown for f64 {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        Values::Names {
            options: FADES.iter().map(|(seconds, name)| (*name, setting(*seconds))).collect(),
            chosen: FADES.iter().position(|(seconds, _)| seconds == self).unwrap_or(FADES.len()),
        }
    }
}

/// Losses of all edges of the picture that can be chosen, in percent. The command line takes any, and each edge for
/// itself.
const CROPS: [(f64, &str); 6] =
    [(0.0, "0 %"), (1.0, "1 %"), (2.0, "2 %"), (3.0, "3 %"), (5.0, "5 %"), (10.0, "10 %")];

impl Shown for Crop {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        let crops =
            CROPS.iter().filter_map(|(percent, name)| Some((*name, Crop::try_from([*percent; 4]).ok()?)));
        let crops: Vec<(&'static str, Self)> = crops.collect();
        Values::Names {
            chosen: crops.iter().position(|(_, crop)| crop == self).unwrap_or(crops.len()),
            options: crops.into_iter().map(|(name, crop)| (name, setting(crop))).collect(),
        }
    }
}
