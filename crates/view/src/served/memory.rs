//! Memory that a picture took goes back to the system.
//!
//! The allocator of the GNU C library keeps what was freed, for each of many threads, of which a server has new ones all the time:
//! after seven minutes of random use by four pages, 273 MB of which 67 were in use. Other allocators are left as they are.
#![cfg_attr(all(target_os = "linux", target_env = "gnu"), expect(unsafe_code, reason = "calls of the C library"))]

/// So many heaps at most, whatever the number of threads: what is in pieces in one of them is of use to the others.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const HEAPS: std::ffi::c_int = 2;
/// What is larger goes back as soon as it is free, bytes: planes of a picture of 1920 pixels are, those of 480 are not.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: std::ffi::c_int = 4 << 20;

#[cfg(all(target_os = "linux", target_env = "gnu"))]
unsafe extern "C" {
    /// malloc_trim(3): `pad` bytes at the top of the heap are kept.
    fn malloc_trim(pad: usize) -> std::ffi::c_int;
    /// mallopt(3).
    fn mallopt(parameter: std::ffi::c_int, value: std::ffi::c_int) -> std::ffi::c_int;
}

/// Makes this process one that keeps little for later: to be called before it has many threads.
pub(super) fn keep_little() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        // Numbers of `malloc.h`.
        const M_MMAP_THRESHOLD: std::ffi::c_int = -3;
        const M_ARENA_MAX: std::ffi::c_int = -8;
        for (parameter, value) in [(M_ARENA_MAX, HEAPS), (M_MMAP_THRESHOLD, LARGE)] {
            // SAFETY: it takes no pointer; what was asked for before stays as it is.
            unsafe { mallopt(parameter, value) };
        }
    }
}

/// Hands what is free back to the system.
pub(super) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: it takes no pointer, and may be called by any thread at any time (MT-Safe).
    unsafe {
        malloc_trim(0)
    };
}
