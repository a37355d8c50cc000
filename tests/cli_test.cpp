// Tests the results of the headless program: files, reports and the split between stdout and stderr. The
// tests run the real program, as a user does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <tuple>

#include "sim_cuda/core/physics_version.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::EndsWith;
using testing::HasSubstr;

std::vector<std::vector<double>> numbers_of_csv(const fs::path& file, std::string& header) {
  const std::vector<std::string> lines = text_lines(text_of(file));
  header = lines.at(0);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    rows.emplace_back();
    std::istringstream row(lines[i]);
    for (std::string cell; std::getline(row, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

TEST(Cli, HelpAndVersionAreResults) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"run", "--help"},
                                                    {"capture", "--help"},
                                                    {"bench", "--help"},
                                                    {"--version"}}) {
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, HasSubstr("collidoscope-headless"));
    EXPECT_EQ(outcome.err, "");
  }
}

TEST(Cli, AFullDiskBehindStdoutIsAnError) {
  const Outcome outcome = run_headless({"run", "one_body", "--steps", "1"}, "/dev/full");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.err, "stdout: writing failed: No space left on device\n");
}

TEST(Cli, JsonOnStdoutStandsAloneWithEveryField) {
  const Outcome outcome =
      run_headless({"run", "box_collider", "--bodies", "300", "--steps", "6", "--executor", "cpu", "--blocks",
                    "2", "--threads", "4", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report.at("scene"), "Box Collider");
  EXPECT_EQ(report.at("executor"), "cpu");
  EXPECT_TRUE(report.at("device").is_string());
  EXPECT_EQ(report.at("physics_version"), physics_version);
  EXPECT_EQ(report.at("bodies"), 300);
  EXPECT_EQ(report.at("blocks"), 2);
  EXPECT_EQ(report.at("threads"), 4);
  EXPECT_EQ(report.at("steps"), 6);
  EXPECT_EQ(report.at("broad_phase"), "lbvh_ropes");
  EXPECT_EQ(report.at("solver"), "soft_step");
  EXPECT_EQ(report.at("precision"), "f32");
  EXPECT_EQ(report.at("effects"), json::array({"gravity"}));
  EXPECT_THAT(report.at("state_hash").get<std::string>(), testing::MatchesRegex("[0-9a-f]{16}"));
  EXPECT_GE(report.at("pairs").at("aabb").get<long>(), report.at("pairs").at("contacts").get<long>());
  EXPECT_TRUE(report.at("energy").at("initial").is_number_float());
  EXPECT_TRUE(report.at("energy").at("final").is_number_float());
  EXPECT_EQ(report.at("momentum").size(), 3u);
  EXPECT_EQ(report.at("angular_momentum").size(), 3u);
  EXPECT_TRUE(report.at("max_penetration").is_number());
  EXPECT_EQ(report.at("non_finite"), 0);
  EXPECT_EQ(report.at("escaped"), 0);
  EXPECT_TRUE(report.at("wall_impulse").is_number());
  EXPECT_GT(report.at("allocated_bytes").get<long>(), 300 * 28);
  EXPECT_GT(report.at("step_median_ms").get<double>(), 0);
  ASSERT_FALSE(report.at("stages").empty());
  for (const json& stage : report.at("stages")) {
    EXPECT_FALSE(stage.at("name").get<std::string>().empty());
    EXPECT_GE(stage.at("p95_ms").get<double>(), stage.at("median_ms").get<double>());
    EXPECT_TRUE(stage.at("launches").is_number_integer());
  }
}

TEST(Cli, HowItRunsChangesNoHash) {
  const auto hash = [](std::vector<std::string> more) {
    std::vector<std::string> arguments{"run",     "box_collider", "--bodies", "400",
                                       "--steps", "20",           "--json",   "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? json::parse(outcome.out).at("state_hash").get<std::string>() : "";
  };
  const std::string once = hash({});
  EXPECT_EQ(hash({}), once);
  EXPECT_EQ(hash({"--executor", "cpu", "--blocks", "3", "--threads", "37", "--cpu-threads", "2"}), once);
  EXPECT_EQ(hash({"--executor", "cpu", "--cpu-item-order", "shuffled", "--blocks", "2", "--threads", "4"}),
            once);
  EXPECT_EQ(hash({"--initial-pair-capacity", "1"}), once);
  EXPECT_EQ(hash({"--broad-phase", "brute_force"}), once);
  // The hash depends on the physics.
  EXPECT_NE(hash({"--seed", "2"}), once);
  EXPECT_NE(hash({"--precision", "f64"}), once);
}

TEST(Cli, TheFilesOfARunAgreeWithItsReport) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_headless({"run", "box_collider", "--bodies", "250", "--steps", "9", "--gravity", "0,0,-4", "--json",
                    folder / "report.json", "--dump-bodies", folder / "bodies.csv", "--dump-dynamics",
                    folder / "dynamics.csv", "--energy-trace", folder / "energy.csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasSubstr("state hash"));
  EXPECT_EQ(folder.names(),
            (std::set<std::string>{"bodies.csv", "dynamics.csv", "energy.csv", "report.json"}));
  const json report = json::parse(text_of(folder / "report.json"));

  std::string header;
  const auto bodies = numbers_of_csv(folder / "bodies.csv", header);
  EXPECT_EQ(header, "id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
  ASSERT_EQ(bodies.size(), 250u);
  double kinetic = 0, potential = 0, momentum[3] = {};
  for (std::size_t id = 0; id < bodies.size(); ++id) {
    const auto& row = bodies[id];
    ASSERT_EQ(row.size(), 16u);
    EXPECT_EQ(row[0], static_cast<double>(id));
    const double mass = row[2], radius = row[1];
    EXPECT_NEAR(mass, 1000 * 4.0 / 3 * M_PI * radius * radius * radius, 1e-5 * mass);  // the density is 1000
    EXPECT_EQ(row[6], 1);                                                              // no rotation
    for (int axis = 0; axis < 3; ++axis) {
      kinetic += mass * row[10 + axis] * row[10 + axis] / 2;
      momentum[axis] += mass * row[10 + axis];
    }
    potential += mass * 4 * row[5];  // the box begins at z = 0
  }
  EXPECT_NEAR(report["energy"]["final"].get<double>(), kinetic + potential, 1e-6 * (kinetic + potential));
  const double scale = std::abs(momentum[2]);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(report["momentum"][axis].get<double>(), momentum[axis], 1e-6 * scale);

  const auto dynamics = numbers_of_csv(folder / "dynamics.csv", header);
  EXPECT_EQ(header,
            "id,mass,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22,px,py,pz,lx,ly,lz,"
            "i00,i01,i02,i10,i11,i12,i20,i21,i22,fx,fy,fz,tx,ty,tz");
  ASSERT_EQ(dynamics.size(), 250u);
  for (std::size_t id = 0; id < dynamics.size(); ++id) {
    const auto &row = dynamics[id], &body = bodies[id];
    ASSERT_EQ(row.size(), 35u);
    EXPECT_EQ(row[1], body[2]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(row[2 + axis], body[3 + axis]);
      EXPECT_DOUBLE_EQ(row[14 + axis], body[2] * body[10 + axis]);
      EXPECT_EQ(row[32 + axis], 0);
    }
    EXPECT_NEAR(row[20], 1 / (0.4 * body[2] * body[1] * body[1]), 1e-5 * row[20]);  // 2/5 m r^2
    EXPECT_DOUBLE_EQ(row[31], -4 * body[2]);
  }

  const auto energy = numbers_of_csv(folder / "energy.csv", header);
  EXPECT_EQ(
      header,
      "step,kinetic,potential,push_work,total,pairs,touching,speculative,uncoloured_contacts,bounce_cap,"
      "max_penetration,escaped");
  ASSERT_EQ(energy.size(), 10u);  // states 0 to 9
  EXPECT_EQ(energy.front()[4], report["energy"]["initial"].get<double>());
  EXPECT_EQ(energy.back()[4], report["energy"]["final"].get<double>());
  EXPECT_EQ(energy.back()[5], report["pairs"]["aabb"].get<double>());
  EXPECT_EQ(energy.back()[6], report["pairs"]["touching"].get<double>());
  EXPECT_EQ(energy.back()[7], report["pairs"]["speculative"].get<double>());
}

TEST(Cli, ASpinningBodysDynamicsFollowBaraff) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_headless({"run", "spinning_top", "--steps", "25", "--precision", "f64", "--dump-bodies",
                    folder / "b.csv", "--dump-dynamics", folder / "d.csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::string header;
  const auto bodies = numbers_of_csv(folder / "b.csv", header),
             dynamics = numbers_of_csv(folder / "d.csv", header);
  ASSERT_FALSE(dynamics.empty());
  for (std::size_t id = 0; id < dynamics.size(); ++id) {
    const auto &d = dynamics[id], &b = bodies[id];
    double spin = 0;
    for (int row = 0; row < 3; ++row) {
      double orthogonal = 0, velocity = 0;
      for (int column = 0; column < 3; ++column) {
        orthogonal += d[5 + 3 * row + column] * d[5 + 3 * row + column];
        velocity += d[20 + 3 * row + column] * d[17 + column];  // w = I^-1 L
        EXPECT_NEAR(d[20 + 3 * row + column], d[20 + 3 * column + row], 1e-12 * std::abs(d[20]));
      }
      EXPECT_NEAR(orthogonal, 1, 1e-12);
      spin += b[13 + row] * b[13 + row];
      EXPECT_NEAR(velocity, b[13 + row], 1e-9 * std::max(1.0, std::sqrt(spin)));
    }
    EXPECT_GT(spin, 0);
  }
}

TEST(Cli, AnExistingFileIsReplacedAndALinkStaysALink) {
  const TemporaryFolder folder;
  std::ofstream(folder / "real.json") << "old";
  fs::create_symlink("real.json", folder / "link.json");
  ASSERT_EQ(run_headless({"run", "one_body", "--steps", "1", "--json", folder / "link.json"}).status, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link.json"));
  EXPECT_EQ(json::parse(text_of(folder / "real.json")).at("steps"), 1);
}

TEST(Cli, ADeviceIsWrittenInPlace) {
  ASSERT_EQ(run_headless({"run", "one_body", "--steps", "1", "--json", "/dev/null"}).status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(Cli, MeshesAreSaidToCollideAsSpheres) {
  const Outcome outcome = run_headless({"run", "tumbling_mesh", "--steps", "2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "note: mesh bodies collide as their bounding spheres\n");
  EXPECT_EQ(run_headless({"run", "one_body", "--steps", "2"}).err, "");
}

TEST(Cli, AnEmptySceneAndNoStepsAreFine) {
  for (const char* scene : {"empty", "one_body"}) {
    const Outcome outcome = run_headless({"run", scene, "--steps", "0", "--json", "-"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json report = json::parse(outcome.out);
    EXPECT_EQ(report.at("steps"), 0);
    EXPECT_TRUE(report.at("step_median_ms").is_null());  // no step was timed
  }
}

TEST(Cli, ChangesAreMadeAndCheckedAgainstWhatWasRecorded) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& changes, std::vector<std::string> more = {}) {
    std::ofstream(folder / "changes.json")
        << "{\"format\": \"collidoscope-changes\", \"version\": 1, " << changes;
    more.insert(more.begin(), {"run", "box_collider", "--bodies", "60", "--json", "-", "--changes",
                               folder / "changes.json"});
    return run_program(program_folder() / "collidoscope-headless", more);
  };
  const std::string changes =
      "\"changes\": [{\"step\": 3, \"bodies\": 80}, {\"step\": 5, \"remove\": [2]}, {\"step\": 5, "
      "\"time_step\": 0.01}]";
  const Outcome first = run(changes + "}", {"--steps", "9"});
  ASSERT_EQ(first.status, 0) << first.err;
  const json report = json::parse(first.out);
  EXPECT_EQ(report["bodies"], 79);
  EXPECT_EQ(report["steps"], 9);
  const std::string hash = report["state_hash"];

  const std::string end = ", \"end\": {\"step\": 9, \"state_hash\": \"";
  const std::string version = "\", \"physics_version\": " + std::to_string(physics_version) + "}}";
  const Outcome again = run(changes + end + hash + version);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(json::parse(again.out)["state_hash"], hash) << "it stops at the end that was recorded";
  EXPECT_EQ(again.err, "");
  const Outcome other = run(changes + end + "0123456789abcdef" + version);
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("state 9: recorded hash 0123456789abcdef, actual hash " + hash));
  const Outcome older = run(changes + end + "0123456789abcdef\"}}");
  EXPECT_EQ(older.status, 0) << older.err;
  EXPECT_EQ(older.err,
            "note: " + (folder / "changes.json").string() + ": cannot compare hashes: physics version 1\n");
  const Outcome soon = run(changes + end + hash + version, {"--steps", "4"});
  EXPECT_EQ(soon.status, 0);
  EXPECT_THAT(soon.err, HasSubstr("the run ended before 2 of the changes in this file"));

  const Outcome wrong = run("\"changes\": [\n {\"step\": 3, \"remove\": [60]}]}");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("changes.json:2:25: body 60 does not exist; ids must be below 60"));
  EXPECT_EQ(run_program(program_folder() / "collidoscope-headless",
                        {"run", "box_collider", "--changes", folder / "none.json"})
                .status,
            2);
}

TEST(Run, EffectsWithNothingToActOnChangeNothing) {
  const auto run = [](const std::string& scene, const std::string& effects) {
    const Outcome outcome = run_headless(
        {"run", scene, "--executor", "cpu", "--effects", effects, "--steps", "3", "--json", "-"});
    EXPECT_EQ(outcome.status, 0) << scene << ", " << effects << ": " << outcome.err;
    return outcome.status == 0 ? json::parse(outcome.out)["state_hash"] : json();
  };
  for (const std::string scene : {"one_body", "empty"}) {
    const json plain = run(scene, "gravity");
    for (const std::string effect : {"attractor", "joints", "continuous_collision", "guards", "drag"})
      EXPECT_EQ(run(scene, "gravity," + effect), plain) << effect;
    EXPECT_EQ(run(scene, "gravity,rotation,friction,rolling_resistance,joints"),
              run(scene, "gravity,rotation"));
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "changes.json")
      << R"({"format": "collidoscope-changes", "version": 1, "changes": [{"step": 2, "effects": ["joints"]}]})";
  const Outcome changed =
      run_headless({"run", "one_body", "--steps", "4", "--changes", folder / "changes.json"});
  EXPECT_EQ(changed.status, 0) << changed.err;
}

TEST(Run, AnEndBeforeTheSnapshotIsRefused) {
  const TemporaryFolder folder;
  const std::string saved = folder / "s", changes = folder / "changes.json";
  ASSERT_EQ(run_headless({"run", "one_body", "--steps", "2", "--save", saved}).status, 0);
  const auto run = [&](int step) {
    std::ofstream(changes) << R"({"format": "collidoscope-changes", "version": 1, "changes": [],
"end": {"step": )" << step << R"(, "state_hash": "0123456789abcdef", "physics_version": )"
                           << physics_version << "}}";
    return run_headless({"run", "--load", saved, "--changes", changes});
  };
  const Outcome early = run(1);
  EXPECT_EQ(early.status, 2);
  EXPECT_EQ(
      early.err,
      changes + ":2:17: lies before state 2, where the run continues; must be that state or a later one\n");
  EXPECT_EQ(run(2).status, 1) << "another hash";
}

TEST(Run, ReportsNoStageTimeThatWasNotTaken) {
  const Outcome outcome = run_headless({"run", "one_body", "--steps", "1", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json stages = json::parse(outcome.out)["stages"];
  for (const json& stage : stages) EXPECT_TRUE(stage["median_ms"].is_null()) << stage;
}

TEST(Capture, RefusesAFileThatIsAlsoAPicture) {
  const TemporaryFolder folder;
  const std::string out = folder.path(), picture = folder / "one_body_0030.png";
  const Outcome outcome = run_headless({"capture", "one_body", "--out", out, "--json", picture});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "--json: " + picture + " is also the picture of state 30; expected a different file\n");
  EXPECT_EQ(folder.files(), 0u);
}

TEST(Capture, PrintsTheCountsOfTheStateWhateverIsDrawn) {
  const TemporaryFolder folder;
  const std::vector<std::string> scene{"box_collider", "--bodies", "300", "--executor", "cpu"};
  std::vector<std::string> capture{"capture"}, run{"run"};
  for (auto* command : {&capture, &run}) command->insert(command->end(), scene.begin(), scene.end());
  run.insert(run.end(), {"--steps", "0", "--json", "-"});
  const json pairs = json::parse(run_headless(run).out)["pairs"];
  ASSERT_GT(pairs["touching"].get<int>(), 0);
  capture.insert(capture.end(),
                 {"--states", "0", "--size", "64x64", "--out", folder.path(), "--layers", "walls"});
  const Outcome outcome = run_headless(capture);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("state 0  bodies 300  boxes drawn 0  touching " + pairs["touching"].dump() + "\n"));
}

TEST(Capture, DrawsWhatOpenGlAllowsWhereSamplesAreAutomatic) {
  const TemporaryFolder folder;
  for (const char* layers : {"spheres", "spheres,ui"}) {
    const Outcome outcome = run_headless({"capture", "one_body", "--states", "0", "--quality", "quick",
                                          "--size", "16384x16", "--layers", layers, "--out", folder.path()});
    EXPECT_EQ(outcome.status, 0) << layers << ": " << outcome.err;
  }
}

TEST(Cli, HelpOffersWhatTheCommandTakes) {
  EXPECT_THAT(run_headless({"capture", "--help"}).out, HasSubstr("--json FILE "));
  EXPECT_THAT(run_headless({"compare", "--help"}).out, HasSubstr("--json - "));
  EXPECT_THAT(run_headless({"run", "--help"}).out, HasSubstr("--json FILE|- "));
  const Outcome automatic =
      run_headless({"run", "one_body", "--steps", "1", "--substeps", "auto", "--json", "-"});
  ASSERT_EQ(automatic.status, 0) << automatic.err;
  EXPECT_EQ(json::parse(automatic.out)["substeps"], 4);
}

}  // namespace
}  // namespace collidoscope
