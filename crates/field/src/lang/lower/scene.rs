//! The scene as a whole: the order in which its items are lowered, and its defaults.

use std::sync::Arc;

use super::super::about::About;
use super::super::ast::{Entry, ExprId, Item, Section};
use super::super::builtin::uses;
use super::super::diagnostic::Diagnostic;
use super::super::material::Material;
use super::super::origins::Stretch;
use super::super::scene::{Camera, Light, LightKind, Medium, Object, Picture, Scene, Sky, Swarm};
use super::super::source::{Sources, Span};
use super::super::value::Value;
use super::lowering::{A_DISTANCE, Lowering};
use super::sections::Values;
use crate::graph::{NodeId, ShapeAtlas};

#[derive(Default)]
pub(super) struct Parts {
    pub objects: Vec<Object>,
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    pub media: Vec<Medium>,
    pub swarms: Vec<Swarm>,
    pub camera: Option<Camera>,
    pub cameras: Vec<(String, Camera)>,
    pub sky: Option<Sky>,
    pub has_own_sky: bool,
    /// The directions of suns whose light rises.
    pub rising: Vec<Span>,
    pub picture: Option<Picture>,
    /// Where a picture without trails sets `memory`.
    pub memory: Option<Span>,
    pub about: Option<About>,
    /// Index of the material for objects that set no material. The material is created when it is first needed.
    pub default_material: Option<usize>,
}

const BARE_NAME: &str = "shape";
/// The distance in a scene without objects.
const NOWHERE: f32 = 1e9;

/// Builds a scene from its items. `declare.rs` handles declarations, and `sections.rs` handles blocks with fields.
pub(super) struct SceneBuilder<'a> {
    pub lowering: Lowering<'a>,
    pub parts: Parts,
}

impl<'a> SceneBuilder<'a> {
    pub(super) fn new(lowering: Lowering<'a>) -> Self {
        Self { lowering, parts: Parts::default() }
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) -> Value {
        self.lowering.reports.add(diagnostic)
    }

    /// Builds the scene. Returns `None` if the scene has neither shape nor sky, or a limit is reached.
    pub(super) fn scene(
        mut self,
        items: &'a [Item],
        includes: Vec<String>,
        sources: &Sources,
    ) -> Option<Scene> {
        self.declare(items);
        self.lower_lets();
        // Materials are lowered first because objects refer to them.
        for of_materials in [true, false] {
            let wanted = |section: &Section| (*section == Section::Material) == of_materials;
            for item in items {
                if self.lowering.reports.stopped {
                    return None;
                }
                match item {
                    Item::Section { section, name, span, entries, broken } if wanted(section) => {
                        let from = self.lowering.origins.mark();
                        let values = self.fields(*section, entries, *broken);
                        self.section(*section, *name, *span, &values);
                        self.warn_of_values(*section, &values);
                        self.record_block(*section, *span, entries, from, &values);
                    }
                    Item::Bare(value) if wanted(&Section::Object) => self.bare(*value),
                    _ => {}
                }
            }
        }
        self.check_textures_beside_media();
        self.check_the_unused();
        self.check_the_graph();
        let distance = self.distance(sources)?;
        self.warn_of_light_from_below();
        self.check_memory();
        self.add_default_light();
        self.lowering.declared.params.extend(self.lowering.changing.params());
        self.lowering.origins.finish(sources);
        let unset = Values::default();
        let camera =
            self.parts.camera.unwrap_or_else(|| Camera::of(self.lowering.numbers(Camera::FIELDS, &unset)));
        let sky = self.parts.sky.unwrap_or_else(|| Sky::of(self.lowering.numbers(Sky::FIELDS, &unset)));
        let picture =
            self.parts.picture.unwrap_or_else(|| Picture::of(self.lowering.numbers(Picture::FIELDS, &unset)));
        Some(Scene {
            graph: self.lowering.graph,
            objects: self.parts.objects,
            distance,
            materials: self.parts.materials,
            lights: self.parts.lights,
            media: self.parts.media,
            swarms: self.parts.swarms,
            camera,
            cameras: self.parts.cameras,
            sky,
            has_own_sky: self.parts.has_own_sky,
            picture,
            about: self.parts.about.unwrap_or_default(),
            params: self.lowering.declared.params,
            textures: self.lowering.declared.textures,
            shapes: self.lowering.declared.shapes,
            atlas: ShapeAtlas::NONE,
            includes,
            origins: Arc::new(self.lowering.origins),
        })
    }

    /// Lowers all lets in the order of the text. A chain of lets that use each other then needs no deep recursion.
    fn lower_lets(&mut self) {
        self.lowering.within(u16::MAX, "", |this| {
            for index in 0..this.declared.lets.len() {
                let span = this.declared.lets[index].name.span;
                if this.declared.lets[index].known.is_none() && !this.reports.stopped {
                    this.global_let(index, span);
                }
            }
        });
    }

    /// Reports textures beyond the limit for scenes with media.
    fn check_textures_beside_media(&mut self) {
        let max = self.lowering.limits.scene_textures_beside_media_max;
        if let Some(texture) = self.lowering.declared.textures.get(max)
            && !self.parts.media.is_empty()
        {
            let message = format!("a scene with a medium can read at most {max} images");
            let beyond = Diagnostic::over_limit(texture.span, message);
            self.report(beyond.hint("combine several images into one file"));
        }
    }

    fn check_the_graph(&mut self) {
        if let Err(error) = self.lowering.graph.check()
            && !self.lowering.reports.stopped
        {
            let span = self.parts.objects.first().map_or(Span::default(), |object| object.span);
            let hint = "nest fewer function calls, or shorten the loops";
            self.lowering.reports.stop(span, error.to_string(), hint);
        }
    }

    /// Returns the distance to the nearest object. Reports a scene with neither objects nor a sky, unless it has other
    /// mistakes.
    fn distance(&mut self, sources: &Sources) -> Option<NodeId> {
        let shapes: Vec<NodeId> = self.parts.objects.iter().map(|object| object.shape).collect();
        let distance = shapes.into_iter().reduce(|a, b| self.lowering.graph.min(a, b));
        let is_seen =
            self.parts.sky.is_some() || !self.parts.media.is_empty() || !self.parts.swarms.is_empty();
        if distance.is_none() && is_seen {
            // Shaders need a material, even if no ray meets a surface.
            self.default_material();
            return Some(self.lowering.constant(NOWHERE));
        }
        if distance.is_none() && self.lowering.reports.diagnostics.is_empty() {
            let text = sources.files().first().map_or(0, |file| file.text.len() as u32);
            let empty = Diagnostic::new(Span::new(text, text), "the scene has no shape");
            let hint = "write an expression in x, y, z, as in `length(p) - 1`, or \
                        `object ball { shape = sphere(p, 1) }`; a scene of sky alone needs a `sky { color = … }`";
            self.report(empty.hint(hint));
        }
        distance
    }

    fn add_default_light(&mut self) {
        if self.parts.lights.is_empty() {
            self.parts.lights.push(Light {
                position: self.lowering.vector([-6.0, 9.0, -6.0]),
                color: self.lowering.vector([500.0, 480.0, 450.0]),
                radius: self.lowering.constant(0.5),
                ..Light::of(LightKind::Lamp, self.lowering.numbers(Light::FIELDS, &Values::default()))
            });
        }
    }

    /// Records the text of an object or a material. The notes since the mark `from` belong to its fields.
    fn record_block(&mut self, section: Section, span: Span, entries: &[Entry], from: u32, values: &Values) {
        let inside = self.lowering.origins.since(from);
        let fields = entries.iter().filter(|entry| !entry.is_let).map(|entry| entry.name.span);
        let head = self.lowering.origins.head([span].into_iter().chain(fields), &values.beside_the_shape);
        let whole = self.lowering.origins.head([].into_iter(), &[head, inside]);
        match (section, self.parts.objects.len().checked_sub(1), self.parts.materials.len().checked_sub(1)) {
            (Section::Object, Some(object), _) => self.lowering.origins.of_object(object, head, whole),
            (Section::Material, _, Some(material)) => self.lowering.origins.of_material(material, whole),
            _ => {}
        }
    }

    fn bare(&mut self, value: ExprId) {
        let span = self.lowering.ast.span(value);
        if let Some(first) = self.parts.objects.iter().find(|object| object.name == BARE_NAME) {
            let second = Diagnostic::new(span, "this is a second expression for the scene's shape");
            let second = second.note(first.span, "the first one is here");
            self.report(second.hint("combine both with `union(a, b)`, or give this one a name with `let`"));
            return;
        }
        let from = self.lowering.origins.mark();
        let shape = self.lowering.within(uses::POINT | uses::FRAME, "a shape", |this| this.expr(value));
        let by = self.lowering.origins.since(from);
        if let Some(shape) = self.lowering.one_number(shape, "a shape", A_DISTANCE, span) {
            let material = self.default_material();
            let name = BARE_NAME.to_owned();
            self.add_object(Object { name, span, shape, bound: None, material, trusted: false });
            let object = self.parts.objects.len().saturating_sub(1);
            self.lowering.origins.of_object(object, Stretch::default(), by);
        }
    }

    pub(super) fn add_object(&mut self, object: Object) {
        let (count, max) = (self.parts.objects.len(), self.lowering.limits.scene_objects_max);
        let hint = "combine shapes of the same material with `union`";
        if !self.lowering.reports.is_full(count, max, "objects", hint, object.span) {
            self.parts.objects.push(object);
        }
    }

    pub(super) fn default_material(&mut self) -> usize {
        if let Some(index) = self.parts.default_material {
            return index;
        }
        let material =
            Material::of("default".to_owned(), self.lowering.numbers(Material::FIELDS, &Values::default()));
        self.parts.materials.push(material);
        self.parts.default_material = Some(self.parts.materials.len() - 1);
        self.parts.materials.len() - 1
    }
}
