//! Where the system's power comes from, as Linux tells it in files.

use std::path::Path;

/// Where it tells.
pub(super) const FOLDER: &str = "/sys/class/power_supply";

/// Whether a battery is being emptied, and no mains are connected. Not where nothing is told.
pub(super) fn is_from_battery(folder: &Path) -> bool {
    let Ok(supplies) = std::fs::read_dir(folder) else { return false };
    let mut discharges = false;
    for supply in supplies.flatten() {
        let read = |name: &str| std::fs::read_to_string(supply.path().join(name)).unwrap_or_default();
        match read("type").trim() {
            "Battery" => {
                // That of a mouse is no concern of the picture.
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
    fn a_battery_counts_only_while_it_is_emptied_and_no_mains_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let tell = |supply: &str, name: &str, text: &str| {
            let place = folder.path().join(supply);
            std::fs::create_dir_all(&place).unwrap();
            std::fs::write(place.join(name), format!("{text}\n")).unwrap();
        };
        assert!(!is_from_battery(folder.path()), "nothing is told");
        tell("hidpp", "type", "Battery");
        tell("hidpp", "scope", "Device");
        tell("hidpp", "status", "Discharging");
        assert!(!is_from_battery(folder.path()), "it is a mouse");
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
