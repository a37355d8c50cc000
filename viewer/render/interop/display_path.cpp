#include "viewer/render/interop/display_path.h"

#include "sim_cuda/core/error.h"

namespace collidoscope {

const char* display_path_name(DisplayPath path) {
  switch (path) {
    case DisplayPath::automatic:
      return "auto";
    case DisplayPath::interop:
      return "CUDA + GL interop";
    case DisplayPath::copy:
      return "CUDA + copied upload";
    case DisplayPath::upload:
      return "CPU + upload";
  }
  return "";
}

DisplayPath parse_display_path(const std::string& text, const std::string& where) {
  if (text == "auto") return DisplayPath::automatic;
  if (text == "interop") return DisplayPath::interop;
  if (text == "copy") return DisplayPath::copy;
  if (text == "upload") return DisplayPath::upload;
  throw InputError(where + ": '" + text +
                   "': unknown display path; expected one of auto, interop, copy, upload");
}

}  // namespace collidoscope
