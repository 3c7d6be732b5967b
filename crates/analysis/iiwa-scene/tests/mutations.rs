//! Damaged mesh files: readers return an error, or triangles within their bounds.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_scene::{Patch, TriangleMesh};

use crate::{
    collada::{file, geometry, triangles},
    mesh::{ascii_stl, binary_stl},
};

/// Words that replace parts of a file.
const WORDS: [&[u8]; 16] = [
    b"0",
    b"-1",
    b"4294967295",
    b"18446744073709551615",
    b"1e308",
    b"nan",
    b"#n",
    b"#g",
    b"<node id='n'>",
    b"</node>",
    b"<instance_node url='#n'/>",
    b"<instance_geometry url='#g'/>",
    b"<scale>1e308 1e308 1</scale>",
    b"<!--",
    b"\"",
    b"\xff\0",
];

/// Changes a file at one to four places.
fn mutate(seed: &[u8], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..random.usize(1..5) {
        let at = random.usize(..=bytes.len());
        let end = bytes.len().min(at + random.usize(..24));
        match random.u8(..6) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..end, WORDS[random.usize(..WORDS.len())].iter().copied())),
            3 => {
                let part = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, part));
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte =
                        if random.bool() { random.u8(..) } else { *byte ^ (1 << random.u8(..8)) };
                }
            }
        }
    }
    bytes
}

/// Replaces a number of a file by another one.
fn renumber(seed: &str, random: &mut fastrand::Rng) -> Vec<u8> {
    let at = random.usize(..seed.len());
    let Some(start) = seed[at..].find(|letter: char| letter.is_ascii_digit()) else {
        return seed.as_bytes().to_vec();
    };
    let start = at + start;
    let length = seed[start..].find(|letter: char| !letter.is_ascii_digit());
    let end = length.map_or(seed.len(), |length| start + length);
    let word = ["0", "7", "-3", "99999999999", "1e300", ""][random.usize(..6)];
    [&seed[..start], word, &seed[end..]].concat().into_bytes()
}

#[test]
fn damaged_meshes_are_refused_or_bounded() {
    let square = "0 0 0 1 0 0 1 1 0 0 1 0";
    let polygons = "<polylist count='2'><input semantic='VERTEX' source='#h-v' offset='0'/>\
                    <vcount>4 3</vcount><p>0 1 2 3 0 1 2</p></polylist>\
                    <tristrips><input semantic='VERTEX' source='#h-v' offset='0'/><p>0 1 3 2</p>\
                    </tristrips>";
    let shapes =
        geometry("g", square, &triangles("g", "0 1 2 0 2 3")) + &geometry("h", square, polygons);
    let collada = file(
        "<unit meter='0.01'/>",
        &format!("<library_geometries>{shapes}</library_geometries>"),
        "<node id='n'><matrix>1 0 0 4 0 1 0 5 0 0 1 6 0 0 0 1</matrix><rotate>0 0 1 90</rotate>\
         <instance_geometry url='#g'/><node id='m'><lookat>1 0 0 0 0 0 0 0 1</lookat>\
         <instance_geometry url='#h'/></node></node><node><instance_node url='#m'/></node>",
    );
    let seeds = [
        ("a.dae", collada.as_bytes().to_vec()),
        ("a.stl", binary_stl()),
        ("b.stl", ascii_stl()),
        ("c.stl", [&binary_stl()[..], b"\r\n"].concat()),
    ];
    let mut random = fastrand::Rng::with_seed(20);
    for (name, seed) in &seeds {
        let mesh = TriangleMesh::read(name, seed, |_| None).unwrap();
        assert!(!mesh.patches.is_empty());
        let (mut read, mut refused) = (0, 0);
        for number in 0..1500 {
            let file = match str::from_utf8(seed) {
                Ok(text) if number % 3 == 0 => renumber(text, &mut random),
                _ => mutate(seed, &mut random),
            };
            let Ok(mesh) = TriangleMesh::read(name, &file, |_| None) else {
                refused += 1;
                continue;
            };
            read += 1;
            let is_whole = |patch: &Patch| {
                patch.triangles.iter().flatten().all(|it| (*it as usize) < patch.points.len())
                    && patch.points.as_flattened().iter().all(|value| value.is_finite())
            };
            assert!(mesh.patches.iter().all(is_whole), "{name}: {file:?}");
            let count: usize = mesh.patches.iter().map(|patch| patch.triangles.len()).sum();
            assert!((1..=2_000_000).contains(&count), "{name}: {count}");
        }
        // Both occur: changes reach the readers, and do not all damage the file.
        assert!(read > 20 && refused > 20, "{name}: {read} read, {refused} refused");
    }
}
