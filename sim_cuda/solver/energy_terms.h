#pragma once
// Energy terms of the energy guard (energy_guard.h), and the corrections that follow from them. Pure
// functions.

#include <bit>
#include <cmath>
#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// What the guard does to an island: it removes a share of impulses, or scales all changes of velocity.
struct EnergyCorrection {
  double share = 0, factor = 1;
  SIM_HD bool is_none() const { return !(share > 0) && !(factor < 1); }
};

/// Bits of a term in a sum; leaves room for 2^24 terms.
inline constexpr int bits_of_term = 38;

/// Unit of a sum in which the largest term has the given bits.
SIM_HD inline double unit_of_sum(std::uint32_t largest_bits, int bits = bits_of_term) {
  return static_cast<double>(std::bit_cast<float>(largest_bits)) /
         static_cast<double>(std::uint64_t{1} << bits);
}
SIM_HD inline bool is_finite(float value) { return value - value == 0; }
/// `value` as a whole number of units. 0 if it is not finite or much too large, as for a body that is not
/// finite: the conversion of such a number differs between CPU and GPU.
SIM_HD inline std::uint64_t in_units(double value, double one, int bits = bits_of_term) {
  const double units = value / one;
  const double largest_units = static_cast<double>(std::uint64_t{1} << (bits + 1));
  return units > -largest_units && units < largest_units
             ? static_cast<std::uint64_t>(static_cast<std::int64_t>(units))
             : 0;
}

/// Terms of a body or an island, J; names as in energy_guard.h. Angular terms are included.
struct EnergyTerms {
  static constexpr std::uint32_t count = 8;
  double values[count];
  SIM_HD double start() const { return values[0]; }   ///< sum of m w . d
  SIM_HD double square() const { return values[1]; }  ///< sum of m d . d / 2
  /// Sum of m h g . (h g + change by springs) / 2, less the change of the energy of rotation by turning.
  SIM_HD double allowed() const { return values[2]; }
  SIM_HD double by_start() const { return values[3]; }   ///< sum of w . P
  SIM_HD double by_change() const { return values[4]; }  ///< sum of d . P
  SIM_HD double by_self() const { return values[5]; }    ///< sum of P . P / m, D
  /// Sum of (2 v - w) . P, v: at the end. Only for the first removal, where loads have a factor; else 0.
  SIM_HD double by_next() const { return values[6]; }
  /// Sum of m v . v of bodies with impulses. Only for the first removal with slow_keep_loads; else 0.
  SIM_HD double motion() const { return values[7]; }

  SIM_HD double gain() const { return start() + square() - allowed(); }  ///< G
  SIM_HD double linear() const { return by_start() + by_change(); }      ///< S
  SIM_HD double gain_without(double share) const {
    return gain() - share * linear() + share * share / 2 * by_self();
  }
  SIM_HD double largest() const {
    double largest = 0;
    for (const double value : values) largest = max_of(largest, value < 0 ? -value : value);
    return largest;
  }
  /// Error of the gain of a body.
  SIM_HD double rounding(double relative) const {
    return relative * (square() + (start() < 0 ? -start() : start())) + 1e-4 * max_of(allowed(), 0.0);
  }
  /// Smallest share, at most `most`, without which the gain is 0 or minimal.
  SIM_HD EnergyCorrection without_share(double most) const {
    const double discriminant = linear() * linear() - 2 * by_self() * gain();
    using std::sqrt;
    const double share =
        discriminant > 0 ? 2 * gain() / (linear() + sqrt(discriminant)) : linear() / by_self();
    return {.share = min_of(share, most)};
  }
  /// Factor of P that leaves the least kinetic energy in the next substep, if other forces do not change.
  /// `removed`: share of P that has been removed from the velocities. Precondition: D > 0.
  ///
  /// Without impulses of contacts, a body would next have the velocity v + (v - w) - P / m.
  SIM_HD double next_loads(double removed) const { return 1 + removed - by_next() / by_self(); }
  /// Factor of all changes of velocity, with which the gain is 0, or smallest.
  SIM_HD EnergyCorrection scaled() const {
    if (!(square() > 0)) return {};
    using std::sqrt;
    const double sum =
        sqrt(max_of(start() * start() + 4 * square() * allowed(), 0.0)) + (start() > 0 ? start() : -start());
    return {.factor = start() > 0 ? max_of(2 * allowed() / sum, 0.0) : sum / (2 * square())};
  }
  SIM_HD double gain_with(double factor) const {
    return factor * start() + factor * factor * square() - allowed();
  }
};

}  // namespace collidoscope
