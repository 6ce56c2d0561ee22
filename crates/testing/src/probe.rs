//! Draws with a single fragment shader that reads lists of numbers and writes floats, for tests of generated shaders.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

const VERTEX: &str = "#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
";

/// A list that the shader reads as a texture buffer.
#[derive(Clone, Copy)]
pub enum List<'a> {
    /// One float in each texel.
    Numbers(&'a [f32]),
    /// Four floats in each texel.
    Vectors(&'a [[f32; 4]]),
    /// Four words in each texel.
    Words(&'a [[u32; 4]]),
}

impl List<'_> {
    fn stored(self) -> (u32, Vec<u8>) {
        let bytes = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
        match self {
            Self::Numbers(numbers) => (glow::R32F, bytes(numbers)),
            Self::Vectors(vectors) => (glow::RGBA32F, bytes(vectors.as_flattened())),
            Self::Words(words) => {
                (glow::RGBA32UI, words.as_flattened().iter().flat_map(|word| word.to_ne_bytes()).collect())
            }
        }
    }
}

/// Draws every pixel once with `fragment`, the complete text of a shader that writes one vec4. Each list has the name of
/// its uniform; the shader need not use all. Returns the pixels row by row, first the row with `gl_FragCoord.y` 0.5.
/// The objects are deleted with the context `gl`, which must be current.
pub fn drawn(gl: &glow::Context, fragment: &str, size: (u32, u32), lists: &[(&str, List)]) -> Vec<[f32; 4]> {
    let [width, height] = [size.0, size.1].map(u32::cast_signed);
    let mut bytes = vec![0; 16 * (width * height) as usize];
    let pixels = glow::PixelPackData::Slice(Some(&mut bytes));
    // SAFETY: all objects are created in the current context, the shaders read nothing but the lists, and `bytes` has
    // four floats for each pixel.
    unsafe {
        let program = linked(gl, fragment);
        gl.use_program(Some(program));
        for ((name, list), unit) in lists.iter().zip(0..) {
            let (format, bytes) = list.stored();
            let buffer = gl.create_buffer().unwrap();
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer));
            gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &bytes, glow::STATIC_DRAW);
            gl.active_texture(glow::TEXTURE0 + unit);
            gl.bind_texture(glow::TEXTURE_BUFFER, Some(gl.create_texture().unwrap()));
            gl.tex_buffer(glow::TEXTURE_BUFFER, format, Some(buffer));
            if let Some(location) = gl.get_uniform_location(program, name) {
                gl.uniform_1_i32(Some(&location), unit.cast_signed());
            }
        }
        let color = gl.create_renderbuffer().unwrap();
        gl.bind_renderbuffer(glow::RENDERBUFFER, Some(color));
        gl.renderbuffer_storage(glow::RENDERBUFFER, glow::RGBA32F, width, height);
        gl.bind_framebuffer(glow::FRAMEBUFFER, Some(gl.create_framebuffer().unwrap()));
        let attachment = glow::COLOR_ATTACHMENT0;
        gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, attachment, glow::RENDERBUFFER, Some(color));
        gl.viewport(0, 0, width, height);
        gl.bind_vertex_array(Some(gl.create_vertex_array().unwrap()));
        gl.draw_arrays(glow::TRIANGLES, 0, 3);
        gl.read_pixels(0, 0, width, height, glow::RGBA, glow::FLOAT, pixels);
        assert_eq!(gl.get_error(), glow::NO_ERROR, "drawing a probe");
    }
    let pixels = bytes.as_chunks::<4>().0.as_chunks::<4>().0;
    pixels.iter().map(|pixel| pixel.map(f32::from_ne_bytes)).collect()
}

/// # Safety
/// `gl` must be current.
// SAFETY: the duty of the caller is above.
unsafe fn linked(gl: &glow::Context, fragment: &str) -> glow::Program {
    // SAFETY: all objects are created in the current context.
    unsafe {
        let program = gl.create_program().unwrap();
        for (kind, text) in [(glow::VERTEX_SHADER, VERTEX), (glow::FRAGMENT_SHADER, fragment)] {
            let shader = gl.create_shader(kind).unwrap();
            gl.shader_source(shader, text);
            gl.compile_shader(shader);
            assert!(gl.get_shader_compile_status(shader), "{}", gl.get_shader_info_log(shader));
            gl.attach_shader(program, shader);
        }
        gl.link_program(program);
        assert!(gl.get_program_link_status(program), "{}", gl.get_program_info_log(program));
        program
    }
}
