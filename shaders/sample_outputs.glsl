// The outputs of scene.frag, of which each variant has its own, and the values in them.

layout(location = 0) out vec4 sample_color;         // see sample_light.glsl; the key is a whole number below 2048
#if defined(VIEWS)
#define BEAM_PLACE 1
#elif defined(COUNT_EVALUATIONS)
#define BEAM_PLACE 4
layout(location = 1) out vec4 evaluations;          // primary, reflection, normal, shadow
layout(location = 2) out vec4 more_evaluations;     // occlusion, capped rays, clauses, lookups of cells
layout(location = 3) out vec4 more_clauses;         // of materials and light; evaluations of media, steps through media, 0
#ifndef CLAUSES_RUN
#define CLAUSES_RUN 0.0
#define SURFACE_CLAUSES_RUN 0.0
#endif
#define COUNTS_EVALUATIONS
#elif defined(LENS)
#define BEAM_PLACE 2
layout(location = 1) out float sample_spread;       // radius of the point's disc in pixels
#define HAS_SPREAD
#else
#define BEAM_PLACE 1
#endif

// Writes the counts, and the blur of a thin lens: a point at distance z becomes a disc of radius * |1/sharp - 1/z| at
// distance 1; the result is negative in front of the sharp distance.
void write_extras(float nearness) {
#ifdef COUNTS_EVALUATIONS
    evaluations = vec4(count_primary, count_reflection, count_normal, count_shadow);
    more_evaluations = vec4(count_occlusion, count_capped, CLAUSES_RUN, count_lookups);
    more_clauses = vec4(SURFACE_CLAUSES_RUN, count_medium, count_medium_steps, count_swarm);
#endif
#ifdef HAS_SPREAD
    float most = picture_lens.z * viewport.y;
    sample_spread = clamp(picture_lens.x * (picture_lens.y - nearness) / (2.0 * camera_position.w), -most, most);
#endif
}

#if (defined(BEAMS) || defined(MEDIA)) && !defined(VIEWS)
// The free distance of the pixel's beam or, in the pass of media, the distance at which the ray ends. It must be the
// last output (crates/render/src/gpu/renderer.rs).
layout(location = BEAM_PLACE) out float sample_beam;
#define WRITE_BEAM(value) sample_beam = value;
#else
#define WRITE_BEAM(value)
#endif
