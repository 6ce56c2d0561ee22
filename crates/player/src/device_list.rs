//! The list of connected devices. A separate thread polls it several times a second, because cpal does not pass on the
//! changes that the sound servers announce. A poll makes four queries to the server.

use std::sync::{Arc, Mutex, Weak};
use std::time::Duration;

use cpal::traits::{DeviceTrait, HostTrait};

use super::devices::{self, hosts_by_preference, hush_sound_library, is_watched, monitored_output};
use super::error::Direction;
use mariana_work::{Latest, Shared, lock, looping};

const LOOK_PERIOD: Duration = Duration::from_millis(250);

/// Maximum wait for the end of the thread, because a poll of a hanging server never returns.
const END_LIMIT: Duration = Duration::from_millis(100);

/// A device in one direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedDevice {
    /// The identifier, which stays the same across restarts.
    pub id: String,
    /// The display name.
    pub name: String,
}

impl ListedDevice {
    pub(crate) fn of(device: &cpal::Device) -> Self {
        let id = device.id().map(|id| id.to_string()).unwrap_or_default();
        let name = device.description().map_or_else(|_| id.clone(), |about| about.name().to_owned());
        Self { id, name }
    }

    /// The entry of an input that records this output.
    fn monitor(&self) -> Self {
        Self { id: devices::monitor_id(&self.id), name: format!("Monitor of {}", self.name) }
    }

    /// True for an input that records an output.
    pub fn is_monitor(&self) -> bool {
        monitored_output(&self.id).is_some()
    }
}

/// A device and its entry in the list of one direction.
pub(crate) struct FoundDevice {
    pub(crate) entry: ListedDevice,
    pub(crate) device: cpal::Device,
}

impl FoundDevice {
    /// Returns the entry of `device` in this direction, if the device supports it. Where outputs can be recorded, an
    /// output that is no input too is listed for recording as its monitor.
    pub(crate) fn of(direction: Direction, device: cpal::Device) -> Option<Self> {
        let (output, input) = (device.supports_output(), device.supports_input());
        let is_monitor = listed_as_monitor(direction, output, input, devices::OUTPUTS_CAN_BE_RECORDED)?;
        let own = ListedDevice::of(&device);
        Some(Self { entry: if is_monitor { own.monitor() } else { own }, device })
    }
}

/// Returns whether a device that supports output and input is listed as a monitor; `None` if it is not listed.
fn listed_as_monitor(
    direction: Direction,
    output: bool,
    input: bool,
    outputs_can_be_recorded: bool,
) -> Option<bool> {
    match direction {
        Direction::Output => output.then_some(false),
        Direction::Input if input => Some(false),
        Direction::Input => (output && outputs_can_be_recorded).then_some(true),
    }
}

/// The devices of the sound server, or of the system if there is no server.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DeviceList {
    /// True if the sound system answered. Without an answer the lists are empty, but devices may exist.
    pub known: bool,
    /// The devices for playback.
    pub outputs: Vec<ListedDevice>,
    /// The devices for recording, including monitors.
    pub inputs: Vec<ListedDevice>,
    /// Id of the default output.
    pub default_output: Option<String>,
    /// Id of the default input.
    pub default_input: Option<String>,
}

impl DeviceList {
    /// Returns the input with this id.
    pub fn input(&self, id: &str) -> Option<&ListedDevice> {
        self.inputs.iter().find(|entry| entry.id == id)
    }

    /// The input that records the default output.
    pub fn default_monitor(&self) -> Option<&ListedDevice> {
        self.input(&devices::monitor_id(self.default_output.as_deref()?))
    }

    /// Queries the sound system. This may block as long as the sound system does.
    fn query() -> Self {
        hush_sound_library();
        let watched = hosts_by_preference().into_iter().find(|id| is_watched(*id));
        let Some(host) = watched.and_then(|id| devices::host(id).ok()) else { return Self::default() };
        let id_of = |device: Option<cpal::Device>| {
            device.and_then(|device| device.id().ok()).map(|id| id.to_string())
        };
        let (default_output, default_input) =
            (id_of(host.default_output_device()), id_of(host.default_input_device()));
        let Ok(devices) = host.devices() else { return Self::default() };
        let mut device_list = Self { known: true, default_output, default_input, ..Self::default() };
        for device in devices {
            let entry = |direction| FoundDevice::of(direction, device.clone()).map(|found| found.entry);
            device_list.outputs.extend(entry(Direction::Output));
            device_list.inputs.extend(entry(Direction::Input));
        }
        device_list
    }
}

#[derive(Default)]
struct Polled {
    /// The device list, and a number that grows with each of its changes; 0 before the first poll.
    latest: (u64, Arc<DeviceList>),
    looks: u64,
}

impl Polled {
    fn publish(&mut self, device_list: DeviceList) {
        if self.latest.0 == 0 || *self.latest.1 != device_list {
            self.latest = (self.latest.0 + 1, Arc::new(device_list));
        }
        self.looks += 1;
    }
}

/// The polling thread. The program has one polling thread, which runs as long as a reference to it exists.
pub struct DeviceWatch(Latest<Polled>);

static WATCH: Mutex<Weak<DeviceWatch>> = Mutex::new(Weak::new());

impl DeviceWatch {
    /// Returns the program's device watch. The first call starts it.
    ///
    /// # Errors
    /// Fails if the thread cannot be started.
    pub fn shared() -> std::io::Result<Arc<Self>> {
        let mut slot = lock(&WATCH);
        if let Some(watch) = slot.upgrade() {
            return Ok(watch);
        }
        let poll = |shared: &Shared<Polled>| {
            while !shared.is_over() {
                let device_list = DeviceList::query();
                shared.lock().publish(device_list);
                shared.rest(LOOK_PERIOD);
            }
        };
        let thread = looping("device watch", Polled::default(), poll)?;
        let watch = Arc::new(Self(thread.finished_at_drop(END_LIMIT)));
        *slot = Arc::downgrade(&watch);
        Ok(watch)
    }

    /// The number of finished polls. A change appears in the list after at most two more polls.
    pub fn looks(&self) -> u64 {
        self.0.lock().looks
    }

    /// Returns the latest list and its generation. If the generation differs from before, the list has changed.
    pub fn latest(&self) -> (u64, Arc<DeviceList>) {
        self.0.lock().latest.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(id: &str) -> ListedDevice {
        ListedDevice { id: id.into(), name: id.to_uppercase() }
    }

    #[test]
    fn the_monitor_of_the_default_output_is_found() {
        let mut device_list = DeviceList {
            known: true,
            outputs: vec![entry("p:a"), entry("p:b")],
            inputs: vec![entry("p:a.monitor"), entry("p:mic"), entry("p:b.monitor")],
            default_output: Some("p:b".into()),
            default_input: Some("p:mic".into()),
        };
        assert_eq!(device_list.default_monitor().map(|entry| &*entry.name), Some("P:B.MONITOR"));
        let monitors: Vec<bool> = device_list.inputs.iter().map(ListedDevice::is_monitor).collect();
        assert_eq!(monitors, [true, false, true]);
        device_list.default_output = None;
        assert_eq!(device_list.default_monitor(), None);
    }

    #[test]
    fn an_output_is_listed_as_a_monitor_only_where_outputs_can_be_recorded() {
        let (output, input, both) = ((true, false), (false, true), (true, true));
        for recordable in [false, true] {
            let listed = |direction, (output, input)| listed_as_monitor(direction, output, input, recordable);
            assert_eq!(listed(Direction::Input, output), recordable.then_some(true));
            assert_eq!(listed(Direction::Output, output), Some(false));
            assert_eq!(
                (listed(Direction::Input, input), listed(Direction::Output, input)),
                (Some(false), None)
            );
            assert_eq!(
                (listed(Direction::Input, both), listed(Direction::Output, both)),
                (Some(false), Some(false))
            );
        }
        assert_eq!(entry("p:a").monitor().name, "Monitor of P:A");
        assert!(entry("p:a").monitor().is_monitor());
    }

    #[test]
    fn only_changes_count() {
        let mut polled = Polled::default();
        polled.publish(DeviceList::default());
        polled.publish(DeviceList::default());
        assert_eq!(polled.latest.0, 1);
        polled.publish(DeviceList { known: true, ..DeviceList::default() });
        assert_eq!((polled.latest.0, polled.looks), (2, 3));
    }

    #[test]
    fn all_callers_get_the_same_watch() {
        let first = DeviceWatch::shared().expect("a thread");
        let second = DeviceWatch::shared().expect("a thread");
        assert!(Arc::ptr_eq(&first, &second));
    }
}
