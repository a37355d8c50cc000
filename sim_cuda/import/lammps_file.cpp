#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/frame_text.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

/// The simulation box of LAMMPS: origin and three edges. Scaled coordinates count along the edges.
struct LammpsBox {
  Vector3d origin{0, 0, 0}, a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
};

struct LammpsFrame : FrameRows {
  LammpsBox box;
};

LammpsBox read_lammps_box(LineReader& lines, std::string_view header) {
  const bool general = header.find("abc origin") != std::string_view::npos;
  const bool tilted = header.find("xy xz yz") != std::string_view::npos;
  double number[3][4] = {};
  for (auto& row : number) {
    const std::vector<std::string_view> fields = fields_of(lines.next("the bounds of the box"), ' ');
    const std::size_t count = general ? 4 : tilted ? 3 : 2;
    bool good = fields.size() >= count;
    for (std::size_t k = 0; good && k < count; ++k)
      good = is_number(fields[k], row[k]) && std::isfinite(row[k]);
    if (!good) lines.fail("damaged bounds of the box", fmt::format("{} numbers", count));
  }
  LammpsBox box;
  if (general) {  // an edge and a component of the origin in each line
    box.a = Vector3d(number[0][0], number[0][1], number[0][2]);
    box.b = Vector3d(number[1][0], number[1][1], number[1][2]);
    box.c = Vector3d(number[2][0], number[2][1], number[2][2]);
    box.origin = Vector3d(number[0][3], number[1][3], number[2][3]);
    return box;
  }
  // The bounds contain the whole tilted box; the box itself is smaller.
  const double xy = number[0][2], xz = number[1][2], yz = number[2][2];
  const double low_x = number[0][0] - std::min({0.0, xy, xz, xy + xz}),
               low_y = number[1][0] - std::min(0.0, yz);
  const double high_x = number[0][1] - std::max({0.0, xy, xz, xy + xz}),
               high_y = number[1][1] - std::max(0.0, yz);
  box.origin = Vector3d(low_x, low_y, number[2][0]);
  box.a = Vector3d(high_x - low_x, 0, 0);
  box.b = Vector3d(xy, high_y - low_y, 0);
  box.c = Vector3d(xz, yz, number[2][1] - number[2][0]);
  return box;
}

/// Reads the header of a frame up to its rows.
LammpsFrame read_lammps_header(LineReader& lines) {
  LammpsFrame frame;
  std::optional<std::size_t> count;
  while (true) {
    const std::string_view line = trimmed(lines.next("ITEM: ATOMS"));
    if (line.starts_with("ITEM: NUMBER OF ATOMS")) {
      count = lines.whole(lines.next("the number of atoms"), static_cast<std::size_t>(limits::max_bodies),
                          "number of atoms");
    } else if (line.starts_with("ITEM: BOX BOUNDS")) {
      frame.box = read_lammps_box(lines, line);
    } else if (line.starts_with("ITEM: ATOMS")) {
      if (!count) lines.fail("atoms without their number", "ITEM: NUMBER OF ATOMS before");
      for (const std::string_view name : fields_of(line.substr(std::string_view("ITEM: ATOMS").size()), ' '))
        frame.names.emplace_back(name);
      if (frame.names.empty()) lines.fail("no names of columns", "ITEM: ATOMS id x y z");
      frame.count = *count;
      return frame;
    } else if (line.starts_with("ITEM: TIMESTEP") || line.starts_with("ITEM: UNITS") ||
               line.starts_with("ITEM: TIME")) {
      lines.next("its value");
    } else {
      lines.fail("unknown line", "a line that begins with ITEM:");
    }
  }
}

bool has_name(const std::vector<std::string>& names, const char* name) {
  return std::ranges::find(names, name) != names.end();
}

/// Renames scaled coordinates to x, y, z if there are no others. Returns whether they are scaled.
bool use_scaled(std::vector<std::string>& names) {
  if (has_name(names, "x") || has_name(names, "xu")) return false;
  bool scaled = false;
  for (const char* const suffix : {"su", "s"})
    for (int k = 0; k < 3; ++k) {
      const std::string own(1, "xyz"[k]);
      const auto found = std::ranges::find(names, own + suffix);
      if (found == names.end() || has_name(names, own.c_str())) continue;
      *found = own;
      scaled = true;
    }
  return scaled;
}

/// Converts scaled coordinates.
void place_in_box(const std::string& file, const LammpsBox& box, double scale,
                  std::vector<Vector3d>& positions) {
  std::size_t outside = 0;
  for (Vector3d& x : positions) {
    const Vector3d own = x / scale;
    x = scale * (box.origin + own.x() * box.a + own.y() * box.b + own.z() * box.c);
    outside += x.cwiseAbs().maxCoeff() <= limits::max_coordinate ? 0 : 1;
  }
  if (outside > 0)
    throw InputError(fmt::format("{}: {} atoms are farther than {:g} m from the origin, expected none", file,
                                 outside, limits::max_coordinate));
}

}  // namespace

std::vector<BodyTable> read_lammps_frames(const std::string& name, const TableOptions& options,
                                          std::int64_t most) {
  const InputFile file(name, "a LAMMPS dump");
  const FileText contents(file);
  BodyTable notes;
  std::vector<BodyTable> tables;
  for (LammpsFrame& frame :
       find_frames(name, contents.text(), options.frame, most, read_lammps_header, notes)) {
    const bool scaled = use_scaled(frame.names);
    BodyTable& bodies = tables.emplace_back(read_frame(name, frame, options, notes));
    if (scaled) place_in_box(name, frame.box, options.scale, bodies.position);
  }
  return tables;
}

}  // namespace collidoscope
