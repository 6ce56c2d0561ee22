//! Splits a packet into its messages. Nested bundles are traversed without recursion, and sizes are checked before
//! decoding.

use rosc::{OscMessage, OscPacket, OscTime};

use crate::limits;

const BUNDLE: &[u8] = b"#bundle\0";
/// The length of a bundle's header, which has a name and a time tag.
const BUNDLE_HEAD: usize = 16;

/// A message and the time tag of its bundle.
pub type Timed = (OscMessage, Option<OscTime>);

/// Returns the messages of a packet in order, and the number of rejected parts. A part is rejected if it is
/// malformed, nested too deeply, or above the maximum number. A message has the time of its innermost bundle.
pub fn messages(packet: &[u8]) -> (Vec<Timed>, u64) {
    let (mut found, mut rubbish) = (Vec::new(), 0);
    // A stack of unread parts. The last part is read next.
    let mut pieces: Vec<(&[u8], usize, Option<OscTime>)> = vec![(packet, 0, None)];
    let mut elements = 0;
    while let Some((piece, depth, time)) = pieces.pop() {
        elements += 1;
        if elements > limits::OSC_ELEMENTS_MAX {
            return (found, rubbish + 1 + pieces.len() as u64);
        }
        if !piece.starts_with(BUNDLE) {
            match message(piece) {
                Some(message) => found.push((message, time)),
                None => rubbish += 1,
            }
            continue;
        }
        let Some(mut rest) = piece.get(BUNDLE_HEAD..).filter(|_| depth < limits::OSC_DEPTH_MAX) else {
            rubbish += 1;
            continue;
        };
        let (time, first) = (time_of(piece), pieces.len());
        while !rest.is_empty() {
            let Some((element, behind)) = element(rest) else {
                rubbish += 1;
                break;
            };
            if pieces.len() < limits::OSC_ELEMENTS_MAX {
                pieces.push((element, depth + 1, time));
            } else {
                rubbish += 1;
            }
            rest = behind;
        }
        if let Some(new) = pieces.get_mut(first..) {
            new.reverse();
        }
    }
    (found, rubbish)
}

fn time_of(bundle: &[u8]) -> Option<OscTime> {
    let (seconds, behind) = bundle.get(BUNDLE.len()..)?.split_first_chunk::<4>()?;
    let (parts, _) = behind.split_first_chunk::<4>()?;
    Some(OscTime { seconds: u32::from_be_bytes(*seconds), fractional: u32::from_be_bytes(*parts) })
}

/// Returns the first element of a bundle, and the bytes after it.
fn element(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (size, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(u32::from_be_bytes(*size) as usize)
}

fn message(bytes: &[u8]) -> Option<OscMessage> {
    // Check the number of type tags before decoding: the decoder recurses into nested arrays.
    let address = bytes.iter().position(|byte| *byte == 0)?;
    let tags = bytes.get((address / 4 + 1) * 4..)?;
    let count = tags.iter().take_while(|byte| **byte != 0).count();
    if count > limits::OSC_ARGUMENTS_MAX + 1 {
        return None;
    }
    match rosc::decoder::decode_udp(bytes) {
        Ok((_, OscPacket::Message(message))) => Some(message),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rosc::{OscBundle, OscTime, OscType, encoder};

    use super::*;

    fn sent(addr: &str) -> OscPacket {
        OscPacket::Message(OscMessage { addr: addr.to_owned(), args: vec![OscType::Float(0.5)] })
    }

    fn bundle(content: Vec<OscPacket>) -> OscPacket {
        OscPacket::Bundle(OscBundle { timetag: OscTime { seconds: 0, fractional: 1 }, content })
    }

    fn addresses(packet: &OscPacket) -> (Vec<String>, u64) {
        let (found, rubbish) = messages(&encoder::encode(packet).unwrap());
        (found.into_iter().map(|(message, _)| message.addr).collect(), rubbish)
    }

    #[test]
    fn messages_keep_their_order_across_nested_bundles() {
        let packet = bundle(vec![sent("/a"), bundle(vec![sent("/b"), bundle(vec![sent("/c")])]), sent("/d")]);
        let wanted = ["/a", "/b", "/c", "/d"].map(str::to_owned).to_vec();
        assert_eq!(addresses(&packet), (wanted, 0));
        assert_eq!(addresses(&bundle(Vec::new())), (Vec::new(), 0));
    }

    #[test]
    fn a_message_has_the_time_of_its_bundle() {
        let timetag = OscTime { seconds: 7, fractional: 9 };
        let inner = OscPacket::Bundle(OscBundle { timetag, content: vec![sent("/b")] });
        let packet = encoder::encode(&bundle(vec![sent("/a"), inner, sent("/c")])).unwrap();
        let times: Vec<u32> =
            messages(&packet).0.iter().filter_map(|(_, time)| time.map(|time| time.seconds)).collect();
        assert_eq!(times, [0, 7, 0]);
        assert_eq!(
            messages(&encoder::encode(&sent("/a")).unwrap()).0.first().map(|(_, time)| *time),
            Some(None)
        );
    }

    #[test]
    fn bundles_nested_beyond_the_limit_are_rejected() {
        let nested = |depth| (0..depth).fold(sent("/a"), |inner, _| bundle(vec![inner]));
        assert_eq!(addresses(&nested(limits::OSC_DEPTH_MAX)).0.len(), 1);
        assert_eq!(addresses(&nested(limits::OSC_DEPTH_MAX + 1)), (Vec::new(), 1));
        // A packet of only headers and sizes has the deepest nesting that fits.
        let deep: Vec<u8> = (0..3_000_u32)
            .rev()
            .flat_map(|left| [BUNDLE, &[0; 8], &(left * 20).to_be_bytes()].concat())
            .collect();
        assert_eq!(messages(&deep).0, []);
    }

    #[test]
    fn more_messages_than_the_limit_are_counted_as_rubbish() {
        let count = limits::OSC_ELEMENTS_MAX;
        let (found, rubbish) = addresses(&bundle(vec![sent("/a"); count + 5]));
        assert!(found.len() < count && found.len() + rubbish as usize >= count, "{} {rubbish}", found.len());
    }

    #[test]
    fn more_arguments_than_the_limit_are_rubbish() {
        let of = |count| {
            let args = vec![OscType::Int(1); count];
            addresses(&OscPacket::Message(OscMessage { addr: "/a".to_owned(), args }))
        };
        assert_eq!(of(limits::OSC_ARGUMENTS_MAX).0.len(), 1);
        assert_eq!(of(limits::OSC_ARGUMENTS_MAX + 1), (Vec::new(), 1));
        // Such deep arrays must not be decoded: dropping them would recurse too deeply.
        for address in [&b"/a\0\0"[..], b"/,\0\0", b",\0\0\0"] {
            let tags = [address, b",", &b"[".repeat(30_000), &b"]".repeat(30_000), b"\0\0\0"].concat();
            assert_eq!(messages(&tags), (Vec::new(), 1));
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_handled_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = messages(&bytes);
        }

        /// Damaged valid packets reach more of the code than random bytes.
        #[test]
        fn damaged_packets_stay_within_the_limits(
            places in proptest::collection::vec((0_usize..200, any::<u8>()), 0..6),
            length in 0_usize..220,
        ) {
            let packet = bundle(vec![sent("/param/size"), bundle(vec![sent("/scene/orb")]), sent("/next")]);
            let mut bytes = encoder::encode(&packet).unwrap();
            for (place, value) in places {
                if let Some(byte) = bytes.get_mut(place) {
                    *byte = value;
                }
            }
            bytes.truncate(length);
            let (found, _) = messages(&bytes);
            prop_assert!(found.len() <= limits::OSC_ELEMENTS_MAX);
        }
    }
}
