//! Limits the number of heaps of the C library's allocator and returns their free memory to the system.
//!
//! **Few heaps.** glibc gives threads up to eight heaps per processor, and freed memory stays in its thread's heap:
//! after 300 scenes a third of the resident memory was free but kept. Each heap also reserves 64 MiB of addresses,
//! which count under `ulimit -v`. Threads that share two heaps reuse the freed memory.
//!
//! **Returned memory.** A compiler takes up to 50 MiB. Freed memory that lies below a block in use stays in the heap,
//! so call [`give_back`] after compiling.

#![expect(unsafe_code, reason = "the C library's allocator is set up by C functions")]

/// Two heaps cause little contention, because small blocks come from a cache of each thread.
const HEAPS: libc::c_int = 2;

/// Makes all threads of the process share two heaps. Call it before starting other threads.
pub fn limit_heaps() {
    // SAFETY: the function takes two plain numbers and locks the state that it changes.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, HEAPS) };
}

/// Returns the free memory of all heaps to the system. Takes milliseconds, during which other threads wait for memory.
pub fn give_back() {
    // SAFETY: the function takes a plain number and locks each heap.
    unsafe { libc::malloc_trim(0) };
}

#[cfg(test)]
mod tests {
    use super::give_back;

    fn resident() -> usize {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<usize>().unwrap() / 1024
    }

    #[test]
    fn freed_memory_returns_to_the_system() {
        // glibc takes such small blocks from a heap. The few kept blocks stop the heap from shrinking by itself.
        let blocks: Vec<Vec<u8>> = (0..8_192).map(|_| vec![1; 64 << 10]).collect();
        let full = resident();
        let kept: Vec<Vec<u8>> = blocks.into_iter().step_by(128).collect();
        give_back();
        // Other tests allocate memory meanwhile, but less than the difference.
        let left = resident();
        assert!(full > 512 && left + 256 < full, "{full} MiB, then {left} MiB");
        drop(kept);
    }
}
