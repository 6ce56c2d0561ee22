//! Text whose encoding is not stated, or is stated wrongly: old tags, playlists and lyrics. Text that is not UTF-8 is in
//! the encoding that browsers would guess (`chardetng`).

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};

/// Guesses the encoding of `bytes`. More text gives a better guess.
pub(crate) fn encoding_of(bytes: &[u8]) -> &'static Encoding {
    if let Some((marked, _)) = Encoding::for_bom(bytes) {
        return marked;
    }
    if std::str::from_utf8(bytes).is_ok() {
        return UTF_8;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(bytes, true);
    detector.guess(None, Utf8Detection::Deny)
}

/// Decodes text in the guessed encoding.
pub(crate) fn decode(bytes: &[u8]) -> String {
    encoding_of(bytes).decode(bytes).0.into_owned()
}

/// Guesses the byte order of UTF-16. Without a mark, it is the order in which fewer characters are outside the blocks of
/// common scripts. Big-endian if both orders are equal.
pub(crate) fn utf16_encoding_of(bytes: &[u8]) -> &'static Encoding {
    let is_common = |c: &char| {
        matches!(c, '\0'..='\u{7ff}' | '\u{2000}'..='\u{206f}' | '\u{3000}'..='\u{30ff}')
            || matches!(c, '\u{4e00}'..='\u{9fff}' | '\u{ac00}'..='\u{d7a3}')
    };
    let strange = |encoding: &'static Encoding| {
        let (text, _) = encoding.decode_without_bom_handling(bytes);
        text.chars().filter(|c| !is_common(c)).count()
    };
    match Encoding::for_bom(bytes) {
        Some((marked, _)) => marked,
        None if strange(UTF_16LE) < strange(UTF_16BE) => UTF_16LE,
        None => UTF_16BE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf16_without_a_mark_is_read_in_the_likely_byte_order() {
        for (text, order) in [("Größe", UTF_16LE), ("Größe", UTF_16BE), ("测试", UTF_16LE), ("", UTF_16BE)]
        {
            let to = if order == UTF_16LE { u16::to_le_bytes } else { u16::to_be_bytes };
            let bytes: Vec<u8> = text.encode_utf16().flat_map(to).collect();
            assert_eq!(utf16_encoding_of(&bytes), order, "{text}");
        }
        assert_eq!(utf16_encoding_of(b"\xff\xfe\0N"), UTF_16LE);
    }
}
