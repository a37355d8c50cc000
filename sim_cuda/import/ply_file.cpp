#include "sim_cuda/import/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/binary_rows.h"
#include "sim_cuda/import/frame_text.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {
namespace {

struct PlyTypeName {
  std::string_view name, long_name;
  PlyHeader::Type type;
  std::size_t bytes;
};
constexpr PlyTypeName ply_types[] = {
    {"char", "int8", PlyHeader::Type::i8, 1},      {"uchar", "uint8", PlyHeader::Type::u8, 1},
    {"short", "int16", PlyHeader::Type::i16, 2},   {"ushort", "uint16", PlyHeader::Type::u16, 2},
    {"int", "int32", PlyHeader::Type::i32, 4},     {"uint", "uint32", PlyHeader::Type::u32, 4},
    {"float", "float32", PlyHeader::Type::f32, 4}, {"double", "float64", PlyHeader::Type::f64, 8}};

constexpr std::size_t most_properties = 4096;
constexpr std::size_t most_elements = std::size_t{1} << 31;

std::optional<PlyHeader::Type> ply_type(std::string_view name) {
  for (const PlyTypeName& type : ply_types)
    if (name == type.name || name == type.long_name) return type.type;
  return std::nullopt;
}

/// Bytes of an element's row; its properties must not be lists.
std::size_t bytes_of_row(const PlyHeader::Element& element) {
  std::size_t bytes = 0;
  for (const PlyHeader::Property& property : element.properties) bytes += bytes_of(property.type);
  return bytes;
}

bool has_lists(const PlyHeader::Element& element) {
  return std::ranges::any_of(element.properties, &PlyHeader::Property::is_list);
}

PlyHeader::Property read_property(const LineReader& lines, const std::vector<std::string_view>& words) {
  PlyHeader::Property property;
  const bool is_list = words.size() == 5 && words[1] == "list";
  const auto type = words.size() >= 3 ? ply_type(words[is_list ? 3 : 1]) : std::nullopt;
  const auto count_type = is_list ? ply_type(words[2]) : PlyHeader::Type::u8;
  if (!type || !count_type || (!is_list && words.size() != 3))
    lines.fail("damaged property", "`property float x` or `property list uchar int name`");
  property.name = words.back();
  property.type = *type;
  property.is_list = is_list;
  property.count_type = *count_type;
  return property;
}

template <class Number>
double number_at(const char* at, bool swapped) {
  char bytes[sizeof(Number)];
  std::memcpy(bytes, at, sizeof bytes);
  if (swapped) std::reverse(std::begin(bytes), std::end(bytes));
  return static_cast<double>(std::bit_cast<Number>(bytes));
}

}  // namespace

const PlyHeader::Element* PlyHeader::find(std::string_view name) const {
  const auto found = std::ranges::find(elements, name, &Element::name);
  return found == elements.end() ? nullptr : &*found;
}

std::size_t bytes_of(PlyHeader::Type type) { return ply_types[static_cast<std::size_t>(type)].bytes; }

double ply_number(const char* at, PlyHeader::Type type, bool swapped) {
  using enum PlyHeader::Type;
  switch (type) {
    case i8:
      return number_at<std::int8_t>(at, swapped);
    case u8:
      return number_at<std::uint8_t>(at, swapped);
    case i16:
      return number_at<std::int16_t>(at, swapped);
    case u16:
      return number_at<std::uint16_t>(at, swapped);
    case i32:
      return number_at<std::int32_t>(at, swapped);
    case u32:
      return number_at<std::uint32_t>(at, swapped);
    case f32:
      return number_at<float>(at, swapped);
    case f64:
      break;
  }
  return number_at<double>(at, swapped);
}

PlyHeader read_ply_header(std::string_view text, const std::string& file) {
  PlyHeader header;
  LineReader lines(file, text);
  if (trimmed(lines.next("the word ply")) != "ply") lines.fail("no PLY file", "the word ply");
  bool has_format = false;
  while (true) {
    const std::vector<std::string_view> words = fields_of(lines.next("end_header"), ' ');
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format") {
      using enum PlyHeader::Encoding;
      has_format = true;
      if (words.size() >= 2 && words[1] == "ascii")
        header.encoding = PlyHeader::Encoding::text;
      else if (words.size() >= 2 && words[1] == "binary_little_endian")
        header.encoding = little;
      else if (words.size() >= 2 && words[1] == "binary_big_endian")
        header.encoding = big;
      else
        lines.fail("unknown format", "ascii, binary_little_endian or binary_big_endian");
    } else if (words[0] == "element" && words.size() == 3 && header.elements.size() < most_properties) {
      header.elements.push_back(
          {std::string(words[1]), lines.whole(words[2], most_elements, "number of elements"), {}});
    } else if (words[0] == "property" && !header.elements.empty() &&
               header.elements.back().properties.size() < most_properties) {
      header.elements.back().properties.push_back(read_property(lines, words));
    } else {
      lines.fail("unknown line", "element NAME COUNT, property TYPE NAME or end_header");
    }
  }
  if (!has_format) lines.fail("no format", "a line `format ascii 1.0` before the end of the header");
  header.lines = lines.line() - 1;
  header.bytes = text.size() - lines.rest().size();
  return header;
}

bool ply_has_faces(const std::string& name) {
  const InputFile file(name, "a PLY file");
  constexpr std::size_t longest_header = std::size_t{1} << 20;
  std::string start(std::min(file.bytes(), longest_header), '\0');
  start.resize(file.read(0, start.data(), start.size()));
  const PlyHeader header = read_ply_header(start, name);
  const PlyHeader::Element* const faces = header.find("face");
  return faces != nullptr && faces->count > 0;
}

BodyTable read_ply_bodies(const std::string& name, const TableOptions& options) {
  const InputFile file(name, "a PLY file");
  const FileText contents(file);
  const std::string_view text = contents.text();
  const PlyHeader header = read_ply_header(text, name);
  const PlyHeader::Element* const vertices = header.find("vertex");
  if (vertices == nullptr || vertices->count == 0)
    throw InputError(name + ": no vertices, expected an element vertex");
  if (const auto* const faces = header.find("face"); faces != nullptr && faces->count > 0)
    throw InputError(
        fmt::format("{}: a mesh of {} faces, expected points without faces", name, faces->count));
  std::size_t before = 0, lines_before = 0;
  for (const PlyHeader::Element* element = header.elements.data(); element != vertices; ++element) {
    if (has_lists(*element))
      throw InputError(fmt::format("{}: lists before the vertices, expected the element vertex first", name));
    before += element->count * bytes_of_row(*element);
    lines_before += element->count;
  }
  if (has_lists(*vertices))
    throw InputError(fmt::format("{}: the vertices have lists, expected numbers", name));
  std::vector<std::string> names;
  for (const PlyHeader::Property& property : vertices->properties) names.push_back(property.name);
  if (header.encoding == PlyHeader::Encoding::text) {
    LineReader lines(name, text.substr(header.bytes));
    std::size_t taken = 0;
    lines.take(lines_before, taken);
    const std::string_view rows_text = lines.take(vertices->count, taken);
    const TextRows rows(name, rows_text, header.lines + lines_before + 1, ' ', false);
    if (rows.rows() != vertices->count)
      throw InputError(
          fmt::format("{}: {} rows of vertices, expected {}", name, rows.rows(), vertices->count));
    if (options.preview != nullptr) {
      preview_text(*options.preview, names, names.size(), rows_text, ' ', false);
      return {};
    }
    const ColumnChoice choice = choose_columns(options.columns, names, names.size(), name);
    BodyTableBuilder table(choice, vertices->count, options.scale, name);
    rows.read(table.targets(names.size()));
    return table.finish(names, names.size());
  }

  const std::size_t row = bytes_of_row(*vertices);
  const std::string_view data = text.substr(header.bytes);
  if (row == 0 || before > data.size() || (data.size() - before) / row < vertices->count)
    throw InputError(fmt::format("{}: byte {}: the file ends, expected {} vertices of {} bytes", name,
                                 text.size(), vertices->count, row));
  std::vector<std::size_t> offset(names.size());
  for (std::size_t k = 1; k < names.size(); ++k)
    offset[k] = offset[k - 1] + bytes_of(vertices->properties[k - 1].type);
  const char* const first = data.data() + before;
  const bool swapped = header.encoding == PlyHeader::Encoding::big;
  const auto number_at = [&](std::size_t k, std::size_t column) {
    return ply_number(first + k * row + offset[column], vertices->properties[column].type, swapped);
  };
  if (options.preview != nullptr) {
    preview_numbers(*options.preview, names, names.size(), vertices->count, number_at);
    return {};
  }
  const ColumnChoice choice = choose_columns(options.columns, names, names.size(), name);
  BodyTableBuilder table(choice, vertices->count, options.scale, name);
  store_rows(vertices->count, table.targets(names.size()), name, number_at);
  return table.finish(names, names.size());
}

}  // namespace collidoscope
