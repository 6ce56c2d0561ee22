//! The file format of a cached program: a header, then the driver's binary.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `mariana` and 0 |
//! | 4 | version of this format |
//! | 16 | the key |
//! | 8 | length of the binary |
//! | 8 | checksum of the binary |
//!
//! Numbers are little-endian.

use std::hash::Hasher as _;

use crate::gpu::program_store::ProgramKey;

const MAGIC: [u8; 8] = *b"mariana\0";
const VERSION: u32 = 1;
pub(super) const HEADER: usize = 8 + 4 + 16 + 8 + 8;

pub(super) fn encode(key: ProgramKey, content: &[u8]) -> Vec<u8> {
    [&header(key, content)[..], content].concat()
}

/// Returns the binary in an entry; `None` if the entry is damaged or has another key.
pub(super) fn decode(key: ProgramKey, bytes: &[u8]) -> Option<&[u8]> {
    let (found, content) = bytes.split_at_checked(HEADER)?;
    (found == header(key, content)).then_some(content)
}

fn header(key: ProgramKey, content: &[u8]) -> Vec<u8> {
    let length = content.len() as u64;
    [&MAGIC[..], &VERSION.to_le_bytes(), key.bytes(), &length.to_le_bytes(), &checksum(content).to_le_bytes()]
        .concat()
}

fn checksum(content: &[u8]) -> u64 {
    let mut hasher = std::hash::DefaultHasher::new();
    hasher.write(content);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_intact_entries_with_the_same_key_are_decoded() {
        let key = ProgramKey::of(["driver", "text"]);
        let bytes = encode(key, b"machine code");
        assert_eq!(bytes.len(), HEADER + 12);
        assert_eq!(decode(key, &bytes), Some(&b"machine code"[..]));
        assert_eq!(decode(ProgramKey::of(["driver", "other"]), &bytes), None);
        for at in 0..bytes.len() {
            assert_eq!(decode(key, &bytes[..at]), None, "the first {at} bytes");
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert_eq!(decode(key, &damaged), None, "byte {at}");
        }
        assert_eq!(decode(key, &[&bytes[..], &[0]].concat()), None);
    }
}
