//! Decoding of a demuxer's packets to stereo frames. Each block of frames has its position on the container's clock.
//! Encoder delay and padding are not cut off yet.

use std::io;

use symphonia::core::audio::{Channels, GenericAudioBufferRef};
use symphonia::core::codecs::CodecParameters;
use symphonia::core::codecs::audio::{AudioCodecParameters, AudioDecoder, CODEC_ID_NULL_AUDIO};
use symphonia::core::errors::Error;
use symphonia::core::formats::well_known::{
    FORMAT_ID_ADTS, FORMAT_ID_AIFF, FORMAT_ID_CAF, FORMAT_ID_FLAC, FORMAT_ID_ISOMP4, FORMAT_ID_MKV,
    FORMAT_ID_MP1, FORMAT_ID_MP2, FORMAT_ID_MP3, FORMAT_ID_OGG, FORMAT_ID_WAVE,
};
use symphonia::core::formats::{FormatReader, SeekMode, SeekTo, Track, TrackFlags};
use symphonia::core::meta::well_known::METADATA_ID_ID3V1;
use symphonia::core::meta::{MetadataContainer, StandardTag};
use symphonia::core::packet::Packet;
use symphonia::core::units::{Duration, Timestamp};

use crate::encoding::decode;
use crate::ffmpeg::Demuxer;
use crate::limits;
use crate::one_line::one_line;
use mariana_music::StereoFrame;

use super::clock::Clock;
use super::downmix::Downmix;
use super::error::Problem;
use super::gapless::{Edits, TrackEdit, opus_head, parse_itun_smpb};
use super::input::{MediaInput, is_disk_error};
use super::loudness::Loudness;
use super::old_tags::OldTags;
use super::{codecs, contained, sniff};

/// Number of consecutive failures after which the stream ends, because the demuxer no longer finds packets.
const DEMUXER_FAILURES_MAX: u32 = 16;

#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) rate: u32,
    /// The block's first raw frame by the container's clock.
    pub(super) start: Option<i64>,
    /// True if `start` is exact without the codec's grid.
    pub(super) exact: bool,
    /// Number of frames at the block's end that are the encoder's padding.
    pub(super) padding: usize,
    /// In the first block of each stream that follows in the same file (chained Ogg): the delay of this stream.
    pub(super) new_link: Option<u64>,
}

#[derive(Debug, Default)]
pub(super) struct Tags {
    pub(super) title: Option<String>,
    pub(super) artist: Option<String>,
    pub(super) lyrics: Option<String>,
    pub(super) loudness: Loudness,
    /// Delay and length in frames, from the `iTunSMPB` tag.
    itunes_gapless: Option<(u64, u64)>,
}

pub(super) struct PacketReader {
    input: MediaInput,
    format: Box<dyn FormatReader>,
    edits: Edits,
    old_tags: OldTags,
    /// Index of the chosen audio track; `None` for the first that can be decoded.
    pub(super) track: Option<usize>,
    stream: Stream,
    /// The packet after the current one, in Matroska files with padding at the end.
    ahead: Option<Packet>,
    mixer: Mixer,
    mpeg_header: Option<[u8; 3]>,
    empty_in_a_row: u32,
    demuxer_failures: u32,
    links: u32,
    link_begins: bool,
}

/// The track being decoded. Each link of a chained file has its own stream.
struct Stream {
    track: Track,
    params: AudioCodecParameters,
    codec: Box<dyn AudioDecoder>,
    clock: Clock,
    announced_delay: Option<u64>,
    /// The factor for all samples, in the header of Opus.
    gain: f32,
    /// The end of the last packet of an Ogg stream, in ticks.
    end: Option<i64>,
    /// The size of a frame in the first packet of MPEG audio.
    bytes_per_frame: Option<f64>,
}

#[derive(Default)]
struct Mixer {
    downmix: Option<(Channels, Downmix)>,
    planes: Vec<Vec<f32>>,
}

impl PacketReader {
    /// Opens the audio track with this index, or the first track that can be decoded.
    pub(super) fn open(input: &MediaInput, track: Option<usize>) -> Result<Self, Problem> {
        let opened = input.open(0)?;
        Ok(Self {
            stream: Stream::choose(opened.format.as_ref(), track)?,
            track,
            input: input.clone(),
            format: opened.format,
            edits: opened.edits,
            old_tags: opened.old_tags,
            ahead: None,
            mixer: Mixer::default(),
            mpeg_header: None,
            empty_in_a_row: 0,
            demuxer_failures: 0,
            links: 0,
            link_begins: false,
        })
    }

    /// Decodes packets until one packet yields frames, and appends the frames to `out`. Returns `None` at the end.
    pub(super) fn next(&mut self, out: &mut Vec<StereoFrame>) -> Result<Option<Block>, Problem> {
        loop {
            let Some(mut packet) = self.next_packet()? else { return Ok(None) };
            self.place(&mut packet);
            self.stream.clock.begin(packet.pts.get());
            self.stream.announced_delay.get_or_insert(packet.trim_start.get());
            let before = out.len();
            let rate = self.decode(&packet, out)?;
            match rate {
                Some(rate) if out.len() > before => {
                    self.empty_in_a_row = 0;
                    if codecs::is_mpeg_audio(self.stream.params.codec) {
                        let size = packet.data.len() as f64 / (out.len() - before) as f64;
                        self.stream.bytes_per_frame.get_or_insert(size);
                    }
                    let new_link = self.link_begins.then(|| self.delay(rate));
                    self.link_begins = false;
                    return Ok(Some(Block {
                        rate,
                        start: self.stream.clock.raw_frame(packet.pts.get(), rate),
                        exact: self.stream.clock.is_exact(rate),
                        padding: self.padding(&packet, rate)?,
                        new_link,
                    }));
                }
                _ => {
                    self.empty_in_a_row += 1;
                    if self.empty_in_a_row > limits::BAD_PACKETS_IN_A_ROW {
                        return Err(Problem::Damaged(format!(
                            "{} packets in a row could not be decoded",
                            limits::BAD_PACKETS_IN_A_ROW
                        )));
                    }
                }
            }
        }
    }

    /// Corrects the times of an Ogg packet. The demuxer trusts a page without a position (-1), and cuts its packets.
    fn place(&mut self, packet: &mut Packet) {
        if self.format.format_info().format != FORMAT_ID_OGG {
            return;
        }
        let whole = packet.dur.saturating_add(packet.trim_start).saturating_add(packet.trim_end);
        let start = packet.pts.get().max(self.stream.end.unwrap_or(i64::MIN));
        let end = start.saturating_add_unsigned(whole.get());
        // The demuxer takes the position of the last page for the number of frames. If the last page is missing, packets
        // that the demuxer cuts whole are those without a position.
        packet.trim_end = match self.stream.track.num_frames {
            Some(last) => Duration::new(u64::try_from(end).unwrap_or(0).saturating_sub(last)).min(whole),
            None if packet.trim_end < whole => packet.trim_end,
            None => Duration::ZERO,
        };
        packet.pts = Timestamp::new(start);
        self.stream.end = Some(end);
    }

    fn next_packet(&mut self) -> Result<Option<Packet>, Problem> {
        if let Some(packet) = self.ahead.take() {
            return Ok(Some(packet));
        }
        loop {
            let format = &mut self.format;
            match contained(|| format.next_packet())? {
                Ok(None) => return Ok(None),
                Ok(Some(packet)) => {
                    self.demuxer_failures = 0;
                    if packet.track_id == self.stream.track.id {
                        return Ok(Some(packet));
                    }
                }
                Err(Error::ResetRequired) => {
                    self.links += 1;
                    if self.links > limits::BAD_PACKETS_IN_A_ROW || !self.begin_link()? {
                        return Ok(None);
                    }
                }
                Err(Error::IoError(e)) if e.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
                Err(Error::IoError(e)) if is_disk_error(&e) => return Err(e.into()),
                Err(_) => {
                    self.demuxer_failures += 1;
                    if self.demuxer_failures > DEMUXER_FAILURES_MAX {
                        return Ok(None);
                    }
                }
            }
        }
    }

    fn begin_link(&mut self) -> Result<bool, Problem> {
        let Ok(stream) = Stream::choose(self.format.as_ref(), self.track) else {
            return Ok(false);
        };
        self.stream = stream;
        self.link_begins = true;
        Ok(true)
    }

    /// Decodes one packet and returns its rate. Returns `None` if the packet cannot be decoded and is skipped.
    fn decode(&mut self, packet: &Packet, out: &mut Vec<StereoFrame>) -> Result<Option<u32>, Problem> {
        if codecs::is_mpeg_audio(self.stream.params.codec) {
            self.follow_mpeg_header(&packet.data)?;
        }
        let mut bare = packet.as_packet_ref();
        // The caller trims, because the caller also knows delays that the demuxer does not report.
        bare.trim_start = Duration::ZERO;
        bare.trim_end = Duration::ZERO;
        let codec = &mut self.stream.codec;
        match contained(|| codec.decode_ref(&bare))? {
            Ok(buffer) => {
                let rate = buffer.spec().rate();
                if buffer.frames() > 0 {
                    self.mixer.mix(&buffer, self.stream.gain, out)?;
                }
                Ok(Some(rate))
            }
            Err(Error::IoError(e)) if is_disk_error(&e) => Err(e.into()),
            Err(_) => Ok(None),
        }
    }

    /// Replaces the decoder if the format changes, because a decoder keeps the rate and channels of its first packet.
    fn follow_mpeg_header(&mut self, data: &[u8]) -> Result<(), Problem> {
        if let [_, version, rate, mode, ..] = data {
            let header = [version & 0x1E, rate & 0x0C, u8::from(mode & 0xC0 == 0xC0)];
            if self.mpeg_header.replace(header).is_some_and(|previous| previous != header) {
                self.stream.codec = codecs::make(&self.stream.params)?;
            }
        }
        Ok(())
    }

    /// The padding at the end of a packet, in frames.
    fn padding(&mut self, packet: &Packet, rate: u32) -> Result<usize, Problem> {
        if self.edits.padding_ns > 0 {
            self.ahead = self.next_packet()?;
            let seconds = self.edits.padding_ns as f64 / 1e9;
            return Ok(if self.ahead.is_none() { (seconds * f64::from(rate)).round() as usize } else { 0 });
        }
        let track = &self.stream.track;
        if codecs::is_mpeg_audio(self.stream.params.codec) {
            // Without a LAME tag the length is an estimate. Sound after the stated end shows that the length is wrong.
            let stated = track.padding.filter(|_| track.num_frames != Some(0)).map_or(0, u64::from);
            if packet.trim_end.get() > stated {
                return Ok(0);
            }
        }
        let ticks = i64::try_from(packet.trim_end.get()).unwrap_or(i64::MAX);
        Ok(self.stream.clock.frames(ticks, rate).map_or(0, |frames| frames.round() as usize))
    }

    fn edit(&self) -> Option<&TrackEdit> {
        self.edits.tracks.iter().find(|edit| edit.track_id == self.stream.track.id && edit.timescale > 0)
    }

    /// Returns the number of raw frames to cut off at the start. The number is known after the first packet.
    pub(super) fn delay(&self, rate: u32) -> u64 {
        if codecs::is_opus(self.stream.params.codec)
            && let Some((skip, _)) = self.stream.params.extra_data.as_deref().and_then(opus_head)
        {
            return skip;
        }
        if let Some(edit) = self.edit() {
            return edit.frames(edit.media_time, rate);
        }
        let lead_in = self.stream.clock.lead_in(rate);
        if self.stream.clock.is_exact(rate) {
            lead_in.max(self.stream.announced_delay.unwrap_or(0))
        } else {
            codecs::known_delay(self.stream.params.codec, lead_in, rate)
        }
    }

    /// The rate that the container claims, in frames per second.
    pub(super) fn claimed_rate(&self) -> Option<u32> {
        self.stream.params.sample_rate.filter(|rate| *rate > 0)
    }

    /// Returns the number of audible frames, if the container states it, and the length in seconds, maybe estimated.
    pub(super) fn length(&mut self, rate: u32) -> (Option<u64>, Option<f64>) {
        let format = self.format.format_info().format;
        let delay = self.delay(rate) as i64;
        let hidden = delay + self.stream.clock.first();
        let counted = self
            .stream
            .track
            .num_frames
            .filter(|&frames| frames > 0 && self.stream.params.sample_rate == Some(rate))
            .and_then(|frames| i64::try_from(frames).ok()?.checked_sub(hidden))
            .and_then(|frames| u64::try_from(frames).ok());
        let exact = match format {
            FORMAT_ID_ISOMP4 if self.edits.is_fragmented => self
                .edit()
                .filter(|edit| edit.length > 0)
                .map(|edit| edit.frames(edit.length, rate).saturating_sub(delay.unsigned_abs())),
            FORMAT_ID_ISOMP4 => match (self.tags().itunes_gapless, counted) {
                (Some((_, length)), Some(counted)) => Some(length.min(counted)),
                (_, counted) => counted,
            },
            FORMAT_ID_CAF => counted,
            _ => None,
        };
        let seconds = |frames: u64| frames as f64 / f64::from(rate);
        let claimed = exact.or(counted).map(seconds).or_else(|| {
            let ticks = |duration: Option<Duration>, base: Option<symphonia::core::units::TimeBase>| {
                Some(base?.calc_duration(duration?)?.as_secs_f64())
            };
            let media = self.format.media_info();
            let whole = ticks(self.stream.track.duration, self.stream.track.time_base)
                .filter(|&s| s > 0.0)
                .or_else(|| ticks(media.duration, media.time_base))?;
            Some(whole - seconds(delay as u64))
        });
        let claimed = claimed.filter(|s| *s > 0.0).or_else(|| {
            // The length of an MP3 file whose header counts no frames, if the bit rate is constant.
            let frames = self.input.size()? as f64 / self.stream.bytes_per_frame?;
            Some(frames / f64::from(rate))
        });
        (exact, claimed.filter(|s| *s > 0.0 && *s <= limits::CLAIMED_DURATION_MAX))
    }

    pub(super) fn tags(&mut self) -> Tags {
        let mut tags = Tags::default();
        let track = u64::from(self.stream.track.id);
        let mut metadata = self.format.metadata();
        let mut read = |container: &MetadataContainer, is_id3v1: bool| {
            // The demuxer decodes ID3v1 as Latin-1, in which every byte is a character.
            let text = |text: &str| match text.chars().map(u8::try_from).collect::<Result<Vec<u8>, _>>() {
                Ok(bytes) if is_id3v1 => one_line(&decode(&bytes)),
                _ => one_line(text),
            };
            for tag in &container.tags {
                match &tag.std {
                    Some(StandardTag::TrackTitle(title)) => tags.title = Some(text(title)),
                    Some(StandardTag::Artist(artist)) => tags.artist = Some(text(artist)),
                    Some(StandardTag::Lyrics(text)) if text.len() as u64 <= limits::LYRICS_BYTES_MAX => {
                        tags.lyrics = Some(text.to_string());
                    }
                    Some(StandardTag::ReplayGainTrackGain(text)) => tags.loudness.replay_gain(false, text),
                    Some(StandardTag::ReplayGainAlbumGain(text)) => tags.loudness.replay_gain(true, text),
                    _ if tag.raw.key.eq_ignore_ascii_case("R128_TRACK_GAIN") => {
                        tags.loudness.r128(false, &tag.raw.value.to_string());
                    }
                    _ if tag.raw.key.eq_ignore_ascii_case("R128_ALBUM_GAIN") => {
                        tags.loudness.r128(true, &tag.raw.value.to_string());
                    }
                    _ if tag.raw.key.ends_with("iTunSMPB") => {
                        tags.itunes_gapless = parse_itun_smpb(&tag.raw.value.to_string());
                    }
                    _ => {}
                }
            }
        };
        // Read the oldest entry first, so that the newest entry is kept.
        loop {
            if let Some(revision) = metadata.current() {
                let per_track = revision.per_track.iter().filter(|per| per.track_id == track);
                per_track.for_each(|per| read(&per.metadata, false));
                read(&revision.media, revision.info.metadata == METADATA_ID_ID3V1);
            }
            if metadata.pop().is_none() {
                break;
            }
        }
        let old = &self.old_tags;
        tags.title = old.title.as_deref().map(one_line).or(tags.title);
        tags.artist = old.artist.as_deref().map(one_line).or(tags.artist);
        tags.lyrics = old.lyrics.clone().or(tags.lyrics);
        tags
    }

    /// Seeks to a packet that begins at least the codec's pre-roll before frame `raw`. Returns false if the container
    /// or its clock does not support the seek. In this case the caller must open the reader again.
    pub(super) fn jump(&mut self, raw: i64, rate: u32) -> Result<bool, Problem> {
        let early = raw - codecs::pre_roll(self.stream.params.codec, rate);
        // The Ogg demuxer never returns from a seek in a file with several streams.
        let lost = self.format.format_info().format == FORMAT_ID_OGG && self.format.tracks().len() > 1;
        if early <= 0 || lost || self.links > 0 || !self.stream.clock.is_usable(rate) {
            return Ok(false);
        }
        let Some(ticks) = self.stream.clock.ticks_before(early, rate) else { return Ok(false) };
        if self.edits.is_fragmented {
            // The demuxer looks for more fragments where it has read the last packet, and finds none.
            self.format = self.input.open(0)?.format;
        }
        let to = SeekTo::Timestamp { ts: Timestamp::new(ticks), track_id: self.stream.track.id };
        let format = &mut self.format;
        if contained(|| format.seek(SeekMode::Accurate, to))?.is_err() {
            return Ok(false);
        }
        // Create a new decoder instead of resetting the old one: AAC's noise generator survives a reset, and the same
        // seek must always yield the same samples.
        self.stream.codec = codecs::make(&self.stream.params)?;
        (self.ahead, self.stream.end) = (None, None);
        self.demuxer_failures = 0;
        self.empty_in_a_row = 0;
        Ok(true)
    }

    /// ffmpeg's demuxer for the container. Fails if ffmpeg has no song demuxer that reads the container.
    pub(super) fn demuxer(&self) -> Result<Demuxer, Problem> {
        let format = self.format.format_info();
        match format.format {
            FORMAT_ID_ADTS => Ok(Demuxer::ADTS),
            FORMAT_ID_AIFF => Ok(Demuxer::AIFF),
            FORMAT_ID_CAF => Ok(Demuxer::CAF),
            FORMAT_ID_FLAC => Ok(Demuxer::FLAC),
            FORMAT_ID_ISOMP4 => Ok(Demuxer::MOV),
            FORMAT_ID_MKV => Ok(Demuxer::MATROSKA),
            FORMAT_ID_MP1 | FORMAT_ID_MP2 | FORMAT_ID_MP3 => Ok(Demuxer::MP3),
            FORMAT_ID_OGG => Ok(Demuxer::OGG),
            FORMAT_ID_WAVE => Ok(Demuxer::WAV),
            _ => Err(Problem::UnsupportedFormat(format!("in the container {}", format.long_name))),
        }
    }

    pub(super) fn channels(&self) -> usize {
        self.mixer.downmix.as_ref().map_or(0, |(_, downmix)| downmix.channels())
    }
}

impl Mixer {
    fn mix(
        &mut self,
        buffer: &GenericAudioBufferRef<'_>,
        gain: f32,
        out: &mut Vec<StereoFrame>,
    ) -> Result<(), Problem> {
        let (spec, frames) = (buffer.spec(), buffer.frames());
        if frames > limits::PACKET_FRAMES_MAX {
            return Err(Problem::OverLimit {
                what: format!("a packet of {frames} frames"),
                limit: format!("{} frames", limits::PACKET_FRAMES_MAX),
            });
        }
        if !self.downmix.as_ref().is_some_and(|(channels, _)| channels == spec.channels()) {
            let channels = spec.channels();
            sniff::check(channels.count(), spec.rate())?;
            self.downmix = Some((channels.clone(), Downmix::new(channels)));
        }
        buffer.copy_to_vecs_planar::<f32>(&mut self.planes);
        if let Some((_, downmix)) = &mut self.downmix {
            let before = out.len();
            downmix.mix(&self.planes, frames, out);
            out.iter_mut().skip(before).flatten().for_each(|sample| *sample *= gain);
        }
        Ok(())
    }
}

impl Stream {
    fn choose(format: &dyn FormatReader, chosen: Option<usize>) -> Result<Self, Problem> {
        let mut tracks: Vec<&Track> = format.tracks().iter().collect();
        match chosen {
            Some(number) => {
                tracks.retain(|track| matches!(track.codec_params, Some(CodecParameters::Audio(_)) | None));
                tracks = tracks.into_iter().skip(number).take(1).collect();
                if tracks.is_empty() {
                    return Err(Problem::NoTrack(number + 1));
                }
            }
            None => tracks.sort_by_key(|track| !track.flags.contains(TrackFlags::DEFAULT)),
        }
        let mut refusal = None;
        for track in tracks {
            let made = match &track.codec_params {
                Some(CodecParameters::Audio(params)) => codecs::make(params).map(|codec| (params, codec)),
                // A codec that the demuxer does not know may be an audio codec, so the track counts as audio.
                None => Err(Problem::UnsupportedCodec("an unknown codec".into())),
                Some(_) => continue,
            };
            match made {
                Ok((params, _)) if params.codec == CODEC_ID_NULL_AUDIO => {}
                Ok((params, codec)) => {
                    let clock = Clock::new(track.time_base, codecs::grid(params.codec));
                    let (track, params) = (track.clone(), params.clone());
                    let head = params.extra_data.as_deref().filter(|_| codecs::is_opus(params.codec));
                    let gain = head.and_then(opus_head).map_or(1.0, |(_, gain)| gain);
                    return Ok(Self {
                        track,
                        params,
                        codec,
                        clock,
                        announced_delay: None,
                        gain,
                        end: None,
                        bytes_per_frame: None,
                    });
                }
                Err(error) => refusal = refusal.or(Some(error)),
            }
        }
        Err(refusal.unwrap_or(Problem::NoAudioTrack))
    }
}
