#pragma once
// The hash by which runs are compared: a sum modulo 2^64 over bodies of a mix of (id, x, q, v, w as bits), so
// that it does not depend on order. Quantities that are not stored count as q = 1, w = 0.

#include "sim_cuda/core/hash.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

struct HashSum {
  std::uint64_t value;
};
SIM_HD inline HashSum combine(HashSum a, HashSum b) { return {a.value + b.value}; }

template <class Real>
struct HashBody {
  BodyView<Real> bodies;
  SIM_HD HashSum operator()(std::int64_t body) const {
    std::uint64_t h = mix64(static_cast<std::uint64_t>(body));
    const auto add = [&h](Real x) { h = mix64(h ^ hash_bits(x)); };
    const auto add_vector = [&](const Vector3<Real>& x) {
      for (int k = 0; k < 3; ++k) add(x[k]);
    };
    const bool turns = bodies.orientation != nullptr;
    add_vector(bodies.position[body]);
    const Quaternion<Real> q = turns ? bodies.orientation[body] : Quaternion<Real>(1, 0, 0, 0);
    add(q.w());
    add(q.x());
    add(q.y());
    add(q.z());
    add_vector(bodies.velocity[body]);
    add_vector(turns ? bodies.angular_velocity[body] : Vector3<Real>(0, 0, 0));
    return {h};
  }
};

}  // namespace collidoscope
