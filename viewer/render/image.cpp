#include "viewer/render/image.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// libpng reports errors by longjmp. No object with a destructor may be constructed between setjmp and the
// last call.
bool write_rows(std::FILE* file, const Image& image, const std::uint8_t* rgb) {
  // Replaces libpng's own error output.
  const auto fail = [](png_structp writer, png_const_charp) { png_longjmp(writer, 1); };
  const auto ignore = [](png_structp, png_const_charp) {};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, rgb + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) * 3);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const Image& image, const std::string& file) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(image.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4)
    rgb.insert(rgb.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(i),
               image.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  AtomicFile out(file);
  errno = 0;
  if (!write_rows(out.stream(), image, rgb.data())) out.fail(errno == 0 ? "libpng failed" : "");
  out.commit();
}

Image read_png(const std::string& file) {
  File in(std::fopen(file.c_str(), "rb"));
  if (!in) throw InputError(file + ": " + std::strerror(errno) + "; expected a PNG image");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_stdio(&png, in.get()))
    throw InputError(file + ": " + png.message + "; expected a PNG image");
  // Plausibility check: deflate expands at most 1032 times, and a byte holds at most 8 pixels. A larger
  // picture is corrupt.
  std::error_code failed;
  const double most_pixels = 8 * 1032 * static_cast<double>(std::filesystem::file_size(file, failed));
  if (!failed && static_cast<double>(png.width) * png.height > most_pixels) {
    const std::string size = std::to_string(png.width) + "x" + std::to_string(png.height);
    png_image_free(&png);
    throw InputError(file + ": is damaged: the file is too short for " + size +
                     " pixels; expected a complete PNG image");
  }
  png.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.rgba.resize(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr)) {
    const std::string why = png.message;
    png_image_free(&png);
    throw InputError(file + ": " + why + "; expected a complete PNG image");
  }
  return image;
}

}  // namespace collidoscope
