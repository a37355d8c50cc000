#include "sim_cuda/run/run_state.h"

#include <type_traits>
#include <utility>

#include "sim_cuda/core/hash.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// Values by new id; `blank` for new bodies. An empty input gives an empty result.
template <class Value>
std::vector<Value> by_new_id(const std::vector<Value>& values, const BodyIdMap& ids, std::size_t count,
                             const Value& blank, std::size_t first = 0) {
  std::vector<Value> moved(values.empty() ? 0 : count, blank);
  for (std::size_t body = 0; body < ids.size() && !values.empty(); ++body)
    if (ids[body] != no_body) moved[ids[body]] = values[first + body];
  return moved;
}

/// Hash of lists, in four lanes, because each word waits for the last one of its lane.
class StateHash {
 public:
  void add(std::uint64_t bits) { lane_[0] = mix64(lane_[0] ^ bits); }
  /// Lists of numbers, or of records that consist of doubles.
  template <class Item>
  void list(const std::vector<Item>& items) {
    add(items.size());
    if constexpr (std::is_integral_v<Item>) {
      for (const Item item : items) add(item);
    } else {
      static_assert(sizeof(Item) % sizeof(double) == 0);
      doubles(reinterpret_cast<const double*>(items.data()), items.size() * (sizeof(Item) / sizeof(double)));
    }
  }
  std::uint64_t value() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t lane : lane_) sum = mix64(sum ^ lane);
    return sum;
  }

 private:
  void doubles(const double* data, std::size_t count) {
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        lane_[lane] = mix64(lane_[lane] ^ hash_bits(data[k + lane]));
    for (; k < count; ++k) add(hash_bits(data[k]));
  }
  static constexpr std::size_t lanes = 4;
  std::uint64_t lane_[lanes] = {};
};

WarmStart remap_bodies(const WarmStart& warm_start, const BodyIdMap& ids, std::size_t count) {
  WarmStart moved;
  moved.sleep_timer = by_new_id(warm_start.sleep_timer, ids, count, 0u);
  const auto wake = [&](std::uint32_t id) {
    if (id < moved.sleep_timer.size()) moved.sleep_timer[id] = 0;
  };
  for (std::size_t k = 0; k < warm_start.contacts.size(); ++k) {
    const ContactImpulse& contact = warm_start.contacts[k];
    const std::uint32_t a = ids[contact.a], b = ids[contact.b];
    if (a == no_body || b == no_body) {
      wake(a);
      wake(b);
      continue;
    }
    moved.contacts.push_back({a, b, contact.impulse});
    if (!warm_start.friction.empty()) moved.friction.push_back(warm_start.friction[k]);
    if (!warm_start.rolling.empty()) moved.rolling.push_back(warm_start.rolling[k]);
  }
  for (WarmStartJoint joint : warm_start.joints) {
    const bool to_world = joint.b == PlacedJoint::world;
    joint.a = ids[joint.a];
    if (!to_world) joint.b = ids[joint.b];
    if (joint.a != no_body && (to_world || joint.b != no_body)) {
      moved.joints.push_back(joint);
    } else {
      wake(joint.a);
      if (!to_world) wake(joint.b);
    }
  }
  // Groups of joints stay the same if no joint is lost.
  if (moved.joints.size() == warm_start.joints.size()) moved.loop_energies = warm_start.loop_energies;
  using Part = std::array<double, 3>;
  for (std::size_t p = 0; p < warm_start.walls.size(); ++p) {
    moved.walls.push_back(by_new_id(warm_start.walls[p], ids, count, 0.0));
    const auto take = [&](const std::vector<Part>& from, std::vector<Part>& to) {
      const std::vector<Part> plane = by_new_id(from, ids, count, Part{}, p * ids.size());
      to.insert(to.end(), plane.begin(), plane.end());
    };
    take(warm_start.wall_friction, moved.wall_friction);
    take(warm_start.wall_rolling, moved.wall_rolling);
  }
  return moved;
}

}  // namespace

std::uint64_t full_hash(const RunState& state) {
  StateHash hash;
  hash.add(static_cast<std::uint64_t>(state.steps));
  hash.add(hash_bits(state.time));
  for (const auto* vectors : {&state.bodies.position, &state.bodies.velocity, &state.bodies.angular_velocity})
    hash.list(*vectors);
  hash.list(state.bodies.orientation);
  hash.list(state.static_impulses);
  hash.list(state.frozen);
  const WarmStart& warm_start = state.warm_start;
  for (const ContactImpulse& contact : warm_start.contacts) {
    hash.add(std::uint64_t{contact.a} << 32 | contact.b);
    hash.add(hash_bits(contact.impulse));
  }
  for (const auto& wall : warm_start.walls) hash.list(wall);
  for (const auto* vectors :
       {&warm_start.friction, &warm_start.wall_friction, &warm_start.rolling, &warm_start.wall_rolling})
    hash.list(*vectors);
  hash.list(warm_start.sleep_timer);
  for (const WarmStartJoint& joint : warm_start.joints) {
    hash.add(std::uint64_t{joint.a} << 32 | joint.b);
    hash.add(joint.kind);
    for (const double part : joint.impulse) hash.add(hash_bits(part));
  }
  hash.list(warm_start.loop_energies);
  return hash.value();
}

RunState remap_bodies(const RunState& state, const BodyIdMap& ids, BodyStates fresh) {
  const std::size_t known = state.bodies.position.size(), count = fresh.position.size();
  if (ids.empty()) {
    BodyIdMap same(known);
    for (std::size_t body = 0; body < known; ++body)
      same[body] = body < count ? static_cast<std::uint32_t>(body) : no_body;
    if (known > 0) return remap_bodies(state, same, std::move(fresh));
  }
  RunState moved{state.steps,
                 std::move(fresh),
                 by_new_id(state.static_impulses, ids, count, StaticImpulse{}),
                 remap_bodies(state.warm_start, ids, count),
                 state.settings,
                 {},
                 state.time};
  for (const std::uint32_t body : state.frozen)
    if (ids[body] != no_body) moved.frozen.push_back(ids[body]);
  for (std::size_t body = 0; body < ids.size(); ++body) {
    if (ids[body] == no_body) continue;
    moved.bodies.position[ids[body]] = state.bodies.position[body];
    moved.bodies.velocity[ids[body]] = state.bodies.velocity[body];
    moved.bodies.orientation[ids[body]] = state.bodies.orientation[body];
    moved.bodies.angular_velocity[ids[body]] = state.bodies.angular_velocity[body];
  }
  return moved;
}

RunState CopiedRunState::complete() {
  bodies.complete(known.bodies);
  warm_start.complete(known.warm_start);
  return std::move(known);
}

std::uint64_t settings_hash(Scene scene) {
  if (!scene.physics.sleep) return 0;
  disable_guards(scene.physics);
  scene.bodies.clear();
  scene.extra_bodies.clear();
  scene.body_files.clear();
  scene.joints.clear();
  for (BoxCollider& generator : scene.generators) {
    generator.count = 0;
    generator.excluded.clear();
  }
  std::uint64_t hash = 0;
  for (const char letter : write_scene(scene)) hash = mix64(hash ^ static_cast<unsigned char>(letter));
  return hash;
}

}  // namespace collidoscope
