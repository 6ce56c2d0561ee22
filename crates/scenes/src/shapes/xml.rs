//! XML as a tree. It is read without recursion, in time that is linear in the size of the text: entities that the
//! document declares are replaced by plain text, and limits are checked before an element is kept.

use std::cell::Cell;
use std::collections::HashMap;

use quick_xml::Reader;
use quick_xml::escape::{resolve_predefined_entity, unescape_with};
use quick_xml::events::{BytesStart, Event};

use super::svg::{Refused, Result};
use crate::limits;

/// An element, with its children as indices of [`Tree::elements`].
#[derive(Debug, Default)]
pub(super) struct Element {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<usize>,
    /// The text directly in the element.
    pub text: String,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }
}

/// The elements in the order of the text. The first one contains all others.
#[derive(Debug)]
pub(super) struct Tree {
    pub elements: Vec<Element>,
}

impl Tree {
    /// Reads a text. Names lose their prefix: `xlink:href` becomes `href`.
    ///
    /// # Errors
    /// Fails with a reason if the text is no XML or exceeds a limit.
    pub(super) fn of(text: &str) -> Result<Self> {
        if text.len() > limits::DRAWING_BYTES_MAX {
            return Err((format!("it has more than {} bytes", limits::DRAWING_BYTES_MAX), true));
        }
        let mut reader = Reader::from_str(text);
        let mut tree = Self { elements: Vec::new() };
        let mut entities = Entities { known: HashMap::new(), left: Cell::new(limits::DRAWING_BYTES_MAX) };
        let mut open: Vec<usize> = Vec::new();
        loop {
            let event = reader.read_event().map_err(|error| {
                (format!("the XML has a mistake at byte {}: {error}", reader.error_position()), false)
            })?;
            match event {
                Event::Start(start) => {
                    let index = tree.add(&start, &open, &entities)?;
                    if open.len() > limits::DRAWING_NESTING_MAX {
                        return Err(too_deep());
                    }
                    open.push(index);
                }
                Event::Empty(start) => drop(tree.add(&start, &open, &entities)?),
                Event::End(_) => drop(open.pop()),
                Event::Text(text) => tree.write(&open, &String::from_utf8_lossy(&text)),
                Event::CData(text) => tree.write(&open, &String::from_utf8_lossy(&text)),
                Event::GeneralRef(name) => {
                    let text = entities.text(&String::from_utf8_lossy(&name)).unwrap_or_default().to_owned();
                    tree.write(&open, &text);
                }
                Event::DocType(text) => entities.declare(&String::from_utf8_lossy(&text)),
                Event::Eof => break,
                Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
            }
        }
        match open.last().and_then(|last| tree.elements.get(*last)) {
            Some(element) => Err((format!("its element `{}` has no end", element.name), false)),
            None if tree.elements.is_empty() => Err(("it has no elements".to_owned(), false)),
            None => Ok(tree),
        }
    }

    fn add(&mut self, start: &BytesStart<'_>, open: &[usize], entities: &Entities) -> Result<usize> {
        let index = self.elements.len();
        if index >= limits::DRAWING_ELEMENTS_MAX {
            return Err((format!("it has more than {} elements", limits::DRAWING_ELEMENTS_MAX), true));
        }
        let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let mut element = Element { name: name(start.local_name().as_ref()), ..Element::default() };
        // Looking for attributes with the same name takes time that grows with the square of their number.
        for attribute in start.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|error| (format!("an attribute of `{}`: {error}", element.name), false))?;
            let value = String::from_utf8_lossy(&attribute.value);
            let value = unescape_with(&value, |name| entities.text(name)).map(|value| value.into_owned());
            if entities.left.get() == 0 {
                let most = limits::DRAWING_BYTES_MAX;
                return Err((format!("its entities expand to more than {most} bytes"), true));
            }
            let value = value.map_err(|error| (error.to_string(), false))?;
            element.attributes.push((name(attribute.key.local_name().as_ref()), value));
        }
        self.elements.push(element);
        if let Some(parent) = open.last().and_then(|parent| self.elements.get_mut(*parent)) {
            parent.children.push(index);
        }
        Ok(index)
    }

    fn write(&mut self, open: &[usize], text: &str) {
        // Only the text of style sheets is read.
        let element = open.last().and_then(|last| self.elements.get_mut(*last));
        if let Some(element) = element.filter(|element| element.name == "style") {
            element.text.push_str(text);
        }
    }
}

pub(super) fn too_deep() -> Refused {
    (format!("its groups and uses are nested more than {} deep", limits::DRAWING_NESTING_MAX), true)
}

/// The entities that the document's type declares.
struct Entities {
    known: HashMap<String, String>,
    /// Bytes to which entities may still expand; 0 if they expanded to too many.
    left: Cell<usize>,
}

impl Entities {
    fn declare(&mut self, document_type: &str) {
        for declaration in document_type.split("<!ENTITY").skip(1) {
            let Some((name, rest)) = declaration.trim_start().split_once(char::is_whitespace) else {
                continue;
            };
            let rest = rest.trim_start();
            let quote = rest.chars().next().filter(|quote| matches!(quote, '"' | '\''));
            let value = quote.and_then(|quote| rest.split(quote).nth(1));
            if let Some(value) = value {
                self.known.insert(name.to_owned(), value.to_owned());
            }
        }
    }

    fn text(&self, name: &str) -> Option<&str> {
        if let Some(text) = resolve_predefined_entity(name) {
            return Some(text);
        }
        let text = self.known.get(name)?;
        self.left.set(self.left.get().saturating_sub(text.len()));
        (self.left.get() > 0).then_some(text)
    }
}
