#include "sim_cuda/dynamics/continuous_collision.h"

#include <algorithm>

#include "sim_cuda/core/atomics.h"

namespace collidoscope {

/// Round 0 lets everybody go; each round after it is over the contacts, reads one set of shares and lowers
/// the other, so that its items are independent of each other. Where a round finds nothing, both sets agree,
/// and the rounds that follow have no items.
template <class Real>
struct HoldApart {
  const Pair* contacts;
  BodyView<Real> bodies;
  std::int64_t body_count;
  const StepControl* control;
  HeldMotion<Real> motion;
  std::uint32_t* share;
  std::uint32_t* entered;
  Real h;  ///< s

  SIM_HD std::int64_t items(int round) const {
    if (round == 0) return body_count;
    return round == 1 || atomic_load(entered + round - 1) != 0 ? control->contacts : 0;
  }
  SIM_HD void operator()(int round, int item) const {
    round == 0 ? let_go(item) : hold(round, contacts[item]);
  }

  static constexpr std::uint32_t one = 0x3f800000;  // 1.0f
  SIM_HD void let_go(int body) const {
    share[body] = share[body_count + body] = one;
    if (body == 0)
      for (int k = 0; k <= ContinuousCollision<Real>::rounds; ++k) entered[k] = 0;
  }

  SIM_HD void hold(int round, Pair pair) const {
    const std::uint32_t* now = share + (round % 2 == 1 ? 0 : body_count);
    std::uint32_t* next = share + (round % 2 == 1 ? body_count : 0);
    const float share_a = std::bit_cast<float>(now[pair.a]), share_b = std::bit_cast<float>(now[pair.b]);
    const auto way = [&](std::uint32_t body, float part) -> Vector3<Real> {
      return static_cast<Real>(part) *
             motion.way(static_cast<int>(body), bodies.position[body], bodies.velocity[body], h);
    };
    const Vector3<Real> d = bodies.position[pair.b] - bodies.position[pair.a];
    const auto s = static_cast<float>(share_outside_core<Real>(
        d, way(pair.b, share_b) - way(pair.a, share_a), bodies.radius[pair.a] + bodies.radius[pair.b]));
    if (s < 1) atomic_store(entered + round, std::uint32_t{1});
    lower(next, pair.a, share_a * s);
    lower(next, pair.b, share_b * s);
  }
  SIM_HD void lower(std::uint32_t* next, std::uint32_t body, float part) const {
    if (part < 1 && bodies.inverse_mass[body] > 0)
      atomic_min(next + body, std::bit_cast<std::uint32_t>(part));
  }
};

namespace {

template <class Real>
struct TakeLeash {
  BodyView<Real> bodies;
  Real time, slack;
  const StepControl* control;
  Leash<Real>* leash;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const Vector3<Real> v = bodies.velocity[body];
    using std::sqrt;
    leash[body] = {bodies.position[body], time * sqrt(v.dot(v)) + slack + bodies.radius[body] / 2};
  }
};

}  // namespace

template <class Real>
ContinuousCollision<Real>::ContinuousCollision(Executor& executor)
    : executor_(executor),
      leash_(executor, "leashes"),
      share_(executor, "shares of ways"),
      entered_(executor, "rounds of held motion") {}

template <class Real>
void ContinuousCollision<Real>::enable(const BodyView<Real>& bodies, std::int64_t body_count,
                                       const StepControl* control) {
  bodies_ = bodies;
  body_count_ = body_count;
  control_ = control;
  leash_.resize_discarding(static_cast<std::size_t>(body_count));
  share_.resize_discarding(2 * static_cast<std::size_t>(body_count));
  entered_.resize_discarding(rounds + 1);
}

template <class Real>
void ContinuousCollision<Real>::begin(Real time, Real slack) {
  executor_.run("continuous", body_count_, TakeLeash<Real>{bodies_, time, slack, control_, leash_.data()});
}

template <class Real>
void ContinuousCollision<Real>::hold(const BodyView<Real>& ways, const Pair* contacts, std::int64_t capacity,
                                     Real h) {
  executor_.run_rounds(
      "continuous", rounds + 1, std::max(capacity, body_count_),
      HoldApart<Real>{contacts, ways, body_count_, control_, motion(), share_.data(), entered_.data(), h});
}

template class ContinuousCollision<float>;
template class ContinuousCollision<double>;

}  // namespace collidoscope
