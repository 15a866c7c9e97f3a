//! Cached packings in a folder: complete ones are read again, others are computed again.

use crate::mesh_shapes::cuboid;
use bubbletouch::Result;
use bubbletouch::mesh::Surface;
use bubbletouch::study::{Packed, pack_within, packing_path};
use glam::DVec3;
use std::path::Path;

const MM: f64 = 1e-3;

fn kept(folder: &Path, surface: &Surface, tolerance: f64) -> Result<Packed> {
    pack_within("box", surface, tolerance, Some(folder))
}

#[test]
fn a_folder_gives_back_what_was_packed_and_knows_what_from() {
    let folder = tempfile::tempdir().unwrap();
    let surface = Surface::new(cuboid(DVec3::new(4.0, 3.0, 2.0) * MM));
    let pack = |tolerance| kept(folder.path(), &surface, tolerance).unwrap();
    let (first, again, finer) = (pack(0.6 * MM), pack(0.6 * MM), pack(0.4 * MM));
    let cached = [&first, &again, &finer].map(|packed| packed.cached);
    assert_eq!(cached, [false, true, false]);
    assert_eq!(first.spheres, again.spheres);
    assert_ne!(first.spheres, finer.spheres);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let path = |mesh| packing_path(folder.path(), mesh, 0.6 * MM);
    let other = cuboid(DVec3::new(4.0, 3.0, 2.1) * MM);
    assert_ne!(path(surface.mesh()), path(&other));
}

#[test]
fn a_kept_packing_that_is_damaged_in_any_way_is_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let surface = Surface::new(cuboid(DVec3::new(4.0, 3.0, 2.0) * MM));
    let pack = || kept(folder.path(), &surface, 0.6 * MM);
    let fresh = pack().unwrap().spheres;
    let path = packing_path(folder.path(), surface.mesh(), 0.6 * MM);
    let whole = std::fs::read(&path).unwrap();
    assert!(pack().unwrap().cached);
    let lines: Vec<&[u8]> = whole.split_inclusive(|&byte| byte == b'\n').collect();
    let seal = lines[lines.len() - 1];
    let flipped = |at: usize, bit: u8| {
        let mut bytes = whole.clone();
        bytes[at] ^= bit;
        bytes
    };
    let version = std::str::from_utf8(&whole).unwrap();
    let version = version.replace("packing ", "packing 9");
    let damages = [
        ("one sphere, no seal", lines[..2].concat()),
        ("one sphere, seal", [lines[0], lines[1], seal].concat()),
        ("cut in a line", whole[..whole.len() / 2].to_vec()),
        ("a changed digit", flipped(whole.len() / 2, 1)),
        ("a changed seal", flipped(whole.len() - 50, 1)),
        ("the last byte gone", whole[..whole.len() - 1].to_vec()),
        ("empty", Vec::new()),
        ("another version", version.into_bytes()),
    ];
    for (what, bytes) in damages {
        assert_ne!(bytes, whole, "{what}");
        std::fs::write(&path, bytes).unwrap();
        let again = pack().unwrap();
        assert_eq!((again.cached, &again.spheres), (false, &fresh), "{what}");
        assert_eq!(std::fs::read(&path).unwrap(), whole, "{what}");
    }
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert_eq!(pack().unwrap_err().exit_code(), 2);
}

#[test]
fn many_threads_may_pack_the_same_mesh_into_one_folder() {
    let folder = tempfile::tempdir().unwrap();
    let surface = Surface::new(cuboid(DVec3::new(2.0, 1.5, 1.0) * MM));
    let pack = || kept(folder.path(), &surface, 0.5 * MM).unwrap();
    let packings: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..16).map(|_| scope.spawn(pack)).collect();
        let packed = threads.into_iter().map(|thread| thread.join().unwrap());
        packed.map(|packed| packed.spheres).collect()
    });
    assert!(packings.windows(2).all(|pair| pair[0] == pair[1]));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
