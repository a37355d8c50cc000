#include "sim_cuda/import/columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr double largest_id = 0x1p53;
// ParaView writes Points:0 and so on, LAMMPS xu (not wrapped) and c_diameter, robotics px.
constexpr BodyQuantityInfo quantities[quantity_count] = {
    {"id", " particleid bodyid atomid ", "", -largest_id, largest_id},
    {"x", " px posx positionx xu points0 centerx centrex cx coordx ", "m", -limits::max_coordinate,
     limits::max_coordinate},
    {"y", " py posy positiony yu points1 centery centrey cy coordy ", "m", -limits::max_coordinate,
     limits::max_coordinate},
    {"z", " pz posz positionz zu points2 centerz centrez cz coordz ", "m", -limits::max_coordinate,
     limits::max_coordinate},
    {"radius", " r rad radii ", "m", limits::min_radius, limits::max_radius},
    {"diameter", " d diam cdiameter ", "m", limits::min_radius, limits::max_radius},
    {"mass", " m masses ", "kg", limits::min_mass, limits::max_mass},
    {"vx", " velx velocityx velocity0 velocities0 linearvelocityx ", "m/s", -limits::max_speed,
     limits::max_speed},
    {"vy", " vely velocityy velocity1 velocities1 linearvelocityy ", "m/s", -limits::max_speed,
     limits::max_speed},
    {"vz", " velz velocityz velocity2 velocities2 linearvelocityz ", "m/s", -limits::max_speed,
     limits::max_speed},
    {"wx", " omegax angularvelocityx spinx ", "rad/s", -limits::max_spin, limits::max_spin},
    {"wy", " omegay angularvelocityy spiny ", "rad/s", -limits::max_spin, limits::max_spin},
    {"wz", " omegaz angularvelocityz spinz ", "rad/s", -limits::max_spin, limits::max_spin},
    {"qw", " quatw orientationw ", "", -1e9, 1e9},
    {"qx", " quatx orientationx ", "", -1e9, 1e9},
    {"qy", " quaty orientationy ", "", -1e9, 1e9},
    {"qz", " quatz orientationz ", "", -1e9, 1e9},
    {"min_x", " minx xmin lowx xlow xlo ", "m", -limits::max_coordinate, limits::max_coordinate},
    {"min_y", " miny ymin lowy ylow ylo ", "m", -limits::max_coordinate, limits::max_coordinate},
    {"min_z", " minz zmin lowz zlow zlo ", "m", -limits::max_coordinate, limits::max_coordinate},
    {"max_x", " maxx xmax highx xhigh xhi ", "m", -limits::max_coordinate, limits::max_coordinate},
    {"max_y", " maxy ymax highy yhigh yhi ", "m", -limits::max_coordinate, limits::max_coordinate},
    {"max_z", " maxz zmax highz zhigh zhi ", "m", -limits::max_coordinate, limits::max_coordinate}};

std::string body_quantity_names() {
  std::vector<std::string_view> names;
  for (const BodyQuantityInfo& quantity : quantities) names.push_back(quantity.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::optional<BodyQuantity> quantity_named(std::string_view name) {
  const auto* const found = std::ranges::find(quantities, name, &BodyQuantityInfo::name);
  if (found == std::end(quantities)) return std::nullopt;
  return static_cast<BodyQuantity>(found - std::begin(quantities));
}

std::string columns_text(std::span<const std::string> names, std::size_t count) {
  if (names.empty()) return fmt::format("{} columns without names", count);
  std::string text = "the columns ";
  constexpr std::size_t most = 20;
  for (std::size_t k = 0; k < std::min(names.size(), most); ++k)
    text += fmt::format("{}{}", k > 0 ? ", " : "", shown_text(names[k]));
  return text + (names.size() > most ? ", ..." : "");
}

std::optional<std::size_t> column_of(const std::string& column, std::span<const std::string> names,
                                     std::size_t count) {
  if (const auto named = std::ranges::find(names, column); named != names.end())
    return static_cast<std::size_t>(named - names.begin());
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
  if (error != std::errc{} || end != column.data() + column.size() || number < 1 || number > count)
    return std::nullopt;
  return number - 1;
}

}  // namespace

const BodyQuantityInfo& info_of(BodyQuantity quantity) {
  return quantities[static_cast<std::size_t>(quantity)];
}

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if ((c == '[' || c == '(') && !plain.empty()) break;
    if (c >= 'A' && c <= 'Z') plain += static_cast<char>(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

std::optional<BodyQuantity> quantity_of_column(const std::string& column) {
  const std::string plain = plain_name(column);
  if (plain.empty()) return std::nullopt;
  const std::string padded = " " + plain + " ";
  for (std::size_t k = 0; k < quantity_count; ++k)
    if (plain == quantities[k].name || quantities[k].names.find(padded) != std::string_view::npos)
      return static_cast<BodyQuantity>(k);
  return std::nullopt;
}

ColumnMap parse_column_map(std::string_view text, const std::string& whose) {
  ColumnMap map;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view part = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals + 1 == part.size())
      throw InputError(
          fmt::format("{}: {} is not QUANTITY=COLUMN, such as radius=4 or x=pos_x", whose, shown_text(part)));
    const std::optional<BodyQuantity> quantity = quantity_named(part.substr(0, equals));
    if (!quantity)
      throw InputError(fmt::format("{}: unknown quantity {}, expected {}", whose,
                                   shown_text(part.substr(0, equals)), body_quantity_names()));
    if (std::ranges::find(map.columns, *quantity, &std::pair<BodyQuantity, std::string>::first) !=
        map.columns.end())
      throw InputError(fmt::format("{}: {} is given twice, expected once", whose, info_of(*quantity).name));
    map.columns.emplace_back(*quantity, part.substr(equals + 1));
  }
  return map;
}

ColumnChoice choose_columns(const ColumnMap& map, std::span<const std::string> names, std::size_t count,
                            const std::string& place) {
  ColumnChoice choice;
  if (names.empty() && map.columns.empty()) {
    using enum BodyQuantity;
    constexpr BodyQuantity order[] = {x, y, z, radius, vx, vy, vz};
    if (count != 3 && count != 4 && count != 7)
      throw InputError(
          fmt::format("{}: {} columns without names; give their meaning, such as --columns "
                      "x=1,y=2,z=3,radius=4",
                      place, count));
    for (std::size_t k = 0; k < count; ++k) choice[order[k]] = k;
    return choice;
  }
  std::array<bool, quantity_count> is_given{};
  for (const auto& [quantity, column] : map.columns) {
    is_given[static_cast<std::size_t>(quantity)] = true;
    if (column == "none") continue;
    choice[quantity] = column_of(column, names, count);
    if (!choice.has(quantity))
      throw InputError(fmt::format("{}: no column {} for {}; there are {}", place, shown_text(column),
                                   info_of(quantity).name, columns_text(names, count)));
  }
  const ColumnChoice given = choice;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::optional<BodyQuantity> quantity = quantity_of_column(names[k]);
    if (!quantity || is_given[static_cast<std::size_t>(*quantity)]) continue;
    if (std::ranges::find(given.column, std::optional(k)) != given.column.end()) continue;
    if (choice.has(*quantity))
      throw InputError(fmt::format("{}: columns {} and {} can both be {}; choose one with --columns {}=N",
                                   place, *choice[*quantity] + 1, k + 1, info_of(*quantity).name,
                                   info_of(*quantity).name));
    choice[*quantity] = k;
  }
  using enum BodyQuantity;
  const auto require = [&](std::initializer_list<BodyQuantity> all) {
    for (const BodyQuantity quantity : all)
      if (!choice.has(quantity))
        throw InputError(fmt::format("{}: no column {}; there are {}; name it with --columns {}=NAME", place,
                                     info_of(quantity).name, columns_text(names, count),
                                     info_of(quantity).name));
  };
  const std::initializer_list<BodyQuantity> corners{min_x, min_y, min_z, max_x, max_y, max_z};
  if (std::ranges::any_of(corners, [&](BodyQuantity corner) { return choice.has(corner); })) {
    require(corners);
    for (std::size_t k = 0; k < quantity_count; ++k)
      if (const auto quantity = static_cast<BodyQuantity>(k);
          choice.has(quantity) && quantity != id && quantity < min_x)
        throw InputError(fmt::format("{}: columns of boxes and of {}; leave one out with --columns {}=none",
                                     place, info_of(quantity).name, info_of(quantity).name));
    return choice;
  }
  require({x, y});
  if (choice.has(qw) || choice.has(qx) || choice.has(qy) || choice.has(qz)) require({qw, qx, qy, qz});
  if (choice.has(radius)) choice[diameter].reset();
  return choice;
}

std::string unused_columns(const ColumnChoice& choice, std::span<const std::string> names,
                           std::size_t count) {
  std::vector<std::string> unused;
  for (std::size_t k = 0; k < count; ++k)
    if (std::ranges::find(choice.column, std::optional(k)) == choice.column.end())
      unused.push_back(k < names.size() ? shown_text(names[k]) : fmt::to_string(k + 1));
  if (unused.empty()) return "";
  constexpr std::size_t most = 12;
  const std::size_t more = unused.size() > most ? unused.size() - most : 0;
  unused.resize(unused.size() - more);
  return fmt::format("columns not used: {}{}", fmt::join(unused, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace collidoscope
