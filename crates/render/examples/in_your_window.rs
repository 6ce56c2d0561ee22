//! Draws a scene into your own window: load the functions of the window's OpenGL context, then draw and show.
//! `cargo run -p mariana-render --example in_your_window -- "sphere(p, 1 + 0.3 * sin(t))"`
#![expect(unsafe_code, clippy::expect_used, reason = "glutin's calls are unsafe, and an example may panic")]

use glutin::{config::ConfigTemplateBuilder, context::ContextAttributesBuilder};
use glutin::{display::GetGlDisplay, prelude::*};
use glutin_winit::{DisplayBuilder, GlWindow};
use mariana_field::world::World;
use mariana_music::Features;
use mariana_render::{Gl, SceneRenderer};
use std::{error::Error, time::Instant};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};
use winit::{application::ApplicationHandler, event::WindowEvent, raw_window_handle::HasWindowHandle};

type Drawing = Box<dyn FnMut()>;

fn open(events: &ActiveEventLoop, text: &str) -> Result<Drawing, Box<dyn Error>> {
    let builder = DisplayBuilder::new().with_window_attributes(Some(Window::default_attributes()));
    let (window, config) =
        builder.build(events, ConfigTemplateBuilder::new(), |mut all| all.next().expect("a config"))?;
    let (window, display) = (window.ok_or("no window")?, config.display());
    let context = ContextAttributesBuilder::new().build(Some(window.window_handle()?.as_raw()));
    let surface = window.build_surface_attributes(Default::default())?;
    // SAFETY: the closure below drops the window after the surface and the context.
    let surface = unsafe { display.create_window_surface(&config, &surface)? };
    let context = unsafe { display.create_context(&config, &context)? }.make_current(&surface)?;
    let gl = Gl::load(|name| display.get_proc_address(name), false)?;
    let (mut scene, begun) = (SceneRenderer::new(&gl, World::parse("a text", text)?)?, Instant::now());
    Ok(Box::new(move || {
        // The closure drops the captured values in this order.
        let (scene, context, surface, window) = (&mut scene, &context, &surface, &window);
        let (time, size) = (begun.elapsed().as_secs_f64(), window.inner_size().into());
        scene.draw(time, Features::SILENCE, size).and_then(|()| scene.show(size)).expect("drawing the scene");
        surface.swap_buffers(context).expect("swapping the buffers");
        window.request_redraw();
    }))
}

struct Program(String, Option<Drawing>);

impl ApplicationHandler for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        self.1 = Some(open(events, &self.0).expect("a window with OpenGL 3.3"));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::RedrawRequested => self.1.iter_mut().for_each(|draw| draw()),
            WindowEvent::CloseRequested => events.exit(),
            _ => {}
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let text = std::env::args().nth(1).unwrap_or("sphere(p, 1 + 0.3 * sin(t))".into());
    Ok(EventLoop::new()?.run_app(&mut Program(text, None))?)
}
