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
constexpr Field<member> place(std::string_view key, std::string_view help, std::string_view fallback = {}) {
  return {.key = key,
          .help = help,
          .unit = "m",
          .low = -limits::max_coordinate,
          .high = limits::max_coordinate,
          .fallback = fallback};
}
template <auto member>
constexpr Field<member> number(std::string_view key, std::string_view help, std::string_view unit, double low,
                               double high, std::string_view fallback = {}) {
  return {.key = key, .help = help, .unit = unit, .low = low, .high = high, .fallback = fallback};
}
/// A direction or an orientation; the reader normalises it.
template <auto member>
constexpr Field<member> direction(std::string_view key, std::string_view help) {
  return {.key = key, .help = help};
}
}  // namespace detail

inline constexpr auto box_fields = std::tuple{
    detail::place<&Box::min>("min", "lower corner; smaller than `max` on each axis"),
    detail::place<&Box::max>("max", "upper corner"),
};

inline constexpr auto drag_fields = std::tuple{
    detail::number<&Drag::viscosity>("viscosity", "dynamic viscosity of the medium", "Pa s", 0,
                                     limits::max_viscosity),
    detail::number<&Drag::density>("density", "density of the medium", "kg/m^3", 0,
                                   limits::max_medium_density),
    detail::number<&Drag::coefficient>("coefficient", "drag coefficient of a sphere in turbulent flow", "", 0,
                                       limits::max_drag_coefficient),
};

inline constexpr auto attractor_fields = std::tuple{
    detail::place<&Attractor::position>("position", "position of the attractor"),
    detail::number<&Attractor::strength>("strength", "G·M; negative values repel", "m^3/s^2",
                                         -limits::max_strength, limits::max_strength),
    detail::number<&Attractor::softening>(
        "softening",
        "Plummer softening; the largest acceleration, 0.385·strength/softening², must not exceed 10⁶ m/s²",
        "m", limits::min_softening, limits::max_softening),
};

inline constexpr auto sleep_fields = std::tuple{
    detail::number<&Sleep::speed>(
        "speed", "a slower body is at rest; applies to the speed of the centre and of the rotating surface",
        "m/s", 0, limits::max_speed),
    detail::number<&Sleep::time>("time", "an island sleeps after all its bodies were at rest for this time",
                                 "s", 0, limits::max_sleep_time),
};

inline constexpr auto guards_fields = std::tuple{
    Field<&ValidationSettings::on_failure>{
        .key = "on_failure", .help = "action on failure", .choices = on_failure_names},
    detail::number<&ValidationSettings::speed>("speed", "largest valid speed", "m/s", 0, limits::max_guarded),
    detail::number<&ValidationSettings::distance>(
        "distance", "largest valid distance of a centre from the origin, and of a bounding box along an axis",
        "m", 0, limits::max_guarded),
    detail::number<&ValidationSettings::angular_speed>("angular_speed", "largest valid angular speed",
                                                       "rad/s", 0, limits::max_guarded),
};

inline constexpr auto body_fields = std::tuple{
    Field<&Body::shape>{.key = "shape", .help = "", .choices = shape_names},
    Field<&Body::motion>{.key = "motion", .help = "", .choices = motion_names},
    detail::number<&Body::radius>("radius", "spheres only; must fit in the box", "m", limits::min_radius,
                                  limits::max_radius),
    Field<&Body::mesh>{
        .key = "mesh",
        .help = "meshes only: path of an OBJ, STL or PLY file from the scene file's folder; closed, faces "
                "counter-clockwise from outside",
        .fallback = "required for a mesh"},
    detail::place<&Body::position>("position", "position of the centre of mass"),
    detail::direction<&Body::orientation>("orientation", "quaternion [w, x, y, z], normalised on reading"),
    detail::number<&Body::velocity>("velocity", "velocity of the centre of mass", "m/s", -limits::max_speed,
                                    limits::max_speed),
    detail::number<&Body::angular_velocity>("angular_velocity", "angular velocity in world axes", "rad/s",
                                            -limits::max_spin, limits::max_spin),
    detail::number<&Body::mass>("mass", "", "kg", limits::min_mass, limits::max_mass, "density × volume"),
    detail::number<&Body::inertia>("inertia",
                                   "three principal moments, none larger than the sum of the others; for a "
                                   "mesh about its principal axes, smallest first",
                                   "kg m^2", limits::min_inertia, limits::max_inertia,
                                   "⅖·m·r², or the moments of the mesh"),
};

inline constexpr auto body_file_fields = std::tuple{
    Field<&BodyFile::path>{
        .key = "path",
        .help = "path of a NPY, NPZ, CSV, XYZ, LAMMPS or PLY file from the scene file's folder, and in it",
        .fallback = "required"},
    Field<&BodyFile::columns>{
        .key = "columns",
        .help = "columns of quantities, by name or number from 1, or none: "
                "`x=px,radius=4,vx=none`; quantities: id, x, y, z, "
                "radius, diameter, mass, vx, vy, vz, wx, wy, wz, qw, qx, qy, qz; or of boxes: "
                "min_x, min_y, min_z, max_x, max_y, max_z",
        .fallback = "by their names in the file"},
    detail::number<&BodyFile::scale>("scale", "length of the file's unit", "m", 1e-15, 1e15),
    detail::number<&BodyFile::radius>("radius", "radius of all its bodies; only if the file has no radii",
                                      "m", limits::min_radius, limits::max_radius, "radii of the file"),
    detail::number<&BodyFile::frame>("frame", "frame of a file with several, from 0", "", 0, 1e9),
    Field<&BodyFile::boxes>{
        .key = "boxes",
        .help =
            "boxes to inspect without dynamics: a NPY array of shape (n, 6) or (n, 2, 3), the triangles of "
            "an OBJ, STL or PLY mesh, or a table with columns of boxes. Such a scene has no other bodies"},
    Field<&BodyFile::tree>{.key = "tree",
                           .help = "boxes only: path of a tree over them, a NPY array of shape (m, 8), as "
                                   "`bvh --tree`",
                           .fallback = "none"},
};

inline constexpr auto plane_fields = std::tuple{
    detail::direction<&Plane::normal>("normal", "planes only: normal, normalised on reading"),
    detail::place<&Plane::offset>("offset", "planes only: distance from the origin along the normal"),
};

inline constexpr auto box_obstacle_fields = std::tuple{
    detail::place<&BoxObstacle::center>("center", "boxes only: centre"),
    detail::number<&BoxObstacle::size>("size", "boxes only: edge lengths", "m", limits::min_radius,
                                       limits::max_coordinate),
    detail::direction<&BoxObstacle::orientation>(
        "orientation", "boxes only: quaternion [w, x, y, z], normalised on reading"),
};

inline constexpr auto joint_fields = std::tuple{
    Field<&Joint::kind>{.key = "kind", .help = "", .choices = joint_kind_names, .fallback = "required"},
    Field<&Joint::a>{.key = "a", .help = "id of a body; generated bodies included", .fallback = "required"},
    Field<&Joint::b>{.key = "b", .help = "id of another body, or `\"world\"`", .fallback = "required"},
    detail::place<&Joint::anchor_a>(
        "anchor_a",
        "offset from the centre of mass of a, in the body axes of a (of a mesh: the axes of its file)"),
    detail::place<&Joint::anchor_b>(
        "anchor_b", "the same for b; a world position if b is the world",
        "distance, spring: centre of b, required for the world; ball, hinge: initial position of `anchor_a`"),
    detail::number<&Joint::length>("length", "distance: fixed length (a rod); spring: rest length", "m",
                                   limits::min_radius, limits::max_coordinate, "initial distance"),
    detail::number<&Joint::min_length>("min_length",
                                       "distance, instead of `length`: smallest length (a strut)", "m", 0,
                                       limits::max_coordinate, "no limit"),
    detail::number<&Joint::max_length>("max_length", "distance, instead of `length`: largest length (a rope)",
                                       "m", limits::min_radius, limits::max_coordinate, "no limit"),
    detail::number<&Joint::frequency>(
        "frequency", "spring: undamped frequency with the effective mass of its two anchors at the start",
        "Hz", limits::min_frequency, limits::max_frequency),
    detail::number<&Joint::damping_ratio>("damping_ratio", "spring: damping ratio; 1 is critical damping", "",
                                          0, limits::max_damping_ratio),
    detail::direction<&Joint::axis>("axis", "hinge: axis in the body axes of a, normalised on reading"),
    Field<&Joint::limits>{.key = "limits",
                          .help = "hinge: [min, max] angle of b relative to a, from the initial pose, "
                                  "counter-clockwise seen from the tip of the axis",
                          .unit = "degrees",
                          .low = -180,
                          .high = 180,
                          .fallback = "no limits"},
    Field<&Joint::collide>{.key = "collide", .help = "whether a and b collide with each other"},
};

inline constexpr auto camera_fields = std::tuple{
    detail::place<&Camera::position>("position", "", "frames the scene"),
    detail::place<&Camera::target>("target", "point that the camera looks at", "frames the scene"),
    detail::number<&Camera::up>("up", "up direction, not 0 and not along the line of sight", "",
                                -limits::max_coordinate, limits::max_coordinate),
    detail::number<&Camera::vertical_field_of_view>("vertical_field_of_view", "", "degrees", 1, 150),
};

}  // namespace collidoscope
