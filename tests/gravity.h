#pragma once
// Gravity of test scenes that are compared with formulas.

namespace collidoscope {

inline constexpr double g = 9.81;  ///< m/s^2

}  // namespace collidoscope
