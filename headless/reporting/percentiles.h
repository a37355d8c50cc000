#pragma once
// What many samples of one quantity say: the form in which every suite gives its results. Plain data.

#include <vector>

namespace collidoscope {

/// The middle, and what a twentieth of the samples lie below and above; all 0 of nothing. In the samples'
/// unit.
struct Percentiles {
  double median = 0, p5 = 0, p95 = 0;
};

Percentiles percentiles_of(const std::vector<float>& samples);

}  // namespace collidoscope
