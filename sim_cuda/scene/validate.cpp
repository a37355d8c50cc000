// Validation of scenes: the rules between fields, in the order of the file format. body_validator.h has those
// of bodies and generators, field_validator.h the ranges of single fields.

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/body_validator.h"
#include "sim_cuda/scene/field_validator.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {
namespace {

/// True if the text is valid as a name in messages and paths.
bool is_plain_text(const std::string& text) {
  return text.size() <= limits::max_name_length && is_printable(text);
}

class SceneValidator {
 public:
  explicit SceneValidator(const Scene& scene) : scene_(scene), fields_(scene.materials.size()) {}

  std::vector<Fault> run() {
    if (!is_plain_text(scene_.name)) {
      fields_.fault({"", -1, "name"},
                    fmt::format("must be UTF-8 text of at most {} bytes without control characters",
                                limits::max_name_length));
    }
    if (scene_.box) check_box(*scene_.box);
    check_physics(scene_.physics);
    check_materials();
    BodyValidator bodies(scene_, box_is_valid_, fields_);
    bodies.check_bodies("bodies", scene_.bodies);
    bodies.check_generators();
    bodies.check_body_files();
    bodies.check_bodies("extra_bodies", scene_.extra_bodies);
    for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
      check_plane(scene_.obstacles[i], {"obstacles", static_cast<std::int64_t>(i)});
    }
    for (std::size_t i = 0; i < scene_.boxes.size(); ++i) {
      check_box_obstacle(scene_.boxes[i], {"boxes", static_cast<std::int64_t>(i)});
    }
    check_joints();
    check_camera(scene_.camera);
    return fields_.take_faults();
  }

 private:
  void check_box(const Box& box) {
    const FaultPath path{"box"};
    box_is_valid_ = fields_.check_all(path, box_fields, box);
    for (int axis = 0; axis < 3 && box_is_valid_; ++axis) {
      // Float runs use float walls; the box must not be empty in float.
      if (static_cast<float>(box.min[axis]) < static_cast<float>(box.max[axis])) continue;
      fields_.fault(path.at("max").at(axis),
                    fmt::format("must be more than min[{}] = {}", axis, box.min[axis]));
      box_is_valid_ = false;
    }
  }

  void check_physics(const Physics& physics) {
    const FaultPath root;
    fields_.check_all(root, physics_settings, physics);
    fields_.check_all(FaultPath{"drag"}, drag_fields, physics.drag);
    check_attractors(physics);
    if (physics.effects && physics.effects->friction) {
      if (physics.solver == Solver::impulse)
        fields_.fault(root.at("effects"),
                      "must not contain friction with the solver impulse (use soft_step)");
      if (!physics.effects->rotation)
        fields_.fault(root.at("effects"),
                      "must contain rotation if they contain friction, which applies torques");
    }
    if (physics.effects && physics.effects->continuous_collision && physics.solver == Solver::impulse)
      fields_.fault(root.at("effects"),
                    "must not contain continuous_collision with the solver impulse (use soft_step)");
    if (physics.effects && physics.effects->rolling_resistance && !physics.effects->friction)
      fields_.fault(root.at("effects"), "must contain friction if they contain rolling_resistance");
    check_sleep(physics);
    if (physics.guards) fields_.check_all(FaultPath{"guards"}, guards_fields, *physics.guards);
  }

  void check_sleep(const Physics& physics) {
    const FaultPath root, path{"sleep"};
    if (physics.effects && physics.effects->sleeping && !physics.sleep)
      fields_.fault(root.at("effects"), "must not contain sleeping without \"sleep\", which sets its limits");
    if (!physics.sleep) return;
    fields_.check_all(path, sleep_fields, *physics.sleep);
    if (physics.solver == Solver::impulse && (!physics.effects || physics.effects->sleeping))
      fields_.fault(
          root.at("sleep"),
          "must be removed with the solver impulse (use soft_step), unless the scene has a list of effects "
          "without sleeping");
  }

  void check_attractors(const Physics& physics) {
    const FaultPath list{"attractors"};
    if (physics.solver == Solver::impulse &&
        (physics.effects ? physics.effects->attractor : !physics.attractors.empty())) {
      fields_.fault(physics.effects ? FaultPath{}.at("effects") : list,
                    "must not contain attractors with the solver impulse (use soft_step)");
    }
    if (physics.attractors.size() > limits::max_attractors)
      fields_.fault(list, fmt::format("must be at most {} attractors", limits::max_attractors));
    for (std::size_t i = 0; i < physics.attractors.size(); ++i) {
      const Attractor& a = physics.attractors[i];
      const FaultPath path{"attractors", static_cast<std::int64_t>(i)};
      if (fields_.check_all(path, attractor_fields, a) && max_field(a) > limits::max_gravity)
        fields_.fault(path.at("softening"),
                      fmt::format("must be larger: the acceleration would reach {:.3g} m/s^2, above {:g}",
                                  max_field(a), limits::max_gravity));
    }
  }

  void check_materials() {
    const FaultPath root{"materials"};
    if (scene_.materials.empty() || scene_.materials[0].name != "default") {
      fields_.fault(root, "must start with the material \"default\"");
    }
    if (scene_.materials.size() > static_cast<std::size_t>(limits::max_materials)) {
      fields_.fault(root, fmt::format("must be at most {} materials", limits::max_materials));
    }
    std::set<std::string_view> names;
    for (const Material& m : scene_.materials) {
      const FaultPath path{"materials", -1, "", -1, &m.name};
      if (m.name.empty() || !is_plain_text(m.name) || m.name.find_first_of("\"\\") != std::string::npos) {
        fields_.fault(
            path,
            fmt::format("a material's name must be UTF-8 text of 1 to {} bytes without quotes, backslashes "
                        "and control characters",
                        limits::max_name_length));
      }
      if (!names.insert(m.name).second) fields_.fault(path, "two materials must not have the same name");
      const bool good = fields_.check_all(path, material_settings, m);
      if (good && m.friction != 0 && !scene_.physics.effects && scene_.physics.solver == Solver::impulse)
        fields_.fault(
            path.at("friction"),
            "must be 0 with the solver impulse (use soft_step), unless the scene has a list of effects "
            "without friction");
      if (good && m.rolling_resistance != 0 && !scene_.physics.effects &&
          scene_.physics.solver == Solver::impulse)
        fields_.fault(
            path.at("rolling_resistance"),
            "must be 0 with the solver impulse (use soft_step), unless the scene has a list of effects "
            "without rolling_resistance");
    }
  }

  void check_plane(const Plane& plane, const FaultPath& path) {
    if (!is_unit(plane.normal.squaredNorm())) {
      fields_.fault(path.at("normal"), "must be a vector of length 1 and of finite numbers");
    }
    fields_.check_all(path, plane_fields, plane);
    fields_.check_material(path, plane.material);
  }

  void check_joints() {
    if (scene_.joints.empty()) return;
    const FaultPath root{"joints"};
    const std::optional<Effects>& effects = scene_.physics.effects;
    const bool on = !effects || effects->joints;
    if (on && scene_.physics.solver == Solver::impulse)
      fields_.fault(
          root,
          "must be empty with the solver impulse (use soft_step), unless the scene has a list of effects "
          "without joints");
    if (on && effects && !effects->rotation && joints_turn_bodies(scene_))
      fields_.fault({"", -1, "effects"},
                    "must contain rotation if joints apply torques: hinges, and anchors away from a centre");
    if (scene_.joints.size() > static_cast<std::size_t>(limits::max_joints))
      fields_.fault(root, fmt::format("must be at most {} joints", limits::max_joints));
    std::int64_t bodies = static_cast<std::int64_t>(scene_.bodies.size() + scene_.extra_bodies.size());
    for (const BodyFile& file : scene_.body_files) bodies += kept_of(file);
    for (const BoxCollider& generator : scene_.generators)
      bodies += std::clamp<std::int64_t>(generator.count, 0, limits::max_bodies) -
                static_cast<std::int64_t>(generator.excluded.size());
    for (std::size_t i = 0; i < scene_.joints.size(); ++i)
      check_joint(scene_.joints[i], bodies, {"joints", static_cast<std::int64_t>(i)});
  }

  void check_joint(const Joint& joint, std::int64_t bodies, const FaultPath& path) {
    const auto body = [&](const char* field, std::int64_t id) {
      if (id < 0 || id >= bodies)
        fields_.fault(path.at(field), fmt::format("must be the id of a body, below {}", bodies));
    };
    bool good = true;
    for_each_field(
        joint_fields, [&]<auto member>(const Field<member>& field) {
          const bool spring_only = is_field<member, &Joint::frequency, &Joint::damping_ratio>;
          const bool lengths = is_field<member, &Joint::length, &Joint::min_length, &Joint::max_length>;
          const bool has_lengths = joint.kind == JointKind::distance || joint.kind == JointKind::spring;
          if ((spring_only && joint.kind != JointKind::spring) || (lengths && !has_lengths)) return;
          const bool fine = fields_.check(path, field, joint.*member);
          if (lengths) good &= fine;
        });
    body("a", joint.a);
    if (joint.b) body("b", *joint.b);
    if (joint.b && *joint.b == joint.a)
      fields_.fault(path.at("b"), "must be a body other than a, or \"world\"");
    if (joint.kind == JointKind::distance || joint.kind == JointKind::spring)
      check_lengths(joint, path, good);
    if (joint.kind != JointKind::hinge) return;
    if (!is_unit(joint.axis.squaredNorm()))
      fields_.fault(path.at("axis"), "must be a vector of length 1 and of finite numbers");
    if (!joint.limits) return;
    good = true;
    for (int end = 0; end < 2; ++end)
      good &= fields_.number(path.at("limits").at(end), (*joint.limits)[static_cast<std::size_t>(end)], -180,
                             180, "degrees");
    if (good && (*joint.limits)[0] > (*joint.limits)[1])
      fields_.fault(path.at("limits"), "must be two angles, the smaller first");
  }

  void check_lengths(const Joint& joint, const FaultPath& path, bool good) {
    if (!joint.b && !joint.anchor_b)
      fields_.fault(path.at("anchor_b"), "must be given for a joint to the world");
    if (joint.length && (joint.min_length || joint.max_length))
      fields_.fault(path.at("length"), "must not be given with min_length or max_length");
    if (good && joint.min_length && joint.max_length && *joint.min_length > *joint.max_length)
      fields_.fault(path.at("max_length"), "must be at least min_length");
  }

  void check_box_obstacle(const BoxObstacle& box, const FaultPath& path) {
    if (scene_.physics.solver == Solver::impulse)
      fields_.fault(path.at("shape"), "must be plane with the solver impulse (boxes need soft_step)");
    fields_.check_all(path, box_obstacle_fields, box);
    if (!is_unit(box.orientation.squaredNorm()))
      fields_.fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
    fields_.check_material(path, box.material);
  }

  void check_camera(const Camera& camera) {
    const FaultPath path{"camera"};
    bool good = fields_.check_all(path, camera_fields, camera);
    if (good && camera.up.isZero(0)) {
      fields_.fault(path.at("up"), "must not be zero");
      good = false;
    }
    if (good && camera.position && camera.target) {
      const Vector3d view = *camera.target - *camera.position;
      if (view.isZero(0)) {
        fields_.fault(path.at("target"), "must differ from the camera's position");
      } else if (view.cross(camera.up).isZero(0)) {
        fields_.fault(path.at("up"), "must not point along the line of sight");
      }
    }
  }

  const Scene& scene_;
  FieldValidator fields_;
  bool box_is_valid_ = false;
};

}  // namespace

std::string line_of(const Fault& fault) {
  constexpr std::size_t longest_path = 300;  // longer than the path of a material with the longest valid name
  return (fault.path.empty() ? "" : printable(fault.path, longest_path) + ": ") + fault.message;
}

std::vector<Fault> validate(const Scene& scene) { return SceneValidator(scene).run(); }

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
