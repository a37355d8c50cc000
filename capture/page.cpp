#include "capture/page.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "capture/png_bytes.h"
#include "capture/text_file.h"
#include "capture/words.h"

namespace collidoscope::capture {
namespace {

namespace fs = std::filesystem;

/// While it exists, no other process changes the page.
class PageLock {
 public:
  explicit PageLock(const fs::path& folder)
      : file_(open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ >= 0) flock(file_, LOCK_EX);
  }
  ~PageLock() {
    if (file_ >= 0) close(file_);
  }
  PageLock(const PageLock&) = delete;
  PageLock& operator=(const PageLock&) = delete;

 private:
  int file_;
};

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (at + k < bytes.size() ? static_cast<std::uint8_t>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += at + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string json_string(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + '"';
}

std::string image(const std::string& role, const Pixels& pixels) {
  return words("<img class=\"", role, "\" alt=\"", role, "\" src=\"data:image/png;base64,",
               base64(png_bytes(pixels)), "\">");
}

std::string section_of(const FailedPicture& failed) {
  const bool has_expected = failed.expected.width > 0;
  const bool is_comparable =
      failed.actual.width == failed.expected.width && failed.actual.height == failed.expected.height;
  std::string text = words("<section><h2>", escaped(failed.name), "</h2><p>", escaped(failed.test), ": ",
                           escaped(failed.text), "</p><p>To accept the picture: <code>",
                           escaped(failed.command), "</code></p>");
  if (is_comparable)
    text +=
        "<p class=\"modes\"><button data-mode=\"side\">side by side</button><button data-mode=\"flicker\">"
        "flicker</button><button data-mode=\"slide\">slider</button>"
        "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\"></p>";
  text += "<div class=\"pictures side\">";
  if (has_expected)
    text += "<figure>" + image("expected", failed.expected) + "<figcaption>expected</figcaption></figure>";
  text += "<figure>" + image("actual", failed.actual) + "<figcaption>actual</figcaption></figure>";
  if (is_comparable) {
    const Picture difference = difference_picture(failed.actual, failed.expected);
    text += "<figure>" + image("difference", difference.pixels()) +
            "<figcaption>difference</figcaption></figure>";
  }
  return text + "</div></section>\n";
}

std::string json_of(const FailedPicture& failed) {
  const Comparison& c = failed.comparison;
  return words("{\"test\": ", json_string(failed.test), ", \"name\": ", json_string(failed.name),
               ", \"text\": ", json_string(failed.text), ", \"command\": ", json_string(failed.command),
               ", \"severity\": ", c.severity, ", \"different\": ", c.different, ", \"beyond\": ", c.beyond,
               ", \"max_difference\": ", c.max_difference, ", \"flip_mean\": ", c.flip_mean,
               ", \"flip_p99\": ", c.flip_p99, ", \"where\": [", c.where.x, ", ", c.where.y, ", ",
               c.where.width, ", ", c.where.height, "]}");
}

constexpr const char* head = R"(<!doctype html><meta charset="utf-8"><title>Pictures that failed</title>
<style>
body{background:#16181c;color:#ddd;font:15px sans-serif;margin:24px}
section{border-top:1px solid #444;padding:8px 0 24px}h2{margin:8px 0}code{background:#2a2d33;padding:2px 6px}
button{margin-right:8px}figure{display:inline-block;margin:4px}figcaption{color:#999}
.pictures{position:relative}.side img{max-width:31vw;image-rendering:pixelated}
.flicker img,.slide img{max-width:94vw;image-rendering:pixelated}
.flicker figure,.slide figure{margin:0}.flicker figcaption,.slide figcaption{display:none}
.flicker figure:nth-child(2),.slide figure:nth-child(2){position:absolute;left:0;top:0}
.flicker figure:nth-child(3),.slide figure:nth-child(3){display:none}
.flicker .actual{animation:flicker 1s steps(1) infinite}@keyframes flicker{50%{visibility:hidden}}
.modes input{display:none;vertical-align:middle;width:40vw}
</style><h1>Pictures that failed</h1>
)";
constexpr const char* foot = R"(<script>
for(const section of document.querySelectorAll('section')){
 const pictures=section.querySelector('.pictures'),range=section.querySelector('input'),actual=section.querySelector('.actual');
 const slide=()=>{actual.style.clipPath=pictures.classList.contains('slide')?`inset(0 0 0 ${range.value}%)`:''};
 for(const button of section.querySelectorAll('button'))button.onclick=()=>{
  pictures.className='pictures '+button.dataset.mode;
  range.style.display=button.dataset.mode==='slide'?'inline':'none';slide()};
 if(range)range.oninput=slide}
</script>
)";

/// A name for files. Different names stay different.
std::string file_name(const std::string& test, const std::string& name) {
  std::string text;
  for (const char c : test + "-" + name)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.')
      text += c;
    else
      text += words("_", static_cast<int>(static_cast<unsigned char>(c)));
  return text;
}

constexpr const char* severity_mark = "<!-- severity ";

double severity_of(const std::string& part) {
  return part.starts_with(severity_mark) ? std::atof(part.c_str() + std::string(severity_mark).size()) : 0;
}

/// Writes index.html and index.json of all parts. Without parts, removes them.
fs::path write_index(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> parts;  // HTML, JSON
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "parts", failed))
    if (entry.path().extension() == ".html")
      parts.emplace_back(read_text_file(entry.path()),
                         read_text_file(fs::path(entry.path()).replace_extension(".json")));
  const fs::path page = folder / "index.html", json = folder / "index.json";
  if (parts.empty()) {
    fs::remove(page, failed);
    fs::remove(json, failed);
    return page;
  }
  std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
    const double severity_a = severity_of(a.first), severity_b = severity_of(b.first);
    return severity_a != severity_b ? severity_a > severity_b : a.second < b.second;
  });
  std::string html = head, list;
  for (const auto& [part, numbers] : parts) {
    html += part;
    list += (list.empty() ? "  " : ",\n  ") + numbers;
  }
  write_text_file(page, html + foot);
  write_text_file(json, "[\n" + list + "\n]\n");
  return page;
}

}  // namespace

fs::path add_to_page(const fs::path& folder, const FailedPicture& failed) {
  std::error_code ignored;
  fs::create_directories(folder / "parts", ignored);
  const std::string stem = file_name(failed.test, failed.name);
  const std::string html = words(severity_mark, failed.comparison.severity, " -->\n") + section_of(failed);
  const PageLock lock(folder);
  write_text_file(folder / "parts" / (stem + ".json"), json_of(failed));
  write_text_file(folder / "parts" / (stem + ".html"), html);
  return write_index(folder);
}

void remove_from_page(const fs::path& folder, const std::string& test, const std::string& name) {
  const fs::path part = folder / "parts" / (file_name(test, name) + ".html");
  std::error_code failed;
  if (!fs::exists(part, failed)) return;
  const PageLock lock(folder);
  fs::remove(part, failed);
  fs::remove(fs::path(part).replace_extension(".json"), failed);
  write_index(folder);
}

}  // namespace collidoscope::capture
