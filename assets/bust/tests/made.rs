//! The generator, with a tenth of the triangles: twice the same, one disc, no triangle of the chart turned over.

use bust::mesh::{Mesh, half};
use bust::unwrap::unwrap;
use glam::DVec2;

fn turned(mesh: &Mesh, uv: &[DVec2]) -> usize {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| uv[i as usize]);
        (b - a).perp_dot(c - a)
    };
    let positive = mesh.triangles.iter().filter(|t| area(t) > 0.).count();
    positive.min(mesh.triangles.len() - positive)
}

/// As fine as the asset is made: coarser, the rim of the ear does not hold together.
const CELL_MM: f64 = 0.9;

#[test]
fn it_is_made_the_same_each_time_and_lies_flat() {
    let mesh = half(CELL_MM, 6000);
    let again = half(CELL_MM, 6000);
    assert!(mesh.positions == again.positions && mesh.triangles == again.triangles);
    let edges = (3 * mesh.triangles.len() + mesh.positions.iter().filter(|p| p.x == 0.).count()) / 2;
    println!("{} triangles, {} vertices", mesh.triangles.len(), mesh.positions.len());
    let euler = mesh.positions.len() as i64 - edges as i64 + mesh.triangles.len() as i64;
    assert_eq!(euler, 1, "a disc has 1");
    let mut uv = unwrap(&mesh).unwrap();
    assert_eq!(uv, unwrap(&again).unwrap());
    assert_eq!(turned(&mesh, &uv), 0);
    let inner = (0..uv.len()).find(|&i| mesh.positions[i].x > 20.).unwrap();
    uv[inner] = DVec2::new(2., 2.);
    assert!(turned(&mesh, &uv) > 0, "a turned triangle is seen");
}
