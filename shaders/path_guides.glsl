// The guides of the filter: the surface that a pixel shows after mirrors and glass.

// Guides follow a path through this number of mirrors and walls of glass that are no rougher than this.
const int GUIDED_RAYS = 6;
const float GUIDED_ALPHA = 0.01;

// Normal and distance of the surface, and about the light of the path if a light of 1 lit everything.
vec4 guide = vec4(0.0, 0.0, 0.0, NEVER);
vec3 guide_color = vec3(0.0);

// Adds a surface to the guides. The path goes the way of most light: of `ways`, 1 is left.
void guide_at(Parting parting, Material m, float travelled, inout vec3 ways) {
    guide = vec4(parting.normal, travelled);
    guide_color += parting.kept * (parting.scattered * (mix(vec3(0.04), vec3(1.0), m.color) + finite_light(m.emission)));
    guide_color += parting.kept * (parting.mirrored + parting.bent);
    bool is_image = !(m.blur * m.blur > GUIDED_ALPHA) && ways.x + ways.y > ways.z;
    bool is_reflected = is_image && ways.x > ways.y;
    ways = vec3(is_reflected, is_image && !is_reflected, !is_image);
}
