#pragma once
// What a picture needs, packed as the GPU draws it. Publisher::publish() writes these records, on the device
// where there is one, straight into memory that the renderer owns (mapped GL buffers or plain memory): the
// simulator has never heard of GL. Plain data, shared with shaders: sizes are part of the contract.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/broad_phase/tree_quality.h"

namespace collidoscope {

/// What BodyInstance::value holds; the renderer maps it to colour.
enum class BodyColor : std::uint32_t { speed, radius, id, contacts, order, depth, visits, sleep, error };

struct BodyInstance {    // 48 bytes
  float center[3];       ///< m
  float radius;          ///< m; of a mesh: bounding radius
  float orientation[4];  ///< unit quaternion x y z w
  float value;  ///< raw, by BodyColor: m/s, m, id, contacts, place in the tree, level of the leaf, visits,
                ///< how far from sleep (sim_cuda/solver/sleeping.h), m of Publisher::set_errors()
  std::uint32_t id;
  std::uint32_t mesh;  ///< 0: sphere; k: mesh k - 1
  std::uint32_t padding;
};

struct BoxInstance {  // 32 bytes
  float min[3];       ///< m
  float level;        ///< depth from the root, which is 0
  float max[3];
  float value;  ///< of the metric asked for; -1 where the node has none
};

/// What a box that is drawn on top of the picture is: its value.
enum class BoxMark : std::uint32_t {
  path,  ///< holds the selected body; coloured by its level
  node,  ///< selected
  left,
  right,  ///< its children, in turn
  met,
  apart,   ///< visited by a query, which overlaps it, or not
  current  ///< the one of these that is looked at
};
constexpr std::size_t box_marks = 7;

struct ContactInstance {  // 48 bytes
  float point[3];         ///< m, midway between the two surfaces
  float penetration;      ///< m, > 0 where they overlap
  float normal[3];        ///< unit, from body a to body b
  float impulse;          ///< N s, normal impulse of the last step; 0 where it is not recorded
  std::uint32_t a, b;     ///< ids, a < b
  float radius;           ///< m, of the smaller sphere: sizes the mark
  float padding;
};

/// How a joint is drawn.
enum class JointLook : std::uint32_t {
  line,    ///< from anchor to anchor
  rope,    ///< the same, sagging
  spring,  ///< the same, in zigzag
  corner   ///< from centre to centre by way of what they share
};

struct JointInstance {  // 64 bytes
  float from[3];        ///< m
  float look;           ///< a JointLook
  float to[3];
  float size;   ///< m, radius of the smaller body: sizes the marks
  float at[3];  ///< of a corner
  float padding;
  float aside[3];  ///< m: how far a rope sags in the middle; half of a hinge's axis, from `at`
  float padding2;
};

/// Where a body should be, as a reference has it; not of a World's own knowledge, but of whoever asks one.
struct GhostInstance {  // 32 bytes
  float body[3];        ///< m, the centre of the body
  float radius;         ///< m
  float offset[3];  ///< m, from there to where it should be: apart, so that what is small keeps its digits
  float opacity;    ///< 0 to 1: 0 where the reference does not know
};

static_assert(sizeof(JointInstance) == 64 && sizeof(GhostInstance) == 32);
static_assert(sizeof(BodyInstance) == 48 && sizeof(BoxInstance) == 32 && sizeof(ContactInstance) == 48);

/// Where publish() writes. All pointers are in the executor's own memory space (device pointers where the
/// world is on a GPU). A null pointer skips that layer; capacities are in records and must hold what
/// PublishCounts announces.
struct PublishTarget {
  BodyInstance* bodies = nullptr;
  std::int64_t body_capacity = 0;
  BodyColor body_color = BodyColor::speed;
  BoxInstance* boxes = nullptr;
  std::int64_t box_capacity = 0;
  int first_level = 0, last_level = 0;  ///< inclusive, depth from the root; clipped to the levels there are
  NodeMetric box_metric = NodeMetric::level;
  ContactInstance* contacts = nullptr;
  std::int64_t contact_capacity = 0;
  JointInstance* joints = nullptr;
  std::int64_t joint_capacity = 0;
};

/// How many records of each kind the current state has.
struct PublishCounts {
  std::int64_t bodies = 0, boxes = 0, contacts = 0, joints = 0;
};

}  // namespace collidoscope
