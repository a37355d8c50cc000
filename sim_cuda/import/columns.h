#pragma once
// Meaning of the columns of a table of bodies: by their names, or as the user says.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace collidoscope {

/// A number of a body. qw, qx, qy, qz: orientation. min_x to max_z: corners of a box, instead of a body.
enum class BodyQuantity {
  id,
  x,
  y,
  z,
  radius,
  diameter,
  mass,
  vx,
  vy,
  vz,
  wx,
  wy,
  wz,
  qw,
  qx,
  qy,
  qz,
  min_x,
  min_y,
  min_z,
  max_x,
  max_y,
  max_z
};
inline constexpr std::size_t quantity_count = 23;

struct BodyQuantityInfo {
  std::string_view name;  ///< in --columns
  std::string_view
      names;  ///< other names of columns, each between spaces; lower case, letters and digits only
  std::string_view unit;
  double low, high;  ///< closed range in SI units
};
const BodyQuantityInfo& info_of(BodyQuantity quantity);

/// The user's names of columns. A column is a name as in the file, or a number from 1, or "none".
struct ColumnMap {
  std::vector<std::pair<BodyQuantity, std::string>> columns;
};
/// Reads "x=px,y=py,radius=4". `whose` begins the lines of errors. Throws InputError.
ColumnMap parse_column_map(std::string_view text, const std::string& whose);

/// For each quantity the index of its column, from 0.
struct ColumnChoice {
  std::array<std::optional<std::size_t>, quantity_count> column;
  bool has(BodyQuantity quantity) const { return column[static_cast<std::size_t>(quantity)].has_value(); }
  std::optional<std::size_t>& operator[](BodyQuantity quantity) {
    return column[static_cast<std::size_t>(quantity)];
  }
};

/// Chooses the columns. `names`: those in the file, or empty; columns without names are x, y, z; or x, y, z,
/// radius; or x, y, z, radius, vx, vy, vz, by their number. `count`: number of columns. x and y are required;
/// z is 0 without a column. Or all corners of boxes, and no position. `place` begins the lines of errors.
/// Throws InputError.
ColumnChoice choose_columns(const ColumnMap& map, std::span<const std::string> names, std::size_t count,
                            const std::string& place);

/// A name in lower-case letters and digits, without a unit: "Pos_X [m]" is "posx".
std::string plain_name(std::string_view name);
/// The quantity of a column of this name.
std::optional<BodyQuantity> quantity_of_column(const std::string& column);

/// "columns not used: type, fx", or empty.
std::string unused_columns(const ColumnChoice& choice, std::span<const std::string> names, std::size_t count);

}  // namespace collidoscope
