//! Errors that end a session. Each message names the problem, its place and a remedy.

use crate::export::ExportError;
use crate::gpu::error::GpuError;
use crate::scenes::SceneError;
use crate::sending::SendError;
use mariana_player::PlayerError;

/// An error that ends a session.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// There is no display to open a window on.
    #[error(
        "cannot open a window ({0}): start Mariana in a graphical session, or use 'mariana still' or 'mariana \
         video', which need no display"
    )]
    NoDisplay(String),
    /// The connection to the window system was lost.
    #[error(
        "the window is gone because its display ended or closed the connection: start Mariana in a running session"
    )]
    DisplayLost,
    /// The Wayland compositor lacks the protocol for wallpapers.
    #[error(
        "this Wayland compositor lacks the protocol zwlr_layer_shell_v1, which --wallpaper needs: start Mariana in \
         an X11 session, or in one of KDE Plasma, Sway, Hyprland or another compositor with that protocol"
    )]
    NoLayerShell,
    /// There is no monitor for the wallpaper.
    #[error("no monitor was found: connect a monitor")]
    NoMonitor,
    /// The system cannot start a thread.
    #[error(
        "the system cannot start another thread ({0}): close other programs, or allow more memory or processes \
         (ulimit -a)"
    )]
    NoThread(String),
    /// The window system reports an error.
    #[error("the window system refuses {doing}: {reason}")]
    Window {
        /// The operation that failed.
        doing: &'static str,
        /// The system's message.
        reason: String,
    },
    /// There is no usable OpenGL for the window.
    #[error(
        "the window cannot get an OpenGL 3.3 core context ({0}): update the graphics driver, or set \
         LIBGL_ALWAYS_SOFTWARE=1 to use Mesa's software renderer"
    )]
    NoContext(String),
    /// Standard output cannot be written.
    #[error(transparent)]
    Print(#[from] ExportError),
    /// The scene cannot be read, or has mistakes.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The frame or the panels cannot be drawn.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The song cannot continue, because it was damaged or removed.
    #[error("the song cannot continue: {0}")]
    SongLost(String),
    /// Frames cannot be sent.
    #[error(transparent)]
    Send(#[from] SendError),
    /// The song cannot be played.
    #[error(transparent)]
    Player(#[from] PlayerError),
}
