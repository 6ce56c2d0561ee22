//! Parsers of flags: names, and numbers that are checked against the limits.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mariana_field::world::BlendKind;

use crate::config::{Choice, setting_limits};
use crate::export::video::VideoPart;
use crate::limits;
use crate::placement::{Corners, Crop};
use crate::y4m::ntsc_rate;

/// Returns a parser of names.
pub(super) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let names = T::ALL.iter().map(|(_, name, meaning)| match *meaning {
        "" => PossibleValue::new(*name),
        meaning => PossibleValue::new(*name).help(meaning),
    });
    let unknown = "unknown name";
    PossibleValuesParser::new(names.collect::<Vec<_>>()).try_map(move |name| T::named(&name).ok_or(unknown))
}

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let (width, height) =
        text.split_once(['x', 'X', '×']).ok_or("write the size as WIDTHxHEIGHT, such as 1280x720")?;
    let side = |text: &str| {
        let value: u32 =
            text.trim().parse().map_err(|_| format!("'{text}' is not a whole number of pixels"))?;
        let (low, high) = (limits::PICTURE_SIDE_MIN, limits::PICTURE_SIDE_MAX);
        if (low..=high).contains(&value) {
            Ok(value)
        } else {
            Err(format!("a side must have {low} to {high} pixels"))
        }
    };
    let (width, height) = (side(width)?, side(height)?);
    let pixels = u64::from(width) * u64::from(height);
    if pixels > limits::PICTURE_PIXELS_MAX {
        return Err(format!("an image can have at most {} pixels, not {pixels}", limits::PICTURE_PIXELS_MAX));
    }
    Ok((width, height))
}

/// Parses a pixel of an image: `640,360`.
pub(super) fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    let (x, y) = text.split_once(',').ok_or("write the pixel as X,Y, such as 640,360")?;
    let number =
        |text: &str| text.trim().parse().map_err(|_| format!("'{text}' is not a whole number of pixels"));
    Ok((number(x)?, number(y)?))
}

/// Returns a parser of numbers.
pub(super) fn number(
    low: f64,
    high: f64,
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| parse_within(text, low, high, unit)
}

/// Returns a parser of whole numbers.
pub(super) fn whole_number<T: From<u16>>(
    low: u16,
    high: u16,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| parse_whole(text, low, high, unit).map(T::from)
}

fn parse_within(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let value = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    within(value, low, high, unit)
}

fn within(value: f64, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    if value >= low && value <= high {
        Ok(value)
    } else {
        Err(format!("the value must be from {low} to {high} {unit}"))
    }
}

fn parse_whole(text: &str, low: u16, high: u16, unit: &str) -> Result<u16, String> {
    let value: i64 = text.trim().parse().map_err(|_| format!("'{text}' is not a whole number"))?;
    let value = u16::try_from(value).ok().filter(|value| (low..=high).contains(value));
    value.ok_or_else(|| format!("the value must be from {low} to {high} {unit}"))
}

pub(super) fn parse_percent(text: &str) -> Result<u8, String> {
    Ok(parse_whole(text, 0, 100, "percent")? as u8)
}

pub(super) fn parse_noise(text: &str) -> Result<f32, String> {
    parse_within(text, 0.0, 1.0, "of the light").map(|noise| noise as f32)
}

/// Parses a part of a video: `3/8`.
pub(super) fn parse_part(text: &str) -> Result<VideoPart, String> {
    let (number, of) = text.split_once('/').ok_or("write the part as NUMBER/PARTS, such as 3/8")?;
    let of = u64::from(parse_whole(of, 1, limits::PARTS_OF_VIDEO_MAX, "parts")?);
    match number.trim().parse() {
        Ok(number) if (1..=of).contains(&number) => Ok(VideoPart { number, of }),
        _ => Err(format!("'{}' is none of the parts 1 to {of}", number.trim())),
    }
}

/// Parses a kind of blend and the fraction of the second scene: `melt:0.5`.
pub(super) fn parse_blend(text: &str) -> Result<(BlendKind, f32), String> {
    let (name, fraction) =
        text.split_once(':').ok_or("write the blend as KIND:FRACTION, such as melt:0.5")?;
    let kind = BlendKind::named(name.trim()).ok_or_else(|| {
        let names: Vec<&str> = BlendKind::ALL.iter().map(|(_, name, _)| *name).collect();
        format!("'{}' is no kind of blend: choose one of {}", name.trim(), names.join(", "))
    })?;
    Ok((kind, parse_within(fraction, 0.0, 1.0, "of the second scene")? as f32))
}

pub(super) fn blend_help() -> String {
    let kinds = BlendKind::ALL.iter().map(|(_, name, meaning)| format!("{name}, where {meaning}"));
    let kinds: Vec<String> = kinds.collect();
    format!("Kind of blend, and the fraction of the second scene from 0 to 1: {}", kinds.join("; "))
}

/// Parses a time in a song: `80`, `1:20`, `1:20.5`, `1:02:03`. Only the largest unit may exceed 59.
pub(super) fn parse_seconds(text: &str) -> Result<f64, String> {
    let whole = |text: &str| text.parse::<u32>().ok().map(f64::from);
    let last = |text: &str| text.parse().ok().filter(|_| text.starts_with(|c: char| c.is_ascii_digit()));
    let sixty = |large: Option<f64>, small: Option<f64>| {
        Some(60.0 * large? + small.filter(|small| (0.0..60.0).contains(small))?)
    };
    let value = match text.trim().split(':').collect::<Vec<_>>()[..] {
        [seconds] => seconds.parse().ok(),
        [minutes, seconds] => sixty(whole(minutes), last(seconds)),
        [hours, minutes, seconds] => sixty(sixty(whole(hours), whole(minutes)), last(seconds)),
        _ => None,
    };
    let value = value.ok_or_else(|| {
        format!("'{text}' is no time: write seconds, such as 80, or minutes and seconds, such as 1:20.5")
    })?;
    within(value, 0.0, limits::SECONDS_MAX, "seconds")
}

pub(super) fn parse_duration(text: &str) -> Result<f64, String> {
    match parse_seconds(text)? {
        0.0 => Err("the length must be more than 0 seconds".into()),
        seconds => Ok(seconds),
    }
}

/// Parses a frame rate: `60`, `30000/1001` or `29.97`, which is short for the same rate.
pub(super) fn parse_fps(text: &str) -> Result<f64, String> {
    let (frames, seconds) = text.split_once('/').unwrap_or((text, "1"));
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| format!("'{text}' is not a number"));
    let fps =
        within(number(frames)? / number(seconds)?, limits::FPS_MIN, limits::FPS_MAX, "frames per second")?;
    Ok(ntsc_rate(fps).unwrap_or(fps))
}

pub(super) fn parse_fade(text: &str) -> Result<f64, String> {
    parse_within(text, 0.0, setting_limits::FADE_SECONDS_MAX, "seconds")
}

fn parse_numbers<const COUNT: usize>(text: &str, example: &str) -> Result<[f64; COUNT], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| format!("write {COUNT} numbers separated by commas, such as {example}"))
}

/// Parses the crop at the edges of the output, in percent.
pub(super) fn parse_crop(text: &str) -> Result<Crop, String> {
    Ok(Crop::try_from(parse_numbers::<4>(text, "10,0,10,0")?)?)
}

/// Parses the corners of the output, in percent.
pub(super) fn parse_corners(text: &str) -> Result<Corners, String> {
    if text.trim() == "off" {
        return Ok(Corners::default());
    }
    let percent = parse_numbers::<8>(text, "0,0,100,5,100,95,0,100")?;
    let mut corners = [[0.0; 2]; 4];
    for (fraction, percent) in corners.as_flattened_mut().iter_mut().zip(percent) {
        *fraction = percent / 100.0;
    }
    Ok(Corners::try_from(corners)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_within_the_limits_are_read_and_others_refused_with_the_limit() {
        assert_eq!(parse_size("1280x720"), Ok((1280, 720)));
        assert_eq!(parse_size("1X16384"), Ok((1, 16384)));
        for (text, part) in [
            ("1280", "WIDTHxHEIGHT"),
            ("0x5", "1 to 16384"),
            ("16385x5", "1 to 16384"),
            ("-3x5", "whole number"),
            ("16384x16384", "at most"),
            ("axb", "whole number"),
        ] {
            let message = parse_size(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn numbers_are_those_within_the_limits() {
        let (parse, parse_whole) = (number(-1.5, 9.0, "units"), whole_number::<u32>(2, 9, "units"));
        for value in [-1.5, 0.0, 9.0] {
            assert_eq!(parse(&value.to_string()), Ok(value));
        }
        for value in [-1.6, 9.1, f64::NAN, f64::INFINITY] {
            assert!(parse(&value.to_string()).is_err(), "{value}");
        }
        assert_eq!([2, 9].map(|value| parse_whole(&value.to_string())), [Ok(2), Ok(9)]);
        for text in ["1", "10", "-2", "70000", "2.5", ""] {
            assert!(parse_whole(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_outside_the_limits_and_non_numbers_are_refused() {
        for text in [
            "nan", "inf", "-1", "1e9", "x", "", ":", "1:", ":5", "1:-5", "1:60", "-1:5", "1:60:00",
            "1:2:3:4", "1.5:3", "1:inf",
        ] {
            assert!(parse_seconds(text).is_err(), "{text}");
        }
        for (text, seconds) in [
            ("12.5", 12.5),
            ("80", 80.0),
            ("1:20", 80.0),
            ("01:20.5", 80.5),
            ("90:00", 5_400.0),
            ("1:02:03", 3_723.0),
        ] {
            assert_eq!(parse_seconds(text), Ok(seconds));
        }
        for text in ["0", "1001", "x", "30/x", "30/0", "nan"] {
            assert!(parse_fps(text).is_err(), "{text}");
        }
    }

    #[test]
    fn short_rates_of_film_and_television_are_exact() {
        for (text, frames) in
            [("23.976", 24), ("23.98", 24), ("29.97", 30), ("30000/1001", 30), ("59.94", 60)]
        {
            assert_eq!(parse_fps(text).map(|fps| fps * 1.001), Ok(f64::from(frames)), "{text}");
        }
        for (text, fps) in [("24", 24.0), ("12.5", 12.5), ("23.9", 23.9), ("60/1", 60.0)] {
            assert_eq!(parse_fps(text), Ok(fps));
        }
    }

    #[test]
    fn edges_and_corners_are_in_percent_and_impossible_ones_are_refused() {
        assert_eq!(parse_crop("10, 0,5.5,0").map(<[f64; 4]>::from), Ok([10.0, 0.0, 5.5, 0.0]));
        let corners = parse_corners("0,0,100,5,100,95,-2,100").map(<[[f64; 2]; 4]>::from);
        assert_eq!(corners, Ok([[0.0, 0.0], [1.0, 0.05], [1.0, 0.95], [-0.02, 1.0]]));
        assert_eq!(parse_corners("off"), Ok(Corners::default()));
        for (text, part) in [("1,2,3", "4 numbers"), ("60,0,60,0", "0 to 90"), ("a,b,c,d", "4 numbers")] {
            let message = parse_crop(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
        for (text, part) in [
            ("0,0,1,1", "8 numbers"),
            ("100,0,0,0,0,100,100,100", "clockwise"),
            ("0,0,999,0,100,100,0,100", "one screen"),
        ] {
            let message = parse_corners(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
