#pragma once
// Bodies of a foreign file as plain numbers in SI units, and the conversion of columns to them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/import/columns.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {

/// A row for each body, ordered by id if the file has ids. Arrays other than `position` are empty if the file
/// does not have the quantity.
struct BodyTable {
  std::vector<Vector3d> position;          ///< m
  std::vector<double> radius;              ///< m
  std::vector<double> mass;                ///< kg
  std::vector<Vector3d> velocity;          ///< m/s
  std::vector<Vector3d> angular_velocity;  ///< rad/s
  std::vector<Quaterniond> orientation;    ///< unit length
  std::vector<Aabb> boxes;                 ///< m; of a file of boxes
  std::vector<std::string> notes;          ///< what was not taken from the file
  std::int64_t frames = 1;                 ///< in the file

  std::size_t size() const { return position.size(); }
};

/// Fills boxes, and with spheres within the boxes, at their centres, positions and radii. Throws InputError
/// for a box beyond limits::max_coordinate; `place` begins the line.
void take_boxes(std::vector<Aabb> boxes, const std::string& place, BodyTable& table);

/// Where the numbers of a column go.
struct ColumnTarget {
  double* first = nullptr;   ///< null: the column is not used
  std::size_t stride = 1;    ///< in doubles, from row to row
  double factor = 1;         ///< to SI units
  double low = 0, high = 0;  ///< after the factor
  BodyQuantity quantity = BodyQuantity::x;

  /// Stores a number of the file. A value below the normal floats becomes 0. Returns whether it is in the
  /// quantity's range.
  bool store(std::size_t row, double number) const {
    const double value = number * factor;
    first[row * stride] = value < limits::smallest_normal && value > -limits::smallest_normal ? 0 : value;
    return value >= low && value <= high;
  }
};
/// "nan is no valid radius, expected 1e-09 to 1e+09 m".
std::string range_fault(const ColumnTarget& target, const std::string& number);

/// Takes the rows of a file column by column. Use: targets(), fill all rows, finish().
class BodyTableBuilder {
 public:
  /// `scale`: m per unit of length in the file. Throws InputError if there are too many rows, or none;
  /// `place` begins the line.
  BodyTableBuilder(const ColumnChoice& choice, std::size_t rows, double scale, const std::string& place);
  /// The target of each of `count` columns.
  std::vector<ColumnTarget> targets(std::size_t count);
  /// Orders by id and normalises orientations. `names` and `count`: as in choose_columns(); columns that are
  /// not used become a note. Throws InputError for an id that appears twice, or an orientation that is zero.
  BodyTable finish(std::span<const std::string> names, std::size_t count);

 private:
  ColumnTarget target_of(BodyQuantity quantity);

  ColumnChoice choice_;
  double scale_;
  std::string place_;
  std::vector<double> id_;
  std::vector<double> corners_;  ///< six for each box
  BodyTable table_;
};

}  // namespace collidoscope
