#include "sim_cuda/dynamics/move.h"

#include "sim_cuda/dynamics/awake.h"

namespace collidoscope {

template <class Real>
void move_bodies(Executor& executor, const BodyView<Real>& bodies, std::int64_t body_count, Effects effects,
                 const Vector3<Real>& gravity, const std::optional<Box>& box, Real h,
                 const StepControl* control, const std::uint8_t* asleep, const ClampedMotion<Real>& motion,
                 const TreeMember* members) {
  const Vector3<Real> low = box ? box->min.cast<Real>() : Vector3<Real>(0, 0, 0);
  const Vector3<Real> high = box ? box->max.cast<Real>() : Vector3<Real>(0, 0, 0);
  const bool with_ccd = effects.continuous_collision;
  run_awake_bodies(
      executor, "move", body_count, asleep,
      MoveBodies<Real>{bodies, gravity, low, high, h, with_ccd ? motion : ClampedMotion<Real>{},
                       effects.gravity && !with_ccd, box.has_value(), effects.rotation, control, members});
}

template void move_bodies(Executor&, const BodyView<float>&, std::int64_t, Effects, const Vector3<float>&,
                          const std::optional<Box>&, float, const StepControl*, const std::uint8_t*,
                          const ClampedMotion<float>&, const TreeMember*);
template void move_bodies(Executor&, const BodyView<double>&, std::int64_t, Effects, const Vector3<double>&,
                          const std::optional<Box>&, double, const StepControl*, const std::uint8_t*,
                          const ClampedMotion<double>&, const TreeMember*);

}  // namespace collidoscope
