//! A cloud that was written is read, and what was damaged is not.

use super::*;
use std::{collections::BTreeMap, fs};

fn meta(count: u64) -> Meta {
    let options = Options {
        seed: 3,
        shard: Shard::ALONE,
        choice: "area".into(),
        pattern: "independent".into(),
        shares: Vec::new(),
        normals: "shading".into(),
        metres_per_unit: 1.0,
        light_unit: "radiometric".into(),
        emission_unit: "radiometric".into(),
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

/// Seen to catch: a limit in metres; the rounding of the centre without half of the object.
#[test]
fn what_positions_for_others_are_relative_to() {
    let about = |scale: f64, x: f64| {
        let origin_m = [0.1, x, 0.3].map(|x| scale * x);
        Meta { diagonal_m: scale, origin_m, ..meta(1) }.exchange_origin_m()
    };
    for scale in [1e-9, 1.0, 1e12] {
        // Half a step of float32 is 1e-5 of the diagonal at 167.8 diagonals; the scene reaches half of one farther.
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

/// Seen to fail: no limit, which several clouds together overflow.
#[test]
fn the_number_of_samples_drawn_is_believable() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("test.cloud");
    for (samples_drawn, good) in [(4, false), (5, true), (MOST_DRAWN, true), (MOST_DRAWN + 1, false), (u64::MAX, false)]
    {
        let mut output = Output::create(&path).expect("creates");
        write(&mut output, &path, &content(5), &Meta { samples_drawn, ..meta(5) }).expect("writes");
        output.commit().expect("commits");
        assert_eq!(Cloud::open(&path).is_ok(), good, "{samples_drawn}");
    }
}

/// Every byte belongs to something that is checked, or is padding that nothing reads.
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

/// Seen to fail: a coordinate left out; fluxes without their sign; places however far away.
#[test]
fn only_samples_of_the_scene_with_flux_that_is_not_negative_are_good() {
    let good = Record::new(&sample(-2.0));
    let good = Record { flux: [0.0, 1.0, f32::MAX], ..good };
    assert!(records_are_good(&[], 4.0) && records_are_good(&[good; 3], 4.0));
    for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for c in 0..3 {
            let (mut place, mut flux) = (good, good);
            (place.position[c], flux.flux[c]) = (bad, bad);
            assert!(!records_are_good(&[good, place], 4.0) && !records_are_good(&[flux, good], 4.0), "{bad}");
        }
    }
    for c in 0..3 {
        let mut place = good;
        place.position[c] = -4.5;
        assert!(records_are_good(&[place], 4.5) && !records_are_good(&[good, place], 4.0));
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
