//! A show without a window: scenes are prepared and composed into pictures here. It knows no window system and reads
//! no keys; whoever drives it hands in an OpenGL context, the moment of the song, and what users ask for.

pub(crate) mod scene;
