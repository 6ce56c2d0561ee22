//! Checks generated GLSL with naga, so that no driver gets invalid text.

use naga::front::glsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::graph::{CELL_HASH_GLSL, LEVEL_COUNT, SoundInput, levels_glsl};
use crate::limits::LIMITS;

/// Returns the declarations that the generated functions need, in a form that naga accepts.
fn surroundings() -> String {
    format!(
        "#version 450\n\
         layout(std140, set = 0, binding = 0) uniform Inputs {{\n    vec4 camera_position;\n    vec4 frame_screen;\n    vec4 frame_mouse;\n    float frame_time;\n    vec4 frame_heard[{}];\n    \
         vec4 frame_levels[{}];\n    vec4 frame_params[{}];\n    vec4 frame_hoisted[{}];\n}};\n\
         {}float table_part(float a) {{ return a; }}\nfloat shape_number(float a) {{ return a; }}\n\
         float shape_distance(float a, float b) {{ return a + b; }}\nfloat table_spectrum(float a) {{ return a; }}\n\
         float table_waveform(float a) {{ return a; }}\nfloat table_history(float a, float b) {{ return a + b; }}\n\
         vec4 read_texture(int i, float u, float v) {{ return vec4(u, v, float(i), 1.0); }}\n\
         vec4 sample_texture(int i, vec2 uv, vec2 dx, vec2 dy) {{ return vec4(uv, dx + dy); }}\n{CELL_HASH_GLSL}\n",
        SoundInput::ALL.len().div_ceil(4),
        LEVEL_COUNT,
        LIMITS.scene_params_max.div_ceil(4),
        LIMITS.hoisted_max.div_ceil(4),
        levels_glsl(),
    )
}

/// Validates generated functions. The error is naga's message.
pub(super) fn validate(functions: &str) -> Result<(), String> {
    let text = surroundings() + functions + "void main() {}\n";
    let module = Frontend::default()
        .parse(&Options::from(naga::ShaderStage::Fragment), &text)
        .map_err(|errors| errors.emit_to_string(&text))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map(drop)
        .map_err(|error| error.emit_to_string(&text))
}

#[cfg(test)]
mod tests {
    use super::validate;

    #[test]
    fn invalid_functions_are_rejected_and_quoted() {
        assert_eq!(validate("float f(vec3 p) { return p.x; }\n"), Ok(()));
        let complaint = validate("float f(vec3 p) { return p.x + no_such_name; }\n").unwrap_err();
        assert!(complaint.contains("no_such_name"), "{complaint}");
    }
}
