// Writes structs as scene files: canonical text in the order of the field tables.
// Unset optional values and default members of bodies and joints are omitted. Numbers are the shortest
// decimals that read back to the same bits. Each body, joint, generator and obstacle has its own line.

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
    OrderedJson head = OrderedJson::object();
    head["format"] = "collidoscope-scene";
    head["version"] = 1;
    head["name"] = scene_.name;
    if (scene_.box) head["box"] = fields_json(box_fields, *scene_.box);
    put_fields(head, physics_settings, physics);
    head["drag"] = fields_json(drag_fields, physics.drag);
    if (physics.sleep) head["sleep"] = fields_json(sleep_fields, *physics.sleep);
    if (physics.guards) head["guards"] = fields_json(guards_fields, *physics.guards);
    for (const auto& [key, value] : head.items()) begin_member(key) += json_line(value);

    write_list("attractors", physics.attractors,
               [](const Attractor& attractor) { return fields_json(attractor_fields, attractor); });
    write_materials();
    write_list("bodies", scene_.bodies, [&](const Body& body) { return json_of(body); });
    write_list("generators", scene_.generators, [&](const BoxCollider& g) { return json_of(g); });
    if (!scene_.extra_bodies.empty())
      write_list("extra_bodies", scene_.extra_bodies, [&](const Body& body) { return json_of(body); });
    write_obstacles();
    write_list("joints", scene_.joints, [](const Joint& joint) { return json_of(joint); });
    begin_member("camera") += json_line(fields_json(camera_fields, scene_.camera));
    return "{" + text_ + "\n}\n";
  }

  OrderedJson json_of(const Body& body) const {
    static const Body usual;
    OrderedJson json = OrderedJson::object();
    for_each_field(
        body_fields, [&]<auto member>(const Field<member>& field) {
          const bool always = is_field<member, &Body::shape, &Body::position> ||
                              (is_field<member, &Body::radius> && body.shape == Shape::sphere);
          if (is_field<member, &Body::radius> && body.shape != Shape::sphere) return;
          if (always || !same_bits(body.*member, usual.*member)) put(json, field.key, field, body.*member);
        });
    if (body.material != 0) put_material(json, body.material);
    return json;
  }

 private:
  /// Starts a member of the scene on a new line.
  std::string& begin_member(const std::string& key) {
    text_ += text_.empty() ? "\n  " : ",\n  ";
    return text_ += json_line(key) + ": ";
  }

  template <class Item, class Write>
  void write_list(const std::string& key, const std::vector<Item>& items, Write write) {
    std::string& text = begin_member(key) += "[";
    for (std::size_t k = 0; k < items.size(); ++k)
      text += (k > 0 ? ",\n    " : "\n    ") + json_line(write(items[k]));
    text += items.empty() ? "]" : "\n  ]";
  }

  void put_material(OrderedJson& json, int index) const {
    json["material"] = scene_.materials.at(static_cast<std::size_t>(index)).name;
  }

  void write_materials() {
    std::string& text = begin_member("materials") += "{";
    for (const Material& material : scene_.materials) {
      text += (&material == scene_.materials.data() ? "\n    " : ",\n    ") + json_line(material.name) +
              ": " + json_line(fields_json(material_settings, material));
    }
    text += "\n  }";
  }

  OrderedJson json_of(const BoxCollider& generator) const {
    OrderedJson json = OrderedJson::object();
    json["kind"] = "box_collider";
    put_fields(json, generator_settings, generator);
    put_material(json, generator.material);
    if (!generator.excluded.empty()) json["excluded"] = generator.excluded;
    return json;
  }

  /// Writes planes before boxes.
  void write_obstacles() {
    std::vector<OrderedJson> all;
    for (const Plane& plane : scene_.obstacles) {
      all.push_back(OrderedJson::object());
      all.back()["shape"] = "plane";
      put_fields(all.back(), plane_fields, plane);
      put_material(all.back(), plane.material);
    }
    for (const BoxObstacle& box : scene_.boxes) {
      all.push_back(OrderedJson::object());
      all.back()["shape"] = "box";
      put_fields(all.back(), box_obstacle_fields, box);
      put_material(all.back(), box.material);
    }
    write_list("obstacles", all, [](const OrderedJson& json) { return json; });
  }

  static OrderedJson json_of(const Joint& joint) {
    static const Joint usual;
    const bool spring = joint.kind == JointKind::spring, hinge = joint.kind == JointKind::hinge;
    OrderedJson json = OrderedJson::object();
    for_each_field(
        joint_fields, [&]<auto member>(const Field<member>& field) {
          const bool of_springs = is_field<member, &Joint::frequency, &Joint::damping_ratio>;
          const bool of_hinges = is_field<member, &Joint::axis, &Joint::limits>;
          if (is_field<member, &Joint::b> && !joint.b) {
            json["b"] = "world";
            return;
          }
          if ((of_springs && !spring) || (of_hinges && !hinge)) return;
          const bool always =
              of_springs || is_field<member, &Joint::kind, &Joint::a, &Joint::b, &Joint::axis>;
          if (always || !same_bits(joint.*member, usual.*member)) put(json, field.key, field, joint.*member);
        });
    return json;
  }

  const Scene& scene_;
  std::string text_;
};

}  // namespace

std::string write_scene(const Scene& scene) { return SceneWriter(scene).write(); }

std::string write_body(const Body& body, const Scene& scene) {
  return json_line(SceneWriter(scene).json_of(body));
}

std::string json_line(const OrderedJson& json) {
  const std::string dense = json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  std::string text;
  text.reserve(dense.size() + dense.size() / 4);
  bool quoted = false;
  for (std::size_t k = 0; k < dense.size(); ++k) {
    const char c = dense[k];
    text += c;
    if (quoted && c == '\\')
      text += dense[++k];  // escaped character
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == ':' || c == ','))
      text += ' ';
  }
  return text;
}

OrderedJson effects_json(const std::optional<Effects>& effects) {
  if (!effects) return "auto";
  OrderedJson names = OrderedJson::array();
  for (const EffectName& effect : effect_names)
    if ((*effects).*effect.flag) names.push_back(std::string(effect.name));
  return names;
}

}  // namespace collidoscope
