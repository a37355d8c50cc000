#pragma once
// PLY files: header, and the properties of the vertices. Text and both binary orders.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace collidoscope {

struct PlyHeader {
  enum class Encoding { text, little, big };
  enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
  struct Property {
    std::string name;
    Type type = Type::f32;
    bool is_list = false;
    Type count_type = Type::u8;  ///< of a list
  };
  struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
  };
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t bytes = 0, lines = 0;  ///< of the header

  /// The element, or null.
  const Element* find(std::string_view name) const;
};

std::size_t bytes_of(PlyHeader::Type type);
/// The number at `at`. The bytes must exist.
double ply_number(const char* at, PlyHeader::Type type, bool swapped);

/// Throws InputError: `file:line:1: problem, expected value`.
PlyHeader read_ply_header(std::string_view text, const std::string& file);
/// Whether a PLY file is a mesh. Throws InputError.
bool ply_has_faces(const std::string& file);

}  // namespace collidoscope
