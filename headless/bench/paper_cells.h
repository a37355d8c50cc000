#pragma once
// Published figures of the paper: all cells of Tables 1 to 5, measured on an NVIDIA GTX 940M (384 shading
// units, 1,072 MHz) with CUDA 8.0. Plain data.

#include <array>
#include <cstdint>
#include <vector>

namespace collidoscope {

struct PaperCell {
  int table;
  std::int64_t bodies;
  int blocks, threads;
  double paper_ms;
};

/// (B, T) of Tables 2 to 5.
inline constexpr std::array<std::array<int, 2>, 6> paper_shapes{
    {{2, 4}, {4, 4}, {4, 8}, {8, 8}, {8, 16}, {16, 16}}};

std::vector<PaperCell> paper_cells();
const char* paper_table_title(int table);

}  // namespace collidoscope
