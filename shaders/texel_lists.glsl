// Lists of texels that shaders read by number: tapes, regions and sound tables. OpenGL has texture buffers for them;
// OpenGL ES 3.0 has none, so there a list fills the rows of a texture (crates/render/src/gpu/texel_list.rs).
//
// Read a list by TEXEL only. It may evaluate `number` twice, so pass no `number++`.

#ifdef LIST_ROW_BITS
#define WORD_LIST usampler2D
#define NUMBER_LIST sampler2D
#define TEXEL(list, number) texelFetch(list, ivec2((number) & ((1 << LIST_ROW_BITS) - 1), (number) >> LIST_ROW_BITS), 0)
#else
#define WORD_LIST usamplerBuffer
#define NUMBER_LIST samplerBuffer
#define TEXEL(list, number) texelFetch(list, number)
#endif
