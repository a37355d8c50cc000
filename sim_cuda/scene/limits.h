#pragma once
// Valid ranges of scene values. They cover dust as well as planets. Every quantity in range is a normal
// float, and no step overflows in its first product.
// validate() checks the ranges. The README.md of this folder lists them.

#include <cstdint>

namespace collidoscope::limits {

inline constexpr std::int64_t max_bodies = std::int64_t{1} << 27;  ///< listed and generated bodies in total
inline constexpr double max_coordinate = 1e9;                      ///< m, of a position or a box
inline constexpr double max_speed = 1e9;                           ///< m/s per component
inline constexpr double max_spin = 1e9;                            ///< rad/s per component
inline constexpr double max_gravity = 1e6;                         ///< m/s^2 per component
inline constexpr double max_viscosity = 1e9;                       ///< Pa s
inline constexpr double max_medium_density = 1e9;                  ///< kg/m^3
inline constexpr double max_drag_coefficient = 100;
inline constexpr double max_strength = 1e24;                        ///< m^3/s^2, of an attractor
inline constexpr double min_softening = 1e-3, max_softening = 1e9;  ///< m
inline constexpr int max_attractors = 1000;
inline constexpr double min_radius = 1e-9, max_radius = 1e9;  ///< m
inline constexpr double min_generated_radius = 1e-3;          ///< m, of the largest sphere of a generator
inline constexpr int max_blocks = 2147483647, max_threads = 1024;    ///< blocks per launch, threads per block
inline constexpr double min_tolerance = 1e-15, max_tolerance = 1e9;  ///< m, allowed error
inline constexpr double min_mass = 1e-30, max_mass = 1e30;           ///< kg
inline constexpr double min_inertia = 1e-36, max_inertia = 1e36;     ///< kg m^2
inline constexpr double min_density = 1e-9, max_density = 1e18;      ///< kg/m^3
inline constexpr double min_time_step = 1e-9, max_time_step = 1e3;   ///< s
inline constexpr int max_steps_per_second = 1'000'000;
inline constexpr double min_rate = 1 / max_time_step;  ///< Hz, for steps given as steps per second
inline constexpr int max_substeps = 1000;
inline constexpr int max_iterations = 1000;
inline constexpr double max_restitution = 1, max_friction = 100;
inline constexpr double max_rolling_resistance = 10;
inline constexpr double max_sleep_time = 1e6;  ///< s
inline constexpr double max_guarded = 1e18;    ///< m, m/s, rad/s: guard thresholds; the square is a finite
                                               ///< float
inline constexpr std::int64_t max_joints = std::int64_t{1} << 24;
inline constexpr double min_frequency = 1e-6, max_frequency = 1e9;  ///< Hz, of a spring
inline constexpr double max_damping_ratio = 1000;
inline constexpr std::uint32_t max_listed = 1u << 20;  ///< entries of a list in a file (bodies, joints)
inline constexpr int max_name_length = 200;            ///< bytes of UTF-8
inline constexpr int max_materials = 65535;            ///< indices have 16 bits
inline constexpr double smallest_normal = 0x1p-126;  ///< smallest normal float; values closer to 0 must be 0

}  // namespace collidoscope::limits
