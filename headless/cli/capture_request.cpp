#include "headless/cli/capture_request.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

bool whole_number(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace

std::vector<std::int64_t> parse_states(const std::string& text, const std::string& where) {
  std::vector<std::int64_t> states;
  std::vector<std::string> faults;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string part = text.substr(from, to - from);
    from = to + 1;
    std::int64_t state = -1;
    if (!whole_number(part, state) || state < 0 || state > 1000000000)
      faults.push_back(where + ": '" + part +
                       "': not a state; expected whole numbers from 0 to 1000000000, such as 0,30,60");
    else
      states.push_back(state);
  }
  if (!faults.empty()) throw InputError(faults);
  std::sort(states.begin(), states.end());
  states.erase(std::unique(states.begin(), states.end()), states.end());
  return states;
}

void parse_size(const std::string& text, CaptureRequest& request, const std::string& where) {
  const std::size_t cross = text.find('x');
  std::int64_t width = 0, height = 0;
  const bool read = cross != text.npos && whole_number(std::string_view(text).substr(0, cross), width) &&
                    whole_number(std::string_view(text).substr(cross + 1), height);
  if (!read || width < 16 || width > 16384 || height < 16 || height > 16384)
    throw InputError(where + ": '" + text +
                     "': not a size; expected WIDTHxHEIGHT, each 16 to 16384, such as 1280x800");
  request.width = static_cast<int>(width);
  request.height = static_cast<int>(height);
}

}  // namespace collidoscope
