// Tests files of other programs in the window: on the command line, dropped, and as a series.

#include <gmock/gmock.h>

#include <fstream>

#include "tests/npy_file.h"
#include "tests/run_program.h"
#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

class ViewerFiles : public Viewer {
 protected:
  /// Three spheres, moved along x by `shift`.
  std::string file(const std::string& name, double shift) {
    std::ofstream out(folder_ / name);
    out << "x,y,z,radius\n";
    for (int k = 0; k < 3; ++k) out << 3 * k + shift << "," << k << ",0," << 1 + 0.25 * k << "\n";
    return folder_ / name;
  }
  /// The state hash of a file's bodies, computed without a window.
  static std::string hash_of(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"run", "--steps", "0", "--json", "-"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return Json::parse(run_headless(all).out)["state_hash"];
  }
  static Json shown_hash(WindowDriver& window) {
    window.wait_for([](const Json& f) { return f["state_hash"].is_string(); });
    return window.frame()["state_hash"];
  }
  TemporaryFolder folder_;
};

TEST_F(ViewerFiles, OpenAndPauseAtTheirState) {
  const std::string bodies = file("bodies.csv", 0);
  WindowDriver window({bodies});
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false; }));
  EXPECT_EQ(shown_hash(window), hash_of({bodies}));
  EXPECT_EQ(window.frame()["step"], 0);
  EXPECT_THAT(window.frame()["last_notice"].get<std::string>(), HasSubstr("table (CSV), 3 bodies"));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerFiles, ReplaceTheRunWhenDropped) {
  const std::string bodies = file("dropped bodies.csv", 5);
  WindowDriver window({"box_collider", "--bodies", "50"});
  std::string uri = bodies;
  uri.replace(uri.find(' '), 1, "%20");
  window.drop_file(uri);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 3; }));
  EXPECT_EQ(shown_hash(window), hash_of({bodies}));
  EXPECT_EQ(window.frame()["playing"], false);

  // A file that cannot be opened leaves the run as it is.
  std::ofstream(folder_ / "bad.csv") << "x,y,z\n1,2,three\n";
  window.drop_file(folder_ / "bad.csv");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["error"].is_string(); }));
  EXPECT_THAT(window.frame()["error"].get<std::string>(), HasSubstr("bad.csv:2:5: three is not a number"));
  EXPECT_EQ(window.frame()["bodies"], 3);
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerFiles, OfPluginsAreLoadedAfterAQuestion) {
  const std::filesystem::path plugins = program_folder() / "plugins";
  const std::string library = std::filesystem::canonical(plugins / "libsweep_and_prune.so");
  WindowDriver window({"box_collider", "--bodies", "50", "--executor", "cpu"});
  window.drop_file(library);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["widgets"].contains("plugin.load"); }));
  window.click("plugin.cancel");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("plugin.load"); }));
  EXPECT_EQ(window.frame()["broad_phase"], "lbvh_ropes");

  window.drop_file(library);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["widgets"].contains("plugin.load"); }));
  window.click("plugin.load");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["broad_phase"] == "sweep_and_prune"; }));
  ASSERT_TRUE(
      window.wait_for([](const Json& f) { return f["pairs_note"] == "plug-in, pairs not compared"; }));
  EXPECT_THAT(window.frame()["last_notice"].get<std::string>(),
              HasSubstr("tests passed; the run is saved in "));

  // A recording has the run, but does not name the library.
  window.key("s");
  window.key("ctrl+s");
  ASSERT_TRUE(window.wait_for(
      [](const Json& f) { return f["last_notice"].get<std::string>().starts_with("wrote "); }));
  std::string recording = window.frame()["last_notice"];
  recording.erase(0, std::string("wrote ").size());
  const Outcome replay = run_headless({"replay", window.file(recording), "--executor", "cpu"});
  EXPECT_EQ(replay.status, 0) << replay.err;
  EXPECT_EQ(close(window), "");
}

/// Two boxes that overlap and one apart, with a tree.
TEST_F(ViewerFiles, OfBoxesAndATreeAreInspected) {
  const std::string boxes =
      box_file(folder_ / "boxes.npy", {0, 0, 0, 4, 1, 1, 3, 0, 0, 5, 1, 1, 8, 0, 0, 9, 1, 1});
  const std::vector<float> nodes{0, 0, 0, 9, 1, 1, -1, -1, 0, 0, 0, 4, 1, 1, 0, 0,
                                 3, 0, 0, 5, 1, 1, 0,  1,  8, 0, 0, 9, 1, 1, 0, 2};
  const std::string tree =
      write_npy(folder_ / "tree.npy",
                npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (4, 8), }", data_of(nodes)));
  WindowDriver window({"--boxes", boxes, "--tree", tree, "--executor", "cpu"});
  ASSERT_TRUE(
      window.wait_for([](const Json& f) { return f["drawn"]["boxes"] == 4 && f["tree"].is_object(); }));
  EXPECT_EQ(window.frame()["tree"]["nodes"], 4);
  EXPECT_EQ(window.frame()["pairs"], 1);
  EXPECT_EQ(window.frame()["drawn"]["spheres"], 0);
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1; }));
  EXPECT_EQ(window.frame()["pairs"], 1);
  EXPECT_EQ(window.frame()["contacts"], 0);

  window.drop_file(boxes);  // without the tree
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["drawn"]["boxes"] == 5 && f["step"] == 0; }));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerFiles, AskForColumnsThatTheyDoNotName) {
  const std::string name = folder_ / "unclear.csv";
  std::ofstream(name) << "a,b,c,r\n0,1,2,0.5\n4,5,6,0.25\n";
  WindowDriver window({"box_collider", "--bodies", "50"});
  window.drop_file(name);
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["widgets"].contains("columns.1"); }));
  EXPECT_FALSE(window.sees("columns.open")) << "x and y are not known";
  EXPECT_EQ(window.frame()["bodies"], 50);
  const auto choose = [&](const std::string& column, const std::string& quantity) {
    window.click(column);
    window.click(column + "." + quantity);
  };
  choose("columns.3", "x");
  choose("columns.2", "y");
  choose("columns.1", "z");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["widgets"].contains("columns.open"); }));
  window.click("columns.open");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["bodies"] == 2; }));
  EXPECT_EQ(shown_hash(window), hash_of({name, "--columns", "x=c,y=b,z=a"}));

  // A second choice: the column r is not used; a radius, and a unit of 2 m.
  window.click("run.columns");
  choose("columns.4", "not used");
  window.type_into("columns.radius", "3");
  window.type_into("columns.scale", "2");
  window.click("columns.open");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("columns.1"); }));
  ASSERT_TRUE(window.wait_for([&](const Json& f) {
    return f["state_hash"] ==
           hash_of({name, "--columns", "x=3,y=2,z=1,radius=none", "--radius", "3", "--scale", "2"});
  }));

  window.click("run.columns");
  window.click("columns.cancel");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return !f["widgets"].contains("columns.1"); }));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerFiles, OfASeriesArePlayed) {
  std::vector<std::string> files;
  for (const int number : {10, 2, 1})
    files.push_back(file("frame_" + std::to_string(number) + ".csv", number));
  WindowDriver window(files);
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "frame_1.csv"}));
  window.key("s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1; }));
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "frame_2.csv"}));
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 2 && f["playing"] == false; }));
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "frame_10.csv"}));
  window.key("shift+s");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1; }));
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "frame_2.csv"}));
  EXPECT_EQ(close(window), "");
}

TEST_F(ViewerFiles, WithFramesArePlayed) {
  std::ofstream(folder_ / "two.xyz") << "2\na\nH 0 0 0\nH 3 0 0\n2\nb\nH 1 0 0\nH 4 0 0\n";
  WindowDriver window({folder_ / "two.xyz", "--radius", "0.5"});
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "two.xyz", "--radius", "0.5"}));
  window.key("space");
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 1 && f["playing"] == false; }));
  EXPECT_EQ(shown_hash(window), hash_of({folder_ / "two.xyz", "--radius", "0.5", "--frame", "1"}));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
