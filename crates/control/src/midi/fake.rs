//! Fake ports for tests and measurements on machines without a MIDI system. Their names say that they are fake.

#![cfg(unix)]

use std::any::Any;
use std::io;
use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::time::Duration;

use mariana_work::{Shared, looping};

use super::ports::{Hear, Ports};

const SAYS_SO: &str = " (fake port)";
const ENDING: &str = "port";
/// The interval at which a port's thread checks if the port has been dropped.
const LOOK: Duration = Duration::from_millis(100);

/// A folder of fake devices: each file `NAME.port` is a connected device. While the device is open, its bytes arrive
/// as datagrams on the socket `NAME.socket` in the same folder. The socket's file stays when the device is closed.
pub struct FolderPorts(pub PathBuf);

impl Ports for FolderPorts {
    fn names(&mut self) -> Result<Vec<String>, String> {
        let entries = std::fs::read_dir(&self.0).map_err(|error| error.to_string())?;
        let mut names: Vec<String> = entries
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|ending| ending == ENDING))
            .filter_map(|path| Some(format!("{}{SAYS_SO}", path.file_stem()?.to_str()?)))
            .collect();
        names.sort();
        Ok(names)
    }

    fn open(&mut self, name: &str, mut hear: Hear) -> Result<Box<dyn Any>, String> {
        let name = name.strip_suffix(SAYS_SO).unwrap_or(name);
        let path = self.0.join(format!("{name}.socket"));
        let open = |path: &Path| -> io::Result<UnixDatagram> {
            // The file of an earlier socket stays.
            if path.exists() {
                std::fs::remove_file(path)?;
            }
            let socket = UnixDatagram::bind(path)?;
            socket.set_read_timeout(Some(LOOK))?;
            Ok(socket)
        };
        let socket = open(&path).map_err(|error| error.to_string())?;
        let receive = move |shared: &Shared<()>| {
            let mut bytes = vec![0; 65_536];
            while !shared.is_over() {
                if let Ok(length) = socket.recv(&mut bytes) {
                    hear(bytes.get(..length).unwrap_or_default());
                }
            }
        };
        let thread = looping("fake MIDI", (), receive).map_err(|error| error.to_string())?;
        Ok(Box::new(thread))
    }
}
