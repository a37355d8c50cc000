#pragma once
// The tests of a plug-in, as they run in the process of validate_plugin().

namespace collidoscope {

/// First argument of the process; the path of the library and the number of the GPU follow.
inline constexpr const char* child_flag = "--validate-plugin-in-this-process";
/// Where the process writes its answers: lines of a word and a value.
inline constexpr int answer_descriptor = 3;

}  // namespace collidoscope
