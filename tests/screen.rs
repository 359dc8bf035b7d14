//! Methods that blur light on the screen, each on its own terms: the profile that it claims, the limit that more work comes to.
mod studio;

#[path = "screen/halo.rs"]
mod halo;
#[path = "screen/plot.rs"]
mod plot;
#[path = "screen/point.rs"]
mod point;
#[path = "screen/profiles.rs"]
mod profiles;
#[path = "screen/sphere.rs"]
mod sphere;
#[path = "screen/texture.rs"]
mod texture;

#[test]
fn a_point_of_light_becomes_the_profile() {
    let gpu = studio::open();
    let (wrong, curves) = point::check(&gpu);
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("point-light.svg");
    std::fs::write(&path, plot::svg(&curves, 32. / 129.)).expect("the target folder is writable");
    println!("plotted in {}", path.display());
    assert_eq!(wrong, Vec::<String>::new());
    studio::close(gpu);
}

#[test]
fn more_work_is_less_error_on_a_sphere() {
    let gpu = studio::open();
    assert_eq!(sphere::check(&gpu), Vec::<String>::new());
    studio::close(gpu);
}

#[test]
fn what_stands_behind_leaves_no_band() {
    let gpu = studio::open();
    assert_eq!(halo::check(&gpu), Vec::<String>::new());
    studio::close(gpu);
}

#[test]
fn colour_before_and_after() {
    let gpu = studio::open();
    assert_eq!(texture::check(&gpu), Vec::<String>::new());
    studio::close(gpu);
}

#[test]
fn profiles_that_touch_do_not_bleed() {
    let gpu = studio::open();
    assert_eq!(profiles::check(&gpu), Vec::<String>::new());
    studio::close(gpu);
}
