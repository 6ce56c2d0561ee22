//! Where frames are sent, as written on the command line.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Where frames are sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SenderTarget {
    /// A y4m stream into a FIFO; `None` is standard output.
    Y4m(Option<PathBuf>),
    /// A v4l2loopback device, which other programs see as a camera.
    V4l2(PathBuf),
    /// MJPEG over HTTP, on this port of the loopback interface.
    Mjpeg(u16),
}

impl FromStr for SenderTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let kinds = "write the target as y4m:FIFO, y4m:-, mjpeg:PORT or v4l2:/dev/videoN";
        let (kind, place) = text.split_once(':').ok_or(kinds)?;
        match (kind, place) {
            (_, "") => Err(format!("'{kind}:' is incomplete: {kinds}")),
            ("y4m", "-") => Ok(Self::Y4m(None)),
            ("y4m", path) => Ok(Self::Y4m(Some(path.into()))),
            ("v4l2", path) => Ok(Self::V4l2(path.into())),
            ("mjpeg", port) => match port.parse() {
                Ok(0) | Err(_) => {
                    Err(format!("'{port}' is no port: choose one from 1 to 65535, such as 8090"))
                }
                Ok(port) => Ok(Self::Mjpeg(port)),
            },
            _ => Err(format!("'{kind}' is no kind of target: {kinds}")),
        }
    }
}

impl fmt::Display for SenderTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Y4m(None) => f.write_str("standard output"),
            Self::Y4m(Some(path)) | Self::V4l2(path) => write!(f, "{}", path.display()),
            Self::Mjpeg(port) => write!(f, "http://127.0.0.1:{port}/"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_parsed_and_others_refused_with_the_valid_forms() {
        for (text, target, reported) in [
            ("y4m:-", SenderTarget::Y4m(None), "standard output"),
            ("y4m:/tmp/a:b", SenderTarget::Y4m(Some("/tmp/a:b".into())), "/tmp/a:b"),
            ("v4l2:/dev/video9", SenderTarget::V4l2("/dev/video9".into()), "/dev/video9"),
            ("mjpeg:8090", SenderTarget::Mjpeg(8090), "http://127.0.0.1:8090/"),
        ] {
            assert_eq!(text.parse(), Ok(target.clone()));
            assert_eq!(target.to_string(), reported);
        }
        for text in ["", "y4m", "y4m:", "mjpeg:", "ndi:x"] {
            assert!(text.parse::<SenderTarget>().unwrap_err().contains("y4m:FIFO"), "{text}");
        }
        for port in ["0", "65536", "-1", "web"] {
            let refused = format!("mjpeg:{port}").parse::<SenderTarget>().unwrap_err();
            assert!(refused.contains("no port"), "{refused}");
        }
    }
}
