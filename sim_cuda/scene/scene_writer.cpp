// Structs to scene files: the canonical text, in the order of README.md's table. What is unset in the struct
// or at a body's default is left out; numbers are the shortest decimals that read back as the same bits.

#include <fmt/format.h>

#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

std::string json_text(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string list(const Vector3d& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }

/// Equal in every bit: -0 is not 0 here, so that it survives.
bool same(const Vector3d& a, const Vector3d& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::bit_cast<std::uint64_t>(a[axis]) != std::bit_cast<std::uint64_t>(b[axis])) return false;
  }
  return true;
}

bool is_default(const Quaterniond& q) {
  return q.w() == 1 && same(Vector3d(q.x(), q.y(), q.z()), Vector3d(0, 0, 0));
}

/// Members of an object or items of a list, with commas between them.
class Items {
 public:
  Items(std::string& text, std::string separator) : text_(text), separator_(std::move(separator)) {}
  std::string& next() {
    text_ += first_ ? "" : separator_;
    first_ = false;
    return text_;
  }
  void member(std::string_view key, std::string_view value) {
    next() += json_text(key) + ": " + std::string(value);
  }

 private:
  std::string& text_;
  std::string separator_;
  bool first_ = true;
};

class SceneWriter {
 public:
  explicit SceneWriter(const Scene& scene) : scene_(scene) {}

  std::string write() {
    const Physics& physics = scene_.physics;
    std::string text = "{\n  ";
    Items root(text, ",\n  ");
    root.member("format", json_text("collidoscope-scene"));
    root.member("version", "1");
    root.member("name", json_text(scene_.name));
    if (scene_.box) {
      root.member("box",
                  fmt::format(R"({{"min": {}, "max": {}}})", list(scene_.box->min), list(scene_.box->max)));
    }
    root.member("gravity", list(physics.gravity));
    root.member("drag", fmt::format(R"({{"viscosity": {}, "density": {}, "coefficient": {}}})",
                                    physics.drag.viscosity, physics.drag.density, physics.drag.coefficient));
    root.member("attractors", items(physics.attractors, [&](const Attractor& a) { return one(a); }));
    if (physics.steps_per_second) {
      root.member("steps_per_second", fmt::format("{}", *physics.steps_per_second));
    } else {
      root.member("time_step", fmt::format("{}", physics.time_step));
    }
    root.member("substeps", physics.substeps ? fmt::format("{}", *physics.substeps) : json_text("auto"));
    root.member("iterations", fmt::format("{}", physics.iterations));
    root.member("solver", json_text(name_of(solver_names, physics.solver)));
    root.member("integrator", json_text(name_of(integrator_names, physics.integrator)));
    root.member("rotation_update", json_text(name_of(rotation_update_names, physics.rotation_update)));
    root.member("precision", json_text(name_of(precision_names, physics.precision)));
    root.member("effects", write_effects(physics.effects));
    root.member("restitution_threshold", physics.restitution_threshold
                                             ? fmt::format("{}", *physics.restitution_threshold)
                                             : json_text("auto"));
    if (const auto& sleep = physics.sleep)
      root.member("sleep", fmt::format(R"({{"speed": {}, "time": {}}})", sleep->speed, sleep->time));
    if (const auto& guards = physics.guards)
      root.member("guards", fmt::format(R"({{"on_failure": {}, "speed": {}, "distance": {}, "spin": {}}})",
                                        json_text(name_of(on_failure_names, guards->on_failure)),
                                        guards->speed, guards->distance, guards->spin));
    root.member("materials", materials());
    root.member("bodies", items(scene_.bodies, [&](const Body& body) { return one(body); }));
    root.member("generators", items(scene_.generators, [&](const BoxCollider& g) { return one(g); }));
    if (!scene_.added.empty())
      root.member("added", items(scene_.added, [&](const Body& body) { return one(body); }));
    root.member("obstacles", obstacles());
    root.member("joints", items(scene_.joints, [&](const Joint& joint) { return one(joint); }));
    root.member("camera", camera());
    return text + "\n}\n";
  }

  std::string one(const Body& body) const {
    std::string text = "{";
    Items members(text, ", ");
    members.member("shape", json_text(name_of(shape_names, body.shape)));
    if (body.shape == Shape::sphere) {
      members.member("radius", fmt::format("{}", body.radius));
    } else {
      members.member("mesh", json_text(body.mesh));
    }
    if (body.motion != Motion::dynamic)
      members.member("motion", json_text(name_of(motion_names, body.motion)));
    const Vector3d zero(0, 0, 0);
    members.member("position", list(body.position));
    if (!is_default(body.orientation)) {
      const Quaterniond& q = body.orientation;
      members.member("orientation", fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z()));
    }
    if (!same(body.velocity, zero)) members.member("velocity", list(body.velocity));
    if (!same(body.angular_velocity, zero)) members.member("angular_velocity", list(body.angular_velocity));
    if (body.mass) members.member("mass", fmt::format("{}", *body.mass));
    if (body.inertia) members.member("inertia", list(*body.inertia));
    if (body.material != 0) members.member("material", material_name(body.material));
    return text + "}";
  }

 private:
  template <class Item, class Write>
  static std::string items(const std::vector<Item>& all, Write write) {
    if (all.empty()) return "[]";
    std::string text = "[\n    ";
    Items separated(text, ",\n    ");
    for (const Item& item : all) separated.next() += write(item);
    return text + "\n  ]";
  }

  std::string material_name(int index) const { return json_text(scene_.materials.at(index).name); }

  std::string materials() const {
    std::string text = "{\n    ";
    Items separated(text, ",\n    ");
    for (const Material& m : scene_.materials) {
      separated.member(m.name, fmt::format(R"({{"density": {}, "restitution": {}, "friction": {}, )"
                                           R"("rolling_resistance": {}}})",
                                           m.density, m.restitution, m.friction, m.rolling_resistance));
    }
    return text + "\n  }";
  }

  std::string one(const BoxCollider& g) const {
    return fmt::format(
        R"({{"kind": "box_collider", "count": {}, "radius_max": {}, "variant": {}, "spawn": {}, )"
        R"("seed": {}, "speed_max": {}, "material": {}{}}})",
        g.count, g.radius_max, json_text(name_of(variant_names, g.variant)),
        json_text(name_of(spawn_names, g.spawn)), g.seed, g.speed_max, material_name(g.material),
        g.without.empty() ? "" : fmt::format(R"(, "without": [{}])", fmt::join(g.without, ", ")));
  }

  static std::string one(const Attractor& a) {
    return fmt::format(R"({{"position": {}, "strength": {}, "softening": {}}})", list(a.position), a.strength,
                       a.softening);
  }

  std::string one(const Plane& plane) const {
    return fmt::format(R"({{"shape": "plane", "normal": {}, "offset": {}, "material": {}}})",
                       list(plane.normal), plane.offset, material_name(plane.material));
  }

  std::string one(const Joint& joint) const {
    const Joint usual;
    std::string text = "{";
    Items members(text, ", ");
    const auto number = [&](std::string_view key, const std::optional<double>& value) {
      if (value) members.member(key, fmt::format("{}", *value));
    };
    members.member("kind", json_text(name_of(joint_kind_names, joint.kind)));
    members.member("a", fmt::format("{}", joint.a));
    members.member("b", joint.b ? fmt::format("{}", *joint.b) : json_text("world"));
    if (!same(joint.anchor_a, usual.anchor_a)) members.member("anchor_a", list(joint.anchor_a));
    if (joint.anchor_b) members.member("anchor_b", list(*joint.anchor_b));
    number("length", joint.length);
    number("min_length", joint.min_length);
    number("max_length", joint.max_length);
    if (joint.kind == JointKind::hinge) {
      members.member("axis", list(joint.axis));
      if (joint.limits)
        members.member("limits", fmt::format("[{}, {}]", (*joint.limits)[0], (*joint.limits)[1]));
    }
    if (joint.kind == JointKind::spring) {
      number("frequency", joint.frequency);
      number("damping_ratio", joint.damping_ratio);
    }
    if (joint.collide) members.member("collide", "true");
    return text + "}";
  }

  std::string one(const BoxObstacle& box) const {
    const Quaterniond& q = box.orientation;
    return fmt::format(
        R"({{"shape": "box", "center": {}, "size": {}, "orientation": [{}, {}, {}, {}], "material": {}}})",
        list(box.center), list(box.size), q.w(), q.x(), q.y(), q.z(), material_name(box.material));
  }

  /// Planes first.
  std::string obstacles() const {
    std::vector<std::string> all;
    for (const Plane& plane : scene_.obstacles) all.push_back(one(plane));
    for (const BoxObstacle& box : scene_.boxes) all.push_back(one(box));
    return items(all, [](const std::string& text) { return text; });
  }

  std::string camera() const {
    std::string text = "{";
    Items members(text, ", ");
    if (scene_.camera.position) members.member("position", list(*scene_.camera.position));
    if (scene_.camera.target) members.member("target", list(*scene_.camera.target));
    members.member("up", list(scene_.camera.up));
    members.member("vertical_field_of_view", fmt::format("{}", scene_.camera.vertical_field_of_view));
    return text + "}";
  }

  const Scene& scene_;
};

}  // namespace

std::string write_scene(const Scene& scene) { return SceneWriter(scene).write(); }

std::string write_body(const Body& body, const Scene& scene) { return SceneWriter(scene).one(body); }

std::string write_effects(const std::optional<Effects>& effects) {
  if (!effects) return json_text("auto");
  std::string text = "[";
  Items names(text, ", ");
  for (const EffectName& effect : effect_names) {
    if ((*effects).*effect.flag) names.next() += json_text(effect.name);
  }
  return text + "]";
}

}  // namespace collidoscope
