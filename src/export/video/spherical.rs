//! Metadata that tells players the projection of a video, in MP4 and QuickTime files: Spherical Video V2 (the boxes
//! `st3d` and `sv3d`), and for whole spheres also V1 (XML in a `uuid` box), which older players read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crate::frame::projection::{Projection, ProjectionKind, Stereo};

/// Largest `moov` box that is read (an hour of video takes a few megabytes).
const MOOV_MAX: u64 = 1 << 28;
/// Bytes of a visual sample entry before its boxes.
const ENTRY_HEAD: usize = 78;
/// Bytes of a sample description before its entries.
const DESCRIPTION_HEAD: usize = 8;
/// The identifier of V1's box.
const V1: [u8; 16] =
    [0xff, 0xcc, 0x82, 0x63, 0xf8, 0x55, 0x4a, 0x93, 0x88, 0x14, 0x58, 0x7a, 0x02, 0x52, 0x1f, 0xdd];
const SOURCE: &str = "Mariana";

/// True if players need metadata for the projection. There is none for domes.
pub(super) fn is_marked(projection: &Projection) -> bool {
    projection.stereo != Stereo::None || is_spherical(projection)
}

fn is_spherical(projection: &Projection) -> bool {
    matches!(projection.kind, ProjectionKind::Sphere | ProjectionKind::Vr180)
}

/// Writes the metadata into a finished file, whose last box is `moov`.
///
/// # Errors
/// Fails if the file cannot be read or written, or has another layout.
pub(super) fn mark(path: &Path, projection: &Projection) -> io::Result<()> {
    let mut file = File::options().read(true).write(true).open(path)?;
    let length = file.metadata()?.len();
    let mut at = 0;
    loop {
        file.seek(SeekFrom::Start(at))?;
        let mut head = [0; 8];
        file.read_exact(&mut head)?;
        let [a, b, c, d, kind @ ..] = head;
        let size = match u32::from_be_bytes([a, b, c, d]) {
            0 => length - at,
            1 => {
                file.read_exact(&mut head)?;
                u64::from_be_bytes(head)
            }
            size => u64::from(size),
        };
        let end = at.checked_add(size).filter(|end| size >= 8 && *end <= length).ok_or_else(unexpected)?;
        if kind == *b"moov" && end == length && size <= MOOV_MAX {
            file.seek(SeekFrom::Start(at + 8))?;
            let mut moov = Vec::new();
            file.read_to_end(&mut moov)?;
            let marked = marked(&moov, projection).ok_or_else(unexpected)?;
            file.seek(SeekFrom::Start(at))?;
            return file.write_all(&boxed(*b"moov", &marked));
        }
        at = end;
    }
}

fn unexpected() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "ffmpeg wrote an unexpected layout")
}

/// Adds the boxes to the first video track of a `moov` box.
fn marked(moov: &[u8], projection: &Projection) -> Option<Vec<u8>> {
    with_child(moov, 0, Some(b"trak"), &|trak| {
        let mut trak = with_child(trak, 0, Some(b"mdia"), &|mdia| {
            with_child(mdia, 0, Some(b"minf"), &|minf| {
                boxes(minf)?.iter().find(|(kind, ..)| kind == b"vmhd")?;
                with_child(minf, 0, Some(b"stbl"), &|stbl| {
                    with_child(stbl, 0, Some(b"stsd"), &|stsd| {
                        with_child(stsd, DESCRIPTION_HEAD, None, &|entry| {
                            let (_, _, first) = *boxes(entry.get(ENTRY_HEAD..)?)?.first()?;
                            let (before, after) = entry.split_at(ENTRY_HEAD + first);
                            Some([before, &entry_boxes(projection), after].concat())
                        })
                    })
                })
            })
        })?;
        if projection.kind == ProjectionKind::Sphere {
            trak.extend(boxed(*b"uuid", &[&V1, xml(projection.stereo).as_bytes()].concat()));
        }
        Some(trak)
    })
}

/// Replaces the content of the first child box of this kind for which `change` returns a new content. The children
/// follow `head` bytes.
fn with_child(
    parent: &[u8],
    head: usize,
    kind: Option<&[u8; 4]>,
    change: &dyn Fn(&[u8]) -> Option<Vec<u8>>,
) -> Option<Vec<u8>> {
    let (head, children) = parent.split_at_checked(head)?;
    boxes(children)?.into_iter().filter(|(found, ..)| kind.is_none_or(|kind| kind == found)).find_map(
        |(kind, start, end)| {
            let changed = change(children.get(start + 8..end)?)?;
            Some([head, &children[..start], &boxed(kind, &changed), &children[end..]].concat())
        },
    )
}

/// Kind, start and end of each box in a sequence; `None` if the sequence is damaged.
fn boxes(bytes: &[u8]) -> Option<Vec<([u8; 4], usize, usize)>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some((size, rest)) = bytes.get(at..)?.split_first_chunk::<4>() {
        let size = u32::from_be_bytes(*size) as usize;
        // A QuickTime list may end with four zero bytes.
        if size == 0 && rest.is_empty() {
            break;
        }
        let end = at.checked_add(size).filter(|end| size >= 8 && *end <= bytes.len())?;
        found.push((*rest.first_chunk::<4>()?, at, end));
        at = end;
    }
    Some(found)
}

fn boxed(kind: [u8; 4], content: &[u8]) -> Vec<u8> {
    let size = (content.len() as u32 + 8).to_be_bytes();
    [&size, &kind, content].concat()
}

fn entry_boxes(projection: &Projection) -> Vec<u8> {
    // The first word of these boxes is their version and flags.
    let stereo = match projection.stereo {
        Stereo::None => 0,
        Stereo::OverUnder => 1,
        Stereo::SideBySide => 2,
    };
    let mut found = boxed(*b"st3d", &[0, 0, 0, 0, stereo]);
    if is_spherical(projection) {
        let source = boxed(*b"svhd", &[&[0; 4], SOURCE.as_bytes(), &[0]].concat());
        let pose = boxed(*b"prhd", &[0; 16]);
        // The picture's part of the sphere: distances from the upper, lower, left and right edges, as fractions of 2^32.
        let side: u32 = if projection.kind == ProjectionKind::Vr180 { 1 << 30 } else { 0 };
        let bounds = [0, 0, 0, side, side].map(u32::to_be_bytes);
        let projected = boxed(*b"proj", &[pose, boxed(*b"equi", bounds.as_flattened())].concat());
        found.extend(boxed(*b"sv3d", &[source, projected].concat()));
    }
    found
}

fn xml(stereo: Stereo) -> String {
    let mode = match stereo {
        Stereo::None => "mono",
        Stereo::SideBySide => "left-right",
        Stereo::OverUnder => "top-bottom",
    };
    let value = |name: &str, value: &str| format!("<GSpherical:{name}>{value}</GSpherical:{name}>");
    let values = [
        value("Spherical", "true"),
        value("Stitched", "true"),
        value("StitchingSoftware", SOURCE),
        value("ProjectionType", "equirectangular"),
        value("StereoMode", mode),
    ];
    format!(
        "<?xml version=\"1.0\"?><rdf:SphericalVideo xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" \
         xmlns:GSpherical=\"http://ns.google.com/videos/1.0/spherical/\">{}</rdf:SphericalVideo>",
        values.concat()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn movie(handler: &[u8; 4], entry: &[u8]) -> Vec<u8> {
        let stsd = boxed(*b"stsd", &[&[0; DESCRIPTION_HEAD], entry].concat());
        let minf = [boxed(*handler, &[]), boxed(*b"stbl", &stsd)].concat();
        boxed(*b"trak", &boxed(*b"mdia", &boxed(*b"minf", &minf)))
    }

    #[test]
    fn boxes_are_added_after_the_codecs_box_of_the_video() {
        let entry = [&[7; ENTRY_HEAD][..], &boxed(*b"avcC", b"abc"), &boxed(*b"pasp", b"d")].concat();
        let sound = movie(b"smhd", &boxed(*b"mp4a", &entry));
        let moov = [sound.clone(), movie(b"vmhd", &boxed(*b"avc1", &entry))].concat();
        let vr =
            Projection { kind: ProjectionKind::Vr180, stereo: Stereo::SideBySide, ..Projection::default() };
        let marked = marked(&moov, &vr).unwrap();
        let added = [&boxed(*b"avcC", b"abc")[..], &entry_boxes(&vr), &boxed(*b"pasp", b"d")].concat();
        let expected = movie(b"vmhd", &boxed(*b"avc1", &[&[7; ENTRY_HEAD][..], &added].concat()));
        assert_eq!(marked, [sound, expected].concat());
    }

    #[test]
    fn damaged_files_are_refused() {
        let sphere = Projection { kind: ProjectionKind::Sphere, ..Projection::default() };
        let good = movie(b"vmhd", &boxed(*b"avc1", &[&[7; ENTRY_HEAD][..], &boxed(*b"avcC", b"")].concat()));
        assert!(marked(&good, &sphere).is_some());
        for length in 0..good.len() {
            assert_eq!(marked(&good[..length], &sphere), None, "{length} bytes");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        std::fs::write(&path, [boxed(*b"moov", &good), boxed(*b"mdat", b"")].concat()).unwrap();
        assert!(mark(&path, &sphere).is_err());
        std::fs::write(&path, [boxed(*b"mdat", b"x"), boxed(*b"moov", &good)].concat()).unwrap();
        mark(&path, &sphere).unwrap();
        let moov = boxed(*b"moov", &marked(&good, &sphere).unwrap());
        assert_eq!(std::fs::read(&path).unwrap(), [boxed(*b"mdat", b"x"), moov].concat());
    }
}
