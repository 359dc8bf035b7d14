use pdss::{frame::*, gpu::*, scene::*, settings::*, skin::profile::Profile};
use clap::Parser;
#[derive(Parser)]
struct A { scene: String, #[arg(short)] o: String, #[arg(long, allow_hyphen_values=true, value_delimiter=',')] camera: Vec<f64>, #[arg(long, allow_hyphen_values=true, value_delimiter=',')] target: Vec<f64>, #[arg(long, default_value="30")] fov: f64, #[arg(long, allow_hyphen_values=true)] light: Vec<String>, #[arg(long, default_value="skin")] profile: String, #[arg(long)] mm: Option<f64>, #[arg(long)] validate: bool, #[arg(long, default_value="1")] frames: u32, #[arg(long)] times: bool, #[command(flatten)] s: Settings }
fn main() -> anyhow::Result<()> {
    let a = A::parse();
    let gpu = Gpu::open(&Options { validate: a.validate, device: None })?;
    let mut scene = Scene::open(&a.scene, &LoadOptions { mm_per_unit: a.mm, ..Default::default() })?;
    scene.assign_profile(None, 0)?;
    let c = &a.camera;
    let t = (a.target.len()==3).then(|| glam::DVec3::new(a.target[0],a.target[1],a.target[2]));
    let camera = if c.len()==3 { Camera::orbit(c[0],c[1],c[2],t,a.fov,&scene) } else { Camera::default_for(&scene, a.fov, a.s.size.width as f64/a.s.size.height as f64) };
    let lights = if a.light.is_empty() { vec![Light::directional(60.,25.,3.14), Light::directional(-70.,10.,0.6)] } else { a.light.iter().map(|l| { let v: Vec<f64> = l.split(',').map(|x| x.parse().unwrap()).collect(); Light::directional(v[0],v[1],*v.get(2).unwrap_or(&1.) as f32) }).collect() };
    let s = a.s.clone();
    let exr = a.o.ends_with("exr");
    let mut r = Renderer::new(&gpu, Inputs { scene: &scene, camera, lights, profile: Some(Profile::resolve(&a.profile)?), settings: s.clone(), timing: a.times.then_some(timing::TimingMode::Isolated), output: if exr { Output::Linear } else { Output::Ldr } })?;
    let mut w = vec![];
    let mut tt: std::collections::BTreeMap<usize, Vec<f64>> = Default::default();
    for _ in 0..a.frames { r.run()?; w.push(r.cpu_times().last_run_ms); for (i,(_, t)) in r.times()?.into_iter().enumerate() { tt.entry(i).or_default().push(t.unwrap_or(0.)/1e6); } }
    w.sort_by(f64::total_cmp); eprintln!("median frame {:.1} ms, min {:.1}; {:?} tiles {:?}", w[w.len()/2], w[0], r.cpu_times(), r.tile_counts()?);
    for (i, v) in &mut tt { v.sort_by(f64::total_cmp); eprintln!("{:16} {:7.2}", r.plan().passes[*i].name, v[v.len()/2]); }
    if r.output()==Output::Ldr { let px = r.ldr()?; ::image::save_buffer(&a.o, &px, s.size.width, s.size.height, ::image::ColorType::Rgba8)?; }
    else { let px = r.linear()?; if exr { let f: Vec<f32> = px.iter().flatten().copied().collect(); ::image::Rgba32FImage::from_raw(s.size.width, s.size.height, f).unwrap().save(&a.o)?; } else { let m = px.iter().map(|p| p[0].abs()).fold(0.,f32::max); let f: Vec<u8> = px.iter().flat_map(|p| [p[0],p[1],p[2]].map(|x| (if matches!(s.view, View::Normal|View::SoftNormal|View::ShadingNormal) {x*0.5+0.5} else if matches!(s.view, View::Curvature|View::SoftCurvature) {0.5+x*8.} else if matches!(s.view, View::Depth|View::Position) {x/m} else {x}).clamp(0.,1.)).map(|x| (x*255.) as u8)).collect(); ::image::save_buffer(&a.o, &f, s.size.width, s.size.height, ::image::ColorType::Rgb8)?; } }
    let msgs = gpu.messages(); eprintln!("{} messages", msgs.len());
    drop(r);
    gpu.close()?;
    Ok(())
}
