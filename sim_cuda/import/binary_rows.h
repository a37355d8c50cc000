#pragma once
// Stores binary numbers of a file in the targets of its columns, with several threads.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/import/input_file.h"

namespace collidoscope {

/// `number(row, column)` is a number of the file, converted to double. Throws InputError for the first number
/// that is out of range: `place: row 3, column 2: problem`, counted from 1.
template <class NumberAt>
void store_rows(std::size_t rows, const std::vector<ColumnTarget>& targets, const std::string& place,
                const NumberAt& number) {
  std::atomic<std::size_t> first_fault = rows * targets.size();
  on_all_cores(rows, std::size_t{1} << 16, [&](std::size_t first, std::size_t last) {
    std::size_t fault = rows * targets.size();
    for (std::size_t row = first; row < last; ++row)
      for (std::size_t column = 0; column < targets.size(); ++column)
        if (targets[column].first != nullptr && !targets[column].store(row, number(row, column)))
          fault = std::min(fault, row * targets.size() + column);
    for (std::size_t known = first_fault;
         fault < known && !first_fault.compare_exchange_weak(known, fault);) {
    }
  });
  if (first_fault == rows * targets.size()) return;
  const std::size_t row = first_fault / targets.size(), column = first_fault % targets.size();
  throw InputError(fmt::format("{}: row {}, column {}: {}", place, row + 1, column + 1,
                               range_fault(targets[column], fmt::to_string(number(row, column)))));
}

}  // namespace collidoscope
