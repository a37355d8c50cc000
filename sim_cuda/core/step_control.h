#pragma once
// Data that the device writes and the host reads with delay: counts, overflow of capacities, and progress of
// the run.

#include <cstdint>

namespace collidoscope {

/// One record in the executor's memory. Once `overflow` is set, all queued pipeline runs have no effect until
/// the host has grown the buffers. No result is lost: the first uncommitted run is repeated.
struct StepControl {
  std::uint32_t overflow;      ///< sticky: 1 after a capacity was exceeded
  std::uint32_t committed;     ///< number of pipeline runs committed to the state
  std::uint64_t pairs_needed;  ///< count of the last run, whether or not the pairs fitted
  std::uint64_t contacts_needed;
  std::uint32_t pairs;  ///< stored pairs; 0 after an overflow, so that all later stages are empty
  std::uint32_t contacts;
  std::uint32_t uncoloured_contacts;  ///< contacts beyond the last colour
  std::uint32_t bounce_caps;  ///< substeps of this run in which impacts needed more sweeps than allowed
  std::uint32_t pairs_committed, contacts_committed, uncoloured_committed,
      bounce_caps_committed;   ///< of the last committed run
  std::uint64_t hash_sums[2];  ///< of the state after the last run; see StateHashes. 0 if not computed
};

}  // namespace collidoscope
