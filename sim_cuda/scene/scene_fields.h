#pragma once
// Field tables of the objects in a scene file. settings.h has the tables of the top level, of materials and
// of generators.
// Readers, writers, range checks and the generated reference iterate over the tables.

#include <tuple>

#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

namespace detail {
/// A position, or a distance from the origin, in metres.
template <auto member>
constexpr Field<member> place(std::string_view key, std::string_view help) {
  return {
      .key = key, .help = help, .unit = "m", .low = -limits::max_coordinate, .high = limits::max_coordinate};
}
template <auto member>
constexpr Field<member> number(std::string_view key, std::string_view help, std::string_view unit, double low,
                               double high) {
  return {.key = key, .help = help, .unit = unit, .low = low, .high = high};
}
}  // namespace detail

inline constexpr auto box_fields = std::tuple{
    detail::place<&Box::min>("min", "lower corner; the six inner faces are walls"),
    detail::place<&Box::max>("max", "upper corner, more than min on each axis"),
};

inline constexpr auto drag_fields = std::tuple{
    detail::number<&Drag::viscosity>("viscosity", "of the medium", "Pa s", 0, limits::max_viscosity),
    detail::number<&Drag::density>("density", "of the medium", "kg/m^3", 0, limits::max_medium_density),
    detail::number<&Drag::coefficient>("coefficient", "of a sphere in turbulent flow", "", 0,
                                       limits::max_drag_coefficient),
};

inline constexpr auto attractor_fields = std::tuple{
    detail::place<&Attractor::position>("position", "of the point"),
    detail::number<&Attractor::strength>("strength", "G M; negative: it repels", "m^3/s^2",
                                         -limits::max_strength, limits::max_strength),
    detail::number<&Attractor::softening>("softening", "within this distance the pull stops growing", "m",
                                          limits::min_softening, limits::max_softening),
};

inline constexpr auto sleep_fields = std::tuple{
    detail::number<&Sleep::speed>("speed", "of a centre, and of a surface that rotates; less is slow", "m/s",
                                  0, limits::max_speed),
    detail::number<&Sleep::time>("time", "an island falls asleep after it was slow for so long", "s", 0,
                                 limits::max_sleep_time),
};

inline constexpr auto guards_fields = std::tuple{
    Field<&ValidationSettings::on_failure>{
        .key = "on_failure",
        .help = "pause the run before the step, or repeat it with the body fixed",
        .choices = on_failure_names},
    detail::number<&ValidationSettings::speed>("speed", "maximum speed of a body", "m/s", 0,
                                               limits::max_guarded),
    detail::number<&ValidationSettings::distance>("distance", "maximum distance of a centre from the origin",
                                                  "m", 0, limits::max_guarded),
    detail::number<&ValidationSettings::angular_speed>("angular_speed", "maximum angular speed of a body",
                                                       "rad/s", 0, limits::max_guarded),
};

inline constexpr auto body_fields = std::tuple{
    Field<&Body::shape>{.key = "shape", .help = "sphere or mesh", .choices = shape_names},
    Field<&Body::motion>{.key = "motion",
                         .help = "dynamic: forces move it; kinematic: its own velocity does; static: nothing",
                         .choices = motion_names},
    detail::number<&Body::radius>("radius", "of a sphere", "m", limits::min_radius, limits::max_radius),
    Field<&Body::mesh>{.key = "mesh", .help = "of a mesh: path of an OBJ file, relative to the scene file"},
    detail::place<&Body::position>("position", "of the centre of mass"),
    Field<&Body::orientation>{.key = "orientation", .help = "quaternion w, x, y, z; is normalised"},
    detail::number<&Body::velocity>("velocity", "of the centre of mass", "m/s", -limits::max_speed,
                                    limits::max_speed),
    detail::number<&Body::angular_velocity>("angular_velocity", "about world axes", "rad/s",
                                            -limits::max_spin, limits::max_spin),
    detail::number<&Body::mass>("mass", "unset: density times volume", "kg", limits::min_mass,
                                limits::max_mass),
    detail::number<&Body::inertia>("inertia", "three principal moments; unset: those of the shape", "kg m^2",
                                   limits::min_inertia, limits::max_inertia),
};

inline constexpr auto plane_fields = std::tuple{
    Field<&Plane::normal>{.key = "normal", .help = "is normalised; bodies stay where normal . x >= offset"},
    detail::place<&Plane::offset>("offset", "distance from the origin along the normal"),
};

inline constexpr auto box_obstacle_fields = std::tuple{
    detail::place<&BoxObstacle::center>("center", "of the box"),
    detail::number<&BoxObstacle::size>("size", "whole edges", "m", limits::min_radius,
                                       limits::max_coordinate),
    Field<&BoxObstacle::orientation>{.key = "orientation", .help = "quaternion w, x, y, z; is normalised"},
};

inline constexpr auto joint_fields = std::tuple{
    Field<&Joint::kind>{
        .key = "kind", .help = "distance, spring, ball or hinge", .choices = joint_kind_names},
    Field<&Joint::a>{.key = "a", .help = "id of a body"},
    Field<&Joint::b>{.key = "b", .help = "id of another body, or \"world\""},
    detail::place<&Joint::anchor_a>("anchor_a", "from a's centre of mass, in a's own axes"),
    detail::place<&Joint::anchor_b>(
        "anchor_b",
        "of b, or of the world; unset: anchor_a's place at the start (ball, hinge), or b's centre"),
    detail::number<&Joint::length>("length", "distance (a rod), spring (at rest); unset: as at the start",
                                   "m", limits::min_radius, limits::max_coordinate),
    detail::number<&Joint::min_length>("min_length", "distance (a strut)", "m", 0, limits::max_coordinate),
    detail::number<&Joint::max_length>("max_length", "distance (a rope)", "m", limits::min_radius,
                                       limits::max_coordinate),
    detail::number<&Joint::frequency>("frequency", "spring, undamped", "Hz", limits::min_frequency,
                                      limits::max_frequency),
    detail::number<&Joint::damping_ratio>("damping_ratio", "spring; 1: critical damping", "", 0,
                                          limits::max_damping_ratio),
    Field<&Joint::axis>{.key = "axis", .help = "hinge: in a's own axes; is normalised"},
    Field<&Joint::limits>{.key = "limits",
                          .help = "hinge: two angles from the start, the smaller first; unset: free",
                          .unit = "degrees",
                          .low = -180,
                          .high = 180},
    Field<&Joint::collide>{.key = "collide", .help = "whether the two bodies have contacts"},
};

inline constexpr auto camera_fields = std::tuple{
    detail::place<&Camera::position>("position", "unset: frames the scene"),
    detail::place<&Camera::target>("target", "unset: frames the scene"),
    detail::number<&Camera::up>("up", "not along the line of sight", "", -limits::max_coordinate,
                                limits::max_coordinate),
    detail::number<&Camera::vertical_field_of_view>("vertical_field_of_view", "", "degrees", 1, 150),
};

}  // namespace collidoscope
