//! The table of the settings that are stored from run to run. A new setting with a flag and a row in the panel needs
//! two edits: a row in this table, and a match arm in `session::settings`, which applies it.

/// Passes the table to a macro, which defines the settings ([`super::Choices`]) or the command-line flags.
///
/// A row has the documentation and serde attributes, the key in the file, the type (a [`super::Shown`]), the default,
/// and the variant of [`super::Setting`]. Braces contain the name, the explanation and the group
/// ([`super::SettingGroup`]) in the panel: words for listeners, without flags. Brackets contain the clap attributes and
/// the help of the flag. A setting without braces is not in the panel. A setting without brackets has no flag.
#[macro_export]
macro_rules! with_settings {
    ($make:ident) => {
        $make! {
            Choices {
                /// The id of the output for songs, used while it is available; `None` is the system's default.
                output: Option<String> = None, Output;

                /// The rendering quality.
                #[serde(with = "by_name")]
                quality: QualityChoice = QualityChoice::Auto, Quality
                    { "Quality", "Resolution and effects of the image", Picture }
                    [ value_name = "HOW", value_parser = choice::<QualityChoice>();
                      "Quality of the image; auto lowers the resolution when frames take too long [default: the setting in the window, initially auto]" ];

                /// True to dim flashes if there are more than three a second.
                #[serde(with = "by_name")]
                flash_limiter: bool = true, FlashLimiter
                    { "Limit flashes", "Dims the image if it flashes more than three times a second, because that can cause seizures (WCAG 2.3.1)", Picture }
                    [ value_name = "ON-OFF", value_parser = choice::<bool>();
                      "Dim more than three flashes a second, as WCAG 2.3.1 requires [default: the setting in the window, initially on]" ];

                /// The tone map from light to screen colours; `None` uses the scene's.
                #[serde(with = "by_name")]
                tone_map: Option<ToneMap> = None, ToneMap
                    { "Colours", "How light becomes colours on the screen", Picture };

                /// The gain control, which makes quiet sound move the image as much as loud sound.
                #[serde(with = "by_name")]
                gain: Gain = Gain::Auto, Gain
                    { "Lift quiet music", "Quiet music moves the image as much as loud music does; the sound does not change", Sound };

                /// The sources for which scenes change automatically.
                #[serde(with = "by_name")]
                follow_song: FollowChoice = FollowChoice::Songs, FollowSong
                    { "Follow the song",
                      "Changes scenes at the song's sections and drops; key A does the same", Scenes };

                /// True to resume the last track list at the next start.
                #[serde(with = "by_name")]
                last_tracks: bool = true, LastTracks
                    { "Resume tracks", "The next start resumes these tracks where they stop; off forgets them", Window };

                /// True to show hints over the image. Errors and requested panels always appear.
                #[serde(with = "by_name")]
                hints: bool = true, Hints
                    { "Hints", "Title, messages and the bar; without them, key G still opens this panel", Window };

                /// True to keep the screen from locking and going dark while the image moves.
                #[serde(with = "by_name")]
                stay_awake: bool = true, StayAwake
                    { "Keep the screen on", "The screen neither locks nor goes dark while the image moves", Window };

                /// True to show a preview of the next scene even without a second monitor.
                #[serde(with = "by_name")]
                next_scene: bool = false, NextScene
                    { "Next scene",
                      "A small preview in this window; always shown while another monitor has the image", Advanced };
            }
            DisplayChoices {
                /// The monitor for the clean image, by name or number; `None` uses none.
                output: Option<String> = None, Screen;

                /// The brightness of the image, 0..100 percent.
                #[serde(deserialize_with = "percent")]
                brightness: u8 = 100, Brightness
                    { "Brightness",
                      "Brightness of the image, in the window and wherever it is sent; key X fades to black", Picture }
                    [ value_name = "PERCENT", value_parser = parse_percent, allow_negative_numbers = true;
                      "Brightness of the image in the window, in percent [default: the value in the settings, initially 100]" ];

                /// The duration of a blackout fade, and of the return from a frozen image, in seconds.
                #[serde(deserialize_with = "fade")]
                blackout_fade: f64 = FADE_SECONDS, BlackoutFade
                    { "Blackout fade",
                      "Duration of a blackout fade (key X), and of the return from a frozen image (key Z)", Advanced }
                    [ value_name = "SECONDS", value_parser = parse_fade, allow_negative_numbers = true;
                      "Duration of a blackout fade (key X), and of the return from a frozen image (key Z), in seconds [default: the setting in the window, initially 0.5]" ];

                /// The direction in which the image is mirrored.
                #[serde(with = "by_name")]
                flip: Flip = Flip::Off, Flip
                    { "Mirror", "Mirrors the image, for projectors; key Y moves the corners", Advanced }
                    [ value_name = "WAY", value_parser = choice::<Flip>();
                      "Mirror the image in the window, for projectors [default: the value in the settings, initially off]" ];

                /// The crop of each edge.
                crop: Crop = Crop::default(), Crop
                    { "Crop",
                      "Cuts the edges of the image, for screens that hide the outermost pixels", Advanced }
                    [ value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = parse_crop, allow_hyphen_values = true;
                      "Crop of each edge of the image in the window, in percent; the rest fills the window, unstretched [default: the last setting, initially 0,0,0,0]" ];

                /// The positions of the corners on the screen.
                corners: Corners = Corners::default(), Corners
                    [ value_name = "X,Y,X,Y,X,Y,X,Y", value_parser = parse_corners, allow_hyphen_values = true;
                      "Positions of the image's corners in the window, in percent to the right and down, clockwise from the upper left, for a projector at an angle. 'off' uses the window's corners [default: the corners set with key Y]" ];
            }
        }
    };
}
