//! Views: false-colour images of the rendering process, with a legend. One table names the views for the key that
//! shows them, the command line and the shaders.
//!
//! `shaders/view.glsl` draws the views. Its colours and numbers come from [`scale`], as in the legends.
//!
//! **Views have their own programs**: variants of the scene's program that count evaluations and record the first
//! surface of each ray, so a view measures the real rendering. The programs are compiled when a view is first
//! requested. Colours go straight into the finished image. Each pixel has one sample, because the mean of two counts
//! is not a count.

pub mod caption;
pub mod legend;
pub(crate) mod letters;
pub mod scale;
pub mod setup;

use std::str::FromStr;

/// A row of [`VIEWS`].
pub struct ViewRow {
    /// The view.
    pub view: View,
    /// Name on the command line and in the title. Its function in `shaders/view.glsl` is `view_NAME`.
    pub name: &'static str,
    /// Description of the view.
    pub meaning: &'static str,
    /// Meaning of the number after the name, for views that take a number.
    pub number: Option<&'static str>,
}

/// Defines [`View`] and [`VIEWS`] from rows. A row has documentation, view, name, description, and the meaning of the
/// number if the view takes a number.
macro_rules! define_views {
    ($( $(#[$documentation:meta])* $view:ident, $name:literal, $meaning:literal $(, $number:literal)?; )*) => {
        /// A view. Its number, here and in the shaders, is its index in [`VIEWS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum View { $( $(#[$documentation])* $view, )* }

        /// All views, in the order in which the key steps through them.
        pub const VIEWS: [ViewRow; [$($name),*].len()] = [$( ViewRow {
            view: View::$view,
            name: $name,
            meaning: $meaning,
            number: [$(Some($number),)? None][0],
        }, )*];
    };
}

// A new view needs a row here, an arm in `setup` and a function `view_NAME` in `shaders/view.glsl`. Compilers report
// what is missing.
define_views! {
    /// Steps of the ray from the eye.
    Steps, "steps", "steps of the ray from the eye, blue to red", "the count shown in red, 100 by default";
    /// The distance on a plane through the camera's target.
    Slice, "slice", "the distance on a plane through the camera's target, as lines",
        "the distance between two lines";
    /// Normals by finite differences.
    Normals, "normals", "normals of the surfaces, by finite differences of the distance",
        "the step of the differences, by default a fraction of a pixel";
    /// The fraction of direct light that arrives at the surface.
    Shadow, "shadow", "the fraction of direct light that arrives";
    /// The fraction of ambient light that arrives at the surface.
    Occlusion, "occlusion", "the fraction of the ambient light that arrives";
    /// The number of clauses or evaluations for a pixel.
    Clauses, "clauses", "clauses that the interpreter runs; distance evaluations if compiled", "the count shown in red";
    /// The cells of the region tree.
    Cells, "cells", "the cells of the regions, and the lengths of their tapes";
    /// A colour for each object.
    Materials, "materials", "a colour for each object";
    /// The distance along the ray to the surface.
    Depth, "depth", "the distance to the surface", "the distance shown in black";
}

/// Range of the number after a view's name.
const NUMBERS: (f32, f32) = (1e-5, 1e6);

/// A view with its optional number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewChoice {
    /// The view.
    pub view: View,
    /// The number described by [`ViewRow::number`]; `None` for the view's default.
    pub number: Option<f32>,
}

/// The list of views for the command line's help, one per line.
pub fn help() -> String {
    let mut text = String::from("Show a view of the rendering process, with a legend:\n");
    for row in &VIEWS {
        text.push_str(&format!("- {}: {}", row.name, row.meaning));
        if let Some(number) = row.number {
            text.push_str(&format!("; {}:NUMBER sets {number}", row.name));
        }
        text.push('\n');
    }
    text
}

impl View {
    /// The view's row in [`VIEWS`].
    pub fn row(self) -> &'static ViewRow {
        &VIEWS[self as usize % VIEWS.len()]
    }

    /// Returns the view after `view`, or before it if not `forward`. `None` is before the first and after the last.
    pub fn beside(view: Option<Self>, forward: bool) -> Option<Self> {
        let places = VIEWS.len() + 1;
        let place = view.map_or(0, |view| view as usize + 1);
        let next = if forward { place + 1 } else { place + places - 1 } % places;
        VIEWS.get(next.wrapping_sub(1)).map(|row| row.view)
    }
}

impl From<View> for ViewChoice {
    fn from(view: View) -> Self {
        Self { view, number: None }
    }
}

impl FromStr for ViewChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, number) = text.split_once(':').map_or((text, None), |(name, number)| (name, Some(number)));
        let name = name.trim();
        let row = VIEWS.iter().find(|row| row.name == name).ok_or_else(|| {
            format!("there is no view '{name}'; the views are {}", VIEWS.map(|row| row.name).join(", "))
        })?;
        let number = match number {
            None => None,
            Some(number) if row.number.is_none() => {
                return Err(format!("the view '{name}' takes no number: leave out ':{number}'"));
            }
            Some(text) => match text.trim().parse() {
                Err(_) => {
                    return Err(format!("'{text}' after '{name}:' is not a number: write it as {name}:0.5"));
                }
                Ok(number) if (NUMBERS.0..=NUMBERS.1).contains(&number) => Some(number),
                Ok(_) => {
                    return Err(format!(
                        "{text} after '{name}:' is out of range: write a number from 0.00001 to 1000000"
                    ));
                }
            },
        };
        Ok(Self { view: row.view, number })
    }
}

impl std::fmt::Display for ViewChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.view.row().name)?;
        self.number.map_or(Ok(()), |number| write!(f, ":{number}"))
    }
}

impl ViewChoice {
    /// Returns the view with the next number after `present` in the series 1, 2, 5, 10 ..., or the number before if not
    /// `larger`. A step below the smallest number returns to the view's default.
    pub fn stepped(self, present: Option<f32>, larger: bool) -> Self {
        let row = self.view.row();
        if row.number.is_none() {
            return self;
        }
        let number = match (present, larger) {
            (None, true) => Some(STEP_MIN),
            (None, false) => None,
            (Some(present), _) => Some(scale::beside(present, larger)),
        };
        Self { number: number.filter(|number| (STEP_MIN * 0.99..=NUMBERS.1).contains(number)), ..self }
    }
}

/// The smallest number that the key can select.
const STEP_MIN: f32 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_parsed_again() {
        for row in &VIEWS {
            assert_eq!(row.name.parse(), Ok(ViewChoice::from(row.view)));
            let with_number = format!("{}:0.5", row.name).parse::<ViewChoice>();
            assert_eq!(with_number.is_ok(), row.number.is_some(), "{with_number:?}");
        }
    }

    #[test]
    fn invalid_views_are_reported() {
        let error = "step".parse::<ViewChoice>().unwrap_err();
        assert!(VIEWS.iter().all(|row| error.contains(row.name)), "{error}");
        for (text, expected) in [
            ("shadow:2", "the view 'shadow' takes no number: leave out ':2'"),
            ("steps:many", "'many' after 'steps:' is not a number: write it as steps:0.5"),
            ("steps:", "'' after 'steps:' is not a number: write it as steps:0.5"),
            ("depth:0", "0 after 'depth:' is out of range: write a number from 0.00001 to 1000000"),
            ("depth:inf", "inf after 'depth:' is out of range: write a number from 0.00001 to 1000000"),
            ("normals:NaN", "NaN after 'normals:' is out of range: write a number from 0.00001 to 1000000"),
        ] {
            assert_eq!(text.parse::<ViewChoice>(), Err(expected.to_owned()));
        }
    }

    #[test]
    fn the_key_cycles_through_all_views_and_the_image() {
        let mut seen = vec![None];
        for _ in 0..VIEWS.len() {
            seen.push(View::beside(seen[seen.len() - 1], true));
        }
        assert_eq!(seen[1..], VIEWS.map(|row| Some(row.view)));
        assert_eq!(View::beside(seen[VIEWS.len()], true), None);
        for pair in seen.windows(2) {
            assert_eq!(View::beside(pair[1], false), pair[0]);
        }
    }

    #[test]
    fn numbers_step_by_one_two_five() {
        let mut choice = ViewChoice::from(View::Normals);
        let mut numbers = Vec::new();
        for _ in 0..5 {
            choice = choice.stepped(choice.number, true);
            numbers.extend(choice.number);
        }
        assert_eq!(numbers, [0.001, 0.002, 0.005, 0.01, 0.02]);
        for _ in 0..5 {
            choice = choice.stepped(choice.number, false);
        }
        assert_eq!(choice.number, None);
        assert_eq!(ViewChoice::from(View::Shadow).stepped(None, true).number, None);
        assert_eq!(ViewChoice::from(View::Steps).stepped(Some(100.0), true).number, Some(200.0));
    }
}
