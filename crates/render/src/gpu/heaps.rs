//! The heaps of the C library's allocator: few of them, and their free memory returns to the system.
//!
//! **Few heaps.** glibc gives each of the first threads its own heap, up to eight for each processor. A driver and the show
//! have some forty threads, and freed memory stays in the heap of its thread: after 300 scenes a third of the resident
//! memory was free but kept. Threads that share two heaps reuse it. Each heap also reserves 64 MiB of addresses, which
//! counts under `ulimit -v` and in some containers.
//!
//! **Free memory returns.** A compiler takes up to 50 MiB for a long program. Blocks that live longer keep its pages from
//! returning when it frees them, so [`give_back`] follows each compilation.

#![expect(unsafe_code, reason = "the C library's allocator is set up by C functions")]

/// Enough that threads seldom wait for each other: small blocks come from a cache of each thread.
const HEAPS: libc::c_int = 2;

/// Makes all threads of the process share few heaps. To be called before there are other threads.
pub fn fraction() {
    // SAFETY: two plain numbers; the function locks what it changes.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, HEAPS) };
}

/// Returns the free memory of all heaps to the system. Takes milliseconds, in which other threads wait for memory.
pub fn give_back() {
    // SAFETY: a plain number; the function locks each heap.
    unsafe { libc::malloc_trim(0) };
}

#[cfg(test)]
mod tests {
    use super::give_back;

    /// The resident memory of this process in MiB.
    fn resident() -> usize {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<usize>().unwrap() / 1024
    }

    #[test]
    fn memory_that_compilers_freed_stayed_with_the_process() {
        // Smaller blocks than glibc takes from the system one by one. A few that live longer hold the heap open.
        let blocks: Vec<Vec<u8>> = (0..8_192).map(|_| vec![1; 64 << 10]).collect();
        let full = resident();
        let kept: Vec<Vec<u8>> = blocks.into_iter().step_by(128).collect();
        give_back();
        // Other tests take memory meanwhile, but not that much.
        let left = resident();
        assert!(full > 512 && left + 256 < full, "{full} MiB, then {left} MiB");
        drop(kept);
    }
}
