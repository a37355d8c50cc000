// Writes structs as scene files: canonical text in the order of the field tables.
// Unset optional values and default members of bodies and joints are omitted. Numbers are the shortest
// decimals that read back to the same bits. Each body, joint, generator and obstacle has its own line.

#include <fmt/format.h>

#include "sim_cuda/scene/field_json.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {
namespace {

class SceneWriter {
 public:
  explicit SceneWriter(const Scene& scene) : scene_(scene) {}

  std::string write() {
    const Physics& physics = scene_.physics;
    const auto add = [&](std::string_view key, std::string_view value) { begin_member(key) += value; };
    add("format", scalar_text("collidoscope-scene"));
    add("version", "1");
    add("name", scalar_text(scene_.name));
    if (scene_.box) add("box", fields_text(box_fields, *scene_.box));
    put_fields(add, physics_settings, physics);
    add("drag", fields_text(drag_fields, physics.drag));
    if (physics.sleep) add("sleep", fields_text(sleep_fields, *physics.sleep));
    if (physics.guards) add("guards", fields_text(guards_fields, *physics.guards));

    write_list("attractors", physics.attractors,
               [](const Attractor& attractor) { return fields_text(attractor_fields, attractor); });
    write_materials();
    write_list("bodies", scene_.bodies, [&](const Body& body) { return text_of(body); });
    write_list("generators", scene_.generators, [&](const BoxCollider& g) { return text_of(g); });
    if (!scene_.body_files.empty())
      write_list("body_files", scene_.body_files, [&](const BodyFile& file) { return text_of(file); });
    if (!scene_.extra_bodies.empty())
      write_list("extra_bodies", scene_.extra_bodies, [&](const Body& body) { return text_of(body); });
    write_obstacles();
    write_list("joints", scene_.joints, [](const Joint& joint) { return text_of(joint); });
    add("camera", fields_text(camera_fields, scene_.camera));
    return "{" + text_ + "\n}\n";
  }

  std::string text_of(const Body& body) const {
    static const Body usual;
    ObjectText object;
    for_each_field(
        body_fields, [&]<auto member>(const Field<member>& field) {
          const bool always = is_field<member, &Body::shape, &Body::position> ||
                              (is_field<member, &Body::radius> && body.shape == Shape::sphere);
          if (is_field<member, &Body::radius> && body.shape != Shape::sphere) return;
          if (always || !same_bits(body.*member, usual.*member)) put(object, field.key, field, body.*member);
        });
    if (body.material != 0) put_material(object, body.material);
    return object.text();
  }

 private:
  /// Starts a member of the scene on a new line.
  std::string& begin_member(std::string_view key) {
    return text_ += fmt::format("{}\n  \"{}\": ", text_.empty() ? "" : ",", key);
  }

  template <class Item, class Write>
  void write_list(std::string_view key, const std::vector<Item>& items, Write write) {
    std::string& text = begin_member(key) += "[";
    for (std::size_t k = 0; k < items.size(); ++k) text += (k > 0 ? ",\n    " : "\n    ") + write(items[k]);
    text += items.empty() ? "]" : "\n  ]";
  }

  void put_material(ObjectText& object, int index) const {
    object("material", scalar_text(scene_.materials.at(static_cast<std::size_t>(index)).name));
  }

  void write_materials() {
    std::string& text = begin_member("materials") += "{";
    for (const Material& material : scene_.materials) {
      text += (&material == scene_.materials.data() ? "\n    " : ",\n    ") + scalar_text(material.name) +
              ": " + fields_text(material_settings, material);
    }
    text += "\n  }";
  }

  std::string text_of(const BoxCollider& generator) const {
    ObjectText object;
    object("kind", scalar_text("box_collider"));
    put_fields(object, generator_settings, generator);
    put_material(object, generator.material);
    if (!generator.excluded.empty()) object("excluded", list_text(generator.excluded));
    return object.text();
  }

  std::string text_of(const BodyFile& file) const {
    static const BodyFile usual;
    ObjectText object;
    for_each_field(
        body_file_fields, [&]<auto member>(const Field<member>& field) {
          if (is_field<member, &BodyFile::path> || !same_bits(file.*member, usual.*member))
            put(object, field.key, field, file.*member);
        });
    if (file.material != 0) put_material(object, file.material);
    if (!file.excluded.empty()) object("excluded", list_text(file.excluded));
    return object.text();
  }

  template <class Table, class Obstacle>
  std::string obstacle_text(const char* shape, const Table& table, const Obstacle& obstacle) const {
    ObjectText object;
    object("shape", scalar_text(shape));
    put_fields(object, table, obstacle);
    put_material(object, obstacle.material);
    return object.text();
  }

  /// Writes planes before boxes.
  void write_obstacles() {
    std::vector<std::string> all;
    for (const Plane& plane : scene_.obstacles) all.push_back(obstacle_text("plane", plane_fields, plane));
    for (const BoxObstacle& box : scene_.boxes) all.push_back(obstacle_text("box", box_obstacle_fields, box));
    write_list("obstacles", all, [](const std::string& text) { return text; });
  }

  static std::string text_of(const Joint& joint) {
    static const Joint usual;
    const bool spring = joint.kind == JointKind::spring, hinge = joint.kind == JointKind::hinge;
    ObjectText object;
    for_each_field(
        joint_fields, [&]<auto member>(const Field<member>& field) {
          const bool of_springs = is_field<member, &Joint::frequency, &Joint::damping_ratio>;
          const bool of_hinges = is_field<member, &Joint::axis, &Joint::limits>;
          if (is_field<member, &Joint::b> && !joint.b) {
            object("b", scalar_text("world"));
            return;
          }
          if ((of_springs && !spring) || (of_hinges && !hinge)) return;
          const bool always =
              of_springs || is_field<member, &Joint::kind, &Joint::a, &Joint::b, &Joint::axis>;
          if (always || !same_bits(joint.*member, usual.*member))
            put(object, field.key, field, joint.*member);
        });
    return object.text();
  }

  const Scene& scene_;
  std::string text_;
};

}  // namespace

std::string write_scene(const Scene& scene) { return SceneWriter(scene).write(); }

std::string write_body(const Body& body, const Scene& scene) { return SceneWriter(scene).text_of(body); }

std::string effects_text(const std::optional<Effects>& effects) {
  if (!effects) return scalar_text("auto");
  std::string text;
  for (const EffectName& effect : effect_names)
    if ((*effects).*effect.flag) text += (text.empty() ? "" : ", ") + scalar_text(effect.name);
  return "[" + text + "]";
}

}  // namespace collidoscope
