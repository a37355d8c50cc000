#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/import/frame_text.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

/// Names of columns in extended XYZ: Properties=species:S:1:pos:R:3:radius:R:1.
std::vector<std::string> extended_names(std::string_view comment) {
  constexpr std::string_view key = "Properties=";
  const std::size_t at = comment.find(key);
  if (at == std::string_view::npos) return {};
  std::string_view text = comment.substr(at + key.size());
  if (text.starts_with('"')) text.remove_prefix(1);
  text = text.substr(0, text.find_first_of(" \t\""));
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    parts.push_back(text.substr(0, colon));
    text.remove_prefix(std::min(colon + 1, text.size()));
  }
  std::vector<std::string> names;
  constexpr std::size_t most = 4096;
  for (std::size_t k = 0; k + 2 < parts.size(); k += 3) {
    double count = 0;
    if (!is_number(parts[k + 2], count) || !(count >= 1 && count <= 100) || names.size() > most) return {};
    const std::string name(parts[k]);
    const bool position = name == "pos", velocity = name == "velo" || name == "vel" || name == "velocities";
    for (int c = 0; c < static_cast<int>(count); ++c) {
      if ((position || velocity) && count == 3)
        names.push_back(std::string(velocity ? "v" : "") + "xyz"[c]);
      else
        names.push_back(count == 1 ? name : fmt::format("{}[{}]", name, c));
    }
  }
  return names;
}

FrameRows read_xyz_header(LineReader& lines) {
  FrameRows frame;
  frame.count = lines.whole(lines.next("a number of atoms"), static_cast<std::size_t>(limits::max_bodies),
                            "number of atoms");
  frame.names = extended_names(lines.next("a comment"));
  return frame;
}

}  // namespace

std::vector<BodyTable> read_xyz_frames(const std::string& name, const TableOptions& options,
                                       std::int64_t most) {
  const InputFile file(name, "an XYZ file");
  const FileText contents(file);
  BodyTable notes;
  std::vector<BodyTable> tables;
  for (FrameRows& frame : find_frames(name, contents.text(), options.frame, most, read_xyz_header, notes)) {
    if (frame.names.empty()) {
      std::string_view rows = frame.rows;
      const std::size_t columns = fields_of(take_line(rows), ' ').size();
      for (std::size_t k = 0; k < columns; ++k)
        frame.names.push_back(k == 0  ? "element"
                              : k < 4 ? std::string(1, "xyz"[k - 1])
                                      : fmt::to_string(k + 1));
    }
    tables.push_back(read_frame(name, frame, options, notes));
  }
  return tables;
}

}  // namespace collidoscope
