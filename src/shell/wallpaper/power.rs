//! The power source, from Linux's files in sysfs.

use std::path::Path;

pub(super) const FOLDER: &str = "/sys/class/power_supply";

/// True if a battery is discharging and no mains are connected; false if the folder cannot be read.
pub(super) fn is_from_battery(folder: &Path) -> bool {
    let Ok(supplies) = std::fs::read_dir(folder) else { return false };
    let mut discharges = false;
    for supply in supplies.flatten() {
        let read = |name: &str| std::fs::read_to_string(supply.path().join(name)).unwrap_or_default();
        match read("type").trim() {
            "Battery" => {
                // Ignores batteries of devices such as a mouse.
                discharges |= read("scope").trim() != "Device" && read("status").trim() == "Discharging";
            }
            _ if read("online").trim() == "1" => return false,
            _ => {}
        }
    }
    discharges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_discharging_battery_without_mains_counts() {
        let folder = tempfile::tempdir().unwrap();
        let tell = |supply: &str, name: &str, text: &str| {
            let place = folder.path().join(supply);
            std::fs::create_dir_all(&place).unwrap();
            std::fs::write(place.join(name), format!("{text}\n")).unwrap();
        };
        assert!(!is_from_battery(folder.path()), "the folder is empty");
        tell("hidpp", "type", "Battery");
        tell("hidpp", "scope", "Device");
        tell("hidpp", "status", "Discharging");
        assert!(!is_from_battery(folder.path()), "the battery of a mouse");
        tell("BAT0", "type", "Battery");
        tell("BAT0", "status", "Discharging");
        tell("AC", "type", "Mains");
        tell("AC", "online", "0");
        assert!(is_from_battery(folder.path()));
        tell("AC", "online", "1");
        assert!(!is_from_battery(folder.path()));
        tell("AC", "online", "0");
        tell("BAT0", "status", "Full");
        assert!(!is_from_battery(folder.path()));
        assert!(!is_from_battery(&folder.path().join("none")));
    }
}
