//! Where a surface scatters and how thick it is, as a file says: masks, thickness, light from behind, and textures on two sets
//! of coordinates.
mod studio;

use glam::Vec3;
use pdss::frame::Renderer;
use pdss::plan::Plan;
use pdss::scene::{Camera, Filter, Light, Scene, Texture, Wrap};
use pdss::settings::{Method, Quality, Transmittance, View};
use pdss::truth;
use std::sync::Arc;
use studio::{Picture, Set, settings};

const SCATTERING: [Method; 8] = [
    Method::Wrap,
    Method::Preintegrated,
    Method::TextureSpace,
    Method::Gaussians,
    Method::Separable,
    Method::Burley,
    Method::Pdss,
    Method::Moments,
];

fn change(set: &mut Set, how: impl FnOnce(&mut Scene)) {
    let mut scene = (*set.scene).clone();
    how(&mut scene);
    set.scene = Arc::new(scene);
}

/// A texture of 2 x 1 texels, linear data.
fn pair(left: [u8; 4], right: [u8; 4]) -> Texture {
    Texture {
        name: "pair".to_owned(),
        width: 2,
        height: 1,
        rgba8: [left, right].concat(),
        srgb: false,
        wrap: [Wrap::Clamp; 2],
        filter: Filter::Nearest,
    }
}

fn torus(method: Method, view: View) -> Set {
    let mut set = Set::new("shape:torus:10,4", 60., settings(method, view, [72, 60]));
    set.settings.quality = Quality::Medium;
    set
}

fn masked(set: &Set, mask: f32, texels: Option<[u8; 2]>) -> Set {
    let mut set = set.clone();
    change(&mut set, |scene| {
        if let Some([a, b]) = texels {
            scene.textures.push(pair([7, 7, 7, a], [7, 7, 7, b]));
            scene.materials[0].scatter_mask_texture = Some(0);
        }
        scene.materials[0].scatter_mask = mask;
    });
    set
}

/// The lower half of the triangles as a material of their own, which always scatters.
fn halved(mut set: Set) -> Set {
    change(&mut set, |scene| {
        let half = scene.indices.len() as u32 / 6 * 3;
        scene.materials.push(scene.materials[0].clone());
        scene.draws[0].index_count = half;
        let index_count = scene.indices.len() as u32 - half;
        scene.draws.push(pdss::scene::Draw { material: 1, first_index: half, index_count });
    });
    set
}

#[test]
fn a_mask_of_one_is_none_and_of_zero_a_material_that_does_not_scatter() {
    let gpu = studio::open();
    for view in [View::Final, View::Scatter] {
        for method in SCATTERING {
            let mut plain = halved(torus(method, view));
            // What is gathered from the light's view, and the mass it is divided by, know materials, not textures.
            plain.settings.no_translucent = true;
            let mut none = plain.clone();
            change(&mut none, |scene| scene.materials[0].scatter = None);
            let (all, bare) = (plain.linear(&gpu), none.linear(&gpu));
            let one = masked(&plain, 1., Some([255; 2])).linear(&gpu).differing(&all);
            let zero = masked(&plain, 1., Some([0; 2])).linear(&gpu).differing(&bare);
            let differ = all.differing(&bare);
            println!("{method:?} {view:?}: 1 differs in {one} pixels, 0 in {zero}; to scatter or not in {differ}");
            assert!(one == 0 && zero == 0 && differ > 200, "{method:?} {view:?}");
        }
    }
    studio::close(gpu);
}

#[test]
fn a_mask_of_a_half_is_half_way_between() {
    let gpu = studio::open();
    for method in SCATTERING {
        let mut plain = torus(method, View::Scatter);
        // Of separable it blurs before the share is taken.
        plain.settings.transmittance = Some(Transmittance::Off);
        if method == Method::Preintegrated {
            // Where nothing else scatters, its frame would be another.
            plain = halved(plain);
            // What does not scatter has the shadow of a disc, too.
            plain.settings.no_shadows = true;
        }
        let mut none = plain.clone();
        change(&mut none, |scene| scene.materials[0].scatter = None);
        let (all, bare) = (plain.linear(&gpu), none.linear(&gpu));
        let half = masked(&plain, 0.5, None).linear(&gpu);
        let off = |at: f32| {
            let one = |i: usize| {
                let (a, b, h) = (all.texels[i], bare.texels[i], half.texels[i]);
                (0..3).map(|c| (h[c] - (at * a[c] + (1. - at) * b[c])).abs()).fold(0f32, f32::max)
            };
            all.covered().map(one).fold(0f32, f32::max)
        };
        // 8 bits hold the share, halves the light.
        println!("{method:?}: half {:.4}; taken for three quarters {:.4}", off(0.5), off(0.75));
        assert!(off(0.5) < 5e-3 && off(0.75) > 0.02, "{method:?}");
    }
    studio::close(gpu);
}

#[test]
fn a_mask_is_a_texture_and_its_two_halves_are_the_two_materials() {
    let gpu = studio::open();
    for method in [Method::Wrap, Method::Preintegrated] {
        // Methods that know nothing of neighbours: a half of the picture is that of the material it is.
        let plain = halved(torus(method, View::Scatter));
        let mut none = plain.clone();
        change(&mut none, |scene| scene.materials[0].scatter = None);
        let split = masked(&plain, 1., Some([0, 255])).linear(&gpu);
        let (all, bare) = (plain.linear(&gpu), none.linear(&gpu));
        let told = split.covered().filter(|i| all.texels[*i] != bare.texels[*i]);
        let (mut scattering, mut not, mut neither) = (0, 0, 0);
        for i in told {
            match split.texels[i] {
                t if t == all.texels[i] => scattering += 1,
                t if t == bare.texels[i] => not += 1,
                _ => neither += 1,
            }
        }
        println!("{method:?}: {scattering} scatter, {not} do not, {neither} neither");
        assert!(scattering > 200 && not > 200 && neither <= 60, "{method:?}");
    }
    studio::close(gpu);
}

/// All that measure how thick a part is and take the light that a slab lets through, or have it added to what they blur.
const THROUGH: [Method; 6] =
    [Method::Pdss, Method::Wrap, Method::Preintegrated, Method::Gaussians, Method::Separable, Method::Burley];

/// Two plates of 80 mm, a slab between them, lit head on from behind; the eye sees the dark side.
fn slab(method: Method, thick: f32, closed: bool) -> Set {
    let mut set = torus(method, View::Scatter);
    let back = (Vec3::new(0., 0., -thick), std::f32::consts::PI);
    let list: &[(Vec3, f32)] = if closed { &[(Vec3::ZERO, 0.), back] } else { &[(Vec3::ZERO, 0.)] };
    let mut scene = studio::plates(list);
    scene.materials[0].double_sided = !closed;
    set.camera = Camera::orbit(0., 0., 100., Some(glam::DVec3::ZERO), 20., &scene);
    set.scene = Arc::new(scene);
    set.lights = vec![Light::directional(180., 0., 1.)];
    set.settings.transmittance = Some(Transmittance::Slab);
    set
}

fn middle(p: &Picture) -> [f32; 4] {
    p.at(p.size[0] / 2, p.size[1] / 2)
}

#[test]
fn a_slab_lets_through_what_it_should() {
    let gpu = studio::open();
    for method in THROUGH {
        for thick in [0.5f32, 2., 5., 40.] {
            let set = slab(method, thick, true);
            let gaussians = set.profile.as_ref().expect("wax").gaussians().gaussians;
            // Front and back of an endless slab: sum w exp(-t^2 / 2v) over what both sides weigh.
            let f: [f64; 3] = std::array::from_fn(|c| {
                let part = |g: &pdss::skin::profile::Gaussian| {
                    g.weight[c] * (-f64::from(thick * thick) / (2. * g.variance)).exp()
                };
                gaussians.iter().map(part).sum()
            });
            let seen = middle(&set.linear(&gpu));
            let mut off = set.clone();
            off.settings.transmittance = Some(Transmittance::Off);
            let dark = middle(&off.linear(&gpu));
            let error = (0..3).map(|c| (f64::from(seen[c]) - f[c] / (1. + f[c])).abs()).fold(0., f64::max);
            println!("{method:?}, {thick} mm: {seen:.4?}, off by {error:.1e}; without {dark:.4?}");
            assert!(error < 4e-3 && dark[..3].iter().all(|x| *x < 1e-3), "{method:?} {thick}");
            if thick < 1. {
                assert!(seen[0] > 0.2, "a slab that thin is bright");
            }
        }
    }
    studio::close(gpu);
}

#[test]
fn open_sheets_and_closed_shells_neither_leak_nor_go_black() {
    let gpu = studio::open();
    for method in THROUGH {
        // A sheet without a back is as thin as can be: half of what falls on it; or as thick as its file says.
        let sheet = slab(method, 0., false);
        let open = middle(&sheet.linear(&gpu));
        let mut stated = sheet.clone();
        change(&mut stated, |scene| scene.materials[0].thickness_mm = 40.);
        let thick = middle(&stated.linear(&gpu));
        let mut unlit = sheet.clone();
        unlit.settings.no_shadows = true;
        let blind = middle(&unlit.linear(&gpu));
        change(&mut unlit, |scene| scene.materials[0].thickness_mm = 0.1);
        let told = middle(&unlit.linear(&gpu));
        println!(
            "{method:?}: open sheet {open:.3?}, said to be 40 mm {thick:.3?}; no shadow map {blind:.3?}, .1 mm {told:.3?}"
        );
        assert!(open[..3].iter().all(|x| (*x - 0.5).abs() < 0.02) && thick[..3].iter().all(|x| *x < 2e-3));
        assert!(blind[..3].iter().all(|x| *x < 1e-3) && told[0] > 0.4);
        // A ball that is thicker than light goes has the same light on its lit side, and nothing on its far side.
        let mut ball = Set::new("shape:sphere:60", 300., settings(method, View::Scatter, [64, 64]));
        ball.settings.quality = Quality::Medium;
        ball.settings.transmittance = Some(Transmittance::Slab);
        let with = ball.linear(&gpu);
        ball.settings.transmittance = Some(Transmittance::Off);
        let without = ball.linear(&gpu);
        let most = with.covered().map(|i| (with.texels[i][0] - without.texels[i][0]).abs()).fold(0f32, f32::max);
        ball.lights = vec![Light::directional(200., -30., 1.)];
        ball.settings.transmittance = Some(Transmittance::Slab);
        let far = middle(&ball.linear(&gpu))[0];
        println!("{method:?}: ball of 60 mm changed by {most:.4}, from behind {far:.1e}");
        assert!(most < 0.02 && far < 1e-3);
    }
    studio::close(gpu);
}

#[test]
fn thickness_that_nobody_reads_is_not_stored() {
    for (method, stored) in
        [(Method::Pdss, true), (Method::Separable, true), (Method::Gaussians, true), (Method::Moments, false)]
    {
        let mut set = torus(method, View::Final);
        set.settings.transmittance = Some(Transmittance::Slab);
        assert!(!Renderer::plan_only(&set.inputs()).expect("a plan").has("coat"), "{method:?}");
        change(&mut set, |scene| scene.materials[0].thickness_mm = 3.);
        assert_eq!(Renderer::plan_only(&set.inputs()).expect("a plan").has("coat"), stored, "{method:?}");
        set.settings.transmittance = Some(Transmittance::Off);
        assert!(!Renderer::plan_only(&set.inputs()).expect("a plan").has("coat"), "{method:?}");
    }
}

#[test]
fn a_normal_map_on_the_second_coordinates_is_the_same_model_authored_on_one() {
    let gpu = studio::open();
    for method in [Method::Lambert, Method::Preintegrated, Method::TextureSpace, Method::Moments] {
        let mut one = torus(method, View::Final);
        change(&mut one, |scene| {
            let across = |n: &[f32; 3]| Vec3::from(*n).any_orthonormal_vector().extend(1.).to_array();
            scene.tangents = scene.normals.iter().map(across).collect();
            scene.textures.push(pair([200, 90, 60, 255], [40, 160, 200, 255]));
            scene.textures.push(pair([90, 128, 240, 255], [170, 150, 230, 255]));
            scene.materials[0].base_color_texture = Some(0);
            scene.materials[0].normal_texture = Some((1, 1.));
        });
        // The normal map is to be read elsewhere: on a second set, or, the same model, with the map itself moved there.
        let mut two = one.clone();
        change(&mut two, |scene| {
            scene.second_uvs = scene.uvs.iter().map(|[u, v]| [1. - u, *v]).collect();
            scene.materials[0].second_uvs = 1 << 2;
        });
        change(&mut one, |scene| scene.textures[1].rgba8.rotate_left(4));
        let mut wrong = two.clone();
        change(&mut wrong, |scene| scene.materials[0].second_uvs = 0);
        let (want, have, not) = (one.linear(&gpu), two.linear(&gpu), wrong.linear(&gpu));
        let far = |p: &Picture| {
            let off = |i: &usize| (0..3).any(|c| (p.texels[*i][c] - want.texels[*i][c]).abs() > 2e-3);
            want.covered().filter(off).count()
        };
        let (off, seen) = (far(&have), far(&not));
        println!("{method:?}: {off} pixels differ, {seen} with the map on the first set");
        // At the seam between the two texels a pixel may fall on either side.
        assert!(off <= want.covered().count() / 50 && seen > want.covered().count() / 4, "{method:?}");
    }
    studio::close(gpu);
}

/// Light that falls on hair does not enter the skin beside it, though the shadow map holds both.
#[test]
fn what_does_not_scatter_gives_no_light() {
    let gpu = studio::open();
    let mut set = Set::new("shape:sphere:12", 70., settings(Method::Moments, View::Scatter, [128, 96]));
    set.settings.quality = Quality::High;
    set.lights = vec![Light::directional(20., 25., 1.)];
    change(&mut set, |scene| {
        let left = |t: &[u32]| t.iter().map(|i| scene.positions[*i as usize][0]).sum::<f32>() < 0.;
        let (skin, hair): (Vec<&[u32]>, Vec<&[u32]>) = scene.indices.chunks(3).partition(|t| left(t));
        let (skin, hair) = (skin.concat(), hair.concat());
        scene.materials.push(scene.materials[0].clone());
        scene.materials[1].scatter = None;
        scene.draws.push(scene.draws[0]);
        scene.draws[0].index_count = skin.len() as u32;
        (scene.draws[1].first_index, scene.draws[1].index_count) = (skin.len() as u32, hair.len() as u32);
        scene.draws[1].material = 1;
        scene.indices = [skin, hair].concat();
    });
    let effort = truth::Effort { samples: 60_000, ..truth::Effort::default() };
    let truth = truth::solve(&set.inputs(), None, &effort, |_| ()).expect("a truth").pixels;
    let draw = |edit: fn(&mut Plan)| {
        let mut renderer = Renderer::edited(&gpu, set.inputs(), edit).expect("a frame");
        renderer.run().expect("it runs");
        let found = renderer.linear().expect("a linear picture");
        let far = |i: usize| (0..3).map(|c| (found[i][c] - truth[i][c]).abs()).fold(0., f32::max);
        let covered: Vec<usize> = (0..truth.len()).filter(|i| truth[*i][3] > 0.).collect();
        let all = covered.iter().map(|i| far(*i).powi(2)).sum::<f32>();
        ((all / covered.len() as f32).sqrt(), covered.into_iter().map(far).fold(0., f32::max))
    };
    let found = draw(|_| ());
    // The twin: everything in the map scatters.
    let blind = draw(|plan| {
        let pass = plan.passes.iter_mut().find(|p| p.name == "sparse").expect("light is gathered");
        pass.constants.iter_mut().filter(|c| c.0 == "INERT").for_each(|c| c.1 = 0);
    });
    println!("rms {:.4}, at most {:.3}; with all that the map holds {:.4}, {:.3}", found.0, found.1, blind.0, blind.1);
    assert!(found.0 < 0.012 && blind.0 > 5. * found.0, "{found:?} {blind:?}");
    studio::close(gpu);
}
