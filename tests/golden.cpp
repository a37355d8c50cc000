#include "tests/golden.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "headless/compare.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

std::string read_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

fs::path write_page(const std::string& name, const Image& picture, const Image& golden,
                    const std::string& what) {
  const fs::path folder = fs::temp_directory_path() / "collidoscope-pictures" / name;
  fs::create_directories(folder);
  write_png(picture, (folder / "actual.png").string());
  write_png(golden, (folder / "expected.png").string());
  const bool same_size = picture.width == golden.width && picture.height == golden.height;
  if (same_size) write_png(difference_picture(picture, golden), (folder / "difference.png").string());
  std::ofstream page(folder / "index.html");
  page << "<!doctype html><meta charset=\"utf-8\"><title>" << name << "</title>"
       << "<style>body{background:#16181c;color:#ddd;font:15px "
          "sans-serif}figure{display:inline-block;margin:8px}"
       << "img{max-width:32vw;image-rendering:pixelated}</style><h1>" << name << "</h1><p>" << what << "</p>";
  for (const char* kind : {"actual", "expected", "difference"})
    if (same_size || std::string(kind) != "difference")
      page << "<figure><img src=\"" << kind << ".png\"><figcaption>" << kind << "</figcaption></figure>";
  return folder / "index.html";
}

}  // namespace

std::string renderer_key() {
  const std::string renderer = gl::renderer_name(), version = gl::version_name();
  const std::size_t mesa = version.find("Mesa ");
  const std::string driver =
      mesa == version.npos ? version : version.substr(mesa, version.find(' ', mesa + 5) - mesa);
  return renderer.substr(0, renderer.find(" (")) + ", " + driver + ", ImGui " IMGUI_VERSION;
}

std::string judge(const Image& picture, const Image& golden, bool same_renderer) {
  if (picture.width != golden.width || picture.height != golden.height)
    return fmt::format("{}x{} pixels where {}x{} are expected", picture.width, picture.height, golden.width,
                       golden.height);
  const ImageDifference d = compare_images(picture, golden);
  if (same_renderer && d.share_over_5 > 0.001)
    return fmt::format(
        "{:.3f} % of the pixels differ by more than 5/255, at most 0.1 % may (perceptual mean {:.4f})",
        100 * d.share_over_5, d.perceptual_mean);
  if (!same_renderer && d.perceptual_mean > loose_bound)
    return fmt::format("perceptual mean {:.4f}, at most {} may be", d.perceptual_mean, loose_bound);
  return "";
}

std::string check_golden(const GoldenFile& file, const Image& picture) {
  const fs::path png = file.path(), key = fs::path(png).replace_extension(".txt");
  if (const char* update = std::getenv("UPDATE_GOLDENS"); update && std::string(update) == "1") {
    fs::create_directories(png.parent_path());
    write_png(picture, png.string());
    std::ofstream(key) << renderer_key() << '\n';
    return "";
  }
  if (!fs::exists(png)) return "golden " + png.string() + " is missing; UPDATE_GOLDENS=1 makes it";
  const Image golden = read_png(png.string());
  const std::string wrong = judge(picture, golden, read_line(key) == renderer_key());
  return wrong.empty() ? ""
                       : wrong + "; see " + write_page(png.stem().string(), picture, golden, wrong).string();
}

}  // namespace collidoscope
