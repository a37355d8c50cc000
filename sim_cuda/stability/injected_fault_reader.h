#pragma once
// Reads the injected states and faults of a criterion.

#include "sim_cuda/stability/criterion_context.h"

namespace collidoscope {

/// Reads "inject", the state that the guards must detect.
void read_injected_state(CriterionContext& context, const JsonNode& node);
/// Reads one of "injected_faults". The assertions must already be read.
void read_injected_fault(CriterionContext& context, const JsonNode& node);

}  // namespace collidoscope
