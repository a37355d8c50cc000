#pragma once
// The texts of a legend: title and ends of its colour bar. Free functions.

#include <string>

#include "sim_cuda/publish/legend.h"

namespace collidoscope {

/// "speed · m/s", "visits · log".
std::string title_text(const Legend& legend);
/// The ends: "0" and "≥ 38".
std::string low_text(const Legend& legend);
std::string high_text(const Legend& legend);

}  // namespace collidoscope
