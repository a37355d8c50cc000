#include "sim_cuda/import/npy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <string_view>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/input_file.h"

namespace collidoscope {
namespace {

constexpr std::string_view npy_magic = "\x93NUMPY";
constexpr std::size_t most_header_bytes = 1 << 20;
constexpr const char* expected_types = "expected floating-point numbers or integers, such as '<f4' or '<f8'";

struct ElementCode {
  std::string_view code;  // of NumPy, without the byte order
  NpyArray::Element element;
  std::size_t bytes;
};
constexpr ElementCode element_codes[] = {
    {"f4", NpyArray::Element::f32, 4}, {"f8", NpyArray::Element::f64, 8}, {"i1", NpyArray::Element::i8, 1},
    {"i2", NpyArray::Element::i16, 2}, {"i4", NpyArray::Element::i32, 4}, {"i8", NpyArray::Element::i64, 8},
    {"u1", NpyArray::Element::u8, 1},  {"u2", NpyArray::Element::u16, 2}, {"u4", NpyArray::Element::u32, 4},
    {"u8", NpyArray::Element::u64, 8}};

/// The header: a dictionary of Python with the keys descr, fortran_order and shape.
class NpyHeader {
 public:
  /// `begin`: position of `text` in the file.
  NpyHeader(const std::string& file, std::string_view text, std::size_t begin)
      : file_(file), text_(text), begin_(begin) {}

  void read() {
    expect('{', "a dictionary of Python");
    while (!next_is('}')) {
      const std::size_t key_at = at_;
      const std::string_view key = text_in_quotes("a key in quotes");
      expect(':', "a colon after the key");
      if (key == "descr")
        read_type();
      else if (key == "fortran_order")
        read_order();
      else if (key == "shape")
        read_shape();
      else
        fail(key_at, "unknown key", "descr, fortran_order or shape");
      if (!next_is(',') && !peek_is('}')) fail(at_, "no comma after a value", "a comma or }");
    }
    skip_spaces();
    if (at_ < text_.size()) fail(at_, "text after the dictionary", "the end of the header");
    if (code_ == nullptr) fail(0, "no type of the numbers", "the key descr");
    if (!order_known_) fail(0, "no order of the numbers", "the key fortran_order");
    if (!shape_known_) fail(0, "no shape of the array", "the key shape");
  }

  const ElementCode& code() const { return *code_; }
  bool swapped() const { return swapped_; }
  bool fortran_order() const { return fortran_order_; }
  const std::vector<std::size_t>& shape() const { return shape_; }

  [[noreturn]] void fail(std::size_t at, const std::string& problem, const std::string& expected) const {
    throw InputError(fmt::format("{}: byte {}: {}, expected {}", file_, begin_ + at, problem, expected));
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  bool peek_is(char wanted) {
    skip_spaces();
    return at_ < text_.size() && text_[at_] == wanted;
  }
  bool next_is(char wanted) {
    if (!peek_is(wanted)) return false;
    ++at_;
    return true;
  }
  void expect(char wanted, const char* what) {
    if (!next_is(wanted)) fail(at_, "damaged header", what);
  }
  std::string_view text_in_quotes(const char* what) {
    skip_spaces();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    const std::size_t end =
        quote == '\'' || quote == '"' ? text_.find(quote, at_ + 1) : std::string_view::npos;
    if (end == std::string_view::npos) fail(at_, "damaged header", what);
    const std::string_view inside = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return inside;
  }
  void read_type() {
    skip_spaces();
    const std::size_t type_at = at_;
    const auto refuse = [&](const std::string& what) {
      throw InputError(fmt::format("{}: byte {}: {}, {}", file_, begin_ + type_at, what, expected_types));
    };
    if (peek_is('[')) refuse("an array of records");
    const std::string_view name = text_in_quotes("the type in quotes");
    if (name.size() >= 2 && name[1] == 'O') refuse("an array of objects, which can contain code");
    const auto* const found = name.empty()
                                  ? std::end(element_codes)
                                  : std::ranges::find(element_codes, name.substr(1), &ElementCode::code);
    const char order = name.empty() ? ' ' : name[0];
    if (found == std::end(element_codes) || std::string_view("<>=|").find(order) == std::string_view::npos)
      refuse("an unknown type of numbers");
    static_assert(std::endian::native == std::endian::little);
    swapped_ = order == '>' && found->bytes > 1;
    code_ = found;
  }
  void read_order() {
    skip_spaces();
    for (const bool value : {true, false}) {
      const std::string_view word = value ? "True" : "False";
      if (!text_.substr(at_).starts_with(word)) continue;
      at_ += word.size();
      fortran_order_ = value;
      order_known_ = true;
      return;
    }
    fail(at_, "damaged header", "True or False");
  }
  void read_shape() {
    expect('(', "a tuple of whole numbers");
    shape_.clear();
    while (!next_is(')')) {
      skip_spaces();
      const std::size_t first = at_;
      std::size_t extent = 0;
      while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') {
        extent = 10 * extent + static_cast<std::size_t>(text_[at_++] - '0');
        if (at_ - first > 15) fail(first, "a dimension is too large", "at most 15 digits");
      }
      if (at_ == first) fail(at_, "damaged header", "a whole number");
      if (shape_.size() == 32) fail(first, "too many dimensions", "at most 32");
      shape_.push_back(extent);
      if (!next_is(',') && !peek_is(')')) fail(at_, "damaged header", "a comma or )");
    }
    shape_known_ = true;
  }

  const std::string& file_;
  std::string_view text_;
  std::size_t begin_, at_ = 0;
  const ElementCode* code_ = nullptr;
  bool swapped_ = false, fortran_order_ = false, order_known_ = false, shape_known_ = false;
  std::vector<std::size_t> shape_;
};

/// Bytes of the array; 2^63 and more: at least that many.
std::size_t bytes_of(const std::vector<std::size_t>& shape, std::size_t element_bytes) {
  if (std::ranges::find(shape, std::size_t{0}) != shape.end()) return 0;
  std::size_t bytes = element_bytes;
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max() / 2 + 1;
  for (const std::size_t extent : shape) {
    if (bytes > most / extent) return most;
    bytes *= extent;
  }
  return bytes;
}

class NpyReader {
 public:
  NpyReader(const std::string& name, std::size_t bytes, const TakeBytes& take)
      : name_(name), bytes_(bytes), take_(take) {}

  NpyLayout read_layout() {
    char start[12] = {};
    if (bytes_ < 10 || !take(start, 10) || std::string_view(start, npy_magic.size()) != npy_magic)
      fail(0, "no NumPy file", "the bytes \\x93NUMPY");
    const auto byte = [&](std::size_t k) {
      return static_cast<std::size_t>(static_cast<unsigned char>(start[k]));
    };
    const std::size_t version = byte(6);
    if (version < 1 || version > 3) fail(6, fmt::format("format {}", version), "format 1, 2 or 3");
    std::size_t length = byte(8) | byte(9) << 8, begin = 10;
    if (version > 1) {
      if (!take(start + 10, 2)) fail(10, "the file ends", "the length of the header");
      length |= byte(10) << 16 | byte(11) << 24;
      begin = 12;
    }
    if (length > most_header_bytes || length > bytes_ - begin)
      fail(8, fmt::format("a header of {} bytes", length),
           fmt::format("at most {}", std::min<std::size_t>(most_header_bytes, bytes_ - begin)));
    std::string text(length, '\0');
    if (!take(text.data(), length)) fail(begin, "the file ends", "the header");
    NpyHeader header(name_, text, begin);
    header.read();
    const NpyLayout layout{header.code().element, header.shape(),      header.fortran_order(),
                           header.swapped(),      header.code().bytes, begin + length};
    const std::size_t there = bytes_ - layout.begin, needed = bytes_of(layout.shape, layout.element_bytes);
    if (there != needed)
      fail(layout.begin, fmt::format("{} bytes of numbers", there),
           needed > there && needed >> 63 != 0
               ? fmt::format("those of an array of shape {}", shape_text(layout.shape))
               : fmt::format("{} for an array of shape {}", needed, shape_text(layout.shape)));
    return layout;
  }

  NpyArray read() {
    const NpyLayout layout = read_layout();
    NpyArray array;
    array.element = layout.element;
    array.shape = layout.shape;
    array.fortran_order = layout.fortran_order;
    const std::size_t needed = bytes_ - layout.begin;
    array.bytes = std::make_unique_for_overwrite<std::byte[]>(needed);
    if (!take(array.bytes.get(), needed)) fail(layout.begin, "the file ends", "its numbers");
    if (layout.swapped)
      for (std::size_t k = 0; k < needed; k += layout.element_bytes)
        std::reverse(array.bytes.get() + k, array.bytes.get() + k + layout.element_bytes);
    return array;
  }

 private:
  bool take(void* to, std::size_t bytes) { return take_(to, bytes); }
  [[noreturn]] void fail(std::size_t at, const std::string& problem, const std::string& expected) const {
    throw InputError(fmt::format("{}: byte {}: {}, expected {}", name_, at, problem, expected));
  }

  const std::string& name_;
  std::size_t bytes_;
  const TakeBytes& take_;
};

}  // namespace

std::string shape_text(const std::vector<std::size_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

NpyArray read_npy(const std::string& name, std::size_t bytes, const TakeBytes& take) {
  return with_allocation_context("reading a NumPy array",
                                 [&] { return NpyReader(name, bytes, take).read(); });
}

namespace {

/// Takes the bytes of a file one after the other, with several threads.
TakeBytes bytes_in_order(const InputFile& file) {
  return [&file, at = std::size_t{0}](void* to, std::size_t bytes) mutable {
    const std::size_t begin = at;
    at += bytes;
    std::atomic<bool> complete = true;
    on_all_cores(bytes, std::size_t{4} << 20, [&](std::size_t first, std::size_t last) {
      if (file.read(begin + first, static_cast<char*>(to) + first, last - first) != last - first)
        complete = false;
    });
    return complete.load();
  };
}

}  // namespace

NpyArray read_npy(const std::string& name) {
  const InputFile file(name, "a NumPy file (.npy)");
  return read_npy(name, file.bytes(), bytes_in_order(file));
}

NpyLayout read_npy_layout(const InputFile& file) {
  const TakeBytes take = bytes_in_order(file);
  return NpyReader(file.name(), file.bytes(), take).read_layout();
}

}  // namespace collidoscope
