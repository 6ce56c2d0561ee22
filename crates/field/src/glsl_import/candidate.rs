//! Finds the function of a file that is a scene's distance.

use super::parse::{GlslFile, GlslFunction, GlslType};

/// Names of distance functions, the most common first.
const NAMES: [&str; 24] = [
    "map",
    "scene",
    "de",
    "sdf",
    "getdist",
    "getsdf",
    "distancefield",
    "world",
    "scenesdf",
    "dist",
    "df",
    "field",
    "mapscene",
    "sdscene",
    "distance_field",
    "sceneDist",
    "sdfscene",
    "estimate",
    "distanceestimator",
    "sd",
    "f",
    "distfunc",
    "dstf",
    "d",
];

/// Number of names at the start of [`NAMES`] that no helper function has.
const SURE_NAMES: usize = 9;

/// True if the function's name says that it is the distance to a scene.
pub(super) fn is_distance_for_sure(function: &GlslFunction) -> bool {
    NAMES.iter().take(SURE_NAMES).any(|known| known.eq_ignore_ascii_case(&function.name))
}

/// Returns the function of a point in space that most likely gives the distance to the scene.
pub fn candidate(file: &GlslFile) -> Option<&GlslFunction> {
    let fits = |function: &&GlslFunction| {
        let takes_point =
            matches!(function.parameters.as_slice(), [one] if one.of == Some(GlslType::Vector(3)));
        takes_point && matches!(function.result, Some(GlslType::Float | GlslType::Vector(_)))
    };
    let rank = |function: &&GlslFunction| {
        let name = function.name.to_lowercase();
        NAMES.iter().position(|known| known.eq_ignore_ascii_case(&name))
    };
    let named =
        file.functions().iter().filter(fits).filter_map(|function| Some((rank(&function)?, function)));
    named.min_by_key(|(rank, _)| *rank).map(|(_, function)| function)
}
