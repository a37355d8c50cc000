#include "sim_cuda/scene/body_count.h"

#include "sim_cuda/import/body_table.h"

namespace collidoscope {

std::int64_t rows_of(const BodyFile& file) {
  return file.table ? static_cast<std::int64_t>(file.table->size()) : 0;
}

std::int64_t bodies_of(const Scene& scene) {
  std::int64_t count = std::ssize(scene.bodies) + std::ssize(scene.extra_bodies);
  for (const BoxCollider& generator : scene.generators) count += kept_of(generator);
  for (const BodyFile& file : scene.body_files) count += kept_of(file);
  return count;
}

}  // namespace collidoscope
