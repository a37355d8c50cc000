#pragma once
// A vector for random memory access: padded to four numbers, so that a GPU loads or stores it in one access
// (core/vector_load.h). Convert it to Vector3 for computations.
//
// In float, the padding can hold a tag, which synchronises threads of one launch. Vector and tag are accessed
// together, in one access of 128 bits. A thread that reads a tag therefore reads the vector that was stored
// with it.

#include <cstdint>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

template <class Real>
class alignas(4 * sizeof(Real)) PackedVector3 {
 public:
  PackedVector3() = default;
  SIM_HD PackedVector3(const Vector3<Real>& vector) : vector_(vector), padding_(0) {}
  SIM_HD Vector3<Real> load() const { return load_cached(this).vector_; }
  SIM_HD operator Vector3<Real>() const { return load(); }
  SIM_HD PackedVector3& operator=(const Vector3<Real>& vector) {
    store_vectorized(this, PackedVector3(vector));
    return *this;
  }
  SIM_HD void operator+=(const Vector3<Real>& vector) { *this = load() + vector; }

  static constexpr bool has_tag = 4 * sizeof(Real) == 16;
  struct Tagged {
    Vector3<Real> vector;
    std::uint32_t tag;
  };
#if defined(__CUDACC__)
  __device__ Tagged load_tagged() const {
    static_assert(has_tag);
    struct {
      std::uint64_t low, high;
    } words;
    asm volatile("{ .reg .b128 q; ld.relaxed.gpu.global.b128 q, [%2]; mov.b128 {%0, %1}, q; }"
                 : "=l"(words.low), "=l"(words.high)
                 : "l"(this)
                 : "memory");
    Tagged tagged;
    memcpy(static_cast<void*>(&tagged), &words, sizeof words);
    return tagged;
  }
  __device__ void store_tagged(const Vector3<Real>& vector, std::uint32_t tag) {
    static_assert(has_tag);
    const Tagged tagged{vector, tag};
    struct {
      std::uint64_t low, high;
    } words;
    memcpy(&words, static_cast<const void*>(&tagged), sizeof words);
    asm volatile("{ .reg .b128 q; mov.b128 q, {%1, %2}; st.relaxed.gpu.global.b128 [%0], q; }" ::"l"(this),
                 "l"(words.low), "l"(words.high)
                 : "memory");
  }
#endif

 private:
  Vector3<Real> vector_;
  Real padding_;
};
static_assert(sizeof(PackedVector3<float>) == 16 && sizeof(PackedVector3<double>) == 32);

}  // namespace collidoscope
