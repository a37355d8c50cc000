#include "sim_cuda/scene/body_validator.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/import/body_table.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/derived_faults.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/mass_properties.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {

BodyValidator::BodyValidator(const Scene& scene, bool box_is_valid, FieldValidator& fields)
    : scene_(scene), fields_(fields), box_is_valid_(box_is_valid), turning_(bodies_turn(scene)) {}

void BodyValidator::check_bodies(const char* list, const std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) check_body(bodies[i], {list, static_cast<std::int64_t>(i)});
}

void BodyValidator::check_body(const Body& body, const FaultPath& path) {
  const auto check_member = [&]<auto member>(const Field<member>& field) {
    return fields_.check(path, field, body.*member);
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
    fields_.fault(path.at("mesh"), "must name an OBJ file, relative to the scene file");
  } else if (body.shape == Shape::mesh && !is_printable(body.mesh)) {
    fields_.fault(path.at("mesh"), "must be a path in UTF-8 without control characters");
  }
  if (!is_unit(body.orientation.squaredNorm())) {
    fields_.fault(path.at("orientation"), "must be a quaternion of length 1 and of finite numbers");
  }
  fields_.check_material(path, body.material);
  if (body.motion == Motion::fixed && !(body.velocity.isZero(0) && body.angular_velocity.isZero(0)))
    fields_.fault(path.at("motion"),
                  "must be kinematic or dynamic if a velocity is given; static bodies have no velocity");
}

std::optional<double> BodyValidator::density_of(int material) const {
  if (material < 0 || static_cast<std::size_t>(material) >= scene_.materials.size()) return std::nullopt;
  const double density = scene_.materials[static_cast<std::size_t>(material)].density;
  if (!(density >= limits::min_density && density <= limits::max_density)) return std::nullopt;
  return density;
}

void BodyValidator::check_derived(const Body& body, const FaultPath& path) {
  const std::optional<double> density = density_of(body.material);
  if (!body.mass && !density) return;
  const double mass = body.mass ? *body.mass : *density * sphere_volume(body.radius);
  if (const auto wrong = mass_fault(mass)) {
    // check_body() reports an invalid mass that was given explicitly.
    if (!body.mass) fields_.fault(path, *wrong);
    return;
  }
  if (!turning_ || body.inertia) return;
  if (const auto wrong = inertia_fault(sphere_inertia(mass, body.radius))) fields_.fault(path, *wrong);
}

void BodyValidator::check_inertia(const Vector3d& inertia, const FaultPath& path) {
  for (int axis = 0; axis < 3; ++axis) {
    // Equality is valid (a flat plate); the tolerance covers rounding.
    const double others = inertia[(axis + 1) % 3] + inertia[(axis + 2) % 3];
    if (inertia[axis] > others * (1 + 1e-12)) {
      fields_.fault(path.at(axis),
                    "must not exceed the sum of the other two moments, as for every rigid body");
    }
  }
}

void BodyValidator::must_fit(const FaultPath& path, double radius) {
  if (!scene_.box || !box_is_valid_ || scene_has_scaled_box()) return;
  const double side = (scene_.box->max - scene_.box->min).minCoeff();
  if (2 * radius > side)
    fields_.fault(path, fmt::format("must be at most {:g} m, for the sphere to fit in the box", side / 2));
}

bool BodyValidator::scene_has_scaled_box() const {
  for (const BoxCollider& generator : scene_.generators) {
    if (generator.variant != Variant::paper) return true;
  }
  return false;
}

void BodyValidator::check_generators() {
  std::int64_t total = static_cast<std::int64_t>(scene_.bodies.size() + scene_.extra_bodies.size());
  int scaled = 0;
  for (std::size_t i = 0; i < scene_.generators.size(); ++i) {
    const BoxCollider& g = scene_.generators[i];
    const FaultPath path{"generators", static_cast<std::int64_t>(i)};
    bool good_count = false, good_radius = false;
    for_each_field(
        generator_settings, [&]<auto member>(const Field<member>& field) {
          const bool good = fields_.check(path, field, g.*member);
          if constexpr (is_field<member, &BoxCollider::count>) good_count = good;
          if constexpr (is_field<member, &BoxCollider::radius_max>) good_radius = good;
        });
    const Physics& physics = scene_.physics;
    if (g.variant == Variant::settled &&
        (physics.gravity.isZero(0) || (physics.effects && !physics.effects->gravity)))
      fields_.fault(path.at("variant"), "must not be settled without gravity: no body would come to rest");
    fields_.check_material(path, g.material);
    if (good_count) {
      total += g.count;
      if (total > limits::max_bodies) {
        fields_.fault(path.at("count"),
                      fmt::format("must give at most {} bodies in total", limits::max_bodies));
        total = 0;
      }
    }
    if (good_count) check_excluded(g, path.at("excluded"));
    if (g.variant != Variant::paper && ++scaled > 1) {
      fields_.fault(
          path.at("variant"),
          "must be paper in all generators except one: \"scaled\", \"settled\" and \"equal\" set the box");
    }
    if (!scene_.box) {
      fields_.fault(path, "needs a \"box\" for its spheres");
    } else if (box_is_valid_ && good_count && good_radius) {
      check_room(g, path);
    }
    if (const std::optional<double> density = density_of(g.material); density && good_radius)
      if (const auto wrong = mass_fault(*density * sphere_volume(largest_radius(g)), "its largest sphere's"))
        fields_.fault(path, *wrong);
  }
}

void BodyValidator::check_body_files() {
  std::int64_t total = std::ssize(scene_.bodies) + std::ssize(scene_.extra_bodies);
  for (const BoxCollider& g : scene_.generators)
    total += std::clamp<std::int64_t>(g.count, 0, limits::max_bodies);
  for (std::size_t k = 0; k < scene_.body_files.size(); ++k) {
    const BodyFile& file = scene_.body_files[k];
    const FaultPath path{"body_files", static_cast<std::int64_t>(k)};
    fields_.check_all(path, body_file_fields, file);
    fields_.check_material(path, file.material);
    if (!file.tree.empty() && !file.boxes) fields_.fault(path.at("tree"), "must not be given without boxes");
    if (file.boxes) {
      if (file.radius) fields_.fault(path.at("radius"), "must not be given, since the file has boxes");
      if (scene_.body_files.size() + scene_.bodies.size() + scene_.extra_bodies.size() +
              scene_.generators.size() >
          1)
        fields_.fault(path, "must be the only bodies of the scene, since it has boxes");
    }
    if (!file.table) continue;
    if (file.table->radius.empty() && !file.radius)
      fields_.fault(path.at("radius"), "must be given, since the file has no radii");
    if (!file.table->radius.empty() && file.radius)
      fields_.fault(path.at("radius"), "must not be given, since the file has radii");
    check_excluded(file, path.at("excluded"));
    total += rows_of(file);
    if (total > limits::max_bodies) {
      fields_.fault(path.at("path"), fmt::format("must give at most {} bodies in total", limits::max_bodies));
      total = 0;
    }
    for (const BoxCollider& g : scene_.generators)
      if (g.variant == Variant::settled)
        fields_.fault(path, "must not be used with the variant settled, which is simulated before state 0");
  }
}

template <class Source>
void BodyValidator::check_excluded(const Source& source, const FaultPath& path) {
  const std::vector<std::int64_t>& excluded = source.excluded;
  for (std::size_t k = 0; k < excluded.size(); ++k)
    if (excluded[k] < 0 || excluded[k] >= rows_of(source) || (k > 0 && excluded[k] <= excluded[k - 1])) {
      fields_.fault(path.at(static_cast<int>(k)),
                    fmt::format("must be the index of one of its {} bodies, from 0, in ascending order",
                                rows_of(source)));
      return;
    }
}

void BodyValidator::check_room(const BoxCollider& g, const FaultPath& path) {
  const Box box = box_in_effect(scene_).value();
  if (g.variant != Variant::paper && !(box.max.cwiseAbs().maxCoeff() <= limits::max_coordinate)) {
    fields_.fault(path.at("count"),
                  fmt::format("must be smaller: the box would extend to {:g} m, beyond {:g} m",
                              box.max.maxCoeff(), limits::max_coordinate));
    return;
  }
  const double side = (box.max - box.min).minCoeff();
  if (2 * largest_radius(g) > side) {
    fields_.fault(path.at("radius_max"),
                  fmt::format("must be at most {:g} m, for the spheres to fit in the box", side / 2));
  }
}

}  // namespace collidoscope
