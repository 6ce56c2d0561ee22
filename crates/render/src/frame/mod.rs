//! [`Frame`]: the inputs of one image of a world, computed from time, sound and camera. The inputs are plain numbers
//! without OpenGL. A window, a still and a video get the same numbers.

pub mod block;
pub mod camera;
pub mod feedback;
pub mod held_inputs;
pub mod orbit_controls;
pub mod picture;
pub mod projection;
pub mod sound_tables;
#[cfg(test)]
pub(crate) mod testing;

use std::sync::Arc;

use camera::Camera;
use held_inputs::HeldInputs;
use image::RgbaImage;
use mariana_field::graph::{
    FrameInputs, LevelList, Levels, PartInput, Screen, SoundInput, SoundInputs, TableData,
};
use mariana_field::limits::MOTION_SECONDS;
use mariana_field::world::{FrameValues, SwarmPicture, SwarmView, World};
pub use mariana_music::Sound;
use mariana_music::{Features, HISTORY_POINTS, RECENT_SECONDS, Recent, SongMoment};
use orbit_controls::OrbitControls;
use picture::Picture;
use projection::{Projection, ProjectionKind};

/// The inputs of one image.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Width and height of the image in pixels, each at least 1.
    pub size: (u32, u32),
    /// Inputs of the scene's expressions: time, sound, parameters. Every number is finite.
    pub inputs: FrameInputs,
    /// The camera.
    pub camera: Camera,
    /// The projection of the camera's rays.
    pub projection: Projection,
    /// Level of detail, 0..1: the shaders' `frame_quality`. The number of pixels does not depend on it.
    pub quality: f32,
    /// Lights and planes.
    pub values: FrameValues,
    /// Exposure, bloom, tone mapping and lens.
    pub picture: Picture,
    /// The pictures of moving textures, by the number of the texture. Other textures, and those without a picture here,
    /// stay as they are.
    pub pictures: Vec<Option<Arc<RgbaImage>>>,
    orbit: OrbitControls,
}

/// Choices for a frame besides its world, time and sound.
#[derive(Debug, Clone, Copy)]
pub struct FrameOptions<'a> {
    /// Values of the scene's parameters. Missing values have the defaults of the scene's text.
    pub params: &'a [f32],
    /// Held inputs, which override the parameters.
    pub held: &'a HeldInputs,
    /// Index of a named camera. `None` means the scene's main camera.
    pub camera: Option<usize>,
}

impl Frame {
    /// The frame of a world at `time` seconds, with the sound that is audible at `time` and the parameters' defaults.
    pub fn new(world: &World, time: f64, sound: impl Into<Sound>, size: (u32, u32)) -> Self {
        Self::with_params(world, time, sound, size, &[])
    }

    /// Like [`Frame::new`], with other parameters. Missing parameters have their defaults.
    pub fn with_params(
        world: &World,
        time: f64,
        sound: impl Into<Sound>,
        size: (u32, u32),
        params: &[f32],
    ) -> Self {
        Self::of_inputs(world, inputs_of(world, time, sound.into(), params, &HeldInputs::default()), size)
    }

    /// Like [`Frame::new`], with the given options.
    pub fn staged(
        world: &World,
        time: f64,
        sound: Sound,
        size: (u32, u32),
        frame_options: &FrameOptions<'_>,
    ) -> Self {
        let inputs = inputs_of(world, time, sound, frame_options.params, frame_options.held);
        let mut frame = Self::of_inputs(world, inputs, size);
        frame.seen_by(world, frame_options.camera);
        frame
    }

    fn of_inputs(world: &World, mut inputs: FrameInputs, size: (u32, u32)) -> Self {
        let size = (size.0.max(1), size.1.max(1));
        inputs.screen = Screen::of_size(size);
        let values = world.frame_tape.values(&inputs);
        let projection = Projection::default();
        let camera = Camera::of(&values.camera, projection.aspect(size));
        let picture = Picture::of(&values, &camera, world.features);
        let mut frame = Self {
            size,
            inputs,
            camera,
            projection,
            values,
            quality: 1.0,
            picture,
            pictures: Vec::new(),
            orbit: OrbitControls::OFF,
        };
        frame.place_camera(world, projection.aspect(size), OrbitControls::OFF);
        frame
    }

    /// The eye that sees the swarms.
    pub fn swarm_view(&self) -> SwarmView {
        let eye @ [x, y, z] = self.camera.position.as_vec3().to_array();
        let faces = |[a, b, c, d]: [f32; 4]| a * x + b * y + c * z + d > 0.0;
        SwarmView {
            eye,
            mirror: self.planes().enumerate().find(|(_, plane)| faces(*plane)),
            pixel: self.projection.pixel_radius(&self.camera, self.size) as f32,
            picture: self.projection.is_plain().then(|| {
                let [right, up, forward] =
                    self.projection.axes(&self.camera).map(|axis| axis.as_vec3().to_array());
                SwarmPicture { forward, half: [right, up], size: self.size.into() }
            }),
        }
    }

    /// Changes the projection. For two eyes, the frame contains two pictures.
    pub fn projected(mut self, world: &World, projection: Projection) -> Self {
        if self.projection == projection {
            return self;
        }
        self.projection = projection;
        let size = self.size;
        self.resized(world, size)
    }
}

/// Returns the numbers that scenes read from the sound of a moment. Every number is within its range.
pub fn sound_inputs(features: &Features, song: &SongMoment) -> SoundInputs {
    SoundInputs::each(|input| sound_input(input, features, song))
}

fn sound_input(input: SoundInput, features: &Features, song: &SongMoment) -> f32 {
    let name = input.name();
    input.clamp(features.number(name).or_else(|| song.number(name)).unwrap_or(0.0))
}

fn inputs_of(world: &World, time: f64, sound: Sound, params: &[f32], held: &HeldInputs) -> FrameInputs {
    let Sound { features, tables, song, parts, recent } = sound;
    let declared = world.scene.params.iter().enumerate();
    let mut inputs = FrameInputs {
        time: finite(time as f32),
        sound: sound_inputs(&features, &song),
        levels: levels(&features, &song),
        parts: part_inputs(&parts),
        spectrum: tables.spectrum.map_or(TableData::EMPTY, TableData::row),
        waveform: tables.waveform.map_or(TableData::EMPTY, TableData::row),
        history: tables.history.map_or(TableData::EMPTY, |rows| {
            TableData::scrolling(rows, HISTORY_POINTS, tables.history_offset, tables.history_span)
        }),
        params: declared
            .map(|(index, param)| {
                let value = params.get(index).copied().filter(|value| value.is_finite());
                value.unwrap_or(param.default).clamp(param.min, param.max)
            })
            .collect(),
        shapes: world.scene.atlas.clone(),
        ..FrameInputs::default()
    };
    held.apply(&mut inputs);
    if !world.frame_tape.motions.is_empty() {
        move_numbers(world, &mut inputs, time, &recent, held);
    }
    inputs
}

const _: () = assert!(RECENT_SECONDS as f32 == MOTION_SECONDS);

/// Computes the numbers with inertia of a frame from the last seconds. Held inputs and parameters keep their present
/// values during these seconds.
fn move_numbers(world: &World, inputs: &mut FrameInputs, time: f64, recent: &[Recent], held: &HeldInputs) {
    let motions = &world.frame_tape.motions;
    let (mut moving, mut at) = (motions.begin(), inputs.clone());
    let mut before = RECENT_SECONDS;
    for Recent { age, features, song, parts } in recent {
        at.time = finite((time - age) as f32);
        for input in &motions.sounds {
            at.sound[*input] = sound_input(*input, features, song);
        }
        if motions.read_levels {
            at.levels = levels(features, song);
        }
        if motions.read_parts {
            at.parts = part_inputs(parts);
        }
        held.apply(&mut at);
        moving.step(&mut at, (before - age) as f32);
        before = *age;
    }
    moving.step(inputs, before as f32);
}

fn levels(features: &Features, song: &SongMoment) -> Levels {
    Levels::each(|list, number| levels_of(list, features, song).get(number).copied().unwrap_or(0.0))
}

fn part_inputs(parts: &[f32]) -> Vec<f32> {
    let part = |(at, value): (usize, &f32)| PartInput::at(at).map_or(0.0, |input| input.clamp(*value));
    parts.iter().take(PartInput::COUNT).enumerate().map(part).collect()
}

/// Returns the levels of a list, as the analysis and the song provide them.
pub fn levels_of<'a>(list: LevelList, features: &'a Features, song: &'a SongMoment) -> &'a [f32] {
    match list {
        LevelList::Band => &features.bands,
        LevelList::Note => &features.notes,
        LevelList::Chroma => &song.chroma,
        LevelList::Pan => &features.pan,
        LevelList::Width => &features.width,
    }
}

impl Frame {
    /// Switches to another camera of the scene. `None` or an unknown index means the main camera.
    pub fn seen_by(&mut self, world: &World, camera: Option<usize>) {
        if let Some(camera) = camera.and_then(|camera| self.values.cameras.get(camera)) {
            self.values.camera = camera.clone();
            self.place_camera(world, self.projection.aspect(self.size), self.orbit);
        }
    }

    /// The point that the camera looks at. Its coordinates are finite.
    pub fn target(&self) -> glam::DVec3 {
        camera::place(self.values.camera.target)
    }

    /// Adapts the frame to a window of the given aspect (width over height) and quality, without changing its size.
    pub fn in_window(mut self, world: &World, aspect: f64, quality: f32) -> Self {
        self.quality = quality;
        self.place_camera(world, aspect, self.orbit);
        self
    }

    /// Changes the size of the image.
    pub fn resized(mut self, world: &World, size: (u32, u32)) -> Self {
        self.size = (size.0.max(1), size.1.max(1));
        self.place_camera(world, self.projection.aspect(self.size), self.orbit);
        let Screen { pointer, pressed, .. } = self.inputs.screen;
        let (width, height) = self.projection.eye_size(self.size);
        self.on_screen(world, Screen { pointer, pressed, size: [width, height].map(|side| side as f32) })
    }

    /// Sets the picture that the frame is shown as, without changing the frame's size: a window may draw fewer pixels
    /// than it shows.
    pub fn on_screen(mut self, world: &World, screen: Screen) -> Self {
        if self.inputs.screen != screen {
            self.inputs.screen = screen;
            if !world.frame_tape.screen_inputs.is_empty() {
                self.inputs.hoisted = world.hoisted.values(&self.inputs);
                self.values.picture = world.frame_tape.values(&self.inputs).picture;
                self.picture = self.wanted_picture(world);
            }
        }
        self
    }

    fn wanted_picture(&self, world: &World) -> Picture {
        let mut picture = Picture::of(&self.values, &self.camera, world.features);
        if !self.projection.is_plain() {
            // Only a flat picture has dark corners.
            picture.vignette = 0.0;
        }
        picture
    }

    /// Moves the camera by the user's controls.
    pub fn by_hand(mut self, world: &World, orbit: OrbitControls) -> Self {
        self.place_camera(world, self.projection.aspect(self.size), orbit);
        self
    }

    fn place_camera(&mut self, world: &World, aspect: f64, orbit: OrbitControls) {
        let mut asked = self.values.camera.clone();
        if self.projection.kind != ProjectionKind::Flat {
            // The whole scene is in view anyway.
            asked.keep = 0.0;
        }
        (self.orbit, self.camera) = (orbit, Camera::by_hand(&asked, aspect, &orbit));
        self.picture = self.wanted_picture(world);
        let eye = self.camera.position.as_vec3().to_array();
        // Hoisted values depend on the eye. Their remaining inputs do not change here.
        if self.inputs.eye != eye || self.inputs.hoisted.is_empty() {
            self.inputs.eye = eye;
            self.inputs.hoisted = world.hoisted.values(&self.inputs);
        }
    }

    /// The angle of the scene's own camera above its target, in radians.
    pub fn own_pitch(&self) -> f64 {
        OrbitControls::pitch_of(camera::place(self.values.camera.position), self.target())
    }
}

/// Replaces values that are not finite by 0. All inputs of a scene pass through here.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mariana_field::graph::{LevelList, SoundInput};
    use mariana_music::{Features, Recent, SongMoment, Sound};

    use super::held_inputs::HeldInputs;
    use super::testing::world_of;
    use super::{Frame, FrameOptions};

    #[test]
    fn numbers_with_inertia_come_from_the_last_seconds_and_obey_held_inputs() {
        let text = "param share = 0.5 in 0 .. 1\nlet slow = follow(bass + share + band(3), 1)\n\
                    object ball { shape = length(p) - slow - since(drums.kick > 0.5) - 0 * t }";
        let world = world_of(text);
        let recent = |bass: f32| -> Arc<[Recent]> {
            let moment = |step: u32| {
                let age = f64::from(100 - step) * 0.05;
                let mut features = Features { bass, ..Features::SILENCE };
                features.bands[3] = bass;
                let mut parts = vec![0.0; mariana_field::graph::PartInput::COUNT];
                let kick = mariana_field::graph::PartInput::named("drums.kick").unwrap().index();
                parts[kick] = if step == 60 { 1.0 } else { 0.0 };
                Recent { age, features, song: SongMoment::UNKNOWN, parts }
            };
            (0..100).map(moment).collect()
        };
        let motions = |sound: Sound, set: &[&str]| {
            let mut held = HeldInputs::default();
            set.iter().for_each(|set| assert_eq!(held.hold(&world.scene, &set.parse().unwrap()), Ok(true)));
            let options = FrameOptions { params: &[0.25], held: &held, camera: None };
            Frame::staged(&world, 9.0, sound, (8, 8), &options).inputs.motions
        };
        let moments = motions(Sound { recent: recent(1.0), ..Sound::default() }, &[]);
        let expected = 0.25 + 2.0 * (-0.05_f32).exp();
        assert!((moments[0] - expected).abs() < 1e-4 && (moments[1] - 2.025).abs() < 1e-3, "{moments:?}");
        assert_eq!(motions(Sound::default(), &[]), [0.25, 6.0], "nothing is remembered");
        let held = motions(
            Sound { recent: recent(1.0), ..Sound::default() },
            &["bass=0.5", "band(3)=0", "share=1", "drums.kick=0", "t=3"],
        );
        assert_eq!(held, [1.5, 6.0]);
    }

    /// Finds inputs that the analysis does not compute. Their value would always be 0, without an error.
    #[test]
    fn the_analysis_or_the_song_provides_every_sound_input() {
        for input in SoundInput::ALL {
            let (name, of_song) = (input.name(), input.is_of_song());
            let heard = Features::SILENCE.number(name).is_some();
            let known = SongMoment::UNKNOWN.number(name).is_some();
            assert_eq!(
                (heard, known),
                (!of_song, of_song),
                "exactly one of analysis and song must provide `{name}`"
            );
        }
        for list in LevelList::ALL {
            let levels = super::levels_of(list, &Features::SILENCE, &SongMoment::UNKNOWN);
            assert_eq!(levels.len(), list.count(), "{list:?}");
        }
        let parts = mariana_field::graph::SongPart::ALL.map(mariana_field::graph::SongPart::name);
        assert_eq!(parts, mariana_music::PART_NAMES);
    }
}
