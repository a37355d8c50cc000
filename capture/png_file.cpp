// PNG files, through libpng's simplified interface. A file is written beside its place and then renamed, so
// that it is never incomplete.

#include <png.h>
#include <unistd.h>

#include <stdexcept>
#include <system_error>

#include <collidoscope/picture.h>
#include "capture/png_bytes.h"
#include "capture/text_file.h"

namespace collidoscope::capture {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, png_image& png) {
  const std::string why = png.message;
  png_image_free(&png);
  throw std::runtime_error(file.string() + ": " + why + "; expected a complete PNG image");
}

}  // namespace

Picture read_png(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str())) fail(file, png);
  // Deflate expands at most 1032 times, and a byte has at most 8 pixels. A larger picture is damaged.
  std::error_code failed;
  const auto bytes = static_cast<double>(std::filesystem::file_size(file, failed));
  if (failed || static_cast<double>(png.width) * png.height > 8 * 1032 * bytes) {
    png_image_free(&png);
    throw std::runtime_error(file.string() + ": too short for its size; expected a complete PNG image");
  }
  png.format = PNG_FORMAT_RGBA;
  Picture picture{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  picture.rgba.resize(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, picture.rgba.data(), 0, nullptr)) fail(file, png);
  return picture;
}

std::string png_bytes(const Pixels& pixels) {
  bool opaque = true;
  for (int y = 0; y < pixels.height && opaque; ++y)
    for (int x = 0; x < pixels.width; ++x) opaque &= pixels.row(y)[4 * x + 3] == 255;
  const std::size_t channels = opaque ? 3 : 4;
  std::string packed;
  for (int y = 0; y < pixels.height; ++y)
    for (int x = 0; x < pixels.width; ++x)
      packed.append(reinterpret_cast<const char*>(pixels.row(y) + 4 * x), channels);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(pixels.width);
  png.height = static_cast<png_uint_32>(pixels.height);
  png.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  png_alloc_size_t bytes = 0;
  if (!png_image_write_to_memory(&png, nullptr, &bytes, 0, packed.data(), 0, nullptr)) fail("PNG", png);
  std::string text(bytes, '\0');
  if (!png_image_write_to_memory(&png, text.data(), &bytes, 0, packed.data(), 0, nullptr)) fail("PNG", png);
  text.resize(bytes);
  return text;
}

void write_png(const Pixels& pixels, const std::filesystem::path& file) {
  write_text_file(file, png_bytes(pixels));
}

}  // namespace collidoscope::capture
