// Whether the values of a scene can be simulated: every range, and everything that is not simulated yet.
// More than 400 lines: one check for each field, in the order of the file format.

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
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// A path, put together only when there is a fault to report: validating 10^5 bodies allocates nothing.
struct Path {
  const char* list = "";
  std::int64_t index = -1;
  const char* field = "";
  int component = -1;
  const std::string* name = nullptr;  ///< of a material

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

/// A text that stays in one line of a message.
bool is_printable(const std::string& text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  }
  return is_utf8(text);
}

/// A text for people and for paths in them.
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
    for (std::size_t i = 0; i < scene_.added.size(); ++i) {
      check_body(scene_.added[i], {"added", static_cast<std::int64_t>(i)});
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

  bool number(const Path& path, double value, double least, double most, const char* unit) {
    if (!(value >= least && value <= most)) {
      fault(path, fmt::format("must lie in [{:g}, {:g}]{}{}", least, most, *unit != 0 ? " " : "", unit));
      return false;
    }
    if (value != 0 && std::abs(value) < limits::smallest_normal) {
      fault(path, "must be 0 or at least 1.2e-38 in size, which a float holds");
      return false;
    }
    return true;
  }
  bool whole(const Path& path, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value >= least && value <= most) return true;
    fault(path, fmt::format("must be a whole number from {} to {}", least, most));
    return false;
  }
  bool vector(const Path& path, const Vector3d& value, double most, const char* unit) {
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) good &= number(path.at(axis), value[axis], -most, most, unit);
    return good;
  }
  void material(const Path& path, int index) {
    if (index >= 0 && static_cast<std::size_t>(index) < scene_.materials.size()) return;
    fault(path.at("material"), "must be the index of a material");
  }
  template <class Choice, std::size_t count>
  void choice(const Path& path, const std::array<Named<Choice>, count>& table, Choice value) {
    if (name_of(table, value) == "?") fault(path, "must be " + either_of(names_in(table)));
  }

  void check_box(const Box& box) {
    const Path path{"box"};
    box_is_good_ = vector(path.at("min"), box.min, limits::max_coordinate, "m");
    box_is_good_ &= vector(path.at("max"), box.max, limits::max_coordinate, "m");
    for (int axis = 0; axis < 3 && box_is_good_; ++axis) {
      // Float runs see the walls as floats; a box must not vanish there.
      if (static_cast<float>(box.min[axis]) < static_cast<float>(box.max[axis])) continue;
      fault(path.at("max").at(axis), fmt::format("must be more than min[{}] = {}", axis, box.min[axis]));
      box_is_good_ = false;
    }
  }

  void check_physics(const Physics& physics) {
    const Path root;
    vector(root.at("gravity"), physics.gravity, limits::max_gravity, "m/s^2");
    check_drag(physics.drag);
    check_attractors(physics);
    if (physics.steps_per_second) {
      if (whole(root.at("steps_per_second"), *physics.steps_per_second, 1, limits::max_steps_per_second) &&
          physics.time_step != 1.0 / *physics.steps_per_second) {
        fault(root.at("time_step"), "must be 1/steps_per_second where that is given");
      }
    } else {
      number(root.at("time_step"), physics.time_step, limits::min_time_step, limits::max_time_step, "s");
    }
    if (physics.substeps) whole(root.at("substeps"), *physics.substeps, 1, limits::max_substeps);
    whole(root.at("iterations"), physics.iterations, 1, limits::max_iterations);
    choice(root.at("solver"), solver_names, physics.solver);
    choice(root.at("integrator"), integrator_names, physics.integrator);
    choice(root.at("rotation_update"), rotation_update_names, physics.rotation_update);
    choice(root.at("precision"), precision_names, physics.precision);
    if (physics.effects && physics.effects->friction) {
      if (physics.solver == Solver::impulse)
        fault(root.at("effects"), "must not hold friction with the solver impulse (soft_step has it)");
      if (!physics.effects->rotation)
        fault(root.at("effects"), "must hold rotation where they hold friction, which turns bodies");
    }
    if (physics.effects && physics.effects->continuous_collision && physics.solver == Solver::impulse)
      fault(root.at("effects"),
            "must not hold continuous_collision with the solver impulse (soft_step has it)");
    if (physics.effects && physics.effects->rolling_resistance && !physics.effects->friction)
      fault(root.at("effects"), "must hold friction where they hold rolling_resistance");
    if (physics.restitution_threshold) {
      number(root.at("restitution_threshold"), *physics.restitution_threshold, 0, limits::max_speed, "m/s");
    }
    check_sleep(physics);
    if (physics.guards) check_guards(*physics.guards);
  }

  void check_guards(const ValidationSettings& guards) {
    const Path path{"guards"};
    choice(path.at("on_failure"), on_failure_names, guards.on_failure);
    number(path.at("speed"), guards.speed, 0, limits::max_guarded, "m/s");
    number(path.at("distance"), guards.distance, 0, limits::max_guarded, "m");
    number(path.at("spin"), guards.spin, 0, limits::max_guarded, "rad/s");
  }

  void check_sleep(const Physics& physics) {
    const Path root, path{"sleep"};
    if (physics.effects && physics.effects->sleeping && !physics.sleep)
      fault(root.at("effects"), "must not hold sleeping without \"sleep\", which says when");
    if (!physics.sleep) return;
    number(path.at("speed"), physics.sleep->speed, 0, limits::max_speed, "m/s");
    number(path.at("time"), physics.sleep->time, 0, limits::max_sleep_time, "s");
    if (physics.solver == Solver::impulse && (!physics.effects || physics.effects->sleeping))
      fault(
          root.at("sleep"),
          "must be left out with the solver impulse, unless a list of effects leaves sleeping out (soft_step "
          "has it)");
  }

  void check_drag(const Drag& drag) {
    const Path path{"drag"};
    number(path.at("viscosity"), drag.viscosity, 0, limits::max_viscosity, "Pa s");
    number(path.at("density"), drag.density, 0, limits::max_medium_density, "kg/m^3");
    number(path.at("coefficient"), drag.coefficient, 0, limits::max_drag_coefficient, "");
  }

  void check_attractors(const Physics& physics) {
    const Path list{"attractors"};
    if (physics.solver == Solver::impulse &&
        (physics.effects ? physics.effects->attractor : !physics.attractors.empty())) {
      fault(physics.effects ? Path{}.at("effects") : list,
            "must not hold attractors with the solver impulse (soft_step has them)");
    }
    if (physics.attractors.size() > limits::max_attractors)
      fault(list, fmt::format("must be at most {} attractors", limits::max_attractors));
    for (std::size_t i = 0; i < physics.attractors.size(); ++i) {
      const Attractor& a = physics.attractors[i];
      const Path path{"attractors", static_cast<std::int64_t>(i)};
      vector(path.at("position"), a.position, limits::max_coordinate, "m");
      const bool good =
          number(path.at("strength"), a.strength, -limits::max_strength, limits::max_strength, "m^3/s^2");
      if (number(path.at("softening"), a.softening, limits::min_softening, limits::max_softening, "m") &&
          good && largest_pull(a) > limits::max_gravity)
        fault(path.at("softening"),
              fmt::format("must be more: the pull would come to {:.3g} m/s^2, beyond {:g}", largest_pull(a),
                          limits::max_gravity));
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
      if (!names.insert(m.name).second) fault(path, "two materials must not have one name");
      number(path.at("density"), m.density, limits::min_density, limits::max_density, "kg/m^3");
      number(path.at("restitution"), m.restitution, 0, limits::max_restitution, "");
      const bool rubs =
          number(path.at("friction"), m.friction, 0, limits::max_friction, "") && m.friction != 0;
      if (rubs && !scene_.physics.effects && scene_.physics.solver == Solver::impulse)
        fault(path.at("friction"),
              "must be 0 with the solver impulse, unless a list of effects leaves friction out (soft_step "
              "has it)");
      const bool resists = number(path.at("rolling_resistance"), m.rolling_resistance, 0,
                                  limits::max_rolling_resistance, "") &&
                           m.rolling_resistance != 0;
      if (resists && !scene_.physics.effects && scene_.physics.solver == Solver::impulse)
        fault(path.at("rolling_resistance"),
              "must be 0 with the solver impulse, unless a list of effects leaves rolling_resistance out "
              "(soft_step has it)");
    }
  }

  void check_body(const Body& body, const Path& path) {
    choice(path.at("shape"), shape_names, body.shape);
    if (body.shape == Shape::sphere) {
      if (number(path.at("radius"), body.radius, limits::min_radius, limits::max_radius, "m")) {
        must_fit(path.at("radius"), body.radius);
        check_derived(body, path);
      }
    } else if (body.mesh.empty()) {
      fault(path.at("mesh"), "must name an OBJ file, relative to the scene file");
    } else if (!is_printable(body.mesh)) {
      fault(path.at("mesh"), "must be a path in UTF-8 without control characters");
    }
    vector(path.at("position"), body.position, limits::max_coordinate, "m");
    if (!is_unit(body.orientation.squaredNorm())) {
      fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
    }
    vector(path.at("velocity"), body.velocity, limits::max_speed, "m/s");
    vector(path.at("angular_velocity"), body.angular_velocity, limits::max_spin, "rad/s");
    if (body.mass) number(path.at("mass"), *body.mass, limits::min_mass, limits::max_mass, "kg");
    if (body.inertia) check_inertia(*body.inertia, path.at("inertia"));
    material(path, body.material);
    choice(path.at("motion"), motion_names, body.motion);
    if (body.motion == Motion::fixed && !(body.velocity.isZero(0) && body.angular_velocity.isZero(0)))
      fault(path.at("motion"),
            "must be kinematic or dynamic where a velocity is given; static bodies have none");
  }

  /// Its density, unless that or the index has a fault of its own.
  std::optional<double> density_of(int material) const {
    if (material < 0 || static_cast<std::size_t>(material) >= scene_.materials.size()) return std::nullopt;
    const double density = scene_.materials[static_cast<std::size_t>(material)].density;
    if (!(density >= limits::min_density && density <= limits::max_density)) return std::nullopt;
    return density;
  }

  /// The mass and the moment of inertia of a sphere.
  void check_derived(const Body& body, const Path& path) {
    const std::optional<double> density = density_of(body.material);
    if (!body.mass && !density) return;
    const double mass = body.mass ? *body.mass : *density * sphere_volume(body.radius);
    if (const auto wrong = mass_fault(mass)) {
      if (!body.mass) fault(path, *wrong);  // check_body() tells of a mass that is given
      return;
    }
    if (!turning_ || body.inertia) return;
    if (const auto wrong = inertia_fault(sphere_inertia(mass, body.radius))) fault(path, *wrong);
  }

  void check_inertia(const Vector3d& inertia, const Path& path) {
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) {
      good &= number(path.at(axis), inertia[axis], limits::min_inertia, limits::max_inertia, "kg m^2");
    }
    for (int axis = 0; axis < 3 && good; ++axis) {
      // Equality, a flat plate, is possible; leave room for its rounding.
      const double others = inertia[(axis + 1) % 3] + inertia[(axis + 2) % 3];
      if (inertia[axis] > others * (1 + 1e-12)) {
        fault(path.at(axis), "must not exceed the sum of the other two moments; no body has such an inertia");
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
    std::int64_t total = static_cast<std::int64_t>(scene_.bodies.size() + scene_.added.size());
    int scaled = 0;
    for (std::size_t i = 0; i < scene_.generators.size(); ++i) {
      const BoxCollider& g = scene_.generators[i];
      const Path path{"generators", static_cast<std::int64_t>(i)};
      const bool good_count = whole(path.at("count"), g.count, 0, limits::max_bodies);
      const bool good_radius =
          number(path.at("radius_max"), g.radius_max, limits::min_generated_radius, limits::max_radius, "m");
      choice(path.at("variant"), variant_names, g.variant);
      const Physics& physics = scene_.physics;
      if (g.variant == Variant::settled &&
          (physics.gravity.isZero(0) || (physics.effects && !physics.effects->gravity)))
        fault(path.at("variant"), "must not be settled without gravity: nothing would come to rest");
      choice(path.at("spawn"), spawn_names, g.spawn);
      number(path.at("speed_max"), g.speed_max, 0, limits::max_speed, "m/s");
      material(path, g.material);
      if (good_count) {
        total += g.count;
        if (total > limits::max_bodies) {
          fault(path.at("count"), fmt::format("must leave at most {} bodies in all", limits::max_bodies));
          total = 0;
        }
      }
      if (good_count) check_without(g, path.at("without"));
      if (g.variant != Variant::paper && ++scaled > 1) {
        fault(path.at("variant"),
              "must be paper in all generators but one: \"scaled\", \"settled\" and \"equal\" set the box");
      }
      if (!scene_.box) {
        fault(path, "needs a \"box\" to put its spheres in");
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
    for (std::size_t k = 0; k < g.without.size(); ++k)
      if (g.without[k] < 0 || g.without[k] >= g.count || (k > 0 && g.without[k] <= g.without[k - 1])) {
        fault(path.at(static_cast<int>(k)),
              fmt::format("must be the number of one of its {} bodies, from 0, more than the one before it",
                          g.count));
        return;
      }
  }

  void check_room(const BoxCollider& g, const Path& path) {
    const Box box = box_in_effect(scene_).value();
    if (g.variant != Variant::paper && !(box.max.cwiseAbs().maxCoeff() <= limits::max_coordinate)) {
      fault(path.at("count"), fmt::format("must be less: the box would reach to {:g} m, beyond {:g} m",
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
    number(path.at("offset"), plane.offset, -limits::max_coordinate, limits::max_coordinate, "m");
    material(path, plane.material);
  }

  void check_joints() {
    if (scene_.joints.empty()) return;
    const Path root{"joints"};
    const std::optional<Effects>& effects = scene_.physics.effects;
    const bool on = !effects || effects->joints;
    if (on && scene_.physics.solver == Solver::impulse)
      fault(root,
            "must be none with the solver impulse, unless a list of effects leaves joints out (soft_step "
            "has them)");
    if (on && effects && !effects->rotation && joints_turn_bodies(scene_))
      fault(
          {"", -1, "effects"},
          "must hold rotation where they hold joints that turn bodies: hinges, and anchors beside a centre");
    if (scene_.joints.size() > static_cast<std::size_t>(limits::max_joints))
      fault(root, fmt::format("must be at most {} joints", limits::max_joints));
    std::int64_t bodies = static_cast<std::int64_t>(scene_.bodies.size() + scene_.added.size());
    for (const BoxCollider& generator : scene_.generators)
      bodies += std::clamp<std::int64_t>(generator.count, 0, limits::max_bodies) -
                static_cast<std::int64_t>(generator.without.size());
    for (std::size_t i = 0; i < scene_.joints.size(); ++i)
      check_joint(scene_.joints[i], bodies, {"joints", static_cast<std::int64_t>(i)});
  }

  void check_joint(const Joint& joint, std::int64_t bodies, const Path& path) {
    const auto body = [&](const char* field, std::int64_t id) {
      if (id < 0 || id >= bodies)
        fault(path.at(field), fmt::format("must be the id of a body, below {}", bodies));
    };
    choice(path.at("kind"), joint_kind_names, joint.kind);
    body("a", joint.a);
    if (joint.b) body("b", *joint.b);
    if (joint.b && *joint.b == joint.a) fault(path.at("b"), "must be another body than a, or \"world\"");
    vector(path.at("anchor_a"), joint.anchor_a, limits::max_coordinate, "m");
    if (joint.anchor_b) vector(path.at("anchor_b"), *joint.anchor_b, limits::max_coordinate, "m");
    if (joint.kind == JointKind::distance || joint.kind == JointKind::spring) check_lengths(joint, path);
    if (joint.kind == JointKind::spring) {
      number(path.at("frequency"), joint.frequency, limits::min_frequency, limits::max_frequency, "Hz");
      number(path.at("damping_ratio"), joint.damping_ratio, 0, limits::max_damping_ratio, "");
    }
    if (joint.kind != JointKind::hinge) return;
    if (!is_unit(joint.axis.squaredNorm()))
      fault(path.at("axis"), "must be a vector of length 1 and of finite numbers");
    if (!joint.limits) return;
    bool good = true;
    for (int end = 0; end < 2; ++end)
      good &= number(path.at("limits").at(end), (*joint.limits)[static_cast<std::size_t>(end)], -180, 180,
                     "degrees");
    if (good && (*joint.limits)[0] > (*joint.limits)[1])
      fault(path.at("limits"), "must be two angles, the smaller first");
  }

  void check_lengths(const Joint& joint, const Path& path) {
    if (!joint.b && !joint.anchor_b) fault(path.at("anchor_b"), "must say where in the world");
    const auto length = [&](const char* field, const std::optional<double>& value, double least) {
      return !value || number(path.at(field), *value, least, limits::max_coordinate, "m");
    };
    bool good = length("length", joint.length, limits::min_radius);
    good &= length("min_length", joint.min_length, 0);
    good &= length("max_length", joint.max_length, limits::min_radius);
    if (joint.length && (joint.min_length || joint.max_length))
      fault(path.at("length"), "must not stand beside min_length or max_length");
    if (good && joint.min_length && joint.max_length && *joint.min_length > *joint.max_length)
      fault(path.at("max_length"), "must be at least min_length");
  }

  void check_box_obstacle(const BoxObstacle& box, const Path& path) {
    if (scene_.physics.solver == Solver::impulse)
      fault(path.at("shape"), "must be plane with the solver impulse (soft_step has boxes)");
    vector(path.at("center"), box.center, limits::max_coordinate, "m");
    for (int axis = 0; axis < 3; ++axis)
      number(path.at("size").at(axis), box.size[axis], limits::min_radius, limits::max_coordinate, "m");
    if (!is_unit(box.orientation.squaredNorm()))
      fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
    material(path, box.material);
  }

  void check_camera(const Camera& camera) {
    const Path path{"camera"};
    bool good = true;
    if (camera.position) good &= vector(path.at("position"), *camera.position, limits::max_coordinate, "m");
    if (camera.target) good &= vector(path.at("target"), *camera.target, limits::max_coordinate, "m");
    good &= vector(path.at("up"), camera.up, limits::max_coordinate, "");
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
    number(path.at("vertical_field_of_view"), camera.vertical_field_of_view, 1, 150, "degrees");
  }

  const Scene& scene_;
  std::vector<Fault> faults_;
  bool box_is_good_ = false, turning_ = false;
};

}  // namespace

std::string line_of(const Fault& fault) {
  constexpr std::size_t longest_path = 300;  // that of a name of the greatest length is shorter
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
