//! The headings of the flags in the help, and the flags of the short help.

use clap::Arg;

/// The headings with the long names of their flags. Other flags, and flags with a letter, stand under "Options".
const HEADINGS: [(&str, &str); 6] = [
    ("Sound", "mic system device silent volume latency gain shuffle repeat once"),
    ("Scenes", "scene show set fade into blend"),
    (
        "Image",
        "size quality flash-limiter fps-cap tone-map view projection stereo eye-distance dome-tilt shutter \
         shutter-frames light samples noise no-filter",
    ),
    (
        "Window and stage",
        "fullscreen new new-window clean output wallpaper brightness blackout-fade flip crop corners",
    ),
    ("Controllers and other programs", "remote osc osc-send osc-rate midi send send-size send-fps"),
    ("Drivers and development", "sdf regions prepare-ahead program-cache shaders gl-info"),
];

/// The flags of a show that `mariana -h` lists.
const FIRST: &str = "mic system volume shuffle once scene show size fullscreen new output remote";

fn has(flags: &str, name: &str) -> bool {
    flags.split(' ').any(|flag| flag == name)
}

/// Puts a flag under its heading.
pub(super) fn under_heading(flag: Arg) -> Arg {
    let Some(name) = flag.get_long().filter(|_| flag.get_short().is_none()) else { return flag };
    match HEADINGS.iter().find(|(_, flags)| has(flags, name)) {
        Some((heading, _)) => flag.help_heading(*heading),
        None => flag,
    }
}

/// Puts a flag of a show under its heading, and hides it in the short help unless it is among the first.
pub(super) fn of_show(flag: Arg) -> Arg {
    let is_first = flag.get_long().is_none_or(|name| has(FIRST, name));
    under_heading(flag).hide_short_help(!is_first)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Arguments;

    #[test]
    fn every_flag_of_a_show_has_a_heading() {
        let command = Arguments::command();
        let flags = || command.get_arguments().filter(|flag| flag.get_long().is_some());
        let bare = flags().filter(|flag| flag.get_help_heading().is_none() && flag.get_short().is_none());
        assert_eq!(bare.map(|flag| flag.get_id().as_str()).collect::<Vec<_>>(), [""; 0]);
        let known = |name: &str| {
            let takes =
                |flags: &clap::Command| flags.get_arguments().any(|flag| flag.get_long() == Some(name));
            takes(&command) || command.get_subcommands().any(takes)
        };
        let listed = HEADINGS.iter().flat_map(|(_, flags)| flags.split(' ')).chain(FIRST.split(' '));
        assert_eq!(listed.filter(|name| !known(name)).collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn the_short_help_had_178_lines_under_one_heading() {
        let short = Arguments::command().render_help().to_string();
        assert!(short.lines().count() <= 70, "{} lines:\n{short}", short.lines().count());
        assert!(short.contains("--help") && short.contains("--scene") && !short.contains("--osc-rate"));
        let long = Arguments::command().render_long_help().to_string();
        for (heading, flags) in HEADINGS {
            let section = long.split(&format!("\n{heading}:\n")).nth(1);
            let section = section.unwrap_or_else(|| panic!("no {heading} in {long}"));
            assert!(
                flags.split(' ').any(|flag| section.contains(&format!("--{flag}"))),
                "{heading}: {section}"
            );
        }
    }
}
