#pragma once
// Impacts of heavy bodies on light ones that cannot give way. In a sweep, a heavy body that hits a light one
// on the ground loses only the momentum of the light one. It needs about as many sweeps as it has times the
// mass, so it would sink in, and recovery of the overlap would lift it again.
//
// Shock propagation (Guendelman, Bridson, Fedkiw, "Nonconvex rigid bodies with stacking", 2003): if the light
// body is supported by the ground, and the pair still approaches after an impact, the light body counts as
// immovable. The heavy body gets the whole impulse, and the ground gives it. The speed of the heavy body
// along the normal does not increase, so its kinetic energy does not. In free space, no body is supported,
// and momentum is conserved.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Marks of bodies in the impacts of a substep. By body: 1 + the sweep in which the mark was set, or 0. A
/// sweep reads only marks of earlier sweeps, so the result does not depend on the order in a sweep.
struct ShockMarks {
  std::uint8_t* driven;     ///< a body of more than `heavy` times its mass has hit it, or a driven body
  std::uint8_t* supported;  ///< a plane, a static body or a supported body has pushed it

  /// Ratio of masses. Equal or lighter bodies converge in few sweeps, and keep momentum and energy exactly.
  static constexpr int heavy = 10;
  /// The first sweep with shocks. The sweeps before it show whether a light body gives way.
  static constexpr int first_sweep = 4;

  /// A light body is blocked if the approach is at least this share of the mean approach in all sweeps.
  static constexpr double blocked_share = 2.0 / 3;

  template <class Real>
  SIM_HD static bool is_heavy(Real inverse_mass, Real inverse_mass_of_other) {
    return inverse_mass > 0 && heavy * inverse_mass < inverse_mass_of_other;
  }
  template <class Real>
  SIM_HD static bool has_heavy(Real w_a, Real w_b) {
    return is_heavy(w_a, w_b) || is_heavy(w_b, w_a);
  }
  SIM_HD bool is_driven(std::uint32_t id, int sweep) const { return is_set(driven, id, sweep); }
  SIM_HD bool is_supported(std::uint32_t id, int sweep) const { return is_set(supported, id, sweep); }
  /// True if one body is heavy for the other, and the light one is supported. `w_a`, `w_b`: inverse masses,
  /// 1/kg.
  template <class Real>
  SIM_HD bool is_shock_pair(const Pair& ids, Real w_a, Real w_b, int sweep) const {
    return (is_heavy(w_a, w_b) && is_supported(ids.b, sweep)) ||
           (is_heavy(w_b, w_a) && is_supported(ids.a, sweep));
  }
  SIM_HD void support(std::uint32_t id, int sweep) const { set(supported, id, sweep); }
  /// Call for a body with inverse mass w that `other` has hit. `other_moves`: it has a velocity. Support
  /// passes to bodies of at most `heavy` times the mass.
  template <class Real>
  SIM_HD void add_impact(std::uint32_t id, Real w, std::uint32_t other, Real w_other, bool other_moves,
                         int sweep) const {
    const bool is_much_heavier = is_heavy(w, w_other);
    if (is_heavy(w_other, w) || (!is_much_heavier && is_driven(other, sweep))) set(driven, id, sweep);
    if (w_other > 0 ? !is_much_heavier && is_supported(other, sweep) : !other_moves) support(id, sweep);
  }
  SIM_HD void clear(std::uint32_t id) const {
    if (driven[id] != 0) driven[id] = 0;
    if (supported[id] != 0) supported[id] = 0;
  }

 private:
  SIM_HD static bool is_set(const std::uint8_t* marks, std::uint32_t id, int sweep) {
    const std::uint8_t mark = atomic_load(marks + id);
    return mark != 0 && mark <= sweep;
  }
  SIM_HD static void set(std::uint8_t* marks, std::uint32_t id, int sweep) {
    if (atomic_load(marks + id) == 0) atomic_store(marks + id, static_cast<std::uint8_t>(sweep + 1));
  }
};

}  // namespace collidoscope
