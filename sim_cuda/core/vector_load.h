#pragma once
// Vectorised loads and stores of records, in 16-byte words. Left to itself, a compiler loads each member
// where it is used, and a walk from record to record then waits several times at each; and it stores each by
// itself, which at random places costs the second-level cache as much as storing a record. A record is of
// plain numbers, Eigen's vectors among them.

#include <cstddef>
#include <cstring>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

#if defined(__CUDACC__)
namespace detail {
template <class T>
struct Words {
  static_assert(sizeof(T) % sizeof(uint4) == 0 && alignof(T) % alignof(uint4) == 0);
  static constexpr std::size_t count = sizeof(T) / sizeof(uint4);
  uint4 word[count];
};

template <class T, class LoadWord>
__device__ T load_words(const T* source, const LoadWord& load_word) {
  Words<T> words;
#pragma unroll
  for (std::size_t k = 0; k < Words<T>::count; ++k)
    words.word[k] = load_word(reinterpret_cast<const uint4*>(source) + k);
  T record;
  memcpy(static_cast<void*>(&record), &words, sizeof record);
  return record;
}
}  // namespace detail
#endif

/// A record that nobody writes while this stage runs.
template <class T>
SIM_HD T load_readonly(const T* source) {
#if defined(__CUDA_ARCH__)
  return detail::load_words(source, [](const uint4* word) { return __ldg(word); });
#else
  return *source;
#endif
}

/// A record that another thread wrote before an atomic_exchange() that this thread has seen: past the GPU's
/// first cache, which may hold what stood there before.
template <class T>
SIM_HD T load_l2(const T* source) {
#if defined(__CUDA_ARCH__)
  return detail::load_words(source, [](const uint4* word) { return __ldcg(word); });
#else
  return *source;
#endif
}

/// A record that this stage writes as well, but that no other thread writes since the last round or launch.
template <class T>
SIM_HD T load_cached(const T* source) {
#if defined(__CUDA_ARCH__)
  return detail::load_words(source, [](const uint4* word) { return *word; });
#else
  return *source;
#endif
}

template <class T>
SIM_HD void store_vectorized(T* target, const T& record) {
#if defined(__CUDA_ARCH__)
  detail::Words<T> words;
  memcpy(&words, static_cast<const void*>(&record), sizeof words);
#pragma unroll
  for (std::size_t k = 0; k < detail::Words<T>::count; ++k)
    reinterpret_cast<uint4*>(target)[k] = words.word[k];
#else
  *target = record;
#endif
}

/// Part of a record: four numbers of it that lie side by side, on a boundary of four.
template <class Real>
SIM_HD void store_vec4(void* target, Real x, Real y, Real z, Real w) {
  struct alignas(4 * sizeof(Real)) Four {
    Real x, y, z, w;
  } four{x, y, z, w};
#if defined(__CUDA_ARCH__)
  store_vectorized(static_cast<Four*>(target), four);
#else
  std::memcpy(target, &four, sizeof four);
#endif
}

}  // namespace collidoscope
