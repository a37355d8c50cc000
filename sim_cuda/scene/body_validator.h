#pragma once
// Validation of bodies, generators and files of bodies: masses, number of bodies, room in the box. Used by
// validate().

#include <optional>
#include <vector>

#include "sim_cuda/scene/field_validator.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Adds the faults of bodies and generators to a FieldValidator.
class BodyValidator {
 public:
  /// `box_is_valid`: the scene has a box without faults. Keeps references to `scene` and `fields`.
  BodyValidator(const Scene& scene, bool box_is_valid, FieldValidator& fields);

  /// `list`: the key of the bodies in the scene file.
  void check_bodies(const char* list, const std::vector<Body>& bodies);
  void check_generators();
  /// Also checks the total number of bodies. Call it after check_generators().
  void check_body_files();

 private:
  void check_body(const Body& body, const FaultPath& path);
  /// Density of a material. Unset if the density or the index is invalid.
  std::optional<double> density_of(int material) const;
  /// Checks the mass and the moment of inertia of a sphere.
  void check_derived(const Body& body, const FaultPath& path);
  void check_inertia(const Vector3d& inertia, const FaultPath& path);
  void must_fit(const FaultPath& path, double radius);
  bool scene_has_scaled_box() const;
  template <class Source>
  void check_excluded(const Source& source, const FaultPath& path);
  void check_room(const BoxCollider& g, const FaultPath& path);

  const Scene& scene_;
  FieldValidator& fields_;
  const bool box_is_valid_, turning_;
};

}  // namespace collidoscope
