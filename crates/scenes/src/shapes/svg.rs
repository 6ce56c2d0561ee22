//! SVG drawings as coverage and brightness.
//!
//! usvg reads what logos are made of: paths and basic shapes, filled or stroked, in groups and symbols, with styles. It
//! sets few limits, so it receives a copy of the drawing whose size is limited after all uses are repeated, without what
//! is left out: texts, pictures, masks, filters and markers. Gradients and patterns count as opaque and half bright.

use std::collections::HashMap;

use kurbo::{Affine, BezPath, Cap, Join, PathEl, PathSeg, Point, Rect, Stroke, StrokeOpts};
use usvg::roxmltree::{self, Document, ParsingOptions};
use usvg::tiny_skia_path::PathSegment;
use usvg::{FillRule, Group, LineCap, LineJoin, Node, Options, Paint, Path};

use super::outline::{Coverage, CoveredPart, Filling, Steps, TooMuchWork};
use crate::folder::ends_with_one_of;
use crate::limits;

/// Largest deviation of a stroke's outline, relative to the size of the drawing.
const STROKE_PRECISION: f64 = 1e-4;

/// The attributes that are read as texts.
const TEXTS: &str = "id class style href fill stroke color";
/// The attributes that are read as numbers or keywords.
const NUMBERS: &str = "transform d points viewBox preserveAspectRatio x y width height r rx ry cx cy x1 y1 x2 y2 \
    fill-rule fill-opacity stroke-width stroke-linecap stroke-linejoin stroke-miterlimit stroke-opacity opacity display \
    visibility";

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
    ends_with_one_of(name, &["svg"]) || start.contains("<svg")
}

impl Drawing {
    /// Reads an SVG.
    ///
    /// # Errors
    /// Fails with a reason if the text is no SVG, exceeds a limit, or paints nothing.
    pub(super) fn of(bytes: &[u8]) -> Result<Self> {
        let text = std::str::from_utf8(bytes)
            .map_err(|error| (format!("byte {} is not UTF-8", error.valid_up_to()), false))?;
        let text = text.trim_start_matches('\u{feff}');
        check_text(text)?;
        let elements_max = limits::DRAWING_ELEMENTS_MAX;
        // About each second node is the text between two elements.
        let nodes_limit = 2 * elements_max as u32;
        let options = ParsingOptions { allow_dtd: true, nodes_limit, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options).map_err(|error| match error {
            roxmltree::Error::NodesLimitReached => {
                (format!("it has more than {elements_max} elements"), true)
            }
            error => (format!("the XML has a mistake: {error}"), false),
        })?;
        let root = document.root_element();
        if root.tag_name().name() != "svg" {
            return Err((format!("its first element is `{}`, not `svg`", root.tag_name().name()), false));
        }
        let mut copy = String::new();
        let has_text = copy_element(root, 0, &mut copy)?;
        // The copy is well-formed.
        let copy = Document::parse(&copy).map_err(|error| (error.to_string(), false))?;
        Visits::count(&copy)?;
        let tree = usvg::Tree::from_xmltree(&copy, &Options::default());
        let tree = tree.map_err(|error| (error.to_string(), false))?;
        let view = Rect::new(0.0, 0.0, tree.size().width().into(), tree.size().height().into());
        let parts_left = limits::DRAWING_SHAPES_MAX.1;
        let mut painter =
            ShapePainter { shapes: Vec::new(), parts_left, size: view.width().max(view.height()) };
        painter.group(tree.root(), 1.0)?;
        match painter.shapes {
            shapes if !shapes.is_empty() => Ok(Self { shapes, view }),
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
            let part = CoveredPart::of(&path, shape.filling, (width, height), &mut steps);
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

/// Checks what the XML parser does not limit: attributes and namespaces, which it compares with each other, and entities.
fn check_text(text: &str) -> Result<()> {
    let most = limits::DRAWING_BYTES_MAX;
    if text.len() > most {
        return Err((format!("it has more than {most} bytes"), true));
    }
    let attributes_max = limits::DRAWING_ATTRIBUTES_MAX;
    let has_too_many = |tag: &str| tag.matches('=').count() > attributes_max;
    if text.matches("xmlns").count() > attributes_max || text.split('<').any(has_too_many) {
        return Err((format!("an element has more than {attributes_max} attributes"), true));
    }
    let mut longest = 0;
    for declaration in text.split("<!ENTITY").skip(1) {
        let quote = declaration.find(['"', '\'']).and_then(|at| declaration.get(at..)?.split_at_checked(1));
        let value = quote.and_then(|(quote, rest)| rest.split(quote).next()).unwrap_or_default();
        if value.contains(['&', '<']) {
            return Err(("its entities contain elements or other entities".to_owned(), false));
        }
        longest = longest.max(value.len());
    }
    if longest.saturating_mul(text.matches('&').count()) > most {
        return Err((format!("its entities expand to more than {most} bytes"), true));
    }
    Ok(())
}

/// Adds a copy of an element to `copy`, with only the elements that can be painted. Returns true if it contains texts.
fn copy_element(element: roxmltree::Node<'_, '_>, depth: usize, copy: &mut String) -> Result<bool> {
    let name = match element.tag_name().name() {
        name @ ("svg" | "g" | "a" | "switch" | "use" | "symbol" | "defs" | "style" | "path" | "rect"
        | "circle" | "ellipse" | "line" | "polyline" | "polygon") => name,
        "linearGradient" | "radialGradient" | "pattern" => "linearGradient",
        name => return Ok(name == "text"),
    };
    if depth > limits::DRAWING_NESTING_MAX {
        return Err(too_deep());
    }
    *copy += &format!("<{name}");
    // `href` is often `xlink:href`; other attributes with prefixes belong to drawing programs.
    let attributes = || element.attributes().filter(|one| one.namespace().is_none() || one.name() == "href");
    for attribute in attributes() {
        let (own, value) = (attribute.name(), attribute.value());
        let is_first = attributes().find(|one| one.name() == own).is_some_and(|first| first == attribute);
        let is_number = NUMBERS.split(' ').any(|name| name == own);
        let is_read = is_number || TEXTS.split(' ').any(|name| name == own);
        // A radius in percent could be a huge one.
        let is_unbounded = own.starts_with('r') && value.contains('%');
        if !is_first || !is_read || is_unbounded || name == "linearGradient" && own != "id" {
            continue;
        }
        if is_number {
            check_numbers(value)?;
        }
        let value = if own == "style" { plain_style(value) } else { value.to_owned() };
        *copy += &format!(" {own}='{}'", escaped(value.trim()));
    }
    copy.push('>');
    let mut has_text = false;
    match name {
        "linearGradient" => *copy += "<stop stop-color='gray'/>",
        "style" => *copy += &escaped(&plain_rules(element.text().unwrap_or_default())),
        _ => {
            for child in element.children() {
                has_text |= copy_element(child, depth + 1, copy)?;
            }
        }
    }
    *copy += &format!("</{name}>");
    Ok(has_text)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('\'', "&apos;")
}

/// Without the sizes of fonts, which would multiply lengths, and without filters: usvg leaves out shapes whose filter is
/// not in the drawing.
fn plain_style(text: &str) -> String {
    text.replace("font", "x-font").replace("filter", "x-filter")
}

/// The rules of a style sheet whose selectors are simple, without those for some media. The time for other selectors grows
/// with a power of the nesting.
fn plain_rules(sheet: &str) -> String {
    let is_simple =
        |one: &&str| !one.contains(|letter: char| letter.is_whitespace() || ">+~@[".contains(letter));
    let (mut rules, mut is_for_media) = (String::new(), false);
    for rule in sheet.split('}') {
        let Some((selectors, body)) = rule.split_once('{') else {
            is_for_media = false;
            continue;
        };
        is_for_media |= body.contains('{');
        let simple: Vec<&str> = selectors.split(',').map(str::trim).filter(is_simple).collect();
        if !is_for_media && !simple.is_empty() {
            rules += &format!("{}{{{}}}", simple.join(","), plain_style(body));
        }
    }
    rules
}

/// Refuses numbers of which kurbo would make almost endless arcs.
fn check_numbers(text: &str) -> Result<()> {
    let most = limits::DRAWING_NUMBER_DIGITS_MAX;
    let text = text.replace('E', "e").replace("e+", "e").replace("e-", " ");
    // `.5.5` is two numbers.
    let is_huge = |number: &str| {
        number.split('.').enumerate().any(|(at, part)| {
            let (digits, exponent) = part.split_once('e').unwrap_or((part, ""));
            let exponent = exponent.parse().unwrap_or(if exponent.is_empty() { 0 } else { most });
            exponent.saturating_add(if at == 0 { digits.len() } else { 1 }) > most
        })
    };
    if text.split(|letter: char| !letter.is_ascii_digit() && !".e".contains(letter)).any(is_huge) {
        return Err((format!("it has a number of more than {most} digits before its point"), true));
    }
    Ok(())
}

/// Counts elements as often as uses repeat them, and the bytes of the properties and rules that usvg reads for them.
struct Visits<'d> {
    ids: HashMap<&'d str, roxmltree::Node<'d, 'd>>,
    /// Bytes of style sheets.
    sheets: usize,
    left: (usize, usize),
}

impl<'d> Visits<'d> {
    fn count(copy: &'d Document<'d>) -> Result<()> {
        let mut ids = HashMap::new();
        for element in copy.descendants() {
            if let Some(id) = element.attribute("id") {
                ids.entry(id).or_insert(element);
            }
        }
        let sheets = copy
            .descendants()
            .filter(roxmltree::Node::is_text)
            .filter_map(|text| Some(text.text()?.len()))
            .sum();
        Self { ids, sheets, left: limits::DRAWING_VISITS_MAX }.element(copy.root_element(), 0, 0)
    }

    fn element(&mut self, element: roxmltree::Node<'d, 'd>, inherited: usize, depth: usize) -> Result<()> {
        if depth > limits::DRAWING_NESTING_MAX {
            return Err(too_deep());
        }
        let own: usize = element.attributes().map(|one| one.name().len() + one.value().len()).sum();
        // Each rule is compared with the classes, and the text of a path becomes a path.
        let classes = element.attribute("class").map_or(0, str::len);
        let bytes = inherited + 64 * own + self.sheets.saturating_mul(1 + classes / 16);
        let left = self.left.1.checked_sub(bytes);
        self.left = self.left.0.checked_sub(1).zip(left).ok_or_else(|| {
            let (elements, bytes) = limits::DRAWING_VISITS_MAX;
            (format!("its uses and styles repeat more than {elements} elements or {bytes} bytes"), true)
        })?;
        let link = element.attribute("href").filter(|_| element.has_tag_name("use"));
        let target = link.and_then(|link| self.ids.get(link.strip_prefix('#')?).copied());
        let children = element.children().filter(roxmltree::Node::is_element);
        children.chain(target).try_for_each(|one| self.element(one, inherited + own, depth + 1))
    }
}

fn too_deep() -> Refused {
    (format!("its groups and uses are nested more than {} deep", limits::DRAWING_NESTING_MAX), true)
}

/// Turns the tree that usvg has read into paths.
struct ShapePainter {
    shapes: Vec<Painted>,
    /// Parts of paths that may still be painted.
    parts_left: usize,
    size: f64,
}

impl ShapePainter {
    fn group(&mut self, group: &Group, opacity: f32) -> Result<()> {
        let opacity = opacity * group.opacity().get();
        group.children().iter().try_for_each(|node| match node {
            Node::Group(group) => self.group(group, opacity),
            Node::Path(path) if path.is_visible() => self.path(path, opacity),
            _ => Ok(()),
        })
    }

    fn path(&mut self, of: &Path, opacity: f32) -> Result<()> {
        let to = of.abs_transform();
        let place = Affine::new([to.sx, to.ky, to.kx, to.sy, to.tx, to.ty].map(f64::from));
        let path = path_of(of.data());
        if let Some(fill) = of.fill().filter(|fill| opacity * fill.opacity().get() >= 0.5) {
            self.count(path.elements().len())?;
            let filling = match fill.rule() {
                FillRule::NonZero => Filling::Turning,
                FillRule::EvenOdd => Filling::Odd,
            };
            self.add(Painted { path: place * &path, filling, brightness: brightness(fill.paint()) })?;
        }
        if let Some(stroke) = of.stroke().filter(|stroke| opacity * stroke.opacity().get() >= 0.5) {
            let width = f64::from(stroke.width().get());
            let precision = STROKE_PRECISION * self.size / place.determinant().abs().sqrt().max(1e-9);
            self.count(stroke_parts(&path, width, precision, self.parts_left))?;
            let cap = match stroke.linecap() {
                LineCap::Butt => Cap::Butt,
                LineCap::Round => Cap::Round,
                LineCap::Square => Cap::Square,
            };
            let join = match stroke.linejoin() {
                LineJoin::Miter | LineJoin::MiterClip => Join::Miter,
                LineJoin::Round => Join::Round,
                LineJoin::Bevel => Join::Bevel,
            };
            let style = Stroke::new(width).with_caps(cap).with_join(join);
            let outline = kurbo::stroke(path.iter(), &style, &StrokeOpts::default(), precision);
            let (filling, brightness) = (Filling::Turning, brightness(stroke.paint()));
            self.add(Painted { path: place * outline, filling, brightness })?;
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
}

fn path_of(data: &usvg::tiny_skia_path::Path) -> BezPath {
    let at = |point: usvg::tiny_skia_path::Point| Point::new(point.x.into(), point.y.into());
    let elements = data.segments().map(|segment| match segment {
        PathSegment::MoveTo(to) => PathEl::MoveTo(at(to)),
        PathSegment::LineTo(to) => PathEl::LineTo(at(to)),
        PathSegment::QuadTo(control, to) => PathEl::QuadTo(at(control), at(to)),
        PathSegment::CubicTo(first, second, to) => PathEl::CurveTo(at(first), at(second), at(to)),
        PathSegment::Close => PathEl::ClosePath,
    });
    elements.collect()
}

/// The brightness of a paint, 0..1.
fn brightness(paint: &Paint) -> f32 {
    match paint {
        Paint::Color(color) => {
            let [red, green, blue] = [color.red, color.green, color.blue].map(f32::from);
            (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0
        }
        _ => 0.5,
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
