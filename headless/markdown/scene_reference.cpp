// The table of all members of a scene file: the fields of sim_cuda/scene, and the rows that no field
// describes.

#include "headless/markdown/field_cells.h"
#include "headless/markdown/reference_pages.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {
namespace {

class SceneTable {
 public:
  /// `default_cell` and the others in Markdown.
  void row(std::string_view path, const std::string& range, const std::string& default_cell,
           const std::string& meaning) {
    table_.row({code(path), "", range, default_cell, meaning});
  }
  template <class Table>
  void fields(const std::string& path, const Table& table) {
    for_each_field(
        table, [&]<auto member>(const Field<member>& field) {
          table_.row({code(path + std::string(field.key)), unit_text(field.unit), range_text(field),
                      default_text(field), meaning_text(field)});
          if constexpr (is_field<member, &Physics::time_step>)
            table_.row(
                {"`steps_per_second`", "1/s",
                 "whole, " + detail::bounds_text(1, limits::max_steps_per_second), "",
                 "instead of `time_step`, which is then 1/`steps_per_second`; both together are an error"});
        });
  }
  void material(const std::string& path) {
    row(path + "material", "a name from `materials`", "`\"default\"`", "");
  }
  const std::string& text() const { return table_.text(); }

 private:
  MarkdownTable table_{"field", "unit", "range", "default", "meaning"};
};

std::string listed(std::int64_t most) { return "list, up to " + number_text(static_cast<double>(most)); }

}  // namespace

std::string scene_reference() {
  SceneTable table;
  table.row("format", "`\"collidoscope-scene\"`", "required", "");
  table.row("version", "1", "required", "");
  table.row("name", fmt::format("text, up to {} bytes", limits::max_name_length),
            code("\"" + Scene{}.name + "\""), "");
  table.row("box", "object", "no walls",
            "closed container; its six inner faces are walls of the material `default`");
  table.fields("box.", box_fields);
  table.fields("", physics_settings);
  table.row("drag", "object", "no drag", "medium around all bodies");
  table.fields("drag.", drag_fields);
  table.row("attractors", listed(limits::max_attractors), "[]",
            "points that attract all bodies; not with `impulse`");
  table.fields("attractors[].", attractor_fields);
  table.row("sleep", "object", "no sleeping", "islands at rest fall asleep; not with `impulse`");
  table.fields("sleep.", sleep_fields);
  table.row("guards", "object", "no guards", "checks of values after each stage");
  table.fields("guards.", guards_fields);
  table.row("materials",
            fmt::format("object: name → material; up to {}; names of 1 to {} bytes", limits::max_materials,
                        limits::max_name_length),
            "`{\"default\": {}}`", "`default` always exists");
  table.fields("materials.*.", material_settings);
  table.row("bodies", listed(limits::max_listed), "[]",
            fmt::format("together with generated bodies, at most {}", number_text(limits::max_bodies)));
  table.fields("bodies[].", body_fields);
  table.material("bodies[].");
  table.row("generators", listed(limits::max_listed), "[]", "");
  table.row("generators[].kind", "`\"box_collider\"`", "required", "needs a `box`");
  table.fields("generators[].", generator_settings);
  table.material("generators[].");
  table.row("generators[].excluded", "list of whole numbers, from 0, ascending", "[]",
            "numbers of its bodies to omit; the other bodies do not change");
  table.row("body_files", "list of objects; up to 1000", "[]", "bodies of files of other programs");
  table.fields("body_files[].", body_file_fields);
  table.material("body_files[].");
  table.row("body_files[].excluded", "as `generators[].excluded`", "[]", "rows of the file to omit");
  table.row("extra_bodies", "as `bodies`", "[]", "bodies added during a run");
  table.row("obstacles", listed(limits::max_listed), "[]", "static half-spaces and boxes");
  table.row("obstacles[].shape", "`\"plane\"`, `\"box\"`", "required",
            "bodies stay where normal · x ≥ offset, or outside the box; boxes not with `impulse`");
  table.fields("obstacles[].", plane_fields);
  table.fields("obstacles[].", box_obstacle_fields);
  table.material("obstacles[].");
  table.row("joints", listed(limits::max_listed), "[]", "not with `impulse`");
  table.fields("joints[].", joint_fields);
  table.row("camera", "object", "frames the scene", "view of pictures");
  table.fields("camera.", camera_fields);
  return table.text();
}

}  // namespace collidoscope
