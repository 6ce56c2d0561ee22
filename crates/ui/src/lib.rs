//! Text and panels over the rendered frame. Panels take plain state and user input, and return shapes and commands.
//!
//! [`overlay::Overlay`] draws an [`overlay::OverlayContent`] with egui. Keys and the pointer change the panels, which
//! are plain values and return [`mariana_commands::Command`]s:
//!
//! ```
//! use mariana_commands::input::{Key, NamedKey};
//! use mariana_settings::Choices;
//! use mariana_ui::settings_panel::{Facts, SettingsPanel};
//!
//! let choices = Choices::default();
//! let mut panel = SettingsPanel::default();
//! panel.update(&Facts {
//!     choices: &choices,
//!     remembered: &choices,
//!     outputs: Vec::new(),
//!     monitors: Vec::new(),
//!     output_for_this_run: false,
//!     shift: 0.0,
//!     device: None,
//! });
//! assert!(panel.rows.iter().any(|row| row.name == "Quality"));
//! panel.handle_key(&Key::Named(NamedKey::ArrowDown));
//! assert_eq!(panel.selected, 1);
//! ```
//!
//! Panels read the time from [`clock`], so tests can simulate it.

pub mod clipboard;
pub mod clock;
pub mod controllers_panel;
pub mod corner_handles;
pub mod desk_picture;
pub mod editor;
pub mod file_browser;
pub mod help_panel;
pub mod limits;
pub mod monitor;
pub mod open_panel;
pub mod overlay;
pub mod pointer;
pub mod pointer_rest;
pub mod scene_browser;
pub mod settings_panel;
pub mod text_query;
pub mod track_panel;
pub mod user_input;
pub mod video_panel;
