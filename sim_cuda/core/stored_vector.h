#pragma once
// A vector as it lies in memory that is read and written at random places: padded to four numbers, so that a
// GPU moves it at one go (core/whole_record.h). To compute with it, make a Vector3 of it.
//
// In float, the padding may hold a count, which threads of one launch take turns by: who sees the count sees
// the vector that was stored with it, as both go in one access of 128 bits.

#include <cstdint>

#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/whole_record.h"

namespace collidoscope {

template <class Real>
class alignas(4 * sizeof(Real)) StoredVector3 {
 public:
  StoredVector3() = default;
  SIM_HD StoredVector3(const Vector3<Real>& vector) : vector_(vector), padding_(0) {}
  SIM_HD Vector3<Real> load() const { return load_own(this).vector_; }
  SIM_HD operator Vector3<Real>() const { return load(); }
  SIM_HD StoredVector3& operator=(const Vector3<Real>& vector) {
    store_whole(this, StoredVector3(vector));
    return *this;
  }
  SIM_HD void operator+=(const Vector3<Real>& vector) { *this = load() + vector; }

  static constexpr bool counts = 4 * sizeof(Real) == 16;
  struct Counted {
    Vector3<Real> vector;
    std::uint32_t count;
  };
#if defined(__CUDACC__)
  __device__ Counted take() const {
    static_assert(counts);
    struct {
      std::uint64_t low, high;
    } words;
    asm volatile("{ .reg .b128 q; ld.relaxed.gpu.global.b128 q, [%2]; mov.b128 {%0, %1}, q; }"
                 : "=l"(words.low), "=l"(words.high)
                 : "l"(this)
                 : "memory");
    Counted counted;
    memcpy(static_cast<void*>(&counted), &words, sizeof words);
    return counted;
  }
  __device__ void give(const Vector3<Real>& vector, std::uint32_t count) {
    static_assert(counts);
    const Counted counted{vector, count};
    struct {
      std::uint64_t low, high;
    } words;
    memcpy(&words, static_cast<const void*>(&counted), sizeof words);
    asm volatile("{ .reg .b128 q; mov.b128 q, {%1, %2}; st.relaxed.gpu.global.b128 [%0], q; }" ::"l"(this),
                 "l"(words.low), "l"(words.high)
                 : "memory");
  }
#endif

 private:
  Vector3<Real> vector_;
  Real padding_;
};
static_assert(sizeof(StoredVector3<float>) == 16 && sizeof(StoredVector3<double>) == 32);

}  // namespace collidoscope
