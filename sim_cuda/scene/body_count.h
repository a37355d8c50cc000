#pragma once
// Numbers of bodies of a scene, without expanding it.

#include <cstdint>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Bodies that a source makes before some are excluded. The table of a body file must have been read.
inline std::int64_t rows_of(const BoxCollider& generator) { return generator.count; }
std::int64_t rows_of(const BodyFile& file);

/// Bodies that a source makes.
template <class Source>
std::int64_t kept_of(const Source& source) {
  return rows_of(source) - static_cast<std::int64_t>(source.excluded.size());
}

/// Number of bodies of a valid scene.
std::int64_t bodies_of(const Scene& scene);

}  // namespace collidoscope
