#pragma once
// Small dense linear systems with several right sides: Gaussian elimination with row exchange, and a fixed
// order of operations.

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Solves A X = C in place: `matrix` is A (size x size), `right` is C and then X (size x columns), both with
/// rows of constant length. Returns false if A is singular or not finite; then `right` is undefined.
template <int max_size, int max_columns>
SIM_HD bool solve_dense(double (&matrix)[max_size][max_size], double (&right)[max_size][max_columns],
                        int size, int columns) {
  const auto magnitude = [](double value) { return value < 0 ? -value : value; };
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int i = k + 1; i < size; ++i)
      if (magnitude(matrix[i][k]) > magnitude(matrix[pivot][k])) pivot = i;
    const double largest = magnitude(matrix[pivot][k]);
    if (!(largest > 0 && largest <= 1e300)) return false;
    if (pivot != k) {
      for (int j = k; j < size; ++j) {
        const double other = matrix[k][j];
        matrix[k][j] = matrix[pivot][j];
        matrix[pivot][j] = other;
      }
      for (int j = 0; j < columns; ++j) {
        const double other = right[k][j];
        right[k][j] = right[pivot][j];
        right[pivot][j] = other;
      }
    }
    const double inverse = 1 / matrix[k][k];
    for (int i = k + 1; i < size; ++i) {
      const double factor = matrix[i][k] * inverse;
      if (factor == 0) continue;
      for (int j = k + 1; j < size; ++j) matrix[i][j] -= factor * matrix[k][j];
      for (int j = 0; j < columns; ++j) right[i][j] -= factor * right[k][j];
    }
    for (int j = k + 1; j < size; ++j) matrix[k][j] *= inverse;
    for (int j = 0; j < columns; ++j) right[k][j] *= inverse;
  }
  for (int k = size - 1; k > 0; --k)
    for (int i = 0; i < k; ++i) {
      const double factor = matrix[i][k];
      if (factor == 0) continue;
      for (int j = 0; j < columns; ++j) right[i][j] -= factor * right[k][j];
    }
  return true;
}

}  // namespace collidoscope
