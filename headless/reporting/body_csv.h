#pragma once
// Tables of all bodies as CSV: a header line, then one row a body in order of ids. Numbers are the shortest
// decimals that read back to exactly the state. Nothing is kept.

#include <functional>
#include <string_view>

namespace collidoscope {

class World;

/// Takes a piece of text of some tens of kilobytes: a million bodies need not be in memory as text at once.
using TextSink = std::function<void(std::string_view)>;

/// id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz
void write_body_states(World& world, const TextSink& sink);

/// The dynamics attribute of Baraff's notes, which the paper stores: mass, X, R (row by row), P, L, the
/// inverse of the inertia tensor in world axes (row by row), F, T. F is the weight, where gravity is an
/// effect of the run; nothing applies a torque yet, so T is 0.
void write_body_dynamics(World& world, const TextSink& sink);

}  // namespace collidoscope
