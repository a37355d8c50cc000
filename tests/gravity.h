#pragma once
// The gravity of test scenes that compare with formulas.

namespace collidoscope {

inline constexpr double g = 9.81;  ///< m/s^2

}  // namespace collidoscope
