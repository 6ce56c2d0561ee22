//! Works within a limited address space, as under `ulimit -v` or in some containers.

#![expect(unsafe_code, reason = "the C library's allocator is set up by a C function")]

/// Makes all threads share few of the C library's heaps if the process's address space is limited.
///
/// Otherwise each thread, and a driver has many, reserves 64 MiB for a heap of its own, of which it uses little: a
/// show that needs 0.5 GiB then crashes inside a driver although it may reserve 1 GiB.
pub fn spare_where_limited() {
    if is_limited(&std::fs::read_to_string("/proc/self/limits").unwrap_or_default()) {
        /// Enough that threads seldom wait for each other.
        const HEAPS: libc::c_int = 2;
        // SAFETY: two plain numbers; the function locks what it changes.
        unsafe { libc::mallopt(libc::M_ARENA_MAX, HEAPS) };
    }
}

/// Whether `limits`, in the kernel's format, contain one for the address space.
fn is_limited(limits: &str) -> bool {
    let row = limits.lines().find_map(|line| line.strip_prefix("Max address space"));
    row.and_then(|row| row.split_whitespace().next()).is_some_and(|soft| soft != "unlimited")
}

#[cfg(test)]
mod tests {
    use super::is_limited;

    #[test]
    fn the_address_space_is_limited_where_the_kernel_tells_a_number() {
        let limits = |soft: &str| {
            format!(
                "Limit  Soft Limit  Hard Limit  Units\nMax cpu time  7  7  seconds\nMax address space  {soft}  unlimited  bytes\n"
            )
        };
        assert!(is_limited(&limits("1073741824")));
        assert!(!is_limited(&limits("unlimited")));
        assert!(!is_limited(""));
    }
}
