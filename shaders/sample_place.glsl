// The position of a sample in the frame.

#ifdef PATHS
// The position of the pixel's path in the frame, in pixels.
vec2 path_place;

vec2 sample_place() {
    return path_place;
}

bool is_medium_pass() {
    return false;
}
#else
uniform usampler2D edge_pixels;     // the pixel of each block of samples, and the bits of its beam's free distance

// True for the pass of media, whose texels are 2 x 2 pixels of the frame.
bool is_medium_pass() {
#ifdef MEDIA
    return pass_sample.z > 2.5;
#else
    return false;
#endif
}

// Returns the place of a texel of the pass of media in its layer.
vec2 medium_texel_place() {
    return vec2(gl_FragCoord.x, mod(gl_FragCoord.y, pass_list.w));
}

// Returns the number of a texel among the further samples of its block.
int block_sample() {
    ivec2 block = ivec2(pass_list.xy);
    ivec2 texel = ivec2(gl_FragCoord.xy) % block;
    return texel.x + block.x * texel.y;
}

// Returns the number of this sample within its pixel, starting at 0.
float sample_number() {
    if (pass_sample.z < 0.5 || is_medium_pass()) return 0.0;
    return 1.0 + (pass_sample.z > 1.5 ? float(block_sample()) : pass_sample.w);
}

uvec4 listed_pixel() {
    return texelFetch(edge_pixels, ivec2(gl_FragCoord.xy) / ivec2(pass_list.xy), 0);
}

// Returns the position of the sample in pixels from the frame's lower left corner.
vec2 sample_place() {
    if (pass_sample.z < 0.5) return gl_FragCoord.xy;
    if (is_medium_pass()) return 2.0 * medium_texel_place();
    if (pass_sample.z < 1.5) return gl_FragCoord.xy + pass_sample.xy;
    int number = block_sample();
    vec4 pair = pass_places[number >> 1];
    return vec2(listed_pixel().xy) + 0.5 + ((number & 1) == 0 ? pair.xy : pair.zw);
}

// Returns the bits of the free distance and the steps at which this sample's ray starts (beams.glsl).
uint sample_start() {
    if (pass_sample.z < 1.5 || is_medium_pass()) return 0u;
    uvec2 halves = listed_pixel().zw;
    return (halves.x << 16) | halves.y;
}
#endif

#ifdef PROJECTED
// Returns the size of one eye's picture, in pixels of the frame.
vec2 eye_size() {
    vec2 halves = vec2(frame_projection.y == STEREO_SIDE_BY_SIDE, frame_projection.y == STEREO_OVER_UNDER);
    return viewport.xy / (1.0 + halves);
}

// Returns the lower left corner of the eye's picture at a point of the frame. z is the eye: -1 left, 1 right, 0 alone.
vec3 eye_corner(vec2 place) {
    vec2 size = eye_size();
    if (frame_projection.y == STEREO_SIDE_BY_SIDE) return place.x < size.x ? vec3(0.0, 0.0, -1.0) : vec3(size.x, 0.0, 1.0);
    if (frame_projection.y == STEREO_OVER_UNDER) return place.y < size.y ? vec3(0.0, 0.0, 1.0) : vec3(0.0, size.y, -1.0);
    return vec3(0.0);
}
#endif

// Returns the position of the sample in pixels of the picture, whatever the resolution of the frame. Each of two eyes
// has its own picture.
vec2 picture_pixel() {
#ifdef PROJECTED
    return (sample_place() - eye_corner(sample_place()).xy) * frame_screen.zw;
#else
    return sample_place() * frame_screen.zw;
#endif
}
