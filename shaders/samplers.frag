// Reads as many textures as a program may read, and discards the result.
//
// Mesa binds no sampler for a texture buffer, so the previous program's sampler stays in that slot. llvmpipe compiles
// a scene's program once for each combination of samplers in the slots, even if the program does not read them. When
// this program is drawn first, every scene gets the same combination.

uniform sampler2D slot_0;
uniform sampler2D slot_1;
uniform sampler2D slot_2;
uniform sampler2D slot_3;
uniform sampler2D slot_4;
uniform sampler2D slot_5;
uniform sampler2D slot_6;
uniform sampler2D slot_7;
uniform sampler2D slot_8;
uniform sampler2D slot_9;
uniform sampler2D slot_10;
uniform sampler2D slot_11;
uniform sampler2D slot_12;
uniform sampler2D slot_13;
uniform sampler2D slot_14;
uniform sampler2D slot_15;

layout(location = 0) out vec4 color;

void main() {
    ivec2 texel = ivec2(0);
    color = texelFetch(slot_0, texel, 0) + texelFetch(slot_1, texel, 0) + texelFetch(slot_2, texel, 0)
        + texelFetch(slot_3, texel, 0) + texelFetch(slot_4, texel, 0) + texelFetch(slot_5, texel, 0)
        + texelFetch(slot_6, texel, 0) + texelFetch(slot_7, texel, 0) + texelFetch(slot_8, texel, 0)
        + texelFetch(slot_9, texel, 0) + texelFetch(slot_10, texel, 0) + texelFetch(slot_11, texel, 0)
        + texelFetch(slot_12, texel, 0) + texelFetch(slot_13, texel, 0) + texelFetch(slot_14, texel, 0)
        + texelFetch(slot_15, texel, 0);
}
