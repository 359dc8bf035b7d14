//! Cameras against points whose place in the picture is known.

use glam::{DVec3, Mat4, Quat, Vec3};
use pdss::scene::{Aabb, Camera};

use crate::check::{SHAPES, built};

/// Where a point lands: x, y in -1..1 (y down), depth.
fn project(camera: &Camera, aspect: f32, p: Vec3) -> Vec3 {
    (camera.clip_from_view(aspect) * camera.view_from_world()).project_point3(p)
}

#[test]
fn an_orbit_looks_at_its_target_from_every_side() {
    let (scene, _) = built("torus");
    for (yaw, pitch) in [(0., 0.), (30., 20.), (-135., 60.), (0., 90.), (45., -90.), (180., 0.)] {
        let camera = Camera::orbit(yaw, pitch, 500.0, None, 30.0, &scene);
        let there_and_back = camera.view_from_world() * camera.world_from_view();
        assert!(there_and_back.abs_diff_eq(Mat4::IDENTITY, 1e-4), "{yaw} {pitch}");
        assert!((camera.world_from_view().determinant() - 1.0).abs() < 1e-5);
        let middle = project(&camera, 1.5, Vec3::ZERO);
        assert!(middle.truncate().length() < 1e-5 && middle.z > 0.0 && middle.z < 1.0);
        let above = project(&camera, 1.5, camera.up * 10.0);
        let right = project(&camera, 1.5, camera.right * 10.0);
        assert!(above.y < 0.0 && right.x > 0.0);
        assert!((camera.eye.length() - 500.0).abs() < 1e-3);
        // Depth is reversed: nearer is more.
        assert!(project(&camera, 1.5, camera.eye + camera.forward * 100.0).z > middle.z);
    }
    let front = Camera::orbit(0.0, 0.0, 500.0, Some(DVec3::new(1.0, 2.0, 3.0)), 30.0, &scene);
    assert_eq!(front.eye, Vec3::new(1.0, 2.0, 503.0));
    assert_eq!((front.right, front.up), (Vec3::X, Vec3::Y));
    // The edge of the field of view is the edge of the picture.
    let edge = Vec3::new(1.0, 2.0 + 500.0 * 15f32.to_radians().tan(), 3.0);
    assert!((project(&front, 1.0, edge).y + 1.0).abs() < 1e-4);
}

#[test]
fn the_default_camera_frames_every_shape() {
    for name in SHAPES {
        let (scene, _) = built(name);
        for (fov, aspect) in [(30.0, 1.65), (90.0, 0.5), (1.0, 1.0), (120.0, 2.0)] {
            let camera = Camera::default_for(&scene, fov, aspect);
            let mut most = 0.0f32;
            for p in scene.positions.iter().step_by(7) {
                let at = project(&camera, aspect as f32, Vec3::from(*p));
                assert!(at.z > 0.0 && at.z < 1.0, "{name}: depth {}", at.z);
                most = most.max(at.x.abs()).max(at.y.abs());
            }
            assert!(most < 0.95 && most > 0.3, "{name} at {fov} degrees: {most}");
        }
    }
}

#[test]
fn an_orthographic_camera_keeps_sizes() {
    let (scene, _) = built("sphere:50");
    let camera = Camera::orbit(20.0, 10.0, 400.0, None, 30.0, &scene).with_orthographic(200.0, &scene);
    for p in &scene.positions {
        let at = project(&camera, 1.5, Vec3::from(*p));
        assert!(at.z > 0.0 && at.z < 1.0 && at.y.abs() < 0.5001 && at.x.abs() < 0.3335);
    }
    let near = project(&camera, 1.5, camera.eye + camera.forward * camera.near_mm);
    let far = project(&camera, 1.5, camera.eye + camera.forward * camera.far_mm);
    assert!((near.z - 1.0).abs() < 1e-4 && far.z.abs() < 1e-4);
}

/// A plane is looked at from the side that it faces, standing or lying.
#[test]
fn the_default_camera_sees_the_front_of_a_plane() {
    let (plane, _) = built("plane");
    for facing in [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let mut scene = plane.clone();
        let turn = Quat::from_rotation_arc(Vec3::Y, facing);
        scene.positions.iter_mut().for_each(|p| *p = (turn * Vec3::from(*p)).to_array());
        scene.bounds = Aabb::around(&scene.positions);
        let camera = Camera::default_for(&scene, 30.0, 1.0);
        assert!(camera.eye.dot(facing) > 0.5 * camera.eye.length(), "{facing}: {}", camera.eye);
    }
}
