//! Shows an image in the viewer tev while it is rendered. A thread of its own sends tiles; what it cannot send in time is
//! left out, so that neither a slow viewer nor a lost one slows the render or fails it.

use cli::Common;
use gather::{Crop, Tile, film::Pixel};
use std::{
    io,
    net::{TcpStream, ToSocketAddrs},
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Tiles that wait to be sent.
const WAITING: usize = 256;

/// How long the viewer has to answer, or to take what was sent.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long the finished picture may take to reach the viewer.
const FAREWELL: Duration = Duration::from_secs(1);

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A picture in a viewer.
pub struct Display {
    tiles: SyncSender<Patch>,
    /// None if no thread could be started: there is no picture then.
    sender: Option<JoinHandle<()>>,
}

/// A rectangle of the picture with red, green and blue of each of its pixels.
struct Patch {
    place: Crop,
    light: Vec<f32>,
}

impl Display {
    /// Begins a picture of this name and size in the viewer at `address`. If there is none, a line says so.
    pub fn start(address: &str, name: &str, [width, height]: [usize; 2], common: &Common) -> Display {
        let (tiles, waiting) = sync_channel(WAITING);
        let (address, name, common) = (address.to_owned(), name.to_owned(), common.clone());
        let show = move || {
            let size = [width as u32, height as u32];
            if let Err(fault) = send(&address, &name, size, &waiting) {
                common.warn(format_args!("--display: {address}: {fault}; the image is rendered without it"));
            }
        };
        Display { tiles, sender: thread::Builder::new().spawn(show).ok() }
    }

    /// Shows a tile, unless too many wait.
    pub fn show(&self, tile: &Tile) {
        if self.is_open() {
            self.tiles.try_send(Patch { place: tile.place(), light: tile.light() }).ok();
        }
    }

    /// Whether the viewer may still take tiles.
    fn is_open(&self) -> bool {
        self.sender.as_ref().is_some_and(|sender| !sender.is_finished())
    }

    /// Shows the whole picture, row by row, as far as the viewer takes it in a moment.
    pub fn finish(self, part: Crop, pixels: &[Pixel]) {
        let rows = pixels.chunks(part.width.max(1)).enumerate();
        let light = |pixel: &Pixel| pixel.beauty().to_array().map(|x| x as f32);
        let patch = |(y, row): (usize, &[Pixel])| Patch {
            place: Crop { x: 0, y, width: part.width, height: 1 },
            light: row.iter().flat_map(light).collect(),
        };
        let start = Instant::now();
        for mut row in rows.map(patch) {
            while let Err(TrySendError::Full(back)) = self.tiles.try_send(row) {
                if start.elapsed() > FAREWELL {
                    return;
                }
                thread::sleep(Duration::from_millis(1));
                row = back;
            }
        }
        drop(self.tiles);
        while self.sender.as_ref().is_some_and(|sender| !sender.is_finished()) && start.elapsed() < FAREWELL {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Sends a picture until the program has no more tiles.
fn send(address: &str, name: &str, [width, height]: [u32; 2], tiles: &Receiver<Patch>) -> io::Result<()> {
    let mut client = TevClient::wrap(connect(address)?);
    client.send(PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names: &CHANNELS })?;
    for Patch { place, light } in tiles {
        client.send(PacketUpdateImage {
            image_name: name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3; 3],
            x: place.x as u32,
            y: place.y as u32,
            width: place.width as u32,
            height: place.height as u32,
            data: &light,
        })?;
    }
    Ok(())
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut fault = io::Error::other("no such host");
    for place in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => fault = error,
        }
    }
    Err(fault)
}
