#pragma once
// The Box Collider, the paper's benchmark: spheres of random radii dropped into a closed box.
// Random numbers come from Philox4x32-10. Key: the generator's seed. Counter: (id, stream, 0, 0), where ids
// count from 0 within the generator. A uniform number is u = (word >> 8) / 2^24 in [0, 1).
// Body i is therefore the same for every N, except in variants whose box grows with N.
//
//   stream 0: word 0 -> radius = radius_max (1 - u), or radius_max (1 + 15 (1 - u)^3) / 16; words 1, 2, 3 ->
//   position, one u per axis stream 1: words 0, 1, 2 -> velocity component = speed_max (2 u - 1) stream 2, 3,
//   ...: words 0, 1, 2 -> further candidate positions; only `apart` uses them
//
// `apart` places the largest sphere first. Only there does a start position depend on the other bodies.
// Values are computed in float and widened, so float and double runs start from the same state.

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Fraction of the box volume filled with spheres in `scaled` and `equal`. Less while the side is at its
/// minimum of 100 m.
inline constexpr double scaled_fill = 0.3;

/// Cube root by Newton's method, y <- (2 y + x / y^2) / 3. x >= 0.
/// Makes eight steps from the smallest power of two not below the root. The initial relative error is below
/// 1, and each step squares it.
double newton_cube_root(double x);

/// Side in metres of the cube of the variants `scaled` and `equal` for `count` spheres.
/// Equals max(100, cuberoot(count m / 0.3)), rounded to float. m = pi/3 radius_max^3 is the mean volume of a
/// sphere with a radius uniform in (0, radius_max] (130.9 m^3 for 5 m).
/// With `mostly_small` radii, m is 0.436 times that.
double scaled_side(std::int64_t count, double radius_max, Radii radii = Radii::uniform);

/// Radius of all spheres in `equal`: its volume is the mean volume m above. radius_max cuberoot(1/4) for
/// `uniform`.
float equal_radius(double radius_max, Radii radii = Radii::uniform);

/// Upper bound in metres of the radii of this generator.
double largest_radius(const BoxCollider& generator);

/// The container of the scene's bodies. If a generator is `scaled` or `equal`, it is the cube of
/// scaled_side() at the min corner of the scene's box. Otherwise it is the scene's own box.
std::optional<Box> box_in_effect(const Scene& scene);

/// True if a generator has the variant `settled`.
bool needs_presimulation(const Scene& scene);

/// Largest radius_max in metres, within limits.h, for which the generator's spheres fit in the box.
double greatest_radius_max(const BoxCollider& generator, const Box& box);

/// Appends the generator's spheres to position and radius, and to velocity if speed_max > 0. Earlier bodies
/// without a velocity get 0.
/// `where` names the generator in error messages. `cancellation` may be null. Throws InputError if `apart`
/// finds no room, and Cancelled after a cancellation request.
void append_box_collider(const BoxCollider& generator, const Box& box, const std::string& where,
                         InitialBodies& bodies, Cancellation* cancellation = nullptr);

}  // namespace collidoscope
