#pragma once
// Reads NumPy files (.npy, formats 1.0 to 3.0) that contain one array of numbers. The file may come from a
// stranger: every size is checked against the size of the file before memory is taken.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace collidoscope {

class InputFile;

struct NpyArray {
  enum class Element { f32, f64, i8, i16, i32, i64, u8, u16, u32, u64 };
  Element element = Element::f32;
  std::vector<std::size_t> shape;      ///< empty: one number
  bool fortran_order = false;          ///< the first index varies fastest, not the last
  std::unique_ptr<std::byte[]> bytes;  ///< the numbers, in the byte order of this machine

  std::size_t count() const {
    std::size_t product = 1;
    for (const std::size_t extent : shape) product *= extent;
    return product;
  }

  /// Returns `visit` of a pointer to the numbers, in their own type.
  template <class Visit>
  decltype(auto) visit(const Visit& visit) const {
    return visit_numbers(element, bytes.get(), visit);
  }
  /// The same for numbers of a type elsewhere.
  template <class Visit>
  static decltype(auto) visit_numbers(Element element, const std::byte* numbers, const Visit& visit) {
    const auto as = [&]<class Number>(Number) -> decltype(auto) {
      return visit(reinterpret_cast<const Number*>(numbers));
    };
    switch (element) {
      case Element::f32:
        return as(float{});
      case Element::f64:
        return as(double{});
      case Element::i8:
        return as(std::int8_t{});
      case Element::i16:
        return as(std::int16_t{});
      case Element::i32:
        return as(std::int32_t{});
      case Element::i64:
        return as(std::int64_t{});
      case Element::u8:
        return as(std::uint8_t{});
      case Element::u16:
        return as(std::uint16_t{});
      case Element::u32:
        return as(std::uint32_t{});
      case Element::u64:
        break;
    }
    return as(std::uint64_t{});
  }
};

/// "(3, 6)".
std::string shape_text(const std::vector<std::size_t>& shape);

/// Throws InputError: `FILE: byte N: problem, expected value`. Arrays of objects are refused, because they
/// contain code; so are records and text.
NpyArray read_npy(const std::string& file);

/// What the header of a file says, and where its numbers begin.
struct NpyLayout {
  NpyArray::Element element = NpyArray::Element::f32;
  std::vector<std::size_t> shape;
  bool fortran_order = false, swapped = false;  ///< swapped: big-endian
  std::size_t element_bytes = 4, begin = 0;     ///< bytes
};
/// Also checks that the file has all numbers. Throws InputError.
NpyLayout read_npy_layout(const InputFile& file);

/// Takes the next bytes of a file. Returns false if there are not so many.
using TakeBytes = std::function<bool(void* to, std::size_t bytes)>;
/// The same for a file of `bytes` bytes within another file. `name` begins the lines of errors.
NpyArray read_npy(const std::string& name, std::size_t bytes, const TakeBytes& take);

}  // namespace collidoscope
