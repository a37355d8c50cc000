#include "sim_cuda/import/file_format.h"

#include <algorithm>
#include <cstring>

#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {
namespace {

constexpr std::size_t bytes_of_start = std::size_t{1} << 16;

bool is_binary_stl(std::string_view start, std::size_t bytes) {
  constexpr std::size_t header = 84, facet = 50;
  if (start.size() < header) return false;
  unsigned char count[4];
  std::memcpy(count, start.data() + 80, sizeof count);
  const std::size_t facets =
      count[0] | count[1] << 8 | count[2] << 16 | static_cast<std::size_t>(count[3]) << 24;
  return bytes == header + facet * facets;
}

/// Number of atoms, comment, and rows of three numbers after a word.
bool is_xyz(std::string_view start) {
  double number = 0;
  const std::string_view first = trimmed(take_line(start));
  if (!is_number(first, number) || first.find_first_not_of("0123456789") != std::string_view::npos)
    return false;
  take_line(start);
  const std::vector<std::string_view> row = fields_of(take_line(start), ' ');
  if (row.size() < 4) return false;
  return std::all_of(row.begin() + 1, row.begin() + 4,
                     [&](std::string_view field) { return is_number(field, number); });
}

bool is_obj(std::string_view start) {
  while (!start.empty()) {
    const std::string_view line = trimmed(take_line(start));
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string_view> words = fields_of(line, ' ');
    if (words[0] == "mtllib" || words[0] == "o" || words[0] == "g") continue;
    double number = 0;
    return words[0] == "v" && words.size() >= 4 && is_number(words[1], number);
  }
  return false;
}

bool is_table(std::string_view start) {
  while (!start.empty()) {
    const std::string_view line = trimmed(take_line(start));
    if (line.empty() || line.front() == '#') continue;
    return line.find_first_of(",;\t ") != std::string_view::npos;
  }
  return false;
}

}  // namespace

std::string_view description_of(FileFormat format) {
  switch (format) {
    case FileFormat::scene:
      return "scene";
    case FileFormat::snapshot:
      return "snapshot";
    case FileFormat::recording:
      return "recording";
    case FileFormat::npy:
      return "NumPy array (.npy)";
    case FileFormat::npz:
      return "NumPy archive (.npz)";
    case FileFormat::csv:
      return "table (CSV)";
    case FileFormat::xyz:
      return "XYZ file";
    case FileFormat::lammps:
      return "LAMMPS dump";
    case FileFormat::ply:
      return "PLY file";
    case FileFormat::stl:
      return "STL mesh";
    case FileFormat::obj:
      return "OBJ mesh";
    case FileFormat::urdf:
      return "URDF robot";
    case FileFormat::mjcf:
      return "MuJoCo model (MJCF)";
    case FileFormat::unknown:
      break;
  }
  return "unknown format";
}

FileFormat format_of(const std::string& name) {
  const InputFile file(name, "a scene, snapshot, recording or file of bodies");
  std::string start(std::min(file.bytes(), bytes_of_start), '\0');
  start.resize(file.read(0, start.data(), start.size()));
  return format_of_start(start, file.bytes());
}

FileFormat format_of_start(std::string_view start, std::size_t bytes) {
  if (start.starts_with("\x93NUMPY")) return FileFormat::npy;
  if (start.starts_with("PK\x03\x04")) return FileFormat::npz;
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return FileFormat::ply;
  if (start.starts_with("ITEM:")) return FileFormat::lammps;
  if (start.starts_with("collidoscope-snapshot")) return FileFormat::snapshot;
  if (start.starts_with("collidoscope-recording")) return FileFormat::recording;
  if (is_binary_stl(start, bytes)) return FileFormat::stl;
  if (start.find('\0') != std::string_view::npos) return FileFormat::unknown;
  if (start.starts_with("\xef\xbb\xbf")) start.remove_prefix(3);  // byte-order mark
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return FileFormat::unknown;
  const std::string_view text = start.substr(first);
  if (text.find_first_of("{[") == 0 || text.starts_with("//") || text.starts_with("/*"))
    return FileFormat::scene;
  if (text.starts_with('<')) {
    if (text.find("<mujoco") != std::string_view::npos) return FileFormat::mjcf;
    return text.find("<robot") != std::string_view::npos ? FileFormat::urdf : FileFormat::unknown;
  }
  if (text.starts_with("solid") && text.find("facet") != std::string_view::npos) return FileFormat::stl;
  if (is_xyz(start)) return FileFormat::xyz;
  if (is_obj(text)) return FileFormat::obj;
  return is_table(text) ? FileFormat::csv : FileFormat::unknown;
}

}  // namespace collidoscope
