//! The table of the settings that users choose for good.
//!
//! A new setting that is remembered, has a flag and a row in the panel takes two places: its row here, and its arm where
//! settings take effect (`session::settings`).

/// Hands the table to a macro, which makes something from its rows: the settings themselves ([`super::Choices`]), or the
/// flags of the command line.
///
/// A row is: documentation and form in the file, the name in the file, the type, the default, the variant of
/// [`super::Setting`]; in braces the name and the purpose in the panel; in brackets the flag as clap takes it, and its
/// help. The kinds of rows are those of [`super::Shown`]. Rows without braces or brackets have no row in the panel made
/// from the table, or no flag.
#[macro_export]
macro_rules! with_settings {
    ($make:ident) => {
        $make! {
            Choices {
                /// Id of the output that songs play on while it is there; none is the system's default.
                #[serde(skip_serializing_if = "Option::is_none")]
                output: Option<String> = None, Output;

                /// How much a picture may cost.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                quality: QualityChoice = QualityChoice::Auto, Quality
                    { "Quality", "What a picture may cost" }
                    [ value_name = "HOW", value_parser = choice::<QualityChoice>();
                      "How good the picture is; auto draws fewer pixels if frames take too long [default: what was chosen in the window, at first auto]" ];

                /// Whether more than three flashes a second are dimmed.
                #[serde(with = "by_name", skip_serializing_if = "is_on")]
                flash_limiter: bool = true, FlashLimiter
                    { "Limit flashes", "Dims more than three flashes a second: those can cause seizures (WCAG 2.3.1)" }
                    [ value_name = "ON-OFF", value_parser = choice::<bool>();
                      "Whether flashes are dimmed if there are more than three a second, as WCAG 2.3.1 asks for [default: what was chosen in the window, at first on]" ];

                /// How light is turned into screen colours; none is as the scene says.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                tone_map: Option<ToneMap> = None, ToneMap
                    { "Tone map", "How light becomes colours of the screen" };

                /// Whether quiet and loud sound move the picture alike.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                gain: Gain = Gain::Auto, Gain
                    { "Gain", "Auto levels quiet and loud music for the picture; what you hear stays as it is" };

                /// Whether scenes follow the song.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                follow_song: FollowChoice = FollowChoice::Songs, FollowSong
                    { "Follow the song",
                      "Scenes change with the song's sections and drops, as a director would; A does the same" };

                /// Whether the next show goes on with the tracks of the last one.
                #[serde(with = "by_name", skip_serializing_if = "is_on")]
                last_tracks: bool = true, LastTracks
                    { "Go on with tracks", "The next start goes on with these tracks where they are; off forgets them" };

                /// Whether more shows over the picture than what was asked for and what is wrong.
                #[serde(with = "by_name", skip_serializing_if = "is_on")]
                hints: bool = true, Hints
                    { "Hints", "First words, answers and the bar; without them G still opens this panel" };

                /// Whether the scene that comes next shows in a window that has no output beside it.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                next_scene: bool = false, NextScene
                    { "Next scene",
                      "A small picture of it in this window, too; beside a picture on another monitor it always shows" };
            }
            DisplayChoices {
                /// The monitor that the picture fills besides the window, by name or number; none is none.
                #[serde(skip_serializing_if = "is_default")]
                output: Option<String> = None, Screen;

                /// How much of their light pictures have, 0..100 percent.
                #[serde(deserialize_with = "percent", skip_serializing_if = "is_full")]
                brightness: u8 = 100, Brightness
                    { "Brightness",
                      "How much of its light the picture has, in the window and wherever it is sent; X is blackout" }
                    [ value_name = "PERCENT", value_parser = parse_percent, allow_negative_numbers = true;
                      "How much of its light the picture has in the window, in percent [default: what was chosen there, at first 100]" ];

                /// How long a blackout takes to come and to go, and a picture that was held to give way, in seconds.
                #[serde(deserialize_with = "fade", skip_serializing_if = "is_usual")]
                blackout_fade: f64 = FADE_SECONDS, BlackoutFade
                    { "Blackout fade",
                      "How long a blackout (X) takes to come and to go, and a picture that was held (Z) to give way" }
                    [ value_name = "SECONDS", value_parser = parse_fade, allow_negative_numbers = true;
                      "How many seconds a blackout (X) takes to come and to go, and a picture that was held (Z) to give way [default: what was chosen in the window, at first 0.5]" ];

                /// Which way pictures are mirrored.
                #[serde(with = "by_name", skip_serializing_if = "is_default")]
                flip: Flip = Flip::Off, Flip
                    { "Mirror", "Mirrors the picture, for projectors; Y moves its corners" }
                    [ value_name = "WAY", value_parser = choice::<Flip>();
                      "Mirror the picture in the window, for projectors [default: what was chosen there, at first off]" ];

                /// What their edges lose.
                #[serde(skip_serializing_if = "is_default")]
                crop: Crop = Crop::default(), Crop
                    { "Crop",
                      "How much each edge of the picture loses, where a screen hides its edges; `--crop` takes each edge for itself" }
                    [ value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = parse_crop, allow_hyphen_values = true;
                      "What the picture in the window loses at its edges, in percent; what is left fills the window, unstretched [default: what was chosen last, at first 0,0,0,0]" ];

                /// Where their corners lie.
                #[serde(skip_serializing_if = "is_default")]
                corners: Corners = Corners::default(), Corners
                    [ value_name = "X,Y,X,Y,X,Y,X,Y", value_parser = parse_corners, allow_hyphen_values = true;
                      "Where the picture's corners lie in the window, in percent to the right and down, clockwise from the upper left: for a projector that stands aslant. 'off' is the window's own corners [default: where Y has put them]" ];
            }
        }
    };
}
