use mariana::{dsp::Features, frame::Frame, gpu::{headless::Headless, renderer::*, shader_source::ShaderLibrary}};
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (t, vol, w, h): (f64, f32, u32, u32) = (a[2].parse().unwrap(), a[3].parse().unwrap(), a[4].parse().unwrap(), a[5].parse().unwrap());
    let start = Instant::now();
    let hl = Headless::new(true).unwrap();
    println!("context {:?}", start.elapsed());
    let lib = ShaderLibrary::on_disk(std::path::Path::new("shaders"));
    let mut f = Features::default();
    f.volume = [vol, vol * 0.8];
    for (i, b) in f.bands.iter_mut().enumerate() { *b = vol * 4.0 * (0.35 + 0.3 * ((i as f32 * 1.7).sin())) * (1.0 - i as f32 / 50.0); }
    let frame = Frame::new(t, f, (w, h));
    let count = a.len() > 6;
    let mut r = Renderer::new(hl.gl(), &lib, if count { Counting::On } else { Counting::Off }).unwrap();
    println!("renderer {:?}", start.elapsed());
    r.draw(&frame).unwrap(); hl.gl().finish();
    println!("first {:?}", start.elapsed());
    if count { println!("{:#?}", r.evaluations().per_pixel((w * h) as f64)); }
    let mut cpus = vec![];
    for _ in 0..7 { let c = cpu_time::ProcessTime::now(); let s = Instant::now(); r.draw(&frame).unwrap(); hl.gl().finish(); cpus.push((c.elapsed().as_millis(), s.elapsed().as_millis())); }
    cpus.sort(); println!("cpu,wall ms {:?}", cpus);
    image::save_buffer(&a[1], &r.read(), w, h, image::ColorType::Rgba8).unwrap();
}
