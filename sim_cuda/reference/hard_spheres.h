#pragma once
// HardSpheres: the exact motion of frictionless hard spheres, the answer that a time-stepped gas is measured
// against. From event to event, without time steps (Alder, Wainwright 1959): between collisions every sphere
// flies its parabola; a collision is instantaneous and changes two velocities, or one at a plane. In double
// on one thread of the host; SI units; made from a Scene, owns all it uses.
//
// What is exact, and how far. A sphere keeps its state at its last collision, so that neither looking nor
// the grid that finds neighbours rounds anything; collisions are found by contact_time.h. What is left is
// rounding: positions carry about 1e-16 of a coordinate, and of speed times the time since the start, and so
// much may spheres overlap. Energy is kept to 1e-12 over 1e5 collisions. Each collision multiplies an error
// by about the free path over the radius, here as in nature: after some 20 collisions of each sphere no two
// programs agree on positions. Events at one time come in the order of ids, a sphere's pairs before its
// planes.
//
// Restitution is that of solver/restitution.h; the threshold is the scene's, and 0 where that is "auto",
// which comes to 0 as a time step does. With restitution below 1 infinitely many collisions can happen in
// finite time: a Zeno point, behind which no event-driven answer goes. Time stops there, and says so, where
// (1) a sphere lies on a plane: its flight to the next bounce is too short to move the clock. Flights from a
// plane to itself are known without the rounding of clock and coordinates, so this is met to 1e-13. Or
// (2) a sphere has had 32 collisions in a row, none elastic, that rounding cannot tell apart: within 2^12
// roundings of the clock, or of its coordinates at the speed of approach (about 1e-12 of either).
//
// Knows spheres (up to about 10,000 for comfort: some 1e5 collisions a second), planes and the box, uniform
// gravity, materials. Throws InputError, a line for each, at anything else that the scene calls for, and
// where spheres overlap or lie beyond a plane at the start (`spawn: apart`).

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

/// A sphere from its last collision on; 64 bytes.
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

/// The time at which the spheres collide if nothing comes between; `never` if they do not.
double collision_time(const Flight& a, const Flight& b, const Vector3d& gravity);

/// What happened: two spheres, or one and a plane.
struct CollisionEvent {
  double time;          ///< s
  std::uint32_t body;   ///< of two the smaller id
  std::uint32_t other;  ///< `no_body`: a plane
  std::uint32_t plane;  ///< which: the scene's planes in order, then x-, x+, y-, y+, z-, z+ of the box
  Vector3d normal;      ///< unit, to `body` from what it hit
  double impulse;       ///< N s along it; 0 where rounding has them part
};

class HardSpheres {
 public:
  explicit HardSpheres(const Scene& scene);

  /// Goes on to `time` >= time(), finite, in s. Returns false where a Zeno point comes before: time() is
  /// there then.
  bool advance_to(double time);
  /// To the next collision, and no further than `until`, where there is none before.
  std::optional<CollisionEvent> next_collision(double until);

  double time() const { return time_; }
  /// The collision at which time has stopped, if it has.
  const std::optional<CollisionEvent>& zeno_point() const { return zeno_; }
  /// "Zeno point at 4.0386 s: body 0 comes to rest on the wall z = 0"; empty without one.
  std::string zeno_line() const;

  const InitialBodies& initial() const { return initial_; }
  BodyStates bodies() const;  ///< now, by id; nothing turns
  /// Now: energies, momenta, what the walls gave, overlap; the rest, which only steps have, is 0.
  StepStats measure() const;
  const std::vector<StaticImpulse>& static_impulses() const { return static_impulses_; }  ///< by body

  struct Counts {
    std::int64_t pairs = 0, planes = 0;  ///< collisions
    std::int64_t crossings = 0;          ///< of cells, which nobody notices
    std::int64_t stale = 0;              ///< events that others had overtaken
  };
  const Counts& counts() const { return counts_; }
  double dissipated() const { return dissipated_; }  ///< J, lost in collisions since the start

 private:
  static constexpr std::uint32_t no_plane = 0xffffffffu;
  struct CollisionHistory {
    std::uint32_t collisions = 0;             // so far; what was foreseen before the last is past
    std::uint32_t coincident_collisions = 0;  // in a row, none elastic, that rounding cannot tell apart
    std::uint32_t touching = no_plane;        // where the flight starts: on this plane, ...
    double rebound = 0;  // m/s, ... leaving it at this speed, whatever rounding made of both
  };

  std::uint32_t count() const { return static_cast<std::uint32_t>(flights_.size()); }
  std::uint32_t first_edge() const { return count() + static_cast<std::uint32_t>(planes_.size()); }
  bool is_stale(const Event& event) const;
  void refuse_overlaps(const std::string& name) const;
  double gap(const Vector3d& x, std::uint32_t body, const WallPlane<double>& plane) const {
    return plane.normal.dot(x) - plane.offset - flights_[body].radius;
  }
  /// Where a body's flight starts, seen from a plane.
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
  std::size_t queue_limit_ = 0;  // events; beyond it, what is past is dropped
  double time_ = 0;
  std::optional<CollisionEvent> zeno_;
  Counts counts_;
  double dissipated_ = 0;
};

}  // namespace collidoscope
