// Counts distance evaluations by kind of ray, for `mariana bench`; without COUNT_EVALUATIONS its macro is empty.

#ifdef COUNT_EVALUATIONS
float count_primary = 0.0;
float count_reflection = 0.0;
float count_normal = 0.0;
float count_shadow = 0.0;
float count_occlusion = 0.0;
float count_capped = 0.0;   // number of rays of this pixel that reached their step limit
float count_medium = 0.0;   // number of evaluations of media
float count_medium_steps = 0.0; // number of steps through media, including those in empty space
float count_swarm = 0.0;     // number of nodes and points of swarms that rays tested
float count_lookups = 0.0;  // number of lookups of a point's cell
#define COUNT(counter) counter += 1.0
#else
#define COUNT(counter)
#endif
