//! SVG drawings as coverage and brightness.
//!
//! Reads what logos are made of: paths and basic shapes, filled or stroked, in groups and symbols, with transformations,
//! attributes, `style`, and style sheets with simple selectors. Gradients count as opaque. Text, pictures, masks and
//! filters are left out.

use std::collections::{BTreeSet, HashMap};

use kurbo::{
    Affine, BezPath, Cap, Ellipse, Join, PathSeg, Point, Rect, RoundedRect, Shape, Stroke, StrokeOpts,
};

use super::outline::{Coverage, Filling, Part, Steps, TooMuchWork};
use super::xml::{Element, Tree, too_deep};
use crate::limits;

/// Largest deviation of a stroke's outline, relative to the size of the drawing.
const STROKE_PRECISION: f64 = 1e-4;

/// A drawing: its painted shapes, and the rectangle to show.
#[derive(Debug)]
pub(super) struct Drawing {
    shapes: Vec<Painted>,
    pub view: Rect,
}

#[derive(Debug)]
struct Painted {
    path: BezPath,
    filling: Filling,
    brightness: f32,
}

/// Why an SVG cannot be drawn: a sentence, and true if it exceeds a limit.
pub(super) type Refused = (String, bool);

pub(super) type Result<T, E = Refused> = std::result::Result<T, E>;

/// True if the bytes look like an SVG.
pub(super) fn is_svg(name: &str, bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(bytes.get(..512).unwrap_or(bytes));
    name.rsplit_once('.').is_some_and(|(_, end)| end.eq_ignore_ascii_case("svg")) || start.contains("<svg")
}

impl Drawing {
    /// Reads an SVG.
    ///
    /// # Errors
    /// Fails with a reason if the text is no SVG, exceeds a limit, or paints nothing.
    pub(super) fn of(bytes: &[u8]) -> Result<Self> {
        let text = std::str::from_utf8(bytes)
            .map_err(|error| (format!("byte {} is not UTF-8", error.valid_up_to()), false))?;
        let tree = Tree::of(text.trim_start_matches('\u{feff}'))?;
        let Some(root) = tree.elements.first().filter(|root| root.name == "svg") else {
            let first = tree.elements.first().map_or("", |root| root.name.as_str());
            return Err((format!("its first element is `{first}`, not `svg`"), false));
        };
        let view = root.attribute("viewBox").map(|text| numbers(text).collect::<Vec<_>>());
        let view = view.and_then(|numbers| match numbers[..] {
            [x, y, width, height] => Some(Rect::new(x, y, x + width, y + height)),
            _ => None,
        });
        let size = ["width", "height"].map(|name| root.attribute(name).and_then(length));
        let view = view.or(match size {
            [Some(width), Some(height)] => Some(Rect::new(0.0, 0.0, width, height)),
            _ => None,
        });
        let is_usable = |view: &Rect| view.width() > 0.0 && view.height() > 0.0;
        let view = view.filter(is_usable);
        let mut reader = Reader {
            tree: &tree,
            ids: tree
                .elements
                .iter()
                .filter_map(|element| Some((element.attribute("id")?, element)))
                .collect(),
            rules: Rules::of(&tree),
            shapes: Vec::new(),
            parts_left: limits::DRAWING_SHAPES_MAX.1,
            visits_left: limits::DRAWING_VISITS_MAX,
            scale: view.map_or(100.0, |view| view.width().max(view.height())),
            has_text: false,
        };
        reader.children(root, &Style::default(), Affine::IDENTITY, 0)?;
        let Reader { shapes, has_text, .. } = reader;
        let around = || shapes.iter().map(|one| one.path.bounding_box()).reduce(|a, b| a.union(b));
        let view = view.or_else(around).filter(is_usable);
        match view {
            Some(view) if !shapes.is_empty() => Ok(Self { shapes, view }),
            _ if has_text => Err(("it paints only texts: convert them to paths".to_owned(), false)),
            _ => Err(("it paints nothing that is a path or a basic shape".to_owned(), false)),
        }
    }

    /// Returns the drawing's opacity if it is transparent anywhere, else its brightness. `place` converts the drawing's
    /// units to pixels.
    ///
    /// # Errors
    /// Fails with a reason if the drawing covers the picture too many times.
    pub(super) fn coverage(&self, place: Affine, width: usize, height: usize) -> Result<Coverage> {
        let mut opacity = Coverage::none(width, height);
        let mut brightness = Coverage::none(width, height);
        let layers = limits::LAYERS_MAX;
        let mut steps = Steps(layers * width * height);
        for shape in &self.shapes {
            let path = place * shape.path.clone();
            let part = Part::of(&path, shape.filling, (width, height), &mut steps);
            let part = part.map_err(|TooMuchWork| {
                (format!("its shapes and their edges cover it more than {layers} times"), true)
            })?;
            let Some(part) = part else { continue };
            opacity.paint(&part, 1.0);
            brightness.paint(&part, shape.brightness);
        }
        // The margin around the view is transparent, so look at the view alone.
        let view = place.transform_rect_bbox(self.view).inset(-1.0);
        let inside =
            |at: usize| view.contains(Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5));
        let is_opaque = opacity.values.iter().enumerate().all(|(at, value)| *value > 0.5 || !inside(at));
        Ok(if is_opaque { brightness } else { opacity })
    }
}

struct Reader<'d> {
    tree: &'d Tree,
    ids: HashMap<&'d str, &'d Element>,
    rules: Rules<'d>,
    shapes: Vec<Painted>,
    /// Parts of paths that may still be painted.
    parts_left: usize,
    /// Elements that may still be visited, and bytes of their properties.
    visits_left: (usize, usize),
    scale: f64,
    has_text: bool,
}

/// Properties that children inherit.
#[derive(Debug, Clone)]
struct Style {
    fill: Option<f32>,
    odd: bool,
    stroke: Option<f32>,
    width: f64,
    cap: Cap,
    join: Join,
    opacity: [f64; 3],
}

impl Default for Style {
    fn default() -> Self {
        let (cap, join) = (Cap::Butt, Join::Miter);
        Self { fill: Some(0.0), odd: false, stroke: None, width: 1.0, cap, join, opacity: [1.0; 3] }
    }
}

impl<'d> Reader<'d> {
    fn children(&mut self, of: &'d Element, style: &Style, place: Affine, depth: usize) -> Result<()> {
        let tree = self.tree;
        let mut children = of.children.iter().filter_map(|child| tree.elements.get(*child));
        children.try_for_each(|child| self.element(child, style, place, depth))
    }

    fn element(&mut self, element: &'d Element, style: &Style, place: Affine, depth: usize) -> Result<()> {
        if depth > limits::DRAWING_NESTING_MAX {
            return Err(too_deep());
        }
        let mut style = style.clone();
        let mut hidden = false;
        let transform = element.attribute("transform");
        let mut own = place * transform.map_or(Affine::IDENTITY, transformation);
        for (name, value) in self.properties(element)? {
            match (name, value.trim()) {
                ("display", "none") | ("visibility", "hidden" | "collapse") => hidden = true,
                ("transform", value) if transform.is_none() => own *= transformation(value),
                (name, value) => style.set(name, value),
            }
        }
        if hidden {
            return Ok(());
        }
        match element.name.as_str() {
            "g" | "a" | "svg" | "switch" => self.children(element, &style, own, depth + 1),
            "use" => {
                let at = ["x", "y"].map(|name| element.attribute(name).and_then(length).unwrap_or(0.0));
                let link = element.attribute("href");
                let target = link.and_then(|link| self.ids.get(link.trim_start_matches('#')).copied());
                let Some(target) = target else { return Ok(()) };
                let own = own * Affine::translate((at[0], at[1]));
                if target.name == "symbol" {
                    return self.children(target, &style, own, depth + 1);
                }
                self.element(target, &style, own, depth + 1)
            }
            "text" => {
                self.has_text = true;
                Ok(())
            }
            _ => match path_of(element)? {
                Some(path) => self.paint(&path, &style, own),
                None => Ok(()),
            },
        }
    }

    fn paint(&mut self, path: &BezPath, style: &Style, place: Affine) -> Result<()> {
        let [all, fill, stroke] = style.opacity;
        if let Some(brightness) = style.fill.filter(|_| all * fill >= 0.5) {
            self.count(path.elements().len())?;
            let filling = if style.odd { Filling::Odd } else { Filling::Turning };
            self.add(Painted { path: place * path, filling, brightness })?;
        }
        let is_stroked = style.width > 0.0 && all * stroke >= 0.5;
        if let Some(brightness) = style.stroke.filter(|_| is_stroked) {
            let precision = STROKE_PRECISION * self.scale;
            self.count(stroke_parts(path, style.width, precision, self.parts_left))?;
            let stroke = Stroke::new(style.width).with_caps(style.cap).with_join(style.join);
            let outline = kurbo::stroke(path.iter(), &stroke, &StrokeOpts::default(), precision);
            self.add(Painted { path: place * outline, filling: Filling::Turning, brightness })?;
        }
        Ok(())
    }

    /// Counts a shape and the parts of its path, before the path is made.
    fn count(&mut self, parts: usize) -> Result<()> {
        let (shapes_max, parts_max) = limits::DRAWING_SHAPES_MAX;
        let left = self.parts_left.checked_sub(parts).filter(|_| self.shapes.len() < shapes_max);
        let most =
            || (format!("it paints more than {shapes_max} shapes or {parts_max} parts of paths"), true);
        self.parts_left = left.ok_or_else(most)?;
        Ok(())
    }

    fn add(&mut self, shape: Painted) -> Result<()> {
        let bounds = shape.path.control_box();
        let most = limits::DRAWING_REACH_MAX;
        if !bounds.is_finite()
            || [bounds.x0, bounds.y0, bounds.x1, bounds.y1].iter().any(|end| end.abs() > most)
        {
            return Err((format!("a shape reaches farther than {most:e} units"), true));
        }
        self.shapes.push(shape);
        Ok(())
    }

    /// Attributes, rules of style sheets, and the attribute `style`: later ones win.
    fn properties(&mut self, element: &'d Element) -> Result<Vec<(&'d str, &'d str)>> {
        let (elements_max, bytes_max) = limits::DRAWING_VISITS_MAX;
        let rules = self.rules.for_element(element);
        let own = element.attributes.iter().map(|(name, value)| name.len() + value.len());
        let bytes = own.chain(rules.iter().map(|rule| rule.0)).sum();
        let left = self.visits_left.0.checked_sub(1).zip(self.visits_left.1.checked_sub(bytes));
        self.visits_left = left.ok_or_else(|| {
            let most =
                format!("its uses and styles repeat more than {elements_max} elements or {bytes_max} bytes");
            (most, true)
        })?;
        let own = element.attributes.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let of_rules = rules.iter().flat_map(|rule| rule.1.iter().copied());
        let of_style = element.attribute("style").into_iter().flat_map(declarations);
        Ok(own.chain(of_rules).chain(of_style).collect())
    }
}

/// Returns about how many parts the outline of a stroke has, and stops soon after `most`. kurbo divides a curve into as
/// many as 512 parts, so each curve is tried.
fn stroke_parts(path: &BezPath, width: f64, precision: f64, most: usize) -> usize {
    let (mut parts, mut side) = (0, BezPath::new());
    for segment in path.segments() {
        // The two sides, and a join or caps.
        parts += 4;
        if !matches!(segment, PathSeg::Line(_)) {
            for distance in [-0.5 * width, 0.5 * width] {
                kurbo::offset::offset_cubic(segment.to_cubic(), distance, precision, &mut side);
                parts += side.elements().len();
            }
        }
        if parts > most {
            break;
        }
    }
    parts
}

impl Style {
    fn set(&mut self, name: &str, value: &str) {
        let value = value.trim_end_matches("!important").trim();
        match name {
            "fill" => self.fill = paint(value, self.fill),
            "stroke" => self.stroke = paint(value, self.stroke),
            "fill-rule" => self.odd = value == "evenodd",
            "stroke-width" => self.width = length(value).unwrap_or(self.width),
            "stroke-linecap" => {
                self.cap = match value {
                    "round" => Cap::Round,
                    "square" => Cap::Square,
                    _ => Cap::Butt,
                }
            }
            "stroke-linejoin" => {
                self.join = match value {
                    "round" => Join::Round,
                    "bevel" => Join::Bevel,
                    _ => Join::Miter,
                }
            }
            "opacity" => self.opacity[0] *= fraction(value),
            "fill-opacity" => self.opacity[1] = fraction(value),
            "stroke-opacity" => self.opacity[2] = fraction(value),
            _ => {}
        }
    }
}

fn fraction(value: &str) -> f64 {
    let percent = value.strip_suffix('%').and_then(|value| Some(value.trim().parse::<f64>().ok()? / 100.0));
    percent
        .or_else(|| value.parse().ok())
        .filter(|value: &f64| value.is_finite())
        .unwrap_or(1.0)
        .clamp(0.0, 1.0)
}

/// Returns the brightness of a paint, 0..1; `None` for no paint. The brightness of gradients and of unknown names is 0.5.
fn paint(value: &str, inherited: Option<f32>) -> Option<f32> {
    let luminance = |[red, green, blue]: [f32; 3]| (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0;
    let lower = value.to_ascii_lowercase();
    match lower.as_str() {
        "none" | "transparent" => return None,
        "inherit" => return inherited,
        "black" => return Some(0.0),
        "white" => return Some(1.0),
        _ => {}
    }
    if let Some(digits) = lower.strip_prefix('#') {
        let digits: Vec<f32> = digits.chars().filter_map(|digit| Some(digit.to_digit(16)? as f32)).collect();
        let color = match digits[..] {
            [r, g, b] | [r, g, b, _] => [17.0 * r, 17.0 * g, 17.0 * b],
            [r, s, g, h, b, c] | [r, s, g, h, b, c, _, _] => [16.0 * r + s, 16.0 * g + h, 16.0 * b + c],
            _ => return Some(0.5),
        };
        return Some(luminance(color));
    }
    if let Some(inner) = lower.strip_prefix("rgb").and_then(|rest| rest.split_once('('))
        && let [r, g, b, ..] = numbers(inner.1.trim_end_matches(')')).collect::<Vec<_>>()[..]
    {
        return Some(luminance([r as f32, g as f32, b as f32]).clamp(0.0, 1.0));
    }
    Some(0.5)
}

/// The path of an element; `None` if the element is no shape.
fn path_of(element: &Element) -> Result<Option<BezPath>> {
    let number = |name: &str| element.attribute(name).and_then(length);
    let of = |name: &str| number(name).unwrap_or(0.0);
    const PRECISION: f64 = 1e-3;
    Ok(Some(match element.name.as_str() {
        "path" => {
            let text = element.attribute("d").unwrap_or_default();
            let most = limits::DRAWING_NUMBER_MAX;
            // kurbo divides arcs of huge radii without end.
            if numbers(text).any(|number| number.abs() >= most) {
                return Err((format!("a path has a number of {most:e} or more"), true));
            }
            // A path with a mistake is left out.
            BezPath::from_svg(text).unwrap_or_default()
        }
        "rect" => {
            let (width, height) = (of("width"), of("height"));
            let radius =
                number("rx").or(number("ry")).unwrap_or(0.0).clamp(0.0, 0.5 * width.min(height).max(0.0));
            let rect = Rect::new(of("x"), of("y"), of("x") + width, of("y") + height);
            match radius > 0.0 {
                true => RoundedRect::from_rect(rect, radius).to_path(PRECISION * width.max(height)),
                false => rect.to_path(PRECISION),
            }
        }
        kind @ ("circle" | "ellipse") => {
            let radii = if kind == "circle" { (of("r"), of("r")) } else { (of("rx"), of("ry")) };
            Ellipse::new((of("cx"), of("cy")), radii, 0.0).to_path(PRECISION * radii.0.max(radii.1).max(1e-6))
        }
        "line" => {
            let mut path = BezPath::new();
            path.move_to((of("x1"), of("y1")));
            path.line_to((of("x2"), of("y2")));
            path
        }
        kind @ ("polyline" | "polygon") => {
            let mut path = BezPath::new();
            let points: Vec<f64> = numbers(element.attribute("points").unwrap_or_default()).collect();
            for at in points.as_chunks::<2>().0 {
                let at = (at[0], at[1]);
                if path.is_empty() { path.move_to(at) } else { path.line_to(at) }
            }
            if kind == "polygon" && !path.is_empty() {
                path.close_path();
            }
            path
        }
        _ => return Ok(None),
    }))
}

/// Returns the numbers in a text, separated by any other characters, clamped to [`crate::limits::DRAWING_NUMBER_MAX`].
fn numbers(text: &str) -> impl Iterator<Item = f64> {
    let mut rest = text;
    std::iter::from_fn(move || {
        loop {
            let start = rest.find(|letter: char| letter.is_ascii_digit() || "+-.".contains(letter))?;
            rest = rest.get(start..).unwrap_or_default();
            let mut seen = (false, false);
            let end = rest.char_indices().find(|(at, letter)| {
                let before = rest.get(..*at).and_then(|text| text.chars().last());
                let is_sign_of_exponent = "+-".contains(*letter) && matches!(before, Some('e' | 'E'));
                let continues = match letter {
                    '0'..='9' => true,
                    '.' => !std::mem::replace(&mut seen.0, true) && !seen.1,
                    'e' | 'E' => !std::mem::replace(&mut seen.1, true) && *at > 0,
                    '+' | '-' => *at == 0 || is_sign_of_exponent,
                    _ => false,
                };
                !continues
            });
            let (number, after) = rest.split_at(end.map_or(rest.len(), |(at, _)| at.max(1)));
            rest = after;
            let most = limits::DRAWING_NUMBER_MAX;
            if let Ok(number) = number.trim_end_matches(['e', 'E']).parse::<f64>() {
                return Some(number.clamp(-most, most));
            }
        }
    })
}

/// A length in pixels. Percentages have no value.
fn length(text: &str) -> Option<f64> {
    if text.trim_end().ends_with('%') {
        return None;
    }
    let unit = match text.trim().get(text.trim().len().saturating_sub(2)..) {
        Some("mm") => 96.0 / 25.4,
        Some("cm") => 96.0 / 2.54,
        Some("in") => 96.0,
        Some("pt") => 96.0 / 72.0,
        Some("pc") => 16.0,
        _ => 1.0,
    };
    numbers(text).next().map(|number| number * unit)
}

fn transformation(text: &str) -> Affine {
    let mut whole = Affine::IDENTITY;
    for part in text.split(')') {
        let Some((name, arguments)) = part.split_once('(') else { continue };
        whole *= match (
            name.trim_matches(|letter: char| !letter.is_ascii_alphabetic()),
            &numbers(arguments).collect::<Vec<_>>()[..],
        ) {
            ("matrix", [a, b, c, d, e, f]) => Affine::new([*a, *b, *c, *d, *e, *f]),
            ("translate", [x]) => Affine::translate((*x, 0.0)),
            ("translate", [x, y]) => Affine::translate((*x, *y)),
            ("scale", [both]) => Affine::scale(*both),
            ("scale", [x, y]) => Affine::scale_non_uniform(*x, *y),
            ("rotate", [angle]) => Affine::rotate(angle.to_radians()),
            ("rotate", [angle, x, y]) => Affine::rotate_about(angle.to_radians(), Point::new(*x, *y)),
            ("skewX", [angle]) => Affine::skew(angle.to_radians().tan(), 0.0),
            ("skewY", [angle]) => Affine::skew(0.0, angle.to_radians().tan()),
            _ => Affine::IDENTITY,
        };
    }
    whole
}

fn declarations(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let pairs = text.split(';').filter_map(|pair| pair.split_once(':'));
    pairs.map(|(name, value)| (name.trim(), value.trim()))
}

/// The size of a rule's text, and its properties.
type Rule<'d> = (usize, Vec<(&'d str, &'d str)>);

/// The rules of style sheets.
struct Rules<'d> {
    rules: Vec<Rule<'d>>,
    /// For each selector, its rules.
    by_selector: HashMap<&'d str, Vec<usize>>,
}

impl<'d> Rules<'d> {
    fn of(tree: &'d Tree) -> Self {
        let mut of = Self { rules: Vec::new(), by_selector: HashMap::new() };
        for rule in tree.elements.iter().flat_map(|sheet| sheet.text.split('}')) {
            let Some((selectors, body)) = rule.split_once('{') else { continue };
            for selector in selectors.split(',') {
                let rules = of.by_selector.entry(selector.trim()).or_default();
                if rules.last() != Some(&of.rules.len()) {
                    rules.push(of.rules.len());
                }
            }
            of.rules.push((rule.len(), declarations(body).collect()));
        }
        of
    }

    /// The rules for an element, in the order of the text.
    fn for_element(&self, element: &Element) -> Vec<&Rule<'d>> {
        if self.rules.is_empty() {
            return Vec::new();
        }
        let classes = element.attribute("class").unwrap_or_default().split_whitespace();
        let names = classes.map(|class| format!(".{class}"));
        let names = names.chain(element.attribute("id").map(|id| format!("#{id}")));
        let names: BTreeSet<String> = names.chain(["*".to_owned(), element.name.clone()]).collect();
        let found = names.iter().filter_map(|name| self.by_selector.get(name.as_str())).flatten();
        let found: BTreeSet<usize> = found.copied().collect();
        found.into_iter().filter_map(|rule| self.rules.get(rule)).collect()
    }
}
