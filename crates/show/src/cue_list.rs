//! A show as it is written down: what comes at which moment of a song, in the words of musicians.

use mariana_field::lang::{Span, Way};
use mariana_field::world::{BlendKind, PortalShape};

/// A show. Its entries stand in the order in which they were written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CueList {
    /// What is on, one scene after the other.
    pub entries: Vec<Entry>,
}

/// A scene that comes.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// When its transition begins.
    pub when: When,
    /// The scene, by name or by file.
    pub scene: String,
    /// One of its cameras; none is the scene's own.
    pub camera: Option<String>,
    /// How it comes; none is as the scene likes, or else a short fade.
    pub transition: Option<Transition>,
    /// What moves its parameters.
    pub settings: Vec<Setting>,
    /// Where it was written, from `at` to the scene.
    pub span: Span,
    /// Where the scene was written.
    pub scene_span: Span,
    /// Where the camera was written, if there is one.
    pub camera_span: Span,
}

impl Entry {
    /// An entry that moves nothing and was written nowhere.
    pub(super) fn new(
        when: When,
        scene: &str,
        camera: Option<String>,
        transition: Option<Transition>,
    ) -> Self {
        let (settings, nowhere) = (Vec::new(), Span::default());
        let (span, scene_span, camera_span) = (nowhere, nowhere, nowhere);
        Self { when, scene: scene.to_owned(), camera, transition, settings, span, scene_span, camera_span }
    }
}

/// A moment.
#[derive(Debug, Clone, PartialEq)]
pub struct When {
    /// What it is counted from.
    pub anchor: Anchor,
    /// How long after that; negative is before.
    pub offset: Length,
}

/// A moment with a name.
#[derive(Debug, Clone, PartialEq)]
pub enum Anchor {
    /// The song's start.
    Start,
    /// The song's end.
    End,
    /// So many seconds after the start.
    Time(f64),
    /// The start of a bar; 1 is the first whole one.
    Bar(u32),
    /// The start of a section: its letter, and which of those of that letter, from 1.
    Section(String, u32),
    /// A drop, from 1.
    Drop(u32),
    /// The start of a build, from 1.
    Build(u32),
    /// When whoever leads the show presses a key, once for each entry of this kind.
    Cue,
}

impl CueList {
    /// The entries that wait for a key, in their order.
    pub fn cues(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(|entry| entry.when.anchor == Anchor::Cue)
    }
}

/// A length of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// In seconds.
    Seconds(f64),
    /// In beats.
    Beats(f64),
    /// In bars.
    Bars(f64),
}

impl Length {
    /// No time.
    pub const ZERO: Self = Self::Seconds(0.0);

    /// The units.
    pub(super) const UNITS: [Unit; 3] = [
        Unit { of: Self::Seconds, names: &["s"] },
        Unit { of: Self::Beats, names: &["beat", "beats"] },
        Unit { of: Self::Bars, names: &["bar", "bars"] },
    ];

    /// The number without its unit.
    pub fn number(self) -> f64 {
        match self {
            Self::Seconds(number) | Self::Beats(number) | Self::Bars(number) => number,
        }
    }
}

/// A unit of lengths.
pub(super) struct Unit {
    /// A length of so many.
    pub of: fn(f64) -> Length,
    /// Its names in shows; the first is printed for one, the last for several.
    pub names: &'static [&'static str],
}

/// How one scene changes into another. Only a portal has a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransitionKind {
    /// From one picture to the next.
    Cut,
    /// The pictures are mixed in linear light.
    Fade,
    /// The worlds are mixed.
    Blend(BlendKind),
}

impl TransitionKind {
    /// The kind in the words of scenes, which name no shape.
    pub fn way(self) -> Way {
        match self {
            Self::Cut => Way::Cut,
            Self::Fade => Way::Fade,
            Self::Blend(kind) => kind.way(),
        }
    }

    /// How the worlds are mixed, if they are.
    pub fn blend(self) -> Option<BlendKind> {
        match self {
            Self::Blend(kind) => Some(kind),
            Self::Cut | Self::Fade => None,
        }
    }
}

/// A portal is a ball.
impl From<Way> for TransitionKind {
    fn from(way: Way) -> Self {
        match way {
            Way::Cut => Self::Cut,
            Way::Fade => Self::Fade,
            Way::Melt => Self::Blend(BlendKind::Melt),
            Way::Portal => Self::Blend(BlendKind::Portal(PortalShape::default())),
        }
    }
}

/// How a scene comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// The kind.
    pub kind: TransitionKind,
    /// How long it takes; nothing for a cut.
    pub length: Length,
    /// Whether it breaks off where what comes next begins sooner; else it is quicker then, and complete.
    pub unfinished: bool,
}

impl Transition {
    /// At once.
    pub const CUT: Self = Self { kind: TransitionKind::Cut, length: Length::ZERO, unfinished: false };

    /// Of a kind that takes some time.
    pub fn new(kind: impl Into<TransitionKind>, length: Length) -> Self {
        Self { kind: kind.into(), length, ..Self::CUT }
    }
}

/// A parameter that moves, or is set; or a turn of the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Its name in the scene, or one of [`CAMERA_TURNS`] or [`PICTURE_NUMBERS`].
    pub param: String,
    /// Its value before.
    pub from: f32,
    /// Where it goes, one after the other; if nowhere, it is set.
    pub steps: Vec<Step>,
    /// How long after the entry it begins.
    pub after: Length,
    /// Where the name was written.
    pub span: Span,
}

/// A part of a movement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The value behind.
    pub to: f32,
    /// How long it takes.
    pub over: Length,
}

/// What turns the camera of any scene as a hand in the window does: degrees to the left and upwards, and what the distance
/// to its target is multiplied by. No parameter has such a name.
pub const CAMERA_TURNS: [&str; 3] = ["camera yaw", "camera pitch", "camera zoom"];

/// The values of [`CAMERA_TURNS`] of a scene's own camera.
pub const UNTURNED: [f32; 3] = [0.0, 0.0, 1.0];

/// What is done to whole pictures, whatever scene they show: the share of their light that is left, and the share of a
/// picture that is held in those that come after it; both are within 0..1. No parameter has such a name. What a show sets
/// here stays, through its scenes, until it sets it again.
pub const PICTURE_NUMBERS: [&str; 2] = ["picture brightness", "picture freeze"];

/// The values of [`PICTURE_NUMBERS`] of a picture to which nothing is done.
pub const PLAIN_PICTURE: [f32; 2] = [1.0, 0.0];

/// Whether a name that stands behind `set` belongs to no scene: its words are no parameter's name.
pub(super) fn is_of_no_scene(name: &str) -> bool {
    CAMERA_TURNS.contains(&name) || PICTURE_NUMBERS.contains(&name)
}
