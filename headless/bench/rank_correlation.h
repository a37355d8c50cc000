#pragma once
// Spearman's rank correlation: whether what ranks high by one quantity does by the other.

#include <vector>

namespace collidoscope {

/// Ranks from 1; equal values share the mean of theirs.
std::vector<double> ranks_of(const std::vector<double>& values);

/// -1 to 1 (Pearson's correlation of the ranks); 0 where either has fewer than two different values. Both are
/// equally long.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace collidoscope
