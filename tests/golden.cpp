#include "tests/golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "headless/compare.h"
#include "tests/test_files.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

bool is_one(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && std::string(value) == "1";
}

std::string command_that_accepts() {
  std::string test = ".";
  if (const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info())
    test = fmt::format("^{}[.]{}$", info->test_suite_name(), info->name());
  return fmt::format("UPDATE_GOLDENS=1 ./dev test -R '{}'", test);
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

std::string golden_folder(const std::string& key) {
  std::string folder;
  for (const char c : key) {
    if (c == ',') {
      folder += '_';
    } else if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_') {
      folder += c;
    } else if (!folder.ends_with('_') && !folder.ends_with('-')) {
      folder += '-';
    }
  }
  return folder;
}

GoldenPicture find_golden(const fs::path& goldens, const std::string& key, const std::string& name) {
  const std::string folder = golden_folder(key), file = name + ".png";
  if (fs::is_directory(goldens / folder)) return {goldens / folder / file, true};
  std::vector<fs::path> found;
  for (const fs::directory_entry& other : fs::directory_iterator(goldens))
    if (fs::exists(other.path() / file)) found.push_back(other.path());
  if (found.empty()) return {goldens / folder / file, true};
  std::sort(found.begin(), found.end());
  const std::string imgui = folder.substr(std::min(folder.rfind('_'), folder.size()));
  const auto same_imgui = std::find_if(found.begin(), found.end(),
                                       [&](const fs::path& f) { return f.string().ends_with(imgui); });
  return {(same_imgui == found.end() ? found.front() : *same_imgui) / file, false};
}

std::string check_golden(const std::string& name, const Image& picture) {
  const fs::path goldens = project_file("tests/golden");
  const std::string key = renderer_key();
  if (is_one("UPDATE_GOLDENS")) {
    fs::create_directories(goldens / golden_folder(key));
    write_png(picture, (goldens / golden_folder(key) / (name + ".png")).string());
    return "";
  }
  if (is_one("COLLIDOSCOPE_TIGHT_GOLDENS") && !fs::is_directory(goldens / golden_folder(key)))
    return "no goldens are of " + key + "; to accept the picture: " + command_that_accepts();
  return check_golden(goldens, key, name, picture);
}

std::string check_golden(const fs::path& goldens, const std::string& key, const std::string& name,
                         const Image& picture) {
  const GoldenPicture golden_picture = find_golden(goldens, key, name);
  if (!fs::exists(golden_picture.png))
    return "golden " + golden_picture.png.string() +
           " is missing; to accept the picture: " + command_that_accepts();
  const Image golden = read_png(golden_picture.png.string());
  const std::string wrong = judge(picture, golden, golden_picture.same_renderer);
  if (wrong.empty()) return "";
  return wrong + "; to accept the picture: " + command_that_accepts() + "; see " +
         write_page(name, picture, golden, wrong).string();
}

}  // namespace collidoscope
