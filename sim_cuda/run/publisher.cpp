#include "sim_cuda/run/publisher.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/run/simulation.h"

namespace collidoscope {

Publisher::Publisher(Simulation& run) : run_(run) {}
Publisher::~Publisher() = default;

PublishCounts Publisher::counts(int first_level, int last_level) {
  run_.detect();
  PublishCounts counts;
  counts.bodies = static_cast<std::int64_t>(run_.initial.size());
  if (first_level <= last_level) {
    const std::vector<std::int64_t> sizes = run_.tree.level_sizes();
    for (int level = std::max(0, first_level); level <= last_level && level < std::ssize(sizes); ++level)
      counts.boxes += sizes[static_cast<std::size_t>(level)];
  }
  counts.contacts = run_.pipeline().control().contacts;
  counts.joints = run_.pipeline().joints();
  return counts;
}

void Publisher::publish(const PublishTarget& target) {
  const bool boxes = target.boxes != nullptr;
  const PublishCounts counts = this->counts(target.first_level, boxes ? target.last_level : -1);
  if ((target.bodies != nullptr && target.body_capacity < counts.bodies) ||
      (target.boxes != nullptr && target.box_capacity < counts.boxes) ||
      (target.contacts != nullptr && target.contact_capacity < counts.contacts) ||
      (target.joints != nullptr && target.joint_capacity < counts.joints))
    throw std::logic_error("publish: the target is smaller than counts()");
  run_.keep_impulses();
  const bool by_visits = target.bodies != nullptr && target.body_color == BodyColor::visits;
  const bool by_tree = by_visits || (target.bodies != nullptr && (target.body_color == BodyColor::order ||
                                                                  target.body_color == BodyColor::depth));
  TreeValues values;
  if (boxes && target.box_metric != NodeMetric::level && run_.tree.quality().nodes > 0)
    values.of_node = run_.bvh_cache().statistics().values(target.box_metric);
  if (by_visits && run_.tree.quality().nodes > 0)
    values.of_body = run_.bvh_cache().statistics().body_visits();
  if (by_tree) run_.detect();
  const bool by_error = target.body_color == BodyColor::error && errors_.size() == run_.initial.size();
  if (by_error && !drawn_errors_)
    drawn_errors_ = std::make_unique<Buffer<float>>(run_.executor, "drawn body errors");
  if (by_error) drawn_errors_->upload(errors_);
  run_.pipeline().publish(target, boxes || by_tree ? run_.level_ordered_tree() : TreeView{}, values,
                          by_error ? drawn_errors_->data() : nullptr);
  run_.executor.synchronize();
}

void Publisher::copy(const FrameLayers& layers, PublishedRecords& to) {
  DrawnCounts drawn;
  drawn.records = counts(layers.first_level, layers.boxes ? layers.last_level : -1);
  if (!layers.spheres) drawn.records.bodies = 0;
  if (!layers.contacts) drawn.records.contacts = 0;
  if (!layers.joints) drawn.records.joints = 0;
  if (layers.boxes) {
    const std::vector<std::int64_t> sizes = run_.tree.level_sizes();
    for (int level = layers.first_level; level <= layers.last_level && level < std::ssize(sizes); ++level)
      drawn.level_sizes.push_back(sizes[static_cast<std::size_t>(level)]);
  }
  publish(to.prepare(std::move(drawn), layers, run_.executor.gpu()));
}

void Publisher::set_errors(std::vector<float> errors) { errors_ = std::move(errors); }

}  // namespace collidoscope
