#pragma once
// How much memory the host has left.

#include <cstdint>

namespace collidoscope {

/// Bytes that this process may take without pushing others out: what the kernel calls available, within the
/// limits of the control groups it runs in. Where neither says: the greatest number.
std::int64_t free_host_bytes();

/// Bytes of memory that this process occupies now; 0 where the system does not say.
std::int64_t resident_host_bytes();

}  // namespace collidoscope
