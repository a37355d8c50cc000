#pragma once
// The Box Collider, the paper's benchmark: spheres of random radii dropped into a closed box. Everything
// random is Philox4x32-10 with the generator's seed as key and counter (id, stream, 0, 0), ids counted from
// 0 within the generator; u = (word >> 8) / 2^24 in [0, 1). So body i is the same whatever N is, except
// where the variant's box grows with N.
//
//   stream 0: word 0 -> radius = radius_max (1 - u); words 1, 2, 3 -> position, a u per axis
//   stream 1: words 0, 1, 2 -> velocity component = speed_max (2 u - 1)
//   stream 2, 3, ...: words 0, 1, 2 -> further positions, tried by `apart` alone, largest sphere first (so
//   there,
//                                      and only there, where a body starts depends on the others too)
//
// All of it is computed in float and widened, so that float and double runs start from the same state.

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Share of the box that `scaled` and `equal` fill with spheres, once they are many enough.
inline constexpr double scaled_fill = 0.3;

/// The cube root by Newton's method, y <- (2 y + x / y^2) / 3: eight steps from the smallest power of two
/// that is not below it (each step squares the relative error, which is < 1 at the start). x >= 0.
double newton_cube_root(double x);

/// m, side of the cube that the variants `scaled` and `equal` put `count` spheres in:
/// max(100, cuberoot(count m / 0.3)), rounded to float, where m = pi/3 radius_max^3 is the mean volume of a
/// sphere whose radius is uniform in (0, radius_max] (130.9 m^3 for 5 m).
double scaled_side(std::int64_t count, double radius_max);

/// The one radius of `equal`: radius_max cuberoot(1/4), whose volume is the mean volume m above.
float equal_radius(double radius_max);

/// m, the radius that no sphere of this generator exceeds.
double largest_radius(const BoxCollider& generator);

/// The box that the scene's bodies move in: its own, or, where a generator is `scaled` or `equal`, the cube
/// of scaled_side() from its own min corner.
std::optional<Box> box_in_effect(const Scene& scene);

/// Whether a generator is `settled`.
bool needs_presimulation(const Scene& scene);

/// m, the greatest radius_max, within limits.h, with which the spheres of this generator fit in the box.
double greatest_radius_max(const BoxCollider& generator, const Box& box);

/// Appends the generator's spheres to position and radius, and to velocity where speed_max > 0 (bodies before
/// them that have none get 0). `where` names the generator in faults. Throws InputError where `apart` finds
/// no room, and Cancelled where `cancellation` (may be null) was requested.
void append_box_collider(const BoxCollider& generator, const Box& box, const std::string& where,
                         InitialBodies& bodies, Cancellation* cancellation = nullptr);

}  // namespace collidoscope
