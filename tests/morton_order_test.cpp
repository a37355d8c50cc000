// Tests the order of a tree's leaves: sorted by all bits of their Morton keys, equal keys by id, with every
// sort method.

#include "sim_cuda/broad_phase/morton.h"

#include <algorithm>

#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/scene/crowded_scenes.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

/// The tree as reported by inspection, in level order.
struct Reported {
  std::vector<NodeReport> nodes;
  explicit Reported(World& world) {
    std::vector<std::uint32_t> places(static_cast<std::size_t>(world.tree().nodes()));
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = static_cast<std::uint32_t>(k);
    world.tree().quality();
    nodes = world.tree().nodes_at(places);
  }
  /// Bodies of the leaves from left to right.
  std::vector<std::uint32_t> leaves() const {
    std::vector<std::uint32_t> bodies, waiting{0};
    while (!waiting.empty()) {
      const NodeReport& node = nodes[waiting.back()];
      waiting.pop_back();
      if (node.children == 0) bodies.push_back(node.body);
      for (std::uint32_t k = node.children; k-- > 0;) waiting.push_back(node.first_child + k);
    }
    return bodies;
  }
  friend bool operator==(const Reported& a, const Reported& b) {
    return std::ranges::equal(a.nodes, b.nodes, [](const NodeReport& x, const NodeReport& y) {
      return x.children == y.children && x.first_child == y.first_child && x.body == y.body &&
             std::equal(x.min, x.min + 3, y.min) && std::equal(x.max, x.max + 3, y.max);
    });
  }
};

/// Morton key of each body, from the float box that its world uses.
std::vector<std::uint64_t> keys_of(World& world, int bits) {
  const BodyStates states = world.bodies();
  const Box& box = *world.initial().box;
  const Aabb extent{box.min.cast<float>(), box.max.cast<float>()};
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < states.position.size(); ++i) {
    const Vector3f position = states.position[i].cast<float>();
    const auto radius = static_cast<float>(world.initial().radius[i]);
    Aabb bounds;
    BodyBounds<float>{&position, &radius, &bounds}(0);
    keys.push_back(bits == 63 ? morton_key<std::uint64_t>(bounds, extent)
                              : morton_key<std::uint32_t>(bounds, extent) >> (30 - bits));
  }
  return keys;
}

/// 30 % of the bodies are in a corner of a thousandth of the box's width, the rest is spread over the box.
Scene corner_of_a_gas(std::int64_t count) {
  Scene scene = box_collider(0);
  scene.generators.clear();
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(100, 100, 100)};
  Random random(5);
  const auto unit = [&] { return random() / 4294967296.0; };
  for (std::int64_t i = 0; i < count; ++i) {
    const double side = i % 10 < 3 ? 0.1 : 100;
    scene.bodies.push_back(sphere(0.01, Vector3d(side * unit(), side * unit(), side * unit())));
  }
  return scene;
}

struct NamedScene {
  std::string name;
  Scene scene;
};
/// In the crowded scenes, one cell of the counting sort holds hundreds of bodies.
std::vector<NamedScene> scenes_to_sort() {
  std::vector<NamedScene> scenes{{"scaled", box_collider(800, Variant::scaled)},
                                 {"corner", corner_of_a_gas(800)}};
  for (const std::string& name : crowded_scene_names())
    scenes.push_back({name, crowded_scene(name, 800, 7, box_collider(0))});
  Scene coincident = corner_of_a_gas(500);
  for (Body& body : coincident.bodies) body.position = Vector3d(1, 2, 3);
  scenes.push_back({"coincident", coincident});
  return scenes;
}

class MortonOrders : public OnEachExecutor {
 protected:
  World world(const Scene& scene, const std::string& method, int bits, SortMethod sort) const {
    RunOptions o = options();
    o.broad_phase = method;
    o.key_bits = bits;
    o.sort = sort;
    return World(scene, o);
  }
};
ON_EACH_EXECUTOR(MortonOrders);

constexpr SortMethod sorts[] = {SortMethod::automatic, SortMethod::library, SortMethod::radix};

TEST_P(MortonOrders, AreSortedByAllBitsThenById) {
  for (const auto& [name, scene] : scenes_to_sort())
    for (const char* method : {"lbvh_ropes", "bvh_bottom_up", "lbvh_top_down", "refit"})
      for (const int bits : {24, 30, 63})
        for (const SortMethod sort : sorts) {
          World w = world(scene, method, bits, sort);
          const std::vector<std::uint64_t> keys = keys_of(w, bits);
          std::vector<std::uint32_t> expected(keys.size());
          for (std::size_t k = 0; k < keys.size(); ++k) expected[k] = static_cast<std::uint32_t>(k);
          std::ranges::stable_sort(expected, {}, [&](std::uint32_t body) { return keys[body]; });
          ASSERT_EQ(Reported(w).leaves(), expected)
              << name << ", " << method << ", " << bits << " bits, sort " << static_cast<int>(sort);
        }
}

TEST_P(MortonOrders, MakeOneTreeWhateverSortsAndInWhateverOrderBodiesArrive) {
  for (const auto& [name, scene] : scenes_to_sort())
    for (const char* method : {"lbvh_ropes", "ploc"})
      for (const int bits : {30, 63}) {
        World first = world(scene, method, bits, SortMethod::library);
        const Reported tree(first);
        for (const SortMethod sort : sorts)
          for (const LaunchShape shape : {LaunchShape{0, 0}, LaunchShape{3, 37}})
            for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled}) {
              if (GetParam() == ExecutorKind::cuda && order != LaneOrder::contiguous) continue;
              RunOptions o = options();
              o.broad_phase = method;
              o.key_bits = bits;
              o.sort = sort;
              o.shape = shape;
              o.lane_order = order;
              World other(scene, o);
              ASSERT_EQ(Reported(other), tree)
                  << name << ", " << method << ", " << bits << " bits, sort " << static_cast<int>(sort)
                  << ", B " << shape.blocks << ", order " << static_cast<int>(order);
            }
      }
}

/// The order uses as many bits as are reported.
TEST_P(MortonOrders, ReportTheirBits) {
  for (const int bits : {24, 30, 63})
    EXPECT_EQ(world(corner_of_a_gas(200), "lbvh_ropes", bits, SortMethod::automatic).info().key_bits, bits);
}

/// The default key length needs at most twice the visits of the best key length.
TEST_P(MortonOrders, AreGoodByDefault) {
  std::vector<NamedScene> scenes = scenes_to_sort();
  scenes.push_back({"paper", box_collider(800, Variant::paper)});
  for (const auto& [name, scene] : scenes)
    for (const char* method :
         {"lbvh_ropes", "bvh_bottom_up", "bvh_recursive", "lbvh_top_down", "refit", "ploc"})
      for (const SortMethod sort : {SortMethod::automatic, SortMethod::library}) {
        double best = 1e30;
        for (const int bits : {24, 30, 63})
          best = std::min(best, world(scene, method, bits, sort).tree().own_visits());
        World automatic = world(scene, method, 0, sort);
        EXPECT_LE(automatic.tree().own_visits(), 2 * best)
            << name << ", " << method << ", sort " << static_cast<int>(sort) << ", "
            << automatic.info().key_bits << " bits";
      }
}

}  // namespace
}  // namespace collidoscope
