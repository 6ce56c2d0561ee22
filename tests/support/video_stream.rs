//! Reads streams of uncompressed frames (y4m).

use std::io::BufRead;

pub(crate) fn header(stream: &mut impl BufRead) -> String {
    let mut line = Vec::new();
    stream.read_until(b'\n', &mut line).unwrap();
    String::from_utf8(line).unwrap()
}

/// Reads a frame of the stream. Returns the luma of the frame's left half and right half.
pub(crate) fn light_of_next(stream: &mut impl BufRead, (width, height): (usize, usize)) -> [u8; 2] {
    assert_eq!(header(stream), "FRAME\n");
    let mut bytes = vec![0; width * height * 3 / 2];
    stream.read_exact(&mut bytes).unwrap();
    let row = &bytes[height / 2 * width..];
    [row[width / 4], row[3 * width / 4]]
}
