//! The digests of a scene's lights and geometry, by which clouds recognize it.

use scene::{ImportOptions, LightUnit, Scene};
use std::path::Path;

fn imported(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../data/scenes/{name}.glb"));
    let options = ImportOptions {
        metres_per_unit: 1.0,
        light_unit: Some(LightUnit::Radiometric),
        emission_unit: Some(LightUnit::Radiometric),
        pose: None,
    };
    Scene::import(&path, &options).expect("the scene can be read")
}

/// A cloud is kept as long as these do not change: other bytes, or the same in another order, would make all clouds
/// stale.
///
/// Seen to catch: the range of a point light left out.
#[test]
fn digests_of_the_repository_scenes_stay() {
    let hex = |digest: [u8; 32]| digest[..8].iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    for (name, lights, geometry) in DIGESTS {
        let scene = imported(name);
        assert_eq!([hex(scene.light_digest()), hex(scene.geometry_digest())], [lights, geometry], "{name}");
    }
}

/// Scene, the first eight bytes of the digest of its lights, and of its geometry.
const DIGESTS: [(&str, &str, &str); 9] = [
    ("candle", "dfc134677d8c92f8", "711d58caa6182e3b"),
    ("chess", "f88958fd45f6f7cd", "306cb821c9b01bbf"),
    ("figure", "bf2079371da6e054", "e7f99464c4f77b78"),
    ("gummies", "f8c8854d9fd56ad8", "4de46df2fbbb0048"),
    ("milk", "af1349b9f5f9a1a6", "caece33d3dbf212b"),
    ("piglet", "90a8d610ceb61ff9", "837c1c0edb67d31c"),
    ("slab", "2d83d37ffa425191", "ee84efeff22e0f8c"),
    ("slivers", "6011b79d3e99f86a", "01eb42ba33b14f8c"),
    ("sphere", "bcef3c0dbf3a83e3", "a196d464a3fc7760"),
];
