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

/// `block_of(first, count)` returns number(row, column) for `count` rows from `first` on: numbers of the
/// file, converted to double. Throws InputError for the first number that is out of range: `place: row 3,
/// column 2: problem`, counted from 1.
template <class BlockOf>
void store_blocks(std::size_t rows, std::size_t block_rows, const std::vector<ColumnTarget>& targets,
                  const std::string& place, const BlockOf& block_of) {
  const std::size_t columns = targets.size();
  std::atomic<std::size_t> first_fault = rows * columns;
  on_all_cores(rows, std::size_t{1} << 16, [&](std::size_t first, std::size_t last) {
    std::size_t fault = rows * columns;
    for (std::size_t begin = first; begin < last; begin += block_rows) {
      const std::size_t end = std::min(last, begin + block_rows);
      const auto number = block_of(begin, end - begin);
      for (std::size_t row = begin; row < end; ++row)
        for (std::size_t column = 0; column < columns; ++column)
          if (targets[column].first != nullptr && !targets[column].store(row, number(row, column)))
            fault = std::min(fault, row * columns + column);
    }
    for (std::size_t known = first_fault;
         fault < known && !first_fault.compare_exchange_weak(known, fault);) {
    }
  });
  if (first_fault == rows * columns) return;
  const std::size_t row = first_fault / columns, column = first_fault % columns;
  throw InputError(fmt::format("{}: row {}, column {}: {}", place, row + 1, column + 1,
                               range_fault(targets[column], fmt::to_string(block_of(row, 1)(row, column)))));
}

/// The same for numbers in memory.
template <class NumberAt>
void store_rows(std::size_t rows, const std::vector<ColumnTarget>& targets, const std::string& place,
                const NumberAt& number) {
  store_blocks(rows, std::max<std::size_t>(rows, 1), targets, place,
               [&](std::size_t, std::size_t) -> const NumberAt& { return number; });
}

}  // namespace collidoscope
