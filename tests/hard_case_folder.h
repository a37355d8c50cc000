#pragma once
// A folder of hard cases for tests. One case passes, one fails and one has a declared limit. One is not
// applicable to the solver impulse, one has changes, and the scene of one is refused.

#include <fstream>
#include <string>

#include "tests/test_files.h"

namespace collidoscope {

class HardCaseFolder {
 public:
  HardCaseFolder() {
    // Body 1 falls freely from 10 m. After 3 steps of 0.1 s it is at 9.55 m, after 4 at 9.2 m.
    scene("falls");
    criterion("falls", "rest", R"("steps": 20, "holds": [{"quantity": "speed", "at_most": 100},
      {"quantity": "position", "body": 1, "axis": "z", "at_least": 9.4}])");
    scene("flies");
    criterion("flies", "speed", R"("steps": 20, "holds": [{"quantity": "escaped", "at_most": 0}])");
    scene("limited");
    criterion("limited", "speed", R"("steps": 20, "holds": [{"quantity": "speed", "at_most": 11.5}],
      "limits": [{"solver": "impulse", "fails": [{"quantity": "speed", "at_most": 50}], "why": "as tests want it"}])");
    scene("rubs", R"("materials": {"default": {"friction": 0.5}},)");
    criterion("rubs", "restitution and friction",
              R"("steps": 4, "holds": [{"quantity": "speed", "at_most": 100}])");
    scene("turned");
    criterion("turned", "settings", R"("steps": 4, "changes": "turned.changes.json",
      "holds": [{"quantity": "speed", "at_most": 100}])");
    write("turned.changes.json", R"({"format": "collidoscope-changes", "version": 1,
      "changes": [{"step": 2, "time_step": 0.05}]})");
    write("wrong.json", R"({"format": "collidoscope-scene", "version": 1, "name": "Wrong",
      "bodies": [{"radius": 0, "position": [0, 0, 1]}]})");
    criterion("wrong", "bad input", R"("refused": ["bodies[0].radius"])");
  }
  std::string path() const { return folder_.path().string(); }

 private:
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  void scene(const std::string& name, const std::string& more = "") {
    write(name + ".json", R"({"format": "collidoscope-scene", "version": 1, "name": ")" + name + R"(", )" +
                              more +
                              R"("gravity": [0, 0, -10], "time_step": 0.1,
      "bodies": [{"radius": 1, "position": [5, 0, 20]}, {"radius": 1, "position": [0, 0, 10]}]})");
  }
  void criterion(const std::string& name, const std::string& group, const std::string& members) {
    write(name + ".criterion.json", R"({"format": "collidoscope-criterion", "version": 1, "what": "of a test",
      "group": ")" + group + "\", " + members +
                                        "}");
  }

  TemporaryFolder folder_;
};

}  // namespace collidoscope
