// The numbers of a pass; written by crates/render/src/gpu/renderer/paths.rs.
#define path_corner pass_sample.xy                  // the place of the first pixel of the state in the frame
#define path_first uint(pass_sample.z)              // number of the pixel's first path in the sequence
#define path_sampling int(pass_sample.w)            // SAMPLE_...
#define paths_most int(pass_list.x)                 // largest number of paths of a pixel
#define path_noise pass_list.y                      // a pixel is finished if its relative standard error is below this
#define is_beginning (pass_list.z > 0.5)            // true in the first pass, in which there is no state
#define is_guiding (pass_list.z > 1.5)              // true in the passes that write what pixels show, for the filter
#define guides_before int(pass_list.z - 1.5)        // number of such passes before
