// Counts distance evaluations by kind of ray, for `mariana bench`; without COUNT_EVALUATIONS its macros are empty.

#ifdef COUNT_EVALUATIONS
float count_primary = 0.0;
float count_reflection = 0.0;
float count_normal = 0.0;
float count_shadow = 0.0;
float count_occlusion = 0.0;
float count_capped = 0.0;   // number of rays of this pixel that reached their step limit
float count_lookups = 0.0;  // number of lookups of a point's cell
#define COUNT(kind) count_##kind += 1.0
#define COUNT_N(kind, n) count_##kind += float(n)
#else
#define COUNT(kind)
#define COUNT_N(kind, n)
#endif
