#pragma once
// Draw records in the layout that the renderer uses. Publisher::publish() writes them into memory of the
// renderer (mapped GL buffers or plain memory), on the device if there is one. The simulator does not
// depend on GL. Plain data, shared with shaders; the sizes are part of the interface.

#include <cstddef>
#include <cstdint>

#include "sim_cuda/broad_phase/tree_quality.h"

namespace collidoscope {

/// Quantity in BodyInstance::value; the renderer maps it to a colour.
enum class BodyColor : std::uint32_t { speed, radius, id, contacts, order, depth, visits, sleep, error };

struct BodyInstance {    // 48 bytes
  float center[3];       ///< m
  float radius;          ///< m; bounding radius of a mesh
  float orientation[4];  ///< unit quaternion x y z w
  float value;           ///< by BodyColor: m/s, m, id, contacts, index in leaf order, leaf level, visits,
                         ///< SleepView::distance() (sim_cuda/solver/sleeping.h), m by Publisher::set_errors()
  std::uint32_t id;
  std::uint32_t mesh;  ///< 0: sphere; k: mesh k - 1
  std::uint32_t padding;
};

struct BoxInstance {  // 32 bytes
  float min[3];       ///< m
  float level;        ///< level from the root, which is 0
  float max[3];
  float value;  ///< metric of the node; -1 if undefined
};

/// Role of a highlighted box, stored as its value.
enum class BoxMark : std::uint32_t {
  path,  ///< contains the selected body; coloured by level
  node,  ///< selected
  left,
  right,  ///< left and right: children of the selected node
  met,
  apart,   ///< met and apart: visited by a query, with and without overlap
  current  ///< the visited box in focus
};
constexpr std::size_t box_marks = 7;

struct ContactInstance {  // 48 bytes
  float point[3];         ///< midpoint between the two surfaces, m
  float penetration;      ///< > 0 if the bodies overlap, m
  float normal[3];        ///< unit, from body a to body b
  float impulse;          ///< normal impulse of the last step, N s; 0 if not recorded
  std::uint32_t a, b;     ///< ids, a < b
  float radius;           ///< radius of the smaller sphere, m; scales the mark
  float padding;
};

/// Shape of a drawn joint.
enum class JointLook : std::uint32_t {
  line,    ///< straight, between the anchors
  rope,    ///< between the anchors, with sag
  spring,  ///< between the anchors, in zigzag
  corner   ///< from centre to centre via the common anchor
};

struct JointInstance {  // 64 bytes
  float from[3];        ///< m
  float look;           ///< JointLook
  float to[3];
  float size;   ///< radius of the smaller body, m; scales the marks
  float at[3];  ///< corner: common anchor, m
  float padding;
  float aside[3];  ///< rope: sag at the middle, m; hinge: half axis from `at`, m
  float padding2;
};

/// Position of a body in a reference run, set by the caller; a World does not compute it.
struct GhostInstance {  // 32 bytes
  float body[3];        ///< centre of the body, m
  float radius;         ///< m
  float offset[3];  ///< from the body to its reference position, m; stored separately to keep small values
                    ///< exact
  float opacity;    ///< 0 to 1; 0 if the reference has no value
};

static_assert(sizeof(JointInstance) == 64 && sizeof(GhostInstance) == 32);
static_assert(sizeof(BodyInstance) == 48 && sizeof(BoxInstance) == 32 && sizeof(ContactInstance) == 48);

/// Output buffers of publish(), in the executor's memory space (device pointers for a world on a GPU). A
/// null pointer skips that layer. Capacities are in records and must be at least PublishCounts.
struct PublishTarget {
  BodyInstance* bodies = nullptr;
  std::int64_t body_capacity = 0;
  BodyColor body_color = BodyColor::speed;
  BoxInstance* boxes = nullptr;
  std::int64_t box_capacity = 0;
  int first_level = 0, last_level = 0;  ///< inclusive, level from the root; clipped to existing levels
  NodeMetric box_metric = NodeMetric::level;
  ContactInstance* contacts = nullptr;
  std::int64_t contact_capacity = 0;
  JointInstance* joints = nullptr;
  std::int64_t joint_capacity = 0;
};

/// Number of records of each kind at the current state.
struct PublishCounts {
  std::int64_t bodies = 0, boxes = 0, contacts = 0, joints = 0;
};

}  // namespace collidoscope
