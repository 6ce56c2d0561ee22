//! Metadata that tells viewers the projection of a still: GPano in XMP, for whole spheres and their front halves.

use crate::frame::projection::{Projection, ProjectionKind, Stereo};

/// Returns the XMP of a picture of `size` pixels; `None` if viewers need none, or if no metadata describes it: domes,
/// and pictures for two eyes.
fn xmp(projection: &Projection, size: (u32, u32)) -> Option<String> {
    let (width, height) = size;
    let whole = match (projection.kind, projection.stereo) {
        (ProjectionKind::Sphere, Stereo::None) => width,
        (ProjectionKind::Vr180, Stereo::None) => 2 * width,
        _ => return None,
    };
    let values = [
        ("ProjectionType", "equirectangular".to_owned()),
        ("UsePanoramaViewer", "True".to_owned()),
        ("CroppedAreaImageWidthPixels", width.to_string()),
        ("CroppedAreaImageHeightPixels", height.to_string()),
        ("FullPanoWidthPixels", whole.to_string()),
        ("FullPanoHeightPixels", height.to_string()),
        ("CroppedAreaLeftPixels", ((whole - width) / 2).to_string()),
        ("CroppedAreaTopPixels", "0".to_owned()),
    ];
    let values = values.map(|(name, value)| format!(" GPano:{name}=\"{value}\"")).concat();
    Some(format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?><x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" \
         xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\"{values}/></rdf:RDF></x:xmpmeta>\
         <?xpacket end=\"w\"?>"
    ))
}

/// Adds the metadata to a PNG, a JPEG or a WebP, as this program's encoders write them.
pub(super) fn marked(file: Vec<u8>, projection: &Projection, size: (u32, u32)) -> Vec<u8> {
    let Some(xmp) = xmp(projection, size) else { return file };
    let marked = match file.get(..4) {
        Some(b"\x89PNG") => png(&file, &xmp),
        Some(b"RIFF") => webp(&file, &xmp, size),
        _ => jpeg(&file, &xmp),
    };
    marked.unwrap_or(file)
}

/// Bytes of a PNG's signature and its first chunk.
const PNG_HEAD: usize = 8 + 25;

fn png(file: &[u8], xmp: &str) -> Option<Vec<u8>> {
    let (head, rest) = file.split_at_checked(PNG_HEAD)?;
    // Uncompressed, without language and translation.
    let chunk = [b"iTXtXML:com.adobe.xmp\0\0\0\0\0", xmp.as_bytes()].concat();
    let length = (chunk.len() as u32 - 4).to_be_bytes();
    Some([head, &length, &chunk, &crc32(&chunk).to_be_bytes(), rest].concat())
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

fn jpeg(file: &[u8], xmp: &str) -> Option<Vec<u8>> {
    // The start of the image, and the segment of the JFIF header with its length.
    let ([0xff, 0xd8, 0xff, 0xe0, high, low], _) = file.split_first_chunk::<6>()? else { return None };
    let (head, rest) = file.split_at_checked(4 + usize::from(u16::from_be_bytes([*high, *low])))?;
    let content = [b"http://ns.adobe.com/xap/1.0/\0", xmp.as_bytes()].concat();
    let length = u16::try_from(content.len() + 2).ok()?.to_be_bytes();
    Some([head, &[0xff, 0xe1], &length, &content, rest].concat())
}

fn webp(file: &[u8], xmp: &str, size: (u32, u32)) -> Option<Vec<u8>> {
    let (width, height) = size;
    let picture = file.get(12..)?;
    let chunk = |name: &[u8; 4], content: &[u8]| {
        let padding = &[0][..content.len() % 2];
        [name, &(content.len() as u32).to_le_bytes()[..], content, padding].concat()
    };
    let side = |pixels: u32| {
        let [a, b, c, _] = pixels.saturating_sub(1).to_le_bytes();
        [a, b, c]
    };
    // XMP follows, and the picture may be transparent.
    let flags = [0b1_0100, 0, 0, 0];
    let features = chunk(b"VP8X", &[&flags[..], &side(width), &side(height)].concat());
    let body = [b"WEBP", &features[..], picture, &chunk(b"XMP ", xmp.as_bytes())].concat();
    Some([b"RIFF", &(body.len() as u32).to_le_bytes()[..], &body].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_pngs() {
        assert_eq!(crc32(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn only_pictures_of_spheres_are_marked() {
        let of = |kind, stereo| Projection { kind, stereo, ..Projection::default() };
        let front = xmp(&of(ProjectionKind::Vr180, Stereo::None), (100, 100)).unwrap();
        for part in ["FullPanoWidthPixels=\"200\"", "CroppedAreaLeftPixels=\"50\""] {
            assert!(front.contains(part), "{front}");
        }
        for (kind, stereo) in [
            (ProjectionKind::Flat, Stereo::None),
            (ProjectionKind::Dome, Stereo::None),
            (ProjectionKind::Sphere, Stereo::OverUnder),
        ] {
            assert_eq!(marked(vec![1, 2], &of(kind, stereo), (2, 2)), [1, 2]);
        }
    }
}
