#pragma once
// Free and used memory of the host, in bytes.

#include <cstdint>

namespace collidoscope {

/// Memory that this process can allocate without swapping: the kernel's MemAvailable, limited by the control
/// groups of the process. Returns the largest number if neither is known.
std::int64_t free_host_bytes();

/// Resident memory of this process; 0 if the system does not report it.
std::int64_t resident_host_bytes();

}  // namespace collidoscope
