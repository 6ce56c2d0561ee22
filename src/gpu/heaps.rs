//! The heaps of the C library's allocator.
//!
//! glibc gives each of the first threads a heap of its own, up to eight for each processor. A driver and the show have some
//! forty threads, and what one of them frees stays in its heap: after 300 scenes a third of the resident memory was free
//! but kept, and it grew with everything that a thread had ever held at once. In two heaps other threads use it again.
//! Each heap also reserves 64 MiB of addresses, which counts under `ulimit -v` and in some containers.

#![expect(unsafe_code, reason = "the C library's allocator is set up by a C function")]

/// Enough that threads seldom wait for each other: small blocks come from a cache of each thread.
const HEAPS: libc::c_int = 2;

/// Makes all threads of the process share few heaps. To be called before there are other threads.
pub fn share() {
    // SAFETY: two plain numbers; the function locks what it changes.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, HEAPS) };
}
