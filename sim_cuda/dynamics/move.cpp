#include "sim_cuda/dynamics/move.h"

#include "sim_cuda/dynamics/awake.h"

namespace collidoscope {

template <class Real>
void move_bodies(Executor& executor, const BodyView<Real>& bodies, std::int64_t body_count, Effects effects,
                 const Vector3<Real>& gravity, const std::optional<Box>& box, Real h,
                 const StepControl* control, const std::uint8_t* asleep) {
  const auto with = [&]<bool pulled, bool rotation, bool boxed>() {
    const Vector3<Real> low = box ? box->min.cast<Real>() : Vector3<Real>(0, 0, 0);
    const Vector3<Real> high = box ? box->max.cast<Real>() : Vector3<Real>(0, 0, 0);
    run_awake_bodies(executor, "move", body_count, asleep,
                     MoveBodies<Real, pulled, rotation, boxed>{bodies, gravity, low, high, h, control});
  };
  const auto with_box = [&]<bool pulled, bool rotation>() {
    box ? with.template operator()<pulled, rotation, true>()
        : with.template operator()<pulled, rotation, false>();
  };
  if (effects.gravity)
    effects.rotation ? with_box.template operator()<true, true>()
                     : with_box.template operator()<true, false>();
  else
    effects.rotation ? with_box.template operator()<false, true>()
                     : with_box.template operator()<false, false>();
}

template void move_bodies(Executor&, const BodyView<float>&, std::int64_t, Effects, const Vector3<float>&,
                          const std::optional<Box>&, float, const StepControl*, const std::uint8_t*);
template void move_bodies(Executor&, const BodyView<double>&, std::int64_t, Effects, const Vector3<double>&,
                          const std::optional<Box>&, double, const StepControl*, const std::uint8_t*);

}  // namespace collidoscope
