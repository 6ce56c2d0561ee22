//! Plays a file and prints its bass level: `cargo run -p mariana-player --example listen -- song.flac`.

use std::error::Error;
use std::time::Duration;

use mariana_player::playlist::Playlist;
use mariana_player::track::Repeat;
use mariana_player::{Player, PlayerOptions};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("name a file to play")?;
    let opened = Playlist::open(&[path.into()], Repeat::Off, false)?;
    let mut player = Player::start(opened.first, Box::new(opened.list), PlayerOptions::default())?;
    while !player.status().ended {
        let moment = player.now(0.0);
        let bars = "#".repeat((40.0 * moment.features.bass) as usize);
        println!("{:7.2} s  {bars}", moment.song_time);
        std::thread::sleep(Duration::from_millis(100));
    }
    Ok(())
}
