#pragma once
// HardSpheres: exact motion of frictionless hard spheres; the reference solution for time-stepped gases.
// Event-driven molecular dynamics without time steps (Alder, Wainwright 1959). Between collisions each sphere
// moves on a parabola. A collision is instantaneous and changes two velocities, or one at a plane.
// Double precision, one host thread, SI units. Constructed from a Scene; owns all its data.
//
// Accuracy. A sphere stores its state at its last collision, so reading states and the neighbour grid add no
// rounding. contact_time.h finds the collisions.
// Rounding is the only error: about 1e-16 of a coordinate, and of speed times the time since the start.
// Spheres may overlap by that amount. Energy is kept to 1e-12 over 1e5 collisions.
// The system is chaotic: each collision multiplies an error by about the free path over the radius. After
// some 20 collisions per sphere, no two programs agree on positions.
// Simultaneous events are processed in the order of ids, a sphere's pairs before its planes.
//
// Restitution is that of solver/restitution.h. The threshold is the scene's, and 0 for "auto", which tends to
// 0 with the time step. With restitution below 1, infinitely many collisions can happen in finite time. This
// is a Zeno point (inelastic collapse); no event-driven solution exists after it. Time stops there and the
// point is reported, in two cases:
// (1) A sphere rests on a plane: its flight to the next bounce is too short to advance the clock. Flights
// from a plane to itself avoid the rounding of clock and coordinates, so the time is accurate to 1e-13.
// (2) A sphere has had 32 consecutive inelastic collisions that rounding cannot distinguish. They lie within
// 2^12 roundings of the clock, or of the coordinates at the approach speed (about 1e-12 of either).
//
// Supports spheres (up to about 10,000, at some 1e5 collisions a second), planes, the box, uniform gravity
// and materials. Throws InputError with one line per unsupported feature, and if spheres initially overlap
// each other or a plane (use `spawn: apart`).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/reference/event_queue.h"
#include "sim_cuda/reference/neighbour_grid.h"
#include "sim_cuda/run/body_states.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

/// Free flight of a sphere since its last collision; 64 bytes.
struct Flight {
  Vector3d x, v;  ///< m, m/s, at `start`
  double start;   ///< s
  double radius;  ///< m

  Vector3d position(double time, const Vector3d& gravity) const {
    const double t = time - start;
    return x + t * (v + (t / 2) * gravity);
  }
  Vector3d velocity(double time, const Vector3d& gravity) const { return v + (time - start) * gravity; }
};

/// Collision time of two spheres without other events. `never` if they do not collide.
double collision_time(const Flight& a, const Flight& b, const Vector3d& gravity);

/// A collision of two spheres, or of a sphere and a plane.
struct CollisionEvent {
  double time;          ///< s
  std::uint32_t body;   ///< the smaller id of a pair
  std::uint32_t other;  ///< `no_body` for a plane
  std::uint32_t plane;  ///< index: the scene's planes in order, then x-, x+, y-, y+, z-, z+ of the box
  Vector3d normal;      ///< unit, towards `body`
  double impulse;       ///< N s along the normal; 0 if rounding makes the objects separate
};

class HardSpheres {
 public:
  explicit HardSpheres(const Scene& scene);

  /// Advances to `time` in s; finite and >= time(). Returns false if a Zeno point comes first; time() is then
  /// that point.
  bool advance_to(double time);
  /// Advances to the next collision and returns it. Advances to `until` and returns nothing if there is no
  /// earlier one.
  std::optional<CollisionEvent> next_collision(double until);

  double time() const { return time_; }
  /// The collision of the Zeno point, if one was reached.
  const std::optional<CollisionEvent>& zeno_point() const { return zeno_; }
  /// "Zeno point at 4.0386 s: body 0 comes to rest on the wall z = 0"; empty without a Zeno point.
  std::string zeno_line() const;

  const InitialBodies& initial() const { return initial_; }
  BodyStates bodies() const;  ///< current states by id; rotation is zero
  /// Current energies, momenta, wall impulses and overlap. Statistics specific to time steps are 0.
  StepStats measure() const;
  const std::vector<StaticImpulse>& static_impulses() const { return static_impulses_; }  ///< by body

  struct Counts {
    std::int64_t pairs = 0, planes = 0;  ///< collisions
    std::int64_t crossings = 0;          ///< cell crossings, without effect on the motion
    std::int64_t stale = 0;              ///< discarded events, invalidated by earlier collisions
  };
  const Counts& counts() const { return counts_; }
  double dissipated() const { return dissipated_; }  ///< J, energy lost in collisions since the start

 private:
  static constexpr std::uint32_t no_plane = 0xffffffffu;
  struct CollisionHistory {
    std::uint32_t collisions = 0;             // total; events predicted before the last one are stale
    std::uint32_t coincident_collisions = 0;  // consecutive inelastic collisions that rounding cannot
                                              // distinguish
    std::uint32_t touching = no_plane;        // plane on which the flight starts
    double rebound = 0;  // m/s, exact speed at which it leaves that plane, without rounding
  };

  std::uint32_t count() const { return static_cast<std::uint32_t>(flights_.size()); }
  std::uint32_t first_edge() const { return count() + static_cast<std::uint32_t>(planes_.size()); }
  bool is_stale(const Event& event) const;
  void refuse_overlaps(const std::string& name) const;
  double gap(const Vector3d& x, std::uint32_t body, const WallPlane<double>& plane) const {
    return plane.normal.dot(x) - plane.offset - flights_[body].radius;
  }
  /// Start of a body's flight relative to a plane.
  struct Start {
    double gap, speed;  // m, m/s
  };
  Start start_above(std::uint32_t plane, std::uint32_t body) const;
  Restitution<double> restitution() const {
    return {restitutions_.data(), initial_.material.empty() ? nullptr : initial_.material.data(), threshold_};
  }

  void predict_pair(std::uint32_t a, std::uint32_t b);
  void predict_plane(std::uint32_t body);
  void predict_crossing(std::uint32_t body);
  void predict(std::uint32_t body);
  void restart(std::uint32_t body);
  bool detect_inelastic_collapse(std::uint32_t body, double since, double approach);
  CollisionEvent collide(std::uint32_t a, std::uint32_t b);
  CollisionEvent bounce(std::uint32_t body, std::uint32_t plane);

  InitialBodies initial_;
  Vector3d gravity_;  // m/s^2
  std::vector<WallPlane<double>> planes_;
  std::vector<double> restitutions_;  // by material
  double threshold_;                  // m/s
  std::vector<Flight> flights_;
  std::vector<CollisionHistory> histories_;
  std::vector<StaticImpulse> static_impulses_;
  std::optional<NeighbourGrid> grid_;
  EventQueue queue_;
  std::size_t queue_limit_ = 0;  // events; stale ones are removed when the queue exceeds it
  double time_ = 0;
  std::optional<CollisionEvent> zeno_;
  Counts counts_;
  double dissipated_ = 0;
};

}  // namespace collidoscope
