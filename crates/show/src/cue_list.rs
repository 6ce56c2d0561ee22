//! A cue list: the content of a show file. Entries name moments in musical terms, such as bars and sections.

use mariana_field::lang::{Span, TransitionStyle};
use mariana_field::world::{BlendKind, PortalShape};

/// A cue list, with entries in the order of the text.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CueList {
    /// The entries.
    pub entries: Vec<Entry>,
}

/// A scene change at a moment of the song.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Start of the transition.
    pub when: When,
    /// The name or file of the scene.
    pub scene: String,
    /// Name of a camera; `None` for the scene's default camera.
    pub camera: Option<String>,
    /// The transition. `None` means the scene's preferred transition, or a short fade if the scene prefers none.
    pub transition: Option<Transition>,
    /// The settings of parameters and cameras.
    pub settings: Vec<Setting>,
    /// Position in the text, from `at` to the scene.
    pub span: Span,
    /// Position of the scene's name.
    pub scene_span: Span,
    /// Position of the camera's name, if there is one.
    pub camera_span: Span,
}

impl Entry {
    /// An entry without settings or positions.
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

/// A moment of the song: an anchor and an offset.
#[derive(Debug, Clone, PartialEq)]
pub struct When {
    /// The reference point.
    pub anchor: Anchor,
    /// Offset from the anchor; negative offsets are before the anchor.
    pub offset: Length,
}

/// A reference point in a song.
#[derive(Debug, Clone, PartialEq)]
pub enum Anchor {
    /// The song's start.
    Start,
    /// The song's end.
    End,
    /// A time in seconds after the start.
    Time(f64),
    /// The start of a bar; 1 is the first whole bar.
    Bar(u32),
    /// The start of a section, by the section's letter and its number among the sections with that letter, from 1 on.
    Section(String, u32),
    /// The drop with this number, counted from 1.
    Drop(u32),
    /// The start of the build with this number, counted from 1.
    Build(u32),
    /// A press of the cue key. Each press triggers the next entry with this anchor.
    Cue,
    /// The start of the entry above.
    Previous,
}

impl CueList {
    /// Returns the entries that wait for the cue key, in the order of the text.
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
    /// Zero seconds.
    pub const ZERO: Self = Self::Seconds(0.0);

    pub(super) const UNITS: [Unit; 3] = [
        Unit { of: Self::Seconds, names: &["s"] },
        Unit { of: Self::Beats, names: &["beat", "beats"] },
        Unit { of: Self::Bars, names: &["bar", "bars"] },
    ];

    /// Returns the number without the unit.
    pub fn number(self) -> f64 {
        match self {
            Self::Seconds(number) | Self::Beats(number) | Self::Bars(number) => number,
        }
    }
}

pub(super) struct Unit {
    /// Converts a number to a length in this unit.
    pub of: fn(f64) -> Length,
    /// Names in show files. The first name is printed for the number 1, the last name for other numbers.
    pub names: &'static [&'static str],
}

/// The kind of a transition. Only a portal has a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransitionKind {
    /// A hard cut.
    Cut,
    /// A cross-fade of the frames in linear light.
    Fade,
    /// A blend of the two worlds.
    Blend(BlendKind),
}

impl TransitionKind {
    /// Returns the kind without a portal's shape, as the scene language names it.
    pub fn style(self) -> TransitionStyle {
        match self {
            Self::Cut => TransitionStyle::Cut,
            Self::Fade => TransitionStyle::Fade,
            Self::Blend(kind) => kind.style(),
        }
    }

    /// Returns the kind of blend; `None` for a cut or a fade.
    pub fn blend(self) -> Option<BlendKind> {
        match self {
            Self::Blend(kind) => Some(kind),
            Self::Cut | Self::Fade => None,
        }
    }
}

/// A portal becomes a ball, because [`TransitionStyle`] has no shapes.
impl From<TransitionStyle> for TransitionKind {
    fn from(style: TransitionStyle) -> Self {
        match style {
            TransitionStyle::Cut => Self::Cut,
            TransitionStyle::Fade => Self::Fade,
            TransitionStyle::Melt => Self::Blend(BlendKind::Melt),
            TransitionStyle::Portal => Self::Blend(BlendKind::Portal(PortalShape::default())),
        }
    }
}

/// A transition to a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// The kind.
    pub kind: TransitionKind,
    /// Duration; zero for a cut.
    pub length: Length,
    /// True if the next entry may interrupt the transition. Otherwise the transition is shortened, so that it ends
    /// before the next entry.
    pub unfinished: bool,
    /// True if the setting [`FADER`] of the entry moves the transition, instead of the time.
    pub by_fader: bool,
}

impl Transition {
    /// A cut.
    pub const CUT: Self =
        Self { kind: TransitionKind::Cut, length: Length::ZERO, unfinished: false, by_fader: false };

    /// A transition of this kind and duration.
    pub fn new(kind: impl Into<TransitionKind>, length: Length) -> Self {
        Self { kind: kind.into(), length, ..Self::CUT }
    }
}

/// A setting of a parameter, of the camera, of the image or of the fader, fixed or animated.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Name of a parameter, or one of [`CAMERA_TURNS`], [`PICTURE_NUMBERS`] or [`FADER`].
    pub param: String,
    /// The initial value.
    pub from: f32,
    /// The steps of the animation; empty for a fixed value.
    pub steps: Vec<Step>,
    /// Delay after the entry's start.
    pub after: Length,
    /// Position of the name in the text.
    pub span: Span,
}

impl Setting {
    /// A fixed value from the start of the entry, without a position in a text.
    pub(super) fn new(param: &str, from: f32) -> Self {
        Self { param: param.to_owned(), from, steps: Vec::new(), after: Length::ZERO, span: Span::default() }
    }
}

/// One step of an animation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The value at the end.
    pub to: f32,
    /// The duration.
    pub over: Length,
}

/// Names of the settings that turn the camera of any scene, as a drag in the window does. Yaw is in degrees to the
/// left, pitch in degrees upwards, and zoom is a factor on the distance to the target. The names contain a space, so
/// no parameter has such a name.
pub const CAMERA_TURNS: [&str; 3] = ["camera yaw", "camera pitch", "camera zoom"];

/// Values of [`CAMERA_TURNS`] for an unchanged camera.
pub const UNTURNED: [f32; 3] = [0.0, 0.0, 1.0];

/// Names of the image settings, which affect the whole image of any scene: the brightness, and the opacity of a
/// frozen frame over later frames. Both values are in 0..1. A new scene does not reset them. The names contain a
/// space, so no parameter has such a name.
pub const PICTURE_NUMBERS: [&str; 2] = ["picture brightness", "picture freeze"];

/// Values of [`PICTURE_NUMBERS`] for an unchanged image.
pub const PLAIN_PICTURE: [f32; 2] = [1.0, 0.0];

/// Name of the setting that moves a transition `by fader`: 0 shows the previous entry's scene, 1 the entry's own. The
/// setting is 0 where no value is set.
pub const FADER: &str = "deck fader";

/// Returns the settings that belong to no scene.
pub(super) fn plain_settings() -> impl Iterator<Item = &'static str> {
    CAMERA_TURNS.into_iter().chain(PICTURE_NUMBERS).chain([FADER])
}

/// True if `name` is a setting of the camera, the image or the fader, not a parameter of a scene.
pub(super) fn is_of_no_scene(name: &str) -> bool {
    plain_settings().any(|plain| plain == name)
}
