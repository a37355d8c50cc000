#pragma once
// Vectorised loads and stores of records, in 16-byte words. Without them, the compiler loads each member at
// its first use, and each record of a traversal causes several stalls. Stores of single members at random
// addresses cost as much L2 bandwidth as a store of the record. Records consist of plain numbers and Eigen
// vectors.

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

/// The result of a load. On the CPU a reference: a copy of a record is slow, because it goes through the
/// stack. So keep the result as `const auto&`, or as a copy if the record changes.
#if defined(__CUDA_ARCH__)
template <class T>
using Loaded = T;
#else
template <class T>
using Loaded = const T&;
#endif

/// Loads a record that is constant during this stage (read-only cache, __ldg).
template <class T>
SIM_HD Loaded<T> load_readonly(const T* source) {
#if defined(__CUDA_ARCH__)
  return detail::load_words(source, [](const uint4* word) { return __ldg(word); });
#else
  return *source;
#endif
}

/// Loads a record that another thread published with atomic_exchange(). Bypasses L1 (ld.cg), which may hold a
/// stale copy.
template <class T>
SIM_HD T load_l2(const T* source) {
#if defined(__CUDA_ARCH__)
  return detail::load_words(source, [](const uint4* word) { return __ldcg(word); });
#else
  return *source;
#endif
}

/// Loads a record that this stage also writes. Precondition: no other thread has written it since the last
/// barrier or launch.
template <class T>
SIM_HD Loaded<T> load_cached(const T* source) {
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

/// Stores four adjacent numbers of a record. Precondition: `target` is aligned to four numbers.
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
