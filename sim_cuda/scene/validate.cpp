// Validation of scenes: ranges and unsupported combinations.
// More than 400 lines: the rules between fields, in the order of the file format.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/derived_faults.h"
#include "sim_cuda/scene/json_syntax.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/mass_properties.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {
namespace {

/// A path whose text is built only if a fault is reported. Validating 10^5 bodies allocates no memory.
struct Path {
  const char* list = "";
  std::int64_t index = -1;
  const char* field = "";
  int component = -1;
  const std::string* name = nullptr;  ///< name of a material

  std::string text() const {
    std::string path = list;
    if (index >= 0) path += fmt::format("[{}]", index);
    if (name != nullptr) {
      const bool plain = !name->empty() && name->find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") ==
                                               std::string::npos;
      path += plain ? "." + *name : "[\"" + *name + "\"]";
    }
    if (*field != 0) path += (path.empty() ? "" : ".") + std::string(field);
    if (component >= 0) path += fmt::format("[{}]", component);
    return path;
  }
  Path at(const char* member) const { return {list, index, member, -1, name}; }
  Path at(int part) const { return {list, index, field, part, name}; }
};

/// True if the text fits in one line of a message.
bool is_printable(const std::string& text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  }
  return is_utf8(text);
}

/// True if the text is valid as a name in messages and paths.
bool is_plain_text(const std::string& text) {
  return text.size() <= limits::max_name_length && is_printable(text);
}

class Validator {
 public:
  explicit Validator(const Scene& scene) : scene_(scene) {}

  std::vector<Fault> run() {
    if (!is_plain_text(scene_.name)) {
      fault({"", -1, "name"}, fmt::format("must be UTF-8 text of at most {} bytes without control characters",
                                          limits::max_name_length));
    }
    turning_ = bodies_turn(scene_);
    if (scene_.box) check_box(*scene_.box);
    check_physics(scene_.physics);
    check_materials();
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      check_body(scene_.bodies[i], {"bodies", static_cast<std::int64_t>(i)});
    }
    check_generators();
    for (std::size_t i = 0; i < scene_.extra_bodies.size(); ++i) {
      check_body(scene_.extra_bodies[i], {"extra_bodies", static_cast<std::int64_t>(i)});
    }
    for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
      check_plane(scene_.obstacles[i], {"obstacles", static_cast<std::int64_t>(i)});
    }
    for (std::size_t i = 0; i < scene_.boxes.size(); ++i) {
      check_box_obstacle(scene_.boxes[i], {"boxes", static_cast<std::int64_t>(i)});
    }
    check_joints();
    check_camera(scene_.camera);
    return std::move(faults_);
  }

 private:
  void fault(const Path& path, std::string message) { faults_.push_back({path.text(), std::move(message)}); }

  bool number(const Path& path, double value, double least, double most, std::string_view unit) {
    if (!(value >= least && value <= most)) {
      fault(path, fmt::format("must lie in [{:g}, {:g}]{}{}", least, most, unit.empty() ? "" : " ", unit));
      return false;
    }
    if (value != 0 && std::abs(value) < limits::smallest_normal) {
      fault(path, "must be 0 or at least 1.2e-38 in magnitude, the smallest normal float");
      return false;
    }
    return true;
  }
  bool whole(const Path& path, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value >= least && value <= most) return true;
    fault(path, fmt::format("must be a whole number from {} to {}", least, most));
    return false;
  }
  bool whole_in(const Path& path, std::int64_t value, double least, double most) {
    return whole(path, value, static_cast<std::int64_t>(least), static_cast<std::int64_t>(most));
  }

  /// Checks the range and the choices of a field. Fields without either always pass.
  template <auto member>
  bool check(const Path& of, const Field<member>& field, const typename Field<member>::Value& value) {
    using Value = typename Field<member>::Value;
    const Path path = of.at(field.key.data());
    if constexpr (std::is_same_v<Value, double>) {
      return number(path, value, field.low, field.high, field.unit);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      return !value || number(path, *value, field.low, field.high, field.unit);
    } else if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, std::int64_t>) {
      return field.low == field.high || whole_in(path, value, field.low, field.high);
    } else if constexpr (std::is_same_v<Value, std::optional<int>>) {
      return !value || whole_in(path, *value, field.low, field.high);
    } else if constexpr (std::is_same_v<Value, Vector3d>) {
      bool good = true;
      for (int axis = 0; axis < 3 && field.low != field.high; ++axis)
        good &= number(path.at(axis), value[axis], field.low, field.high, field.unit);
      return good;
    } else if constexpr (std::is_same_v<Value, std::optional<Vector3d>>) {
      bool good = true;
      for (int axis = 0; axis < 3 && value; ++axis)
        good &= number(path.at(axis), (*value)[axis], field.low, field.high, field.unit);
      return good;
    } else if constexpr (std::is_enum_v<Value>) {
      if (name_of(field.choices, value) != "?") return true;
      fault(path, "must be " + either_of(choice_names(field)));
      return false;
    } else if constexpr (std::is_same_v<Value, TimeStep>) {
      if (const auto n = value.steps_per_second())
        return whole(of.at("steps_per_second"), *n, 1, limits::max_steps_per_second);
      return number(path, value, field.low, field.high, field.unit);
    } else {
      return true;
    }
  }
  template <class Table, class Owner>
  bool check_all(const Path& path, const Table& table, const Owner& owner) {
    bool good = true;
    for_each_field(table, [&](const auto& field) { good &= check(path, field, owner.*(field.member)); });
    return good;
  }
  void material(const Path& path, int index) {
    if (index >= 0 && static_cast<std::size_t>(index) < scene_.materials.size()) return;
    fault(path.at("material"), "must be the index of a material");
  }
  void check_box(const Box& box) {
    const Path path{"box"};
    box_is_good_ = check_all(path, box_fields, box);
    for (int axis = 0; axis < 3 && box_is_good_; ++axis) {
      // Float runs use float walls; the box must not be empty in float.
      if (static_cast<float>(box.min[axis]) < static_cast<float>(box.max[axis])) continue;
      fault(path.at("max").at(axis), fmt::format("must be more than min[{}] = {}", axis, box.min[axis]));
      box_is_good_ = false;
    }
  }

  void check_physics(const Physics& physics) {
    const Path root;
    check_all(root, physics_settings, physics);
    check_all(Path{"drag"}, drag_fields, physics.drag);
    check_attractors(physics);
    if (physics.effects && physics.effects->friction) {
      if (physics.solver == Solver::impulse)
        fault(root.at("effects"), "must not contain friction with the solver impulse (use soft_step)");
      if (!physics.effects->rotation)
        fault(root.at("effects"), "must contain rotation if they contain friction, which applies torques");
    }
    if (physics.effects && physics.effects->continuous_collision && physics.solver == Solver::impulse)
      fault(root.at("effects"),
            "must not contain continuous_collision with the solver impulse (use soft_step)");
    if (physics.effects && physics.effects->rolling_resistance && !physics.effects->friction)
      fault(root.at("effects"), "must contain friction if they contain rolling_resistance");
    check_sleep(physics);
    if (physics.guards) check_all(Path{"guards"}, guards_fields, *physics.guards);
  }

  void check_sleep(const Physics& physics) {
    const Path root, path{"sleep"};
    if (physics.effects && physics.effects->sleeping && !physics.sleep)
      fault(root.at("effects"), "must not contain sleeping without \"sleep\", which sets its limits");
    if (!physics.sleep) return;
    check_all(path, sleep_fields, *physics.sleep);
    if (physics.solver == Solver::impulse && (!physics.effects || physics.effects->sleeping))
      fault(root.at("sleep"),
            "must be removed with the solver impulse (use soft_step), unless the scene has a list of effects "
            "without sleeping");
  }

  void check_attractors(const Physics& physics) {
    const Path list{"attractors"};
    if (physics.solver == Solver::impulse &&
        (physics.effects ? physics.effects->attractor : !physics.attractors.empty())) {
      fault(physics.effects ? Path{}.at("effects") : list,
            "must not contain attractors with the solver impulse (use soft_step)");
    }
    if (physics.attractors.size() > limits::max_attractors)
      fault(list, fmt::format("must be at most {} attractors", limits::max_attractors));
    for (std::size_t i = 0; i < physics.attractors.size(); ++i) {
      const Attractor& a = physics.attractors[i];
      const Path path{"attractors", static_cast<std::int64_t>(i)};
      if (check_all(path, attractor_fields, a) && max_field(a) > limits::max_gravity)
        fault(path.at("softening"),
              fmt::format("must be larger: the acceleration would reach {:.3g} m/s^2, above {:g}",
                          max_field(a), limits::max_gravity));
    }
  }

  void check_materials() {
    const Path root{"materials"};
    if (scene_.materials.empty() || scene_.materials[0].name != "default") {
      fault(root, "must start with the material \"default\"");
    }
    if (scene_.materials.size() > static_cast<std::size_t>(limits::max_materials)) {
      fault(root, fmt::format("must be at most {} materials", limits::max_materials));
    }
    std::set<std::string_view> names;
    for (const Material& m : scene_.materials) {
      const Path path{"materials", -1, "", -1, &m.name};
      if (m.name.empty() || !is_plain_text(m.name) || m.name.find_first_of("\"\\") != std::string::npos) {
        fault(path,
              fmt::format("a material's name must be UTF-8 text of 1 to {} bytes without quotes, backslashes "
                          "and control characters",
                          limits::max_name_length));
      }
      if (!names.insert(m.name).second) fault(path, "two materials must not have the same name");
      const bool good = check_all(path, material_settings, m);
      if (good && m.friction != 0 && !scene_.physics.effects && scene_.physics.solver == Solver::impulse)
        fault(path.at("friction"),
              "must be 0 with the solver impulse (use soft_step), unless the scene has a list of effects "
              "without friction");
      if (good && m.rolling_resistance != 0 && !scene_.physics.effects &&
          scene_.physics.solver == Solver::impulse)
        fault(path.at("rolling_resistance"),
              "must be 0 with the solver impulse (use soft_step), unless the scene has a list of effects "
              "without rolling_resistance");
    }
  }

  void check_body(const Body& body, const Path& path) {
    const auto check_member = [&]<auto member>(const Field<member>& field) {
      return check(path, field, body.*member);
    };
    for_each_field(
        body_fields, [&]<auto member>(const Field<member>& field) {
          if constexpr (is_field<member, &Body::radius>) {
            if (body.shape == Shape::sphere && check_member(field)) {
              must_fit(path.at("radius"), body.radius);
              check_derived(body, path);
            }
          } else if constexpr (is_field<member, &Body::inertia>) {
            if (check_member(field) && body.inertia) check_inertia(*body.inertia, path.at("inertia"));
          } else {
            check_member(field);
          }
        });
    if (body.shape == Shape::mesh && body.mesh.empty()) {
      fault(path.at("mesh"), "must name an OBJ file, relative to the scene file");
    } else if (body.shape == Shape::mesh && !is_printable(body.mesh)) {
      fault(path.at("mesh"), "must be a path in UTF-8 without control characters");
    }
    if (!is_unit(body.orientation.squaredNorm())) {
      fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
    }
    material(path, body.material);
    if (body.motion == Motion::fixed && !(body.velocity.isZero(0) && body.angular_velocity.isZero(0)))
      fault(path.at("motion"),
            "must be kinematic or dynamic if a velocity is given; static bodies have no velocity");
  }

  /// Density of a material. Unset if the density or the index is invalid.
  std::optional<double> density_of(int material) const {
    if (material < 0 || static_cast<std::size_t>(material) >= scene_.materials.size()) return std::nullopt;
    const double density = scene_.materials[static_cast<std::size_t>(material)].density;
    if (!(density >= limits::min_density && density <= limits::max_density)) return std::nullopt;
    return density;
  }

  /// Checks the mass and the moment of inertia of a sphere.
  void check_derived(const Body& body, const Path& path) {
    const std::optional<double> density = density_of(body.material);
    if (!body.mass && !density) return;
    const double mass = body.mass ? *body.mass : *density * sphere_volume(body.radius);
    if (const auto wrong = mass_fault(mass)) {
      if (!body.mass) fault(path, *wrong);  // check_body() reports an invalid mass that was given explicitly
      return;
    }
    if (!turning_ || body.inertia) return;
    if (const auto wrong = inertia_fault(sphere_inertia(mass, body.radius))) fault(path, *wrong);
  }

  void check_inertia(const Vector3d& inertia, const Path& path) {
    for (int axis = 0; axis < 3; ++axis) {
      // Equality is valid (a flat plate); the tolerance covers rounding.
      const double others = inertia[(axis + 1) % 3] + inertia[(axis + 2) % 3];
      if (inertia[axis] > others * (1 + 1e-12)) {
        fault(path.at(axis), "must not exceed the sum of the other two moments, as for every rigid body");
      }
    }
  }

  void must_fit(const Path& path, double radius) {
    if (!scene_.box || !box_is_good_ || scene_has_scaled_box()) return;
    const double side = (scene_.box->max - scene_.box->min).minCoeff();
    if (2 * radius > side)
      fault(path, fmt::format("must be at most {:g} m, for the sphere to fit in the box", side / 2));
  }
  bool scene_has_scaled_box() const {
    for (const BoxCollider& generator : scene_.generators) {
      if (generator.variant != Variant::paper) return true;
    }
    return false;
  }

  void check_generators() {
    std::int64_t total = static_cast<std::int64_t>(scene_.bodies.size() + scene_.extra_bodies.size());
    int scaled = 0;
    for (std::size_t i = 0; i < scene_.generators.size(); ++i) {
      const BoxCollider& g = scene_.generators[i];
      const Path path{"generators", static_cast<std::int64_t>(i)};
      bool good_count = false, good_radius = false;
      for_each_field(
          generator_settings, [&]<auto member>(const Field<member>& field) {
            const bool good = check(path, field, g.*member);
            if constexpr (is_field<member, &BoxCollider::count>) good_count = good;
            if constexpr (is_field<member, &BoxCollider::radius_max>) good_radius = good;
          });
      const Physics& physics = scene_.physics;
      if (g.variant == Variant::settled &&
          (physics.gravity.isZero(0) || (physics.effects && !physics.effects->gravity)))
        fault(path.at("variant"), "must not be settled without gravity: no body would come to rest");
      material(path, g.material);
      if (good_count) {
        total += g.count;
        if (total > limits::max_bodies) {
          fault(path.at("count"), fmt::format("must give at most {} bodies in total", limits::max_bodies));
          total = 0;
        }
      }
      if (good_count) check_without(g, path.at("excluded"));
      if (g.variant != Variant::paper && ++scaled > 1) {
        fault(
            path.at("variant"),
            "must be paper in all generators except one: \"scaled\", \"settled\" and \"equal\" set the box");
      }
      if (!scene_.box) {
        fault(path, "needs a \"box\" for its spheres");
      } else if (box_is_good_ && good_count && good_radius) {
        check_room(g, path);
      }
      if (const std::optional<double> density = density_of(g.material); density && good_radius)
        if (const auto wrong =
                mass_fault(*density * sphere_volume(largest_radius(g)), "its largest sphere's"))
          fault(path, *wrong);
    }
  }

  void check_without(const BoxCollider& g, const Path& path) {
    for (std::size_t k = 0; k < g.excluded.size(); ++k)
      if (g.excluded[k] < 0 || g.excluded[k] >= g.count || (k > 0 && g.excluded[k] <= g.excluded[k - 1])) {
        fault(path.at(static_cast<int>(k)),
              fmt::format("must be the index of one of its {} bodies, from 0, in ascending order", g.count));
        return;
      }
  }

  void check_room(const BoxCollider& g, const Path& path) {
    const Box box = box_in_effect(scene_).value();
    if (g.variant != Variant::paper && !(box.max.cwiseAbs().maxCoeff() <= limits::max_coordinate)) {
      fault(path.at("count"), fmt::format("must be smaller: the box would extend to {:g} m, beyond {:g} m",
                                          box.max.maxCoeff(), limits::max_coordinate));
      return;
    }
    const double side = (box.max - box.min).minCoeff();
    if (2 * largest_radius(g) > side) {
      fault(path.at("radius_max"),
            fmt::format("must be at most {:g} m, for the spheres to fit in the box", side / 2));
    }
  }

  void check_plane(const Plane& plane, const Path& path) {
    if (!is_unit(plane.normal.squaredNorm())) {
      fault(path.at("normal"), "must be a vector of length 1 and of finite numbers");
    }
    check_all(path, plane_fields, plane);
    material(path, plane.material);
  }

  void check_joints() {
    if (scene_.joints.empty()) return;
    const Path root{"joints"};
    const std::optional<Effects>& effects = scene_.physics.effects;
    const bool on = !effects || effects->joints;
    if (on && scene_.physics.solver == Solver::impulse)
      fault(root,
            "must be empty with the solver impulse (use soft_step), unless the scene has a list of effects "
            "without joints");
    if (on && effects && !effects->rotation && joints_turn_bodies(scene_))
      fault({"", -1, "effects"},
            "must contain rotation if joints apply torques: hinges, and anchors away from a centre");
    if (scene_.joints.size() > static_cast<std::size_t>(limits::max_joints))
      fault(root, fmt::format("must be at most {} joints", limits::max_joints));
    std::int64_t bodies = static_cast<std::int64_t>(scene_.bodies.size() + scene_.extra_bodies.size());
    for (const BoxCollider& generator : scene_.generators)
      bodies += std::clamp<std::int64_t>(generator.count, 0, limits::max_bodies) -
                static_cast<std::int64_t>(generator.excluded.size());
    for (std::size_t i = 0; i < scene_.joints.size(); ++i)
      check_joint(scene_.joints[i], bodies, {"joints", static_cast<std::int64_t>(i)});
  }

  void check_joint(const Joint& joint, std::int64_t bodies, const Path& path) {
    const auto body = [&](const char* field, std::int64_t id) {
      if (id < 0 || id >= bodies)
        fault(path.at(field), fmt::format("must be the id of a body, below {}", bodies));
    };
    bool good = true;
    for_each_field(
        joint_fields, [&]<auto member>(const Field<member>& field) {
          const bool spring_only = is_field<member, &Joint::frequency, &Joint::damping_ratio>;
          const bool lengths = is_field<member, &Joint::length, &Joint::min_length, &Joint::max_length>;
          const bool has_lengths = joint.kind == JointKind::distance || joint.kind == JointKind::spring;
          if ((spring_only && joint.kind != JointKind::spring) || (lengths && !has_lengths)) return;
          const bool fine = check(path, field, joint.*member);
          if (lengths) good &= fine;
        });
    body("a", joint.a);
    if (joint.b) body("b", *joint.b);
    if (joint.b && *joint.b == joint.a) fault(path.at("b"), "must be a body other than a, or \"world\"");
    if (joint.kind == JointKind::distance || joint.kind == JointKind::spring)
      check_lengths(joint, path, good);
    if (joint.kind != JointKind::hinge) return;
    if (!is_unit(joint.axis.squaredNorm()))
      fault(path.at("axis"), "must be a vector of length 1 and of finite numbers");
    if (!joint.limits) return;
    good = true;
    for (int end = 0; end < 2; ++end)
      good &= number(path.at("limits").at(end), (*joint.limits)[static_cast<std::size_t>(end)], -180, 180,
                     "degrees");
    if (good && (*joint.limits)[0] > (*joint.limits)[1])
      fault(path.at("limits"), "must be two angles, the smaller first");
  }

  void check_lengths(const Joint& joint, const Path& path, bool good) {
    if (!joint.b && !joint.anchor_b) fault(path.at("anchor_b"), "must be given for a joint to the world");
    if (joint.length && (joint.min_length || joint.max_length))
      fault(path.at("length"), "must not be given with min_length or max_length");
    if (good && joint.min_length && joint.max_length && *joint.min_length > *joint.max_length)
      fault(path.at("max_length"), "must be at least min_length");
  }

  void check_box_obstacle(const BoxObstacle& box, const Path& path) {
    if (scene_.physics.solver == Solver::impulse)
      fault(path.at("shape"), "must be plane with the solver impulse (boxes need soft_step)");
    check_all(path, box_obstacle_fields, box);
    if (!is_unit(box.orientation.squaredNorm()))
      fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
    material(path, box.material);
  }

  void check_camera(const Camera& camera) {
    const Path path{"camera"};
    bool good = check_all(path, camera_fields, camera);
    if (good && camera.up.isZero(0)) {
      fault(path.at("up"), "must not be zero");
      good = false;
    }
    if (good && camera.position && camera.target) {
      const Vector3d view = *camera.target - *camera.position;
      if (view.isZero(0)) {
        fault(path.at("target"), "must differ from the camera's position");
      } else if (view.cross(camera.up).isZero(0)) {
        fault(path.at("up"), "must not point along the line of sight");
      }
    }
  }

  const Scene& scene_;
  std::vector<Fault> faults_;
  bool box_is_good_ = false, turning_ = false;
};

}  // namespace

std::string line_of(const Fault& fault) {
  constexpr std::size_t longest_path = 300;  // longer than the path of a material with the longest valid name
  return (fault.path.empty() ? "" : printable(fault.path, longest_path) + ": ") + fault.message;
}

std::vector<Fault> validate(const Scene& scene) { return Validator(scene).run(); }

const Scene& valid(const Scene& scene) {
  std::vector<std::string> lines;
  for (const Fault& fault : validate(scene)) lines.push_back(scene.name + ": " + line_of(fault));
  if (!lines.empty()) throw InputError(lines);
  return scene;
}

bool is_unit(double squared_length) {
  const double error = squared_length - 1;
  return error <= 1e-14 && error >= -1e-14;
}

}  // namespace collidoscope
