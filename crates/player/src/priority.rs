//! The priority of threads that work ahead.

/// Lowers the priority of the calling thread: 0 is normal, 19 the lowest. Without effect where the system offers no
/// priorities.
#[cfg(target_os = "linux")]
pub fn lower_priority(niceness: i32) {
    if let Err(error) = rustix::process::setpriority_process(None, niceness) {
        tracing::debug!("the priority of a thread cannot be changed: {error}");
    }
}

/// Lowers the priority of the calling thread: 0 is normal, 19 the lowest. Without effect where the system offers no
/// priorities.
#[cfg(not(target_os = "linux"))]
pub fn lower_priority(_: i32) {}
