//! Clouds are read as they were written, and damaged ones are refused.

use super::*;
use glam::{DVec3, Vec3};
use std::{collections::BTreeMap, fs, sync::mpsc, time::Duration};

pub(super) fn meta(count: u64) -> Meta {
    let options = Options {
        seed: 3,
        shard: Shard::ALONE,
        choice: Choice::Area,
        pattern: Pattern::Independent,
        shares: Vec::new(),
        normals: Normals::Shading,
        metres_per_unit: 1.0,
        light_unit: LightUnit::Radiometric,
        emission_unit: LightUnit::Radiometric,
        pose: String::new(),
        environment: "0,0,0".into(),
    };
    Meta {
        content: [1; 32],
        geometry: [2; 32],
        lights: [3; 32],
        options,
        samples_drawn: 2 * count + 1,
        samples_dropped: BTreeMap::from([("shadowed".into(), count + 1)]),
        shadow_rays: 2 * count,
        mesh_faults: BTreeMap::from([("open_edges".into(), count)]),
        surface_area_m2: 0.5,
        mean_flux_w: [1.0; 3],
        diagonal_m: 100.0,
        origin_m: [0.0, 1.0, 2.0],
        materials: vec![SampledMaterial { name: "Wax".into(), index: 0, halves: halves(count), area_m2: 0.5 }],
    }
}

/// The origin depends on the ratio of distance and size, not on metres.
#[test]
fn the_exchange_origin_depends_on_distance_over_size() {
    let about = |scale: f64, x: f64| {
        let origin_m = [0.1, x, 0.3].map(|x| scale * x);
        Meta { diagonal_m: scale, origin_m, ..meta(1) }.exchange_origin_m()
    };
    for scale in [1e-9, 1.0, 1e12] {
        // Half a step of float32 is 1e-5 of the diagonal at a distance of 167.8 diagonals; the scene extends half a
        // diagonal farther.
        assert_eq!(about(scale, 167.2), [0.0; 3]);
        assert_eq!(about(scale, -167.5)[1], (-167.5 * scale) as f32);
    }
    assert_eq!(about(1.0, 1e6), [0.1f32, 1e6, 0.3]);
}

fn halves(count: u64) -> [Group; 2] {
    let even = Group { samples: count.div_ceil(2), first_tile: 0, first_node: 0 };
    [even, Group { samples: count / 2, first_tile: even.tiles(), first_node: even.nodes() }]
}

fn content(count: u64) -> Content {
    let mut content = Content { samples: count, ..Content::default() };
    let mut next = 0;
    for half in halves(count) {
        let records: Vec<Record> = (next..next + half.samples).map(|k| Record::new(&sample(k as f32))).collect();
        content.tiles.extend(records.chunks(TILE).map(tile));
        content.nodes.extend((0..half.nodes()).map(|_| Node::default()));
        next += half.samples;
    }
    content
}

fn sample(x: f32) -> Sample {
    let position = Vec3::new(x, 2.0 * x, -x);
    Sample { position, normal: DVec3::Z, direction: DVec3::Y, flux: Vec3::splat(x) }
}

fn written(count: usize) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("test.cloud");
    let mut output = Output::create(&path).expect("creates");
    write(&mut output, &path, &content(count as u64), &meta(count as u64)).expect("writes");
    output.commit().expect("commits");
    (folder, path)
}

#[test]
fn what_is_written_is_read() {
    for count in [0, 1, 16, 37] {
        let (_folder, path) = written(count);
        let cloud = Cloud::open(&path).expect("opens");
        cloud.verify(&path).expect("is good");
        assert_eq!(cloud.meta(), &meta(count as u64));
        let read: Vec<Sample> = cloud.samples(&cloud.meta().materials[0]).collect();
        let expected: Vec<Sample> = (0..count).map(|k| sample(k as f32)).collect();
        assert_eq!(read, expected);
    }
}

/// Seen to fail: no limit, where the sum over several clouds overflows.
#[test]
fn the_number_of_samples_drawn_is_believable() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("test.cloud");
    for (samples_drawn, good) in [(4, false), (5, true), (MAX_DRAWN, true), (MAX_DRAWN + 1, false), (u64::MAX, false)] {
        let mut output = Output::create(&path).expect("creates");
        write(&mut output, &path, &content(5), &Meta { samples_drawn, ..meta(5) }).expect("writes");
        output.commit().expect("commits");
        assert_eq!(Cloud::open(&path).is_ok(), good, "{samples_drawn}");
    }
}

/// Every byte is checked, or is padding that nothing reads.
#[test]
fn every_flipped_byte_is_found_and_none_panics() {
    let (folder, path) = written(5);
    let good = fs::read(&path).expect("reads");
    let bad = folder.path().join("bad.cloud");
    let mut unseen = 0;
    for at in 0..good.len() {
        let mut bytes = good.clone();
        bytes[at] ^= 0x41;
        fs::write(&bad, &bytes).expect("writes");
        let accepted = Cloud::open(&bad).and_then(|c| c.verify(&bad)).is_ok();
        unseen += usize::from(accepted);
    }
    let (head, table) = (HEADER, 64 * SECTIONS.len());
    assert!(unseen < 4096 + 64 * SECTIONS.len(), "{unseen} of {} bytes unseen", good.len());
    assert!(good.len() - unseen > head + table);
}

/// Seen to fail: a coordinate left out; fluxes without their sign; no limit of the distance.
#[test]
fn only_samples_of_the_scene_with_flux_that_is_not_negative_are_good() {
    let good = Record::new(&sample(-2.0));
    let good = Record { flux: [0.0, 1.0, f32::MAX], ..good };
    assert!(records_are_good(&[], 4.0) && records_are_good(&[good; 3], 4.0));
    for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for c in 0..3 {
            let (mut position, mut flux) = (good, good);
            (position.position[c], flux.flux[c]) = (bad, bad);
            assert!(!records_are_good(&[good, position], 4.0) && !records_are_good(&[flux, good], 4.0), "{bad}");
        }
    }
    for c in 0..3 {
        let mut far = good;
        far.position[c] = -4.5;
        assert!(records_are_good(&[far], 4.5) && !records_are_good(&[good, far], 4.0));
    }
    assert!(!records_are_good(&[Record { flux: [0.0, -1e-40, 0.0], ..good }], 4.0));
}

#[test]
fn every_truncation_is_found() {
    let (folder, path) = written(5);
    let good = fs::read(&path).expect("reads");
    let bad = folder.path().join("bad.cloud");
    for length in (0..good.len()).step_by(7) {
        fs::write(&bad, &good[..length]).expect("writes");
        assert!(Cloud::open(&bad).is_err(), "{length}");
    }
}

/// A change in any block of a section of several blocks is found, by one thread and by several.
///
/// Seen to catch: the checksum of the first block alone; the last block left out.
#[test]
fn every_block_of_a_large_section_is_checked() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("test.cloud");
    let count = 40_000;
    let mut output = Output::create(&path).expect("creates");
    write(&mut output, &path, &content(count), &Meta { diagonal_m: 1e6, ..meta(count) }).expect("writes");
    output.commit().expect("commits");
    let good = fs::read(&path).expect("reads");
    let tile = Cloud::open(&path).expect("opens").header.section("tile").expect("is there").clone();
    assert!(tile.bytes > 4 * BLOCK as u64);
    let verified = |threads: usize| {
        Cloud::open(&path).and_then(|c| c.verify_with(NonZeroUsize::new(threads).expect("some"), &path)).is_ok()
    };
    assert!([1, 2, 3, 64].into_iter().all(verified));
    for at in (tile.offset..tile.end()).step_by(BLOCK).chain([tile.end() - 1]) {
        let mut bytes = good.clone();
        bytes[at as usize] ^= 1;
        fs::write(&path, &bytes).expect("writes");
        assert!(!verified(1) && !verified(3), "byte {at}");
    }
}

/// Writes a sparse file with these sections.
fn with_sections(path: &Path, sections: &[Section]) {
    let length = sections.iter().map(Section::end).max().unwrap_or_default().max(HEADER as u64);
    fs::write(path, layout::encode(sections, length, 0)).expect("writes");
    fs::OpenOptions::new().write(true).open(path).and_then(|f| f.set_len(length)).expect("files may have holes");
}

/// Seen to catch: facts of 64 GiB that are read to the end before they are refused; a section that occurs 60 times and
/// is checked each time.
#[test]
fn huge_facts_and_duplicate_sections_are_refused_at_once() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("test.cloud");
    let laid = |sizes: [u64; 4]| {
        let mut end = (HEADER + 64 * 5) as u64;
        let lay = |(k, (name, kind, components)): (usize, (&'static str, Kind, u16))| {
            let section = Section::after(end, name, kind, components, sizes[k]);
            end = section.end();
            section
        };
        SECTIONS.into_iter().enumerate().map(lay).collect::<Vec<Section>>()
    };
    let refused = |sections: &[Section]| {
        with_sections(&path, sections);
        Cloud::open(&path).err().expect("is refused").to_string()
    };
    for sizes in [[1 << 36, 0, 0, 0], [16, 1 << 36, 0, 0]] {
        assert!(refused(&laid(sizes)).contains("longer than"), "{sizes:?}");
    }
    let mut twice = laid([16, 16, 16, 16]);
    twice.push(twice[2].clone());
    assert!(refused(&twice).contains("`tile` occurs twice"));
}

/// Samples are picked by an index of 32 bits.
///
/// Seen to catch: no limit, where an index would be truncated and another sample picked.
#[test]
fn groups_are_no_larger_than_their_indices() {
    for (samples, good) in [(LARGEST_GROUP, true), (LARGEST_GROUP + 1, false)] {
        let mut meta = meta(0);
        let halves = &mut meta.materials[0].halves;
        halves[0].samples = samples;
        (halves[1].first_tile, halves[1].first_node) = (halves[0].tiles(), halves[0].nodes());
        meta.samples_drawn = samples;
        let counts = [0, 0, halves[0].tiles(), halves[0].nodes()];
        let section = |(k, (name, kind, components)): (usize, (&'static str, Kind, u16))| {
            Section::after(0, name, kind, components, counts[k])
        };
        let header = Header { samples, sections: SECTIONS.into_iter().enumerate().map(section).collect() };
        assert_eq!(groups_fit(&meta, &header).is_some(), good, "{samples}");
    }
}

/// Seen to catch: a file that is opened before its kind is checked, where a pipe's reader waits for a writer that never
/// comes.
#[cfg(unix)]
#[test]
fn a_pipe_is_no_cloud_and_is_not_waited_for() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    if !made.is_ok_and(|status| status.success()) {
        eprintln!("not run: there is no mkfifo");
        return;
    }
    let (tell, told) = mpsc::channel();
    std::thread::spawn(move || tell.send(Cloud::open(&path).map(|_| ()).map_err(|e| e.to_string())));
    let refused = told.recv_timeout(Duration::from_secs(10)).expect("opening waits for the pipe's writer");
    assert!(refused.expect_err("not a file").contains("not a file"));
}

/// Nodes of a tree over samples within 4 m of the origin.
///
/// Seen to catch: only the flux is checked.
#[test]
fn only_nodes_that_a_tree_can_have_are_good() {
    let good = Node {
        center: [-2.0, 4.0, 0.0],
        spread: 1.0,
        radius: 13.0,
        flux: f32::MAX,
        flux_deviation: 30.0,
        direction_deviation: 1.4,
    };
    assert!(nodes_are_good(&[], 4.0) && nodes_are_good(&[Node::default(), good], 4.0));
    let limits = [4.0, 4.0, 4.0, 16.0, 16.0, f32::MAX, f32::MAX, 2.0];
    for word in 0..8 {
        let with = |x: f32| {
            let mut node = good;
            bytemuck::cast_mut::<Node, [f32; 8]>(&mut node)[word] = x;
            nodes_are_good(&[good, node], 4.0)
        };
        let beyond = if limits[word] < f32::MAX { 1.01 * limits[word] } else { f32::INFINITY };
        assert!(![f32::NAN, f32::INFINITY, beyond].into_iter().any(with), "word {word}");
        assert!(with(limits[word]) && with(-limits[word]) == (word < 3), "word {word}");
    }
}

/// A setting is stored as the length of its name and the name.
///
/// Seen to catch: the number of the variant, as serde would write it.
#[test]
fn settings_are_stored_by_name() {
    let encoded = |meta: &Meta| bincode::serde::encode_to_vec(meta, meta_config()).expect("encodes");
    let block = encoded(&meta(1));
    for name in ["area", "independent", "shading", "radiometric"] {
        let stored = [&(name.len() as u64).to_le_bytes(), name.as_bytes()].concat();
        let at = block.windows(stored.len()).position(|bytes| bytes == stored).expect(name);
        let mut unknown = block.clone();
        unknown[at + 8] = b'?';
        let read = |block: &[u8]| bincode::serde::borrow_decode_from_slice::<Meta, _>(block, meta_config()).is_ok();
        assert!(read(&block) && !read(&unknown), "{name}");
    }
}
