// Which place of the picture a sample is of.

uniform usampler2D edge_pixels;     // the pixel of each square of two by two samples

// Which sample of its pixel this is, counted from 0.
float sample_number() {
    if (pass_sample.z < 0.5) return 0.0;
    vec2 number = pass_sample.z > 1.5 ? vec2(ivec2(gl_FragCoord.xy) & 1) : pass_sample.xy;
    return 1.0 + number.x + 2.0 * number.y;
}

// In pixels from the picture's lower left corner.
vec2 sample_place() {
    if (pass_sample.z < 0.5) return gl_FragCoord.xy;
    ivec2 texel = ivec2(gl_FragCoord.xy);
    bool listed = pass_sample.z > 1.5;
    vec2 pixel = listed ? vec2(texelFetch(edge_pixels, texel >> 1, 0).xy) + 0.5 : gl_FragCoord.xy;
    vec2 number = listed ? vec2(texel & 1) : pass_sample.xy;
    // A rotated grid, so that no two samples share a row or a column.
    vec2 corner = 0.5 * number - 0.25;
    return pixel + corner + 0.5 * vec2(-corner.y, corner.x);
}
