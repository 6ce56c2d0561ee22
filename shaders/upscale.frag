// Enlarges a finished frame for a window that has more pixels than the frame.

#include "post_block.glsl"
#include "enlarge.glsl"

layout(location = 0) out vec4 screen;

void main() {
    screen = vec4(enlarged(post_place()), 1.0);
}
