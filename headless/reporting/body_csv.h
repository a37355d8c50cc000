#pragma once
// CSV tables of all bodies: a header line, then one row per body in the order of ids. Numbers are the
// shortest decimals that read back to the same bits. Stateless.

#include <functional>
#include <string_view>

namespace collidoscope {

class World;

/// Receives blocks of text of some tens of kilobytes. Avoids storing the text of a million bodies.
using TextSink = std::function<void(std::string_view)>;

/// Columns: id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz.
void write_body_states(World& world, const TextSink& sink);

/// The dynamics attribute of Baraff's notes, which the paper stores. Columns: mass, X, R (row by row), P, L,
/// inverse inertia tensor in world axes (row by row), F, T.
/// F is the weight if the run has gravity. T is 0, because no torque is applied yet.
void write_body_dynamics(World& world, const TextSink& sink);

}  // namespace collidoscope
