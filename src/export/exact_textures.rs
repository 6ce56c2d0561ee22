//! The pictures of moving textures in stills and videos, which wait for each picture.

use std::sync::Arc;

use image::RgbaImage;

use super::print::print_message;
use crate::covers;
use crate::frame::Frame;
use crate::moving_textures::{image_of, pictures_of};
use crate::scenes::TextureSource;
use crate::song_shapes::{self, ExactSongShapes, SongTexts};
use crate::song_structures::lyrics_of;
use mariana_field::world::World;
use mariana_player::lyrics::Lyrics;
use mariana_player::song::Song;
use mariana_player::video::{VideoError, VideoReader};

/// The moving textures of stills and videos. A source that fails shows grey, and is reported once.
#[derive(Default)]
pub(super) struct ExactTextures {
    known: Vec<(TextureSource, Exact)>,
    /// The song, its display name, and its lyrics if they are known.
    song: Option<(Song, String, Option<Lyrics>)>,
    shapes: ExactSongShapes,
    /// Known once a scene shows them.
    texts: Option<SongTexts>,
}

enum Exact {
    Video {
        reader: Box<VideoReader>,
        shown: Option<(u64, Arc<RgbaImage>)>,
    },
    Still(Arc<RgbaImage>),
    /// Grey, or the last picture of a video that failed.
    Nothing,
}

impl ExactTextures {
    /// Sets the song whose cover the scenes show, its display name, and its lyrics if they are known.
    pub(super) fn set_song(&mut self, song: Song, name: String, lyrics: Option<Lyrics>) {
        self.song = Some((song, name, lyrics));
        self.texts = None;
    }

    fn texts(&mut self) -> &SongTexts {
        let song = &self.song;
        self.texts.get_or_insert_with(|| {
            let Some((song, name, lyrics)) = song else { return SongTexts::default() };
            let decoder = song.open().ok();
            let info = decoder.as_ref().map(|decoder| decoder.info());
            let title = info.and_then(|info| info.title.as_deref());
            let artist = info.and_then(|info| info.artist.clone());
            SongTexts {
                title: song_shapes::shown_title(title, name),
                artist: artist.unwrap_or_default(),
                lyrics: Arc::new(lyrics.clone().unwrap_or_else(|| lyrics_of(song))),
            }
        })
    }

    /// Adds the pictures at the frame's time to a frame of a world. Waits for them.
    pub(super) fn put_into(&mut self, frame: &mut Frame, world: &World) {
        let time = f64::from(frame.inputs.time);
        frame.pictures = pictures_of(world, |source| self.picture(source, time));
        if song_shapes::are_shown_by(world) {
            let texts = self.texts().clone();
            let line = texts.lyrics.at(time).map(|(number, _)| number);
            self.shapes.put_into(frame, world, &texts, line);
        }
    }

    fn picture(&mut self, source: TextureSource, time: f64) -> Option<Arc<RgbaImage>> {
        let at = match self.known.iter().position(|(known, _)| *known == source) {
            Some(at) => at,
            None => {
                let opened = self.open(&source).unwrap_or_else(|error| {
                    print_message(&format!("{error}; its texture is grey"));
                    Exact::Nothing
                });
                self.known.push((source, opened));
                self.known.len() - 1
            }
        };
        let (_, exact) = self.known.get_mut(at)?;
        match exact {
            Exact::Still(picture) => Some(picture.clone()),
            Exact::Nothing => None,
            Exact::Video { reader, shown } => {
                let number = reader.info().number_at(time) % reader.info().frames;
                if let Some((_, picture)) = shown.as_ref().filter(|(known, _)| *known == number) {
                    return Some(picture.clone());
                }
                match reader.frame(number) {
                    Ok(frame) => {
                        let picture = Arc::new(image_of(frame.clone())?);
                        *shown = Some((number, picture.clone()));
                        Some(picture)
                    }
                    Err(error) => {
                        print_message(&format!("{error}; its last picture stays"));
                        let last = shown.take().map(|(_, picture)| picture);
                        *exact = last.clone().map_or(Exact::Nothing, Exact::Still);
                        last
                    }
                }
            }
        }
    }

    fn open(&self, source: &TextureSource) -> Result<Exact, VideoError> {
        Ok(match source {
            TextureSource::Video { file, .. } => {
                Exact::Video { reader: Box::new(VideoReader::open(file, &source.name())?), shown: None }
            }
            TextureSource::Camera(_) | TextureSource::CameraDevice(_) => {
                print_message(&format!(
                    "{} is live only, so its texture is grey: give stills and videos a recording of it",
                    source.name()
                ));
                Exact::Nothing
            }
            TextureSource::Cover => {
                let of_song = self.song.as_ref().and_then(|(song, ..)| covers::picture_of(song));
                let name = self.song.as_ref().map_or("", |(_, name, _)| name);
                Exact::Still(Arc::new(of_song.unwrap_or_else(|| covers::painted(name))))
            }
        })
    }
}
