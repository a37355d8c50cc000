#pragma once
// Spearman's rank correlation of two quantities. Stateless.

#include <vector>

namespace collidoscope {

/// Ranks from 1. Equal values share the mean of their ranks.
std::vector<double> ranks_of(const std::vector<double>& values);

/// The correlation, -1 to 1 (Pearson's correlation of the ranks). 0 if either argument has fewer than two
/// different values. Both must have the same length.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace collidoscope
