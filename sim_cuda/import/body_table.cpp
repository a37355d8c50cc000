#include "sim_cuda/import/body_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/outwards.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

template <class Value>
void put_in_order(std::vector<Value>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<Value> ordered(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) ordered[k] = values[order[k]];
  values.swap(ordered);
}

}  // namespace

void take_boxes(std::vector<Aabb> boxes, const std::string& place, BodyTable& table) {
  table.position.clear();
  table.radius.clear();
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const Vector3d min = boxes[k].min.cast<double>(), max = boxes[k].max.cast<double>();
    if (!(std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff()) <= limits::max_coordinate))
      throw InputError(
          fmt::format("{}: box {} is beyond {:g} m of the origin", place, k, limits::max_coordinate));
    table.position.push_back((min + max) / 2);
    table.radius.push_back(std::clamp((max - min).minCoeff() / 2, limits::min_radius, limits::max_radius));
  }
  table.boxes = std::move(boxes);
}

std::string range_fault(const ColumnTarget& target, const std::string& number) {
  const BodyQuantityInfo& info = info_of(target.quantity);
  return fmt::format("{} is no valid {}, expected {:g} to {:g}{}{}", number, info.name,
                     target.low / target.factor, target.high / target.factor, info.unit.empty() ? "" : " ",
                     target.factor == 1 ? info.unit : "");
}

BodyTableBuilder::BodyTableBuilder(const ColumnChoice& choice, std::size_t rows, double scale,
                                   const std::string& place)
    : choice_(choice), scale_(scale), place_(place) {
  if (rows == 0) throw InputError(place + ": no bodies, expected at least one row");
  if (rows > static_cast<std::size_t>(limits::max_bodies))
    throw InputError(fmt::format("{}: {} bodies, expected at most {}", place, rows, limits::max_bodies));
  using enum BodyQuantity;
  // Each position is read, except z without a column.
  table_.position.resize(rows);
  if (!choice.has(z))
    for (Vector3d& position : table_.position) position.z() = 0;
  if (choice.has(radius) || choice.has(diameter)) table_.radius.resize(rows);
  if (choice.has(mass)) table_.mass.resize(rows);
  if (choice.has(vx) || choice.has(vy) || choice.has(vz)) table_.velocity.resize(rows, Vector3d(0, 0, 0));
  if (choice.has(wx) || choice.has(wy) || choice.has(wz))
    table_.angular_velocity.resize(rows, Vector3d(0, 0, 0));
  if (choice.has(qw)) table_.orientation.resize(rows, Quaterniond(1, 0, 0, 0));
  if (choice.has(id)) id_.resize(rows);
  if (choice.has(min_x)) corners_.resize(6 * rows);
}

std::vector<ColumnTarget> BodyTableBuilder::targets(std::size_t count) {
  std::vector<ColumnTarget> all(count);
  for (std::size_t k = 0; k < quantity_count; ++k)
    if (const auto column = choice_.column[k]) all.at(*column) = target_of(static_cast<BodyQuantity>(k));
  return all;
}

ColumnTarget BodyTableBuilder::target_of(BodyQuantity quantity) {
  using enum BodyQuantity;
  ColumnTarget target;
  target.quantity = quantity;
  target.low = info_of(quantity).low;
  target.high = info_of(quantity).high;
  const auto component = [&](auto& values, int k, double factor) {
    target.first = values[0].data() + k;
    target.stride = 3;
    target.factor = factor;
  };
  const auto number = [&](std::vector<double>& values, double factor) {
    target.first = values.data();
    target.factor = factor;
  };
  switch (quantity) {
    case id:
      number(id_, 1);
      break;
    case x:
    case y:
    case z:
      component(table_.position, static_cast<int>(quantity) - static_cast<int>(x), scale_);
      break;
    case radius:
      number(table_.radius, scale_);
      break;
    case diameter:
      number(table_.radius, scale_ / 2);
      break;
    case mass:
      number(table_.mass, 1);
      break;
    case vx:
    case vy:
    case vz:
      component(table_.velocity, static_cast<int>(quantity) - static_cast<int>(vx), scale_);
      break;
    case wx:
    case wy:
    case wz:
      component(table_.angular_velocity, static_cast<int>(quantity) - static_cast<int>(wx), 1);
      break;
    case qw:
    case qx:
    case qy:
    case qz:
      // Eigen stores x, y, z, w.
      target.first =
          table_.orientation[0].coeffs().data() + (static_cast<int>(quantity) + 3 - static_cast<int>(qw)) % 4;
      target.stride = 4;
      break;
    case min_x:
    case min_y:
    case min_z:
    case max_x:
    case max_y:
    case max_z:
      target.first = corners_.data() + (static_cast<int>(quantity) - static_cast<int>(min_x));
      target.stride = 6;
      target.factor = scale_;
      break;
  }
  return target;
}

BodyTable BodyTableBuilder::finish(std::span<const std::string> names, std::size_t count) {
  if (std::string unused = unused_columns(choice_, names, count); !unused.empty())
    table_.notes.push_back(std::move(unused));
  for (std::size_t k = 0; k < table_.orientation.size(); ++k) {
    Quaterniond& q = table_.orientation[k];
    const double largest = q.coeffs().cwiseAbs().maxCoeff();
    if (!(largest > 0))
      throw InputError(fmt::format("{}: row {}: the orientation is 0, expected a quaternion", place_, k + 1));
    q.coeffs() /= largest;  // avoids overflow and underflow of the squares
    q.coeffs() /= std::sqrt(q.squaredNorm());
  }
  const auto out_of_order = [](double a, double b) { return a >= b; };
  if (std::ranges::adjacent_find(id_, out_of_order) != id_.end()) {
    std::vector<std::uint32_t> order(id_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      return id_[a] < id_[b] || (id_[a] == id_[b] && a < b);
    });
    for (std::size_t k = 1; k < order.size(); ++k)
      if (id_[order[k - 1]] == id_[order[k]])
        throw InputError(fmt::format("{}: rows {} and {} have the same id {}, expected different ids", place_,
                                     order[k - 1] + 1, order[k] + 1, id_[order[k]]));
    put_in_order(table_.position, order);
    put_in_order(table_.radius, order);
    put_in_order(table_.mass, order);
    put_in_order(table_.velocity, order);
    put_in_order(table_.angular_velocity, order);
    put_in_order(table_.orientation, order);
    std::vector<double> corners;
    for (const std::uint32_t row : order)
      if (!corners_.empty()) corners.insert(corners.end(), &corners_[6 * row], &corners_[6 * row] + 6);
    corners_.swap(corners);
  }
  if (!corners_.empty()) {
    std::vector<Aabb> boxes(corners_.size() / 6);
    for (std::size_t k = 0; k < boxes.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const double low = corners_[6 * k + static_cast<std::size_t>(axis)],
                     high = corners_[6 * k + 3 + static_cast<std::size_t>(axis)];
        if (low > high)
          throw InputError(fmt::format("{}: box {}: {} from {} to {} has min above max", place_, k,
                                       "xyz"[axis], low, high));
        boxes[k].min[axis] = rounded_outwards(low, -1);
        boxes[k].max[axis] = rounded_outwards(high, 1);
      }
    take_boxes(std::move(boxes), place_, table_);
  }
  return std::move(table_);
}

}  // namespace collidoscope
