//! Unwrappings: what is refused, and where a cut leads.
use glam::{DVec2, Vec2, Vec2Swizzles};
use pdss::scene::{Atlas, Scene, gutter};

use crate::check::built;

fn scattering(name: &str) -> Scene {
    let (mut scene, _) = built(name);
    scene.assign_profile(None, 0).expect("a material");
    scene
}

#[test]
fn what_has_no_place_of_its_own_is_refused() {
    let why = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scattering("torus:10,4");
        change(&mut scene);
        let refused = Atlas::new(&scene, 0).err().unwrap_or_default();
        println!("{refused}");
        assert!(!refused.contains('\n'));
        refused
    };
    assert_eq!(why(&|_| {}), "", "the twin: good coordinates pass");
    assert!(why(&|s| s.uvs.clear()).contains("no texture coordinates"));
    assert!(why(&|s| s.uvs.iter_mut().for_each(|t| t[0] *= 2.)).contains("outside of 0..1"));
    // Both halves on the same place, as mirrored unwrappings have it.
    assert!(why(&|s| s.uvs.iter_mut().for_each(|t| t[0] = (2. * t[0] - 1.).abs())).contains("covered twice"));
    assert!(why(&|s| s.uvs.iter_mut().for_each(|t| *t = [0.5; 2])).contains("cover no area"));
}

#[test]
fn charts_and_cuts_of_the_shapes() {
    for (name, charts, side) in [("sphere:10", 6, 0.), ("torus:10,4", 1, 0.), ("plane", 1, 0.)] {
        let atlas = Atlas::new(&scattering(name), 0).expect("good coordinates");
        println!("{name}: {} charts, {} sides of cuts, {:.2} mm", atlas.count, atlas.seams.len(), atlas.side_mm);
        assert_eq!(atlas.count, charts, "{name}");
        assert!(atlas.side_mm > side);
        assert_eq!(atlas.seams.is_empty(), name == "plane", "{name}: only a plane has no other side");
    }
}

/// Each texel beside a cut shows the place on the surface that lies as far beyond it.
#[test]
fn a_cut_leads_to_the_surface_beyond_it() {
    let scene = scattering("torus:10,4");
    let atlas = Atlas::new(&scene, 0).expect("good coordinates");
    let (side, border) = (512u32, atlas.border(4.));
    let filled = gutter(&atlas, side, border, 4. / atlas.side_mm);
    let scale = f64::from(side) * (1. - 2. * border);
    let place = |t: DVec2| (t - f64::from(side) * border) / scale;
    // The torus goes round: a coordinate left of 0 is the one as far left of 1.
    let round = |p: DVec2| (p - p.floor()).as_vec2();
    let mut worst = 0f32;
    let (mut beyond, mut swapped) = (0, 0f32);
    for [xy, u, v, _] in &filled {
        let here = place(DVec2::new(f64::from(xy & 0xffff) + 0.5, f64::from(xy >> 16) + 0.5));
        let shows = place(DVec2::new(f32::from_bits(*u).into(), f32::from_bits(*v).into()));
        let outside = here.x.min(here.y) < 0. || here.x.max(here.y) > 1.;
        // Past a corner of the square two cuts meet, and either may lead on.
        let corner = (here.x < 0. || here.x > 1.) && (here.y < 0. || here.y > 1.);
        if outside && !corner {
            beyond += 1;
            let apart = |a: Vec2, b: Vec2| (a - b).abs().max_element();
            worst = worst.max(apart(round(here), shows.as_vec2()));
            swapped = swapped.max(apart(round(here), shows.as_vec2().yx()));
        }
    }
    println!(
        "{} texels, {beyond} beyond the square, at most {worst:.1e} off; with u and v exchanged {swapped:.2}",
        filled.len()
    );
    // Three texels: what is as far beyond in mm is not quite as far in coordinates where they are stretched.
    assert!(beyond > 1000 && worst < 3. / side as f32, "{worst}");
    assert!(swapped > 0.1, "the twin is caught");
}
