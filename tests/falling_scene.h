#pragma once
// A scene for tests of break conditions: two spheres fall freely. After k steps of 0.1 s body 0 has k m/s and
// body 1 has k + 1.

#include <string>

namespace collidoscope {

/// `guards`: the JSON member "guards" of the scene, or empty.
inline std::string falling_scene(const std::string& guards = "") {
  return R"({"format": "collidoscope-scene", "version": 1, "name": "Falling", "gravity": [0, 0, -10],
    "time_step": 0.1, )" +
         (guards.empty() ? "" : "\"guards\": " + guards + ", ") +
         R"("bodies": [{"radius": 1, "position": [5, 0, 20]},
                {"radius": 1, "position": [0, 0, 10], "velocity": [0, 0, -1]}]})";
}

}  // namespace collidoscope
