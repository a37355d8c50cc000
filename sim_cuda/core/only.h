#pragma once
// A member that is there where an effect is on. Elsewhere it takes no room (declare it
// [[no_unique_address]]), so that what a stage is given is the same as if the effect had never been written;
// and code that reads it does not compile.
//
// It may not be the last member: of a struct that ends in an absent one, the kernels that nvcc 13.0 makes
// expect another layout than the host and their own sizeof give it.

#include <type_traits>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Takes what the member would have been given, and forgets it. One type for each `T`: two empty members of
/// one type would need an address each.
template <class T>
struct Absent {
  Absent() = default;
  SIM_HD constexpr Absent(const T&) {}
};

template <bool on, class T>
using Only = std::conditional_t<on, T, Absent<T>>;

}  // namespace collidoscope
