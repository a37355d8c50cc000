#pragma once
// What the device knows and the host reads late: counts, whether a capacity was too small, how far the run
// has come.

#include <cstdint>

namespace collidoscope {

/// One record in the executor's memory. Once `overflow` is set, every pipeline run queued behind does
/// nothing, until the host has grown what was too small; so nothing is ever dropped, and the first run not
/// committed is simply done again.
struct StepControl {
  std::uint32_t overflow;      ///< sticky: 1 once a capacity was exceeded
  std::uint32_t committed;     ///< pipeline runs whose result is in the state
  std::uint64_t pairs_needed;  ///< by the last run that counted them, whether they fitted or not
  std::uint64_t contacts_needed;
  std::uint32_t pairs;  ///< stored; 0 after an overflow, so that all later stages are empty
  std::uint32_t contacts;
  std::uint32_t uncoloured_contacts;                                        ///< contacts beyond the colours
  std::uint32_t pairs_committed, contacts_committed, uncoloured_committed;  ///< of the last committed run
};

}  // namespace collidoscope
