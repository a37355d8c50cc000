#include "sim_cuda/solver/energy_guard.h"

#include <algorithm>
#include <vector>

#include "sim_cuda/solver/energy_guard_rounds.h"

namespace collidoscope {

template <class Real>
EnergyGuard<Real>::EnergyGuard(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      start_velocity_(executor, "velocities at substep start"),
      start_spin_(executor, "spins at substep start"),
      start_rotation_(executor, "rotation energies at substep start"),
      moved_velocity_(executor, "velocities of the move"),
      gains_(executor, "energy guard gains"),
      largest_(executor, "energy guard largest gain"),
      total_(executor, "energy guard total"),
      flags_(executor, "energy guard flags"),
      parent_(executor, "energy guard islands"),
      scale_(executor, "energy guard scales"),
      terms_(executor, "energy guard terms"),
      changes_(executor, "energy guard changes"),
      sums_(executor, "energy guard sums"),
      exempt_(executor, "energy guard exemptions"),
      grounded_(executor, "energy guard ground"),
      active_(executor, "energy guard active bodies"),
      rigid_scale_(executor, "energy guard rigid scales"),
      rigid_sums_(executor, "energy guard rigid sums"),
      load_factor_(executor, "energy guard load factors"),
      is_free_(executor, "freely moving bodies") {
  const auto n = static_cast<std::size_t>(scene.body_count);
  start_velocity_.resize_discarding(n);
  if (scene.effects.rotation && (scene.effects.friction || scene.effects.joints))
    start_spin_.resize_discarding(n);
  if (start_spin() != nullptr && scene.unequal_moments) start_rotation_.resize_discarding(n);
  moved_velocity_.resize_discarding(n);
  gains_.resize_discarding(n);
  largest_.upload({0});
  total_.upload(std::vector<std::uint64_t>(total_slots, 0));
  flags_.upload(std::vector<std::uint32_t>(removals, 0));
  parent_.resize_discarding(n);
  scale_.resize_discarding(n);
  terms_.resize_discarding(n);
  changes_.resize_discarding(n);
  sums_.resize_discarding(std::size_t{EnergyTerms::count} * n);
  exempt_.resize_discarding(n);
  grounded_.resize_discarding(n);
  active_.resize_discarding(n);
  rigid_scale_.resize_discarding(std::size_t{RigidSums::kinds} * n);
  rigid_sums_.resize_discarding(std::size_t{RigidSums::count} * n);
  if (scene.limits_recovery()) load_factor_.resize_discarding(n);
  if (scene.integrator != Integrator::semi_implicit_euler) is_free_.resize_discarding(n);
}

template <class Real>
void EnergyGuard<Real>::apply(Real h, bool is_first_substep, const GuardedContacts<Real>& contacts,
                              std::int64_t contact_capacity) {
  executor_.run_rounds(
      "relax", GuardRounds<Real>::rounds, std::max(scene_.body_count, contact_capacity),
      GuardRounds<Real>{
          {{scene_.bodies,
            scene_.body_count,
            start_velocity_.data(),
            start_spin(),
            start_rotation(),
            moved_velocity_.data(),
            is_free(),
            scene_.gravity,
            scene_.effects.attractor ? scene_.field : nullptr,
            scene_.effects.gravity || scene_.effects.attractor,
            is_first_substep,
            h,
            contacts,
            scene_.planes,
            scene_.plane_count,
            scene_.surfaces(),
            scene_.joints != nullptr ? scene_.joints->view() : JointView<Real>{},
            scene_.joints != nullptr ? scene_.joints->is_jointed() : nullptr,
            scene_.joints != nullptr ? scene_.joints->members() : nullptr,
            scene_.joints != nullptr ? scene_.joints->loops() : LoopView<Real>{},
            scene_.joints != nullptr ? scene_.joints->spring_impulses() : SpringImpulses<Real>{},
            scene_.static_impulses,
            scene_.control},
           parent_.data(),
           scale_.data(),
           terms_.data(),
           changes_.data(),
           sums_.data(),
           exempt_.data(),
           grounded_.data(),
           active_.data(),
           rigid_scale_.data(),
           rigid_sums_.data(),
           load_factor_.size() > 0 ? load_factor_.data() : nullptr,
           load_factor_.size() > 0 && scene_.effects.friction},
          gains_.data(),
          largest_.data(),
          total_.data(),
          flags_.data()});
}

template class EnergyGuard<float>;
template class EnergyGuard<double>;

}  // namespace collidoscope
