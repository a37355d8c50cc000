#include "headless/bench/paper_cells.h"

namespace collidoscope {
namespace {

constexpr std::array<PaperCell, 8> table_1{{{1, 100, 16, 16, 0.2933},
                                            {1, 100, 8, 64, 0.1859},
                                            {1, 500, 16, 16, 5.3388},
                                            {1, 500, 8, 64, 2.8176},
                                            {1, 1000, 16, 16, 21.8844},
                                            {1, 1000, 8, 64, 11.0379},
                                            {1, 5000, 16, 16, 534.405},
                                            {1, 5000, 8, 64, 273.7910}}};

struct PaperTable {
  int table;
  std::int64_t bodies;
  std::array<double, 6> ms;  ///< in the order of paper_shapes
};
constexpr std::array<PaperTable, 13> other_tables{
    {{2, 1000, {0.122720, 0.071584, 0.032768, 0.019296, 0.013248, 0.009472}},
     {2, 5000, {0.535296, 0.266784, 0.145792, 0.085216, 0.052512, 0.024456}},
     {2, 10000, {1.05216, 0.536256, 0.268928, 0.149824, 0.088224, 0.042528}},
     {2, 50000, {6.19203, 3.09773, 1.57142, 0.795168, 0.408704, 0.218240}},
     {3, 10000, {22.83467, 13.57422, 9.623959, 6.859251, 4.478128, 3.148109}},
     {4, 1000, {1.02256, 0.600480, 0.383522, 0.195681, 0.136486, 0.103849}},
     {4, 5000, {4.88496, 2.50912, 1.40656, 0.738243, 0.456867, 0.240884}},
     {4, 10000, {9.46384, 4.87392, 2.59872, 1.41523, 0.775528, 0.457289}},
     {4, 50000, {56.4363, 28.3112, 14.5653, 7.55952, 4.01712, 2.16896}},
     {5, 1000, {1.14528, 0.672064, 0.41629, 0.214977, 0.149734, 0.113321}},
     {5, 5000, {5.420256, 2.775904, 1.552352, 0.823459, 0.509379, 0.26534}},
     {5, 10000, {10.516, 5.410176, 2.867648, 1.565054, 0.863752, 0.499817}},
     {5, 50000, {62.62833, 31.40893, 16.13672, 8.354688, 4.425824, 2.3872}}}};

}  // namespace

std::vector<PaperCell> paper_cells() {
  std::vector<PaperCell> all(table_1.begin(), table_1.end());
  for (const PaperTable& row : other_tables)
    for (std::size_t k = 0; k < paper_shapes.size(); ++k)
      all.push_back({row.table, row.bodies, paper_shapes[k][0], paper_shapes[k][1], row.ms[k]});
  return all;
}

const char* paper_table_title(int table) {
  constexpr std::array names{"",
                             "Table 1: brute force over all pairs",
                             "Table 2: dynamics forwarding",
                             "Table 3: collision handling, tree built top-down from a work queue",
                             "Table 4: collision handling, tree built bottom-up",
                             "Table 5: forwarding and collision handling, tree built bottom-up"};
  return names[static_cast<std::size_t>(table)];
}

}  // namespace collidoscope
