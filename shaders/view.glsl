// Colours of the views (variant VIEWS), 0..1 in sRGB, from the values recorded for a sample. Each view has a function
// `view_NAME` of the ray's direction.

// Maximum number of counted texels of a tape.
const int TAPE_TEXELS_MAX = 4096;
// Half the width of the lines on a slice and at the faces of cells, in pixels.
const float LINE_WIDTH = 0.8;

vec3 heat_color(float fraction) {
    float along = clamp(fraction, 0.0, 1.0) * float(HEAT_COLORS - 1);
    int left = min(int(along), HEAT_COLORS - 2);
    return mix(HEAT_COLOR[left], HEAT_COLOR[left + 1], along - float(left));
}

// Returns the distance at a point, or the formula's value, including planes.
float value_at(vec3 p) {
    // This point is outside the tree, so the whole tape runs.
    Cell whole = cell_at(vec3(1e9));
    float d = bounds_low.w < 0.5 ? FAR : scene_distance(whole, p, 0.0).y;
    for (int i = 0; i < PLANES; i++) {
        if (dot(planes[i].xyz, planes[i].xyz) > 0.5) d = min(d, dot(planes[i].xyz, p) + planes[i].w);
    }
    // Treat NaN as far away.
    return abs(d) < 1e9 ? d : 1e9;
}

// Returns the covered fraction of a pixel that is `away` pixels from the middle of a line.
float line_cover(float away, float half_width) {
    return clamp(half_width + 0.5 - away, 0.0, 1.0);
}

// Lines of equal distance (Abt 2022, figure 1).
vec3 view_slice(vec3 direction) {
    float along = dot(view_plane.xyz, direction);
    float t = -(dot(view_plane.xyz, ray_origin) + view_plane.w) / max(along, 1e-6);
    // The plane may contain the camera.
    t = clamp(t, 1e-3, 1e6);
    float d = value_at(ray_origin + t * direction);
    float pixel = 2.0 * camera_position.w * t;
    // The change of the value from pixel to pixel. For a signed distance, it is at most the pixel's width.
    float slope = max(fwidth(d), 0.05 * pixel);
    float spacing = view_choice.y;
    vec3 color = d > 0.0 ? COLOR_OUTSIDE : COLOR_INSIDE;
    // Darken colours towards the surface, and every second band.
    float bands = abs(d) / spacing;
    color *= 0.55 + 0.45 * (1.0 - exp(-0.35 * bands));
    color *= mod(floor(bands), 2.0) < 0.5 ? 1.0 : 0.93;
    for (int i = 0; i < 2; i++) {
        float width = i == 0 ? spacing : 5.0 * spacing;
        float away = abs(d - width * floor(d / width + 0.5)) / slope;
        // Fade out lines where they are so dense that they would merge.
        float seen = clamp(width / slope / 5.0 - 0.5, 0.0, 1.0);
        color *= 1.0 - (i == 0 ? 0.35 : 0.5) * seen * line_cover(away, 0.2 + float(i) * 0.3);
    }
    // Surfaces in front of the plane are faint, like mist.
    if (noted && noted_t < t) {
        float facing = clamp(-dot(noted_normal, direction), 0.0, 1.0);
        color = mix(color, vec3(0.25 + 0.6 * facing), 0.30);
    }
    return mix(color, COLOR_ZERO, line_cover(abs(d) / slope, 1.5));
}

// Returns the number of clauses in a region's tape.
float tape_length(int first) {
    int texels = 0;
    for (; texels < TAPE_TEXELS_MAX; texels++) {
        if ((TEXEL(regions, first + texels).z & 255u) == 0u) break;
    }
    // A texel has two clauses, but the second clause of the last texel is END.
    return 2.0 * float(texels) + 1.0;
}

// Returns the fraction of a pixel that a line at the nearest face covers. Cells are `side` root cells wide.
float face_cover(vec3 q, float side, float half_width) {
    vec3 pixel = 2.0 * camera_position.w * noted_t * region_scale.xyz;
    vec3 away = abs(q - side * floor(q / side + 0.5));
    // Skip faces that contain the surface: their lines would cover it completely.
    vec3 along = sqrt(max(1.0 - noted_normal * noted_normal, 0.0));
    vec3 cover = clamp(half_width + 0.5 - away / (pixel * max(along, 1e-3)), 0.0, 1.0);
    cover *= step(vec3(0.05), along);
    return max(cover.x, max(cover.y, cover.z));
}

vec3 view_cells(vec3 direction) {
    if (!noted) return COLOR_NOTHING;
    vec3 q = in_root(noted_p);
    Cell cell = cell_at(q);
    if (cell.side <= 0.0) return COLOR_NO_CELL;
    vec3 color = COLOR_EMPTY_CELL;
    if (!(cell.bound > 0.0)) color = heat_color(tape_length(cell.tape) / view_choice.y);
    // Shade alternate cells differently, so that they are visible where lines are too fine.
    ivec3 place = ivec3(floor(q / cell.side));
    color *= ((place.x + place.y + place.z) & 1) == 0 ? 1.0 : 0.9;
    color *= 1.0 - 0.45 * face_cover(q, cell.side, LINE_WIDTH * 0.5);
    return color * (1.0 - 0.75 * face_cover(q, 1.0, LINE_WIDTH));
}

vec3 view_steps(vec3 direction) {
    return heat_color(count_primary / view_choice.y);
}

vec3 view_clauses(vec3 direction) {
#ifdef CLAUSES_RUN
    float run = CLAUSES_RUN + SURFACE_CLAUSES_RUN;
#else
    float run = count_primary + count_reflection + count_normal + count_shadow + count_occlusion;
#endif
    return heat_color(run / view_choice.y);
}

vec3 view_normals(vec3 direction) {
    return noted ? 0.5 + 0.5 * noted_normal : COLOR_NOTHING;
}

vec3 view_shadow(vec3 direction) {
    if (!noted) return COLOR_NOTHING;
    return noted_light > 0.0 ? vec3(clamp(noted_arrives / noted_light, 0.0, 1.0)) : COLOR_FACES_AWAY;
}

vec3 view_occlusion(vec3 direction) {
    return noted ? vec3(noted_open) : COLOR_NOTHING;
}

vec3 view_materials(vec3 direction) {
    return noted ? OBJECT_COLOR[noted_object - OBJECT_COLORS * (noted_object / OBJECT_COLORS)] : COLOR_NOTHING;
}

vec3 view_depth(vec3 direction) {
    return noted ? vec3(1.0 - clamp(noted_t / view_choice.y, 0.0, 1.0)) : COLOR_NOTHING;
}

#include "view_dispatch.glsl"
