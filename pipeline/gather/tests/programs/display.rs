//! `--display`: a viewer sees the image while it is rendered, and neither a slow one nor a missing one matters.

use std::{
    io::Read,
    net::{TcpListener, TcpStream},
    thread,
    time::{Duration, Instant},
};
use test_support::{Bench, data};

/// The sphere at 40 x 30 pixels, of which tiles at the edges are parts.
fn render(bench: &Bench, output: &str, more: &[&str]) -> String {
    let (scene, view) = (data("scenes/sphere.glb"), data("views/sphere/front.json"));
    let own = ["sphere.cloud", &scene, "--view", &view, "--medium", "marble", "--width", "40", "--height", "30"];
    bench.says("gather", &[&own[..], &["--spp", "4", "--progress", "none", "-o", output], more].concat())
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.succeed("sample-surface", &[&data("scenes/sphere.glb"), "-n", "5k", "-o", "sphere.cloud", "--quiet"]);
    bench
}

/// The numbers and words of a packet of tev's protocol, little-endian; words end with a zero.
struct Packet(Vec<u8>);

impl Packet {
    /// The next packet, unless the stream has ended.
    fn read(stream: &mut TcpStream) -> Option<Packet> {
        let mut length = [0; 4];
        stream.read_exact(&mut length).ok()?;
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut bytes).expect("a whole packet");
        Some(Packet(bytes))
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let taken: Vec<u8> = self.0.drain(..N).collect();
        taken.try_into().expect("N bytes")
    }

    fn word(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).expect("a zero");
        let bytes: Vec<u8> = self.0.drain(..=end).take(end).collect();
        String::from_utf8(bytes).expect("text")
    }

    fn number(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }

    fn float(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }
}

/// A viewer with one picture.
#[derive(Default)]
struct Viewer {
    name: String,
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
    updates: usize,
}

impl Viewer {
    /// Takes packets until the program closes the connection.
    fn watch(mut stream: TcpStream) -> Viewer {
        let mut viewer = Viewer::default();
        while let Some(mut packet) = Packet::read(&mut stream) {
            let [kind, _focus] = packet.take();
            let name = packet.word();
            match kind {
                4 => {
                    viewer.name = name;
                    viewer.size = [packet.number(), packet.number()];
                    viewer.pixels = vec![[f32::NAN; 3]; viewer.size[0] * viewer.size[1]];
                    assert_eq!(packet.number(), 3);
                }
                6 => viewer.update(&name, &mut packet),
                other => panic!("a packet of kind {other}"),
            }
        }
        viewer
    }

    fn update(&mut self, name: &str, packet: &mut Packet) {
        assert_eq!((name, packet.number()), (self.name.as_str(), 3));
        assert_eq!([packet.word(), packet.word(), packet.word()], ["R", "G", "B"]);
        let [x, y, width, height] = [0; 4].map(|_| packet.number());
        packet.take::<48>();
        for row in y..y + height {
            for column in x..x + width {
                self.pixels[row * self.size[0] + column] = [0; 3].map(|_| packet.float());
            }
        }
        assert!(packet.0.is_empty());
        self.updates += 1;
    }
}

/// Seen to catch: rows and columns of a tile exchanged, tiles of the last step alone, a picture that ends before the last
/// tile.
#[test]
fn a_viewer_sees_the_image() {
    let bench = bench();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    let viewer = thread::spawn(move || Viewer::watch(listener.accept().expect("the program connects").0));
    let said = render(&bench, "seen.exr", &["--display", &address]);
    assert!(!said.contains("--display"), "{said}");
    let viewer = viewer.join().expect("a viewer");
    assert_eq!((viewer.name.as_str(), viewer.size), ("seen.exr", [40, 30]));
    let image = bench.image("seen.exr");
    let [r, g, b] = ["R", "G", "B"].map(|name| image.channel(name).expect("a channel"));
    assert!(viewer.pixels.iter().enumerate().all(|(k, pixel)| *pixel == [r[k], g[k], b[k]]));
    // Two steps of twenty tiles, of which the first may come before there is a connection, and thirty rows.
    assert!(viewer.updates >= 30, "{} updates", viewer.updates);
    render(&bench, "alone.exr", &[]);
    assert!(bench.read("seen.exr") == bench.read("alone.exr"));
}

/// Seen to catch: a queue without bound that is waited for.
#[test]
fn a_viewer_that_reads_nothing_or_is_not_there_stops_nothing() {
    let bench = bench();
    render(&bench, "alone.exr", &[]);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    let start = Instant::now();
    render(&bench, "deaf.exr", &["--display", &address]);
    assert!(start.elapsed() < Duration::from_secs(30));
    drop(listener);
    let said = render(&bench, "gone.exr", &["--display", &address]);
    let lines: Vec<&str> = said.lines().filter(|line| line.contains("--display")).collect();
    assert!(lines.len() == 1 && lines[0].contains("rendered without it"), "{said}");
    for name in ["deaf.exr", "gone.exr"] {
        assert!(bench.read(name) == bench.read("alone.exr"), "{name}");
    }
    for address in ["viewer", "viewer:", ":14158", "viewer:99999"] {
        let scene = data("scenes/sphere.glb");
        bench.refuses("gather", &["sphere.cloud", &scene, "-o", "no.exr", "--display", address], &["HOST:PORT"]);
    }
}
