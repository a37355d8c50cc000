#include "sim_cuda/import/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {
namespace {

BodyTable read_table(const std::string& file, FileFormat format, const TableOptions& options) {
  switch (format) {
    case FileFormat::npy:
      return read_npy_bodies(file, options);
    case FileFormat::npz:
      return read_npz_bodies(file, options);
    case FileFormat::csv:
      return read_csv_bodies(file, options);
    case FileFormat::xyz:
      return std::move(read_xyz_frames(file, options, 1)[0]);
    case FileFormat::lammps:
      return std::move(read_lammps_frames(file, options, 1)[0]);
    case FileFormat::ply:
      return read_ply_bodies(file, options);
    default:
      throw InputError(fmt::format("{}: {}, expected bodies as NPY, NPZ, CSV, XYZ, LAMMPS dump or PLY", file,
                                   description_of(format)));
  }
}

void require_bodies(const std::string& file, const BodyTable& table, const BodyTable& first) {
  if (table.size() != first.size())
    throw InputError(
        fmt::format("{}: {} bodies, expected {} as in the first frame", file, table.size(), first.size()));
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Order of names whose numbers count as numbers: a2 is before a10.
bool is_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (is_digit(a[0]) && is_digit(b[0])) {
      const auto number = [](std::string_view& text) {
        text.remove_prefix(std::min(text.find_first_not_of('0'), text.size()));
        std::size_t digits = 0;
        while (digits < text.size() && is_digit(text[digits])) ++digits;
        const std::string_view found = text.substr(0, digits);
        text.remove_prefix(digits);
        return found;
      };
      const std::string_view left = number(a), right = number(b);
      if (left.size() != right.size()) return left.size() < right.size();
      if (left != right) return left < right;
      continue;
    }
    if (a[0] != b[0]) return a[0] < b[0];
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  return a.empty() && !b.empty();
}

}  // namespace

std::vector<BodyTable> read_body_frames(const std::string& file, FileFormat format,
                                        const TableOptions& options) {
  constexpr std::int64_t all = std::numeric_limits<std::int64_t>::max();
  return with_allocation_context("reading frames of bodies", [&] {
    std::vector<BodyTable> frames;
    if (format == FileFormat::xyz)
      frames = read_xyz_frames(file, options, all);
    else if (format == FileFormat::lammps)
      frames = read_lammps_frames(file, options, all);
    else
      frames.push_back(read_body_table(file, format, options));
    for (const BodyTable& frame : frames) require_bodies(file, frame, frames[0]);
    return frames;
  });
}

void sort_by_numbers(std::vector<std::string>& files) { std::ranges::stable_sort(files, is_before); }

std::vector<BodyTable> read_body_series(const std::vector<std::string>& files, const TableOptions& options) {
  std::vector<BodyTable> frames;
  for (const std::string& file : files) {
    frames.push_back(read_body_table(file, format_of(file), options));
    require_bodies(file, frames.back(), frames[0]);
  }
  return frames;
}

BodyTable read_body_table(const std::string& file, FileFormat format, const TableOptions& options) {
  return with_allocation_context("reading bodies", [&] {
    BodyTable bodies = read_table(file, format, options);
    if (options.frame >= bodies.frames)
      throw InputError(
          fmt::format("{}: no frame {}; it has {}, counted from 0", file, options.frame, bodies.frames));
    return bodies;
  });
}

TablePreview preview_body_table(const std::string& file, FileFormat format, std::int64_t frame) {
  return with_allocation_context("reading the columns of a file", [&] {
    TablePreview preview;
    TableOptions options;
    options.frame = frame;
    options.preview = &preview;
    read_table(file, format, options);
    return preview;
  });
}

std::string preview_number(double number) { return fmt::format("{:.6g}", number); }

void preview_text(TablePreview& preview, std::span<const std::string> names, std::size_t columns,
                  std::string_view rows, char separator, bool comments) {
  preview.names.assign(names.begin(), names.end());
  preview.columns = columns;
  while (!rows.empty() && preview.rows.size() < TablePreview::most_rows) {
    const std::string_view line = take_line(rows);
    if (trimmed(line).empty() || (comments && trimmed(line).starts_with('#'))) continue;
    std::vector<std::string>& fields = preview.rows.emplace_back();
    for (const std::string_view field : fields_of(line, separator)) fields.emplace_back(field);
  }
}

}  // namespace collidoscope
