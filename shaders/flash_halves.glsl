// Declares the six outputs of a pass of the flash limiter, which is drawn twice. Each draw writes three outputs, because
// OpenGL ES 3.0 guarantees only four; compilers drop what computes the others.

#ifdef SECOND_HALF
#define FIRST_HALF(number)
#define OTHER_HALF(number) layout(location = number) out
#else
#define FIRST_HALF(number) layout(location = number) out
#define OTHER_HALF(number)
#endif
