#pragma once
// A list of arrays of numbers whose contents are hashed by one stage. Plain data, passed to the stage by
// value. The sum of the hashes of all items does not depend on the order of summation.

#include <cstdint>
#include <stdexcept>
#include <type_traits>

#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/item_count.h"

namespace collidoscope {

class HashedArrays {
 public:
  /// Adds an array in the executor's memory. An item consists of numbers of type `Number`; the first `used`
  /// are hashed (0: all). The place of the array in the list is part of the hash.
  template <class Number, class Item>
  void add(const Item* data, const ItemCount& items, int used = 0) {
    static_assert(sizeof(Number) == 4 || sizeof(Number) == 8);
    static_assert(sizeof(Item) % sizeof(Number) == 0);
    if (count_ == most) throw std::logic_error("too many arrays to be hashed");
    Array& array = arrays_[count_++];
    array.data = data;
    array.begin = items_;
    array.device_count = items.device_count;
    array.numbers = static_cast<int>(sizeof(Item) / sizeof(Number));
    array.used = used > 0 ? used : array.numbers;
    array.wide = sizeof(Number) == 8;
    array.floating = std::is_floating_point_v<Number>;
    items_ += items.max;
  }
  std::int64_t items() const { return items_; }

  /// Hash of an item; 0 if all its numbers are 0. `array`: where the search for its array starts, and where
  /// it ends. Start with 0, and pass it on to later items.
  SIM_HD std::uint64_t hash(std::int64_t item, int& array) const {
    while (array + 1 < count_ && item >= arrays_[array + 1].begin) ++array;
    const Array& list = arrays_[array];
    const std::int64_t k = item - list.begin, first = k * list.numbers;
    if (list.device_count != nullptr && k >= static_cast<std::int64_t>(*list.device_count)) return 0;
    if (list.is_zero(first)) return 0;  // most items of planes
    std::uint64_t h = step(static_cast<std::uint64_t>(array) << 48 ^ static_cast<std::uint64_t>(k));
    for (int w = 0; w < list.used; ++w) h = step(h ^ list.bits(first + w));
    return mix64(h);
  }

 private:
  /// Cheaper than mix64(), which ends each hash.
  SIM_HD static std::uint64_t step(std::uint64_t x) {
    x *= 0xd6e8feb86659fd93u;  // odd, so this is a bijection
    return x ^ x >> 32;
  }
  struct Array {
    const void* data;
    std::int64_t begin;  ///< number of items of the arrays before
    const std::uint32_t* device_count;
    int numbers, used;  ///< per item
    bool wide, floating;

    /// -0 is 0.
    SIM_HD bool is_zero(std::int64_t first) const {
      return wide ? is_zero<std::uint64_t>(first) : is_zero<std::uint32_t>(first);
    }
    template <class Word>
    SIM_HD bool is_zero(std::int64_t first) const {
      const Word* words = static_cast<const Word*>(data) + first;
      Word any = 0;
      for (int w = 0; w < used; ++w) any |= words[w];
      return floating ? static_cast<Word>(any << 1) == 0 : any == 0;
    }
    SIM_HD std::uint64_t bits(std::int64_t at) const {
      if (wide) {
        return floating ? hash_bits(static_cast<const double*>(data)[at])
                        : static_cast<const std::uint64_t*>(data)[at];
      }
      return floating ? hash_bits(static_cast<const float*>(data)[at])
                      : static_cast<const std::uint32_t*>(data)[at];
    }
  };
  static constexpr int most = 16;
  Array arrays_[most] = {};
  int count_ = 0;
  std::int64_t items_ = 0;
};

}  // namespace collidoscope
