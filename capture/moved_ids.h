#pragma once
// What happened to the objects of two pictures of ids.

#include <cstdint>
#include <functional>
#include <string>

#include <collidoscope/picture.h>

namespace collidoscope::capture {

/// Such as "17 moved by 3.2 pixels (right 3, down 1); 4 is missing (120 pixels)": the five with the most
/// changed pixels. `name_of` may be empty. Precondition: equal sizes.
std::string moved_ids_text(const Pixels& actual, const Pixels& expected,
                           const std::function<std::string(std::uint32_t)>& name_of);

}  // namespace collidoscope::capture
