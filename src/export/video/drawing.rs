//! The frames of a video, by their numbers.

use super::lyric_captions::LyricCaptions;
use super::request::{VideoRequest, frames_in};
use super::title_card::TitleCard;
use crate::export::error::ExportError;
use crate::export::show_painter::ShowPainter;
use crate::export::song_features::SongFeatures;

pub(super) struct VideoFrames<'a> {
    request: &'a VideoRequest,
    song: SongFeatures,
    painter: ShowPainter,
    card: Option<TitleCard>,
    captions: Option<LyricCaptions>,
    pub(super) expected: Option<u64>,
}

impl<'a> VideoFrames<'a> {
    /// Opens the song and the scenes. `asked` is the number of frames to draw; `None` draws to the song's end. With
    /// `needs_all`, the song must have this many frames.
    pub(super) fn open(
        request: &'a VideoRequest,
        asked: Option<u64>,
        needs_all: bool,
    ) -> Result<Self, ExportError> {
        let mut song = SongFeatures::open_with(&request.song, request.start, request.gain)?;
        song.require(request.start)?;
        let seconds_left = song.duration().map(|seconds| seconds - request.start);
        let left = seconds_left.map(|seconds| frames_in(seconds, request.fps));
        let expected = asked.into_iter().chain(left).min();
        if needs_all && expected < asked {
            return Err(too_long(request, asked, seconds_left.unwrap_or(0.0)));
        }
        let length = expected.map(|frames| frames as f64 / request.fps);
        let length = length.into_iter().chain(request.duration).reduce(f64::min);
        let card = request.title_card.then(|| TitleCard::of(request, length)).transpose()?;
        if let Some(lyrics) = &request.lyrics {
            song.sing(lyrics.clone());
        }
        let captions = request.lyrics.clone().map(|lyrics| LyricCaptions::new(lyrics, request.size));
        let prepared_show = request.showing.prepared_show(&mut song, request.start)?;
        let mut painter = ShowPainter::open(&request.scene, prepared_show, &request.set)?;
        if request.limit_flashes {
            painter.headless_renderer.renderer.add_flash_limiter(&request.scene.shaders)?;
        }
        painter.graphs().for_each(|graph| song.know_for(graph));
        painter.headless_renderer.set_song(&song)?;
        painter.headless_renderer.is_video = true;
        Ok(Self { request, song, painter, card, captions, expected })
    }

    /// Draws a frame; `None` after the song's end. Numbers must not decrease.
    pub(super) fn draw(&mut self, number: u64) -> Result<Option<Vec<u8>>, ExportError> {
        let Self { request, song, painter, .. } = self;
        let time = request.start + number as f64 / request.fps;
        let Some(sound) = song.sound_at(time)? else { return Ok(None) };
        let held = painter.held_at(song, request.start, time)?;
        let exposures = request.shutter.exposures(song, time, sound, 1.0 / request.fps)?;
        painter.draw(time, exposures, held, request.size)?;
        painter.headless_renderer.renderer.limit_flashes(1.0 / request.fps)?;
        Ok(Some(painter.read()))
    }

    /// Writes title and lyrics over the frame with this number in the video.
    pub(super) fn letter(&mut self, picture: &mut [u8], number: u64) {
        let seconds = number as f64 / self.request.fps;
        if let Some(card) = &self.card {
            card.draw_over(picture, seconds);
        }
        if let Some(captions) = &mut self.captions {
            captions.draw_over(picture, self.request.start + seconds);
        }
    }

    /// Checks that the song has `asked` frames, of which `drawn` are drawn.
    pub(super) fn require_all(&self, asked: Option<u64>, drawn: u64) -> Result<(), ExportError> {
        let is_over = self.song.is_over(self.request.start + drawn as f64 / self.request.fps);
        match asked {
            Some(frames) if is_over && drawn < frames => {
                Err(too_long(self.request, asked, drawn as f64 / self.request.fps))
            }
            _ => Ok(()),
        }
    }
}

/// `left` is the rest of the song in seconds.
fn too_long(request: &VideoRequest, asked: Option<u64>, left: f64) -> ExportError {
    let needed = asked.map_or(0.0, |frames| frames as f64 / request.fps);
    loop_too_long(request.duration.unwrap_or(0.0), needed, left)
}

/// The error of a loop of `length` seconds that needs more of the song than is left after its start.
pub(crate) fn loop_too_long(length: f64, needed: f64, left: f64) -> ExportError {
    ExportError::Refused(format!(
        "a loop of {length} s and its seam need {needed:.2} s of the song, but only {left:.2} s are left: choose an \
         earlier --start or a shorter --duration"
    ))
}
