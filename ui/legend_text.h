#pragma once
// Texts of a legend: title and ends of the colour bar. Free functions.

#include <string>

#include "sim_cuda/publish/legend.h"

namespace collidoscope {

/// Title with unit and scale: "speed · m/s", "visits · log".
std::string title_text(const Legend& legend);
/// Texts at the ends of the bar: "0" and "≥ 38".
std::string low_text(const Legend& legend);
std::string high_text(const Legend& legend);

}  // namespace collidoscope
