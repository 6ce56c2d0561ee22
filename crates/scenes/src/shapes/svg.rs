//! SVG drawings as coverage and brightness.
//!
//! Reads what logos are made of: paths and basic shapes, filled or stroked, in groups and symbols, with transformations,
//! attributes, `style`, and style sheets with simple selectors. Gradients count as opaque. Text, pictures, masks and
//! filters are left out.

use std::collections::HashMap;

use kurbo::{Affine, BezPath, Cap, Ellipse, Join, Point, Rect, RoundedRect, Shape, Stroke, StrokeOpts};
use roxmltree::{Document, Node, ParsingOptions};

use super::outline::{Coverage, Filling, Part};

/// Maximum number of elements of an SVG's text.
const NODES_MAX: u32 = 100_000;
/// Maximum number of elements that are visited, after uses of symbols are expanded.
const VISITED_MAX: usize = 50_000;
/// Maximum number of painted shapes, after uses of symbols are expanded.
const PAINTED_MAX: usize = 10_000;
/// Maximum nesting of groups and uses.
const DEPTH_MAX: usize = 64;
/// Maximum number of elements of all paths together.
const ELEMENTS_MAX: usize = 1 << 19;
/// How often shapes may cover the whole drawing.
const LAYERS_MAX: usize = 64;
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
    pub(super) fn of(bytes: &[u8]) -> Result<Self, Refused> {
        let text = std::str::from_utf8(bytes)
            .map_err(|error| (format!("byte {} is not UTF-8", error.valid_up_to()), false))?;
        let options = ParsingOptions { allow_dtd: true, nodes_limit: NODES_MAX };
        let document =
            Document::parse_with_options(text.trim_start_matches('\u{feff}'), options).map_err(|error| {
                match error {
                    roxmltree::Error::NodesLimitReached => {
                        (format!("it has more than {NODES_MAX} elements"), true)
                    }
                    error => (error.to_string(), false),
                }
            })?;
        let root = document.root_element();
        if root.tag_name().name() != "svg" {
            return Err((format!("its first element is `{}`, not `svg`", root.tag_name().name()), false));
        }
        let mut reader = Reader {
            ids: document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect(),
            rules: rules(&document),
            shapes: Vec::new(),
            elements: 0,
            visited: 0,
            scale: 1.0,
            has_text: false,
        };
        let view = root.attribute("viewBox").map(numbers).and_then(|numbers| match numbers[..] {
            [x, y, width, height] => Some(Rect::new(x, y, x + width, y + height)),
            _ => None,
        });
        let size = ["width", "height"].map(|name| root.attribute(name).and_then(length));
        let view = view.or(match size {
            [Some(width), Some(height)] => Some(Rect::new(0.0, 0.0, width, height)),
            _ => None,
        });
        reader.scale = view.map_or(100.0, |view| view.width().max(view.height()));
        reader.children(root, &Style::default(), Affine::IDENTITY, 0)?;
        let Reader { shapes, has_text, .. } = reader;
        let around = || shapes.iter().map(|one| one.path.bounding_box()).reduce(|a, b| a.union(b));
        let view = view.filter(|view| view.is_finite() && view.width() > 0.0 && view.height() > 0.0);
        let view = view.or_else(around).filter(|view| view.width() > 0.0 && view.height() > 0.0);
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
    pub(super) fn coverage(&self, place: Affine, width: usize, height: usize) -> Result<Coverage, Refused> {
        let mut opacity = Coverage::none(width, height);
        let mut brightness = Coverage::none(width, height);
        let mut left = LAYERS_MAX * width * height;
        for shape in &self.shapes {
            let path = place * shape.path.clone();
            let Some(part) = Part::of(&path, shape.filling, (width, height)) else { continue };
            let Some(rest) = left.checked_sub(part.pixels()) else {
                return Err((format!("its shapes cover it more than {LAYERS_MAX} times"), true));
            };
            left = rest;
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
    ids: HashMap<&'d str, Node<'d, 'd>>,
    rules: Vec<(String, Vec<(String, String)>)>,
    shapes: Vec<Painted>,
    elements: usize,
    visited: usize,
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
    fn children(
        &mut self,
        of: Node<'d, 'd>,
        style: &Style,
        place: Affine,
        depth: usize,
    ) -> Result<(), Refused> {
        if depth > DEPTH_MAX {
            return Err((format!("its groups and uses are nested more than {DEPTH_MAX} deep"), true));
        }
        of.children().filter(Node::is_element).try_for_each(|node| self.node(node, style, place, depth))
    }

    fn node(
        &mut self,
        node: Node<'d, 'd>,
        style: &Style,
        place: Affine,
        depth: usize,
    ) -> Result<(), Refused> {
        self.visited += 1;
        if self.visited > VISITED_MAX {
            return Err((format!("its uses repeat more than {VISITED_MAX} elements"), true));
        }
        let mut style = style.clone();
        let mut hidden = false;
        let mut own = place * node.attribute("transform").map_or(Affine::IDENTITY, transformation);
        for (name, value) in self.properties(node) {
            match (name.as_str(), value.trim()) {
                ("display", "none") | ("visibility", "hidden" | "collapse") => hidden = true,
                ("transform", value) if node.attribute("transform").is_none() => {
                    own *= transformation(value);
                }
                (name, value) => style.set(name, value),
            }
        }
        if hidden {
            return Ok(());
        }
        match node.tag_name().name() {
            "g" | "a" | "svg" | "switch" => self.children(node, &style, own, depth + 1),
            "use" => {
                let at = ["x", "y"].map(|name| node.attribute(name).and_then(length).unwrap_or(0.0));
                let link = node.attributes().find(|attribute| attribute.name() == "href");
                let target =
                    link.and_then(|link| self.ids.get(link.value().trim_start_matches('#')).copied());
                let Some(target) = target else { return Ok(()) };
                let own = own * Affine::translate((at[0], at[1]));
                if target.tag_name().name() == "symbol" {
                    return self.children(target, &style, own, depth + 1);
                }
                if depth > DEPTH_MAX {
                    return Err((format!("its groups and uses are nested more than {DEPTH_MAX} deep"), true));
                }
                self.node(target, &style, own, depth + 1)
            }
            "text" => {
                self.has_text = true;
                Ok(())
            }
            _ => match path_of(node) {
                Some(path) => self.paint(&path, &style, own),
                None => Ok(()),
            },
        }
    }

    fn paint(&mut self, path: &BezPath, style: &Style, place: Affine) -> Result<(), Refused> {
        let [all, fill, stroke] = style.opacity;
        let mut parts = Vec::new();
        if let Some(brightness) = style.fill.filter(|_| all * fill >= 0.5) {
            let filling = if style.odd { Filling::Odd } else { Filling::Turning };
            parts.push(Painted { path: place * path.clone(), filling, brightness });
        }
        let is_stroked = style.width > 0.0 && style.width.is_finite() && all * stroke >= 0.5;
        if let Some(brightness) = style.stroke.filter(|_| is_stroked) {
            let stroke = Stroke::new(style.width).with_caps(style.cap).with_join(style.join);
            let precision = STROKE_PRECISION * self.scale;
            let outline = kurbo::stroke(path.iter(), &stroke, &StrokeOpts::default(), precision);
            parts.push(Painted { path: place * outline, filling: Filling::Turning, brightness });
        }
        for part in parts {
            self.elements += part.path.elements().len();
            if self.shapes.len() >= PAINTED_MAX || self.elements > ELEMENTS_MAX {
                let most =
                    format!("it paints more than {PAINTED_MAX} shapes or {ELEMENTS_MAX} parts of paths");
                return Err((most, true));
            }
            if part.path.is_finite() {
                self.shapes.push(part);
            }
        }
        Ok(())
    }

    /// Attributes, rules of style sheets, and the attribute `style`: later ones win.
    fn properties(&self, node: Node<'d, 'd>) -> Vec<(String, String)> {
        let mut found: Vec<(String, String)> = node
            .attributes()
            .map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned()))
            .collect();
        let classes: Vec<&str> = node.attribute("class").unwrap_or_default().split_whitespace().collect();
        for (selector, properties) in &self.rules {
            let fits = match selector.split_at_checked(1) {
                Some((".", class)) => classes.contains(&class),
                Some(("#", id)) => node.attribute("id") == Some(id),
                _ => selector == "*" || selector == node.tag_name().name(),
            };
            if fits {
                found.extend(properties.iter().cloned());
            }
        }
        found.extend(node.attribute("style").into_iter().flat_map(declarations));
        found
    }
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
        && let [r, g, b, ..] = numbers(inner.1.trim_end_matches(')'))[..]
    {
        return Some(luminance([r as f32, g as f32, b as f32]).clamp(0.0, 1.0));
    }
    Some(0.5)
}

fn path_of(node: Node<'_, '_>) -> Option<BezPath> {
    let number = |name: &str| node.attribute(name).and_then(length);
    let of = |name: &str| number(name).unwrap_or(0.0);
    const PRECISION: f64 = 1e-3;
    Some(match node.tag_name().name() {
        "path" => {
            // A path with a mistake is drawn up to the mistake.
            let text = node.attribute("d")?;
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
            for (number, at) in numbers(node.attribute("points")?).as_chunks::<2>().0.iter().enumerate() {
                let at = (at[0], at[1]);
                if number == 0 { path.move_to(at) } else { path.line_to(at) }
            }
            if kind == "polygon" && !path.is_empty() {
                path.close_path();
            }
            path
        }
        _ => return None,
    })
}

/// Returns the numbers in a text, whatever is between them.
fn numbers(text: &str) -> Vec<f64> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_digit() || "+-.".contains(letter)) {
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
        found.extend(
            number.trim_end_matches(['e', 'E']).parse::<f64>().ok().filter(|number| number.is_finite()),
        );
        rest = after;
    }
    found
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
    numbers(text).first().map(|number| number * unit)
}

fn transformation(text: &str) -> Affine {
    let mut whole = Affine::IDENTITY;
    for part in text.split(')') {
        let Some((name, arguments)) = part.split_once('(') else { continue };
        whole *= match (
            name.trim_matches(|letter: char| !letter.is_ascii_alphabetic()),
            &numbers(arguments)[..],
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

fn declarations(text: &str) -> Vec<(String, String)> {
    let pairs = text.split(';').filter_map(|pair| pair.split_once(':'));
    pairs.map(|(name, value)| (name.trim().to_owned(), value.trim().to_owned())).collect()
}

/// The rules of style sheets, one for each selector.
fn rules(document: &Document<'_>) -> Vec<(String, Vec<(String, String)>)> {
    let mut rules = Vec::new();
    for sheet in document.descendants().filter(|node| node.tag_name().name() == "style") {
        let text: String = sheet.descendants().filter(Node::is_text).filter_map(|node| node.text()).collect();
        for rule in text.split('}') {
            let Some((selectors, body)) = rule.split_once('{') else { continue };
            let properties = declarations(body);
            for selector in selectors.split(',') {
                rules.push((selector.trim().to_owned(), properties.clone()));
            }
        }
    }
    rules
}
