#include "sim_cuda/plugin/validation_child.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/philox.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/plugin/validation.h"
#include "sim_cuda/run/box_query.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

using Boxes = std::vector<Aabb>;

/// Random numbers in [0, 1); equal in each run.
class Numbers {
 public:
  explicit Numbers(std::uint32_t stream) : stream_(stream) {}
  float next() {
    return static_cast<float>(philox4x32({{stream_, next_++, 0, 0}}, philox_key(1)).w[0] >> 8) * 0x1p-24f;
  }
  float next(float low, float high) { return low + (high - low) * next(); }

 private:
  std::uint32_t stream_, next_ = 0;
};

Aabb box_at(float x, float y, float z, float half) {
  const Vector3f center(x, y, z), extent(half, half, half);
  return {center - extent, center + extent};
}

Boxes random_boxes(std::uint32_t stream, int count, float side, float smallest, float largest) {
  Numbers random(stream);
  Boxes boxes;
  for (int k = 0; k < count; ++k) {
    const float x = random.next(0, side), y = random.next(0, side), z = random.next(0, side);
    boxes.push_back(box_at(x, y, z, random.next(smallest, largest)));
  }
  return boxes;
}

struct BoxSet {
  const char* name;
  Boxes (*make)();
};
constexpr BoxSet box_sets[] = {
    {"one box", [] { return Boxes{box_at(0, 0, 0, 1)}; }},
    {"two boxes that overlap",
     [] {
       return Boxes{box_at(0, 0, 0, 1), box_at(1, 1, 1, 1)};
     }},
    {"two boxes that touch",
     [] {
       return Boxes{box_at(0, 0, 0, 1), box_at(2, 2, -2, 1)};
     }},
    {"two boxes one bit apart",
     [] {
       Boxes boxes{box_at(0, 0, 0, 1), box_at(2, 0, 0, 1)};
       boxes[1].min[0] = std::nextafter(boxes[1].min[0], 2.0f);
       return boxes;
     }},
    {"points at one place", [] { return Boxes(40, box_at(3, -2, 5, 0)); }},
    {"equal boxes", [] { return Boxes(200, box_at(-1, 2, 3, 0.5f)); }},
    {"empty boxes among others",
     [] {
       Boxes boxes = random_boxes(1, 60, 4, 0.2f, 0.8f);
       for (std::size_t k = 0; k < boxes.size(); k += 3) boxes[k] = Aabb::empty();
       return boxes;
     }},
    {"only empty boxes", [] { return Boxes(5, Aabb::empty()); }},
    {"a line",
     [] {
       Boxes boxes;
       for (int k = 0; k < 300; ++k) boxes.push_back(box_at(0, 0, static_cast<float>(k), 0.5f));
       return boxes;
     }},
    {"a flat layer of one height",
     [] {
       Boxes boxes = random_boxes(2, 500, 30, 0.5f, 1);
       for (Aabb& box : boxes) box.min[2] = box.max[2] = 0;
       return boxes;
     }},
    {"random boxes", [] { return random_boxes(3, 1000, 20, 0.3f, 1); }},
    {"one box around all others",
     [] {
       Boxes boxes = random_boxes(4, 700, 20, 0.1f, 0.4f);
       boxes[350] = box_at(10, 10, 10, 50);
       return boxes;
     }},
    {"sizes from 0.001 to 1000",
     [] {
       Boxes boxes;
       Numbers random(5);
       for (int k = 0; k < 600; ++k) {
         float half = 0.001f;
         for (int power = static_cast<int>(random.next(0, 7)); power > 0; --power) half *= 10;
         boxes.push_back(
             box_at(random.next(-3000, 3000), random.next(-3000, 3000), random.next(-3000, 3000), half));
       }
       return boxes;
     }},
    {"far from the origin",
     [] {
       Boxes boxes = random_boxes(6, 300, 20, 0.3f, 1);
       for (Aabb& box : boxes)
         for (int k = 0; k < 3; ++k) box.min[k] += 1e6f, box.max[k] += 1e6f;
       return boxes;
     }},
    {"two clusters far apart",
     [] {
       Boxes boxes = random_boxes(7, 400, 5, 0.1f, 0.3f);
       for (std::size_t k = 0; k < boxes.size(); k += 2)
         for (int axis = 0; axis < 3; ++axis) boxes[k].min[axis] -= 4e5f, boxes[k].max[axis] -= 4e5f;
       return boxes;
     }},
    {"many boxes", [] { return random_boxes(8, 5000, 30, 0.3f, 1); }},
};

Boxes moved(Boxes boxes, int frame) {
  Numbers random(static_cast<std::uint32_t>(100 + frame));
  for (Aabb& box : boxes) {
    if (is_empty(box)) continue;
    const Vector3f shift(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1));
    box.min += shift;
    box.max += shift;
  }
  return boxes;
}

void answer(const std::string& word, const std::string& value) {
  std::string line = word + ' ' + value;
  std::ranges::replace(line, '\n', ' ');
  line += '\n';
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t written = write(answer_descriptor, line.data() + done, line.size() - done);
    if (written <= 0) _exit(1);  // the other process has ended
    done += static_cast<std::size_t>(written);
  }
}

BoxPairs pairs_by_brute_force(RunOptions options, const Boxes& boxes) {
  options.broad_phase = "brute_force";
  options.executor = ExecutorKind::cpu;
  return BoxQuery(options, boxes).find();
}

std::string faults_of(BoxQuery& query, const BoxPairs& expected, const BoxPairs& found) {
  std::string text;
  const PairDifference difference = compare_pairs(expected, found);
  if (difference.missing > 0) {
    text = fmt::format("{} of {} pairs missing, such as ", difference.missing, expected.second.size());
    for (const auto& [a, b] : difference.missing_examples)
      text += fmt::format("{}{}-{}", text.ends_with(' ') ? "" : ", ", a, b);
  }
  const PairCheck check = query.pair_check().value_or(PairCheck{});
  if (check.is_wrong()) text += (text.empty() ? "" : "; ") + describe(check);
  return text;
}

/// Tests a set of boxes that then move: several objects in turns, the overflow of the list, the replay of a
/// captured step, and the tree.
void test_set(const BoxSet& set, const RunOptions& options) {
  const std::string executor = options.executor == ExecutorKind::cpu ? "cpu" : "cuda";
  Boxes boxes = set.make();
  answer("test", fmt::format("{} ({})", set.name, executor));
  answer("boxes", std::to_string(boxes.size()));
  try {
    BoxQuery query(options, boxes), other(options, {box_at(0, 0, 0, 1), box_at(0, 0, 1, 1)});
    std::string faults;
    std::size_t pairs = 0;
    for (int frame = 0; frame < 3 && faults.empty(); ++frame) {
      if (frame > 0) query.move(boxes = moved(boxes, frame));
      const BoxPairs expected = pairs_by_brute_force(options, boxes);
      if (frame == 0) pairs = expected.second.size();
      faults = faults_of(query, expected, query.find());
      if (other.find().second.size() != 1 && faults.empty())
        faults = "two objects in turns: the second one lacks its pair";
      if (faults.empty() && frame == 0) query.time(2);
      if (faults.empty()) faults = faults_of(query, expected, query.find());
      query.has_tree();
      if (faults.empty()) faults = faults_of(query, expected, expected);
    }
    if (!faults.empty()) answer("fault", faults);
    answer("pairs", std::to_string(pairs));
  } catch (const std::exception& error) {
    answer("fault", error.what());
  }
}

}  // namespace

std::optional<int> run_validation_child(std::span<const std::string> arguments) {
  if (arguments.size() != 3 || arguments[0] != child_flag) return std::nullopt;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // the other process ends this one
  RunOptions options;
  options.gpu = std::atoi(arguments[2].c_str());
  options.cpu_threads = 2;
  try {
    options.broad_phase = load_plugin(arguments[1], file_identity(arguments[1]), false);
  } catch (const InputError& error) {
    answer("refused", error.what());
    return 0;
  }
  answer("name", options.broad_phase);
  const BroadPhaseMethod& method = *find_broad_phase(options.broad_phase);
  for (const ExecutorKind executor : {ExecutorKind::cpu, ExecutorKind::cuda}) {
    const bool on_gpu = executor == ExecutorKind::cuda;
    if (on_gpu ? method.cpu_only || !cuda_available() : method.gpu_only) continue;
    options.executor = executor;
    for (const BoxSet& set : box_sets) test_set(set, options);
  }
  answer("end", "");
  return 0;
}

}  // namespace collidoscope
