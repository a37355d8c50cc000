#include "sim_cuda/recording/compact_state.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

namespace collidoscope {
namespace {

constexpr std::size_t word_bytes = sizeof(std::uint64_t);

/// The float with the value of a double that is stored as these bits.
float narrowed(std::uint64_t word) { return static_cast<float>(std::bit_cast<double>(word)); }
std::uint64_t widened(float value) { return std::bit_cast<std::uint64_t>(static_cast<double>(value)); }

/// Writes the parts of a state.
class Packer {
 public:
  explicit Packer(std::vector<std::byte>& data) : data_(data) {}

  template <class Value>
  void value(const Value& value) {
    append(&value, sizeof value);
  }
  template <class Item>
  void list(const std::vector<Item>& items) {
    value(items.size());
    if (items.empty()) return;
    if constexpr (sizeof(Item) % word_bytes == 0) {
      constexpr std::size_t columns = sizeof(Item) / word_bytes;
      for (std::size_t k = 0; k < columns; ++k)
        column(reinterpret_cast<const std::byte*>(items.data()) + k * word_bytes, sizeof(Item), items.size());
    } else {
      append(items.data(), items.size() * sizeof(Item));
    }
  }
  template <class Item>
  void lists(const std::vector<std::vector<Item>>& lists) {
    value(lists.size());
    for (const auto& items : lists) list(items);
  }

 private:
  void append(const void* from, std::size_t bytes) {
    const std::size_t end = data_.size();
    data_.resize(end + bytes);
    if (bytes > 0) std::memcpy(data_.data() + end, from, bytes);
  }
  /// A column: whether its words are floats, a bit per word that is not zero, and these words.
  void column(const std::byte* from, std::size_t stride, std::size_t count) {
    words_.resize(count);
    bool floats = true;
    std::size_t used = 0;
    std::vector<std::uint64_t> bits((count + 63) / 64);
    for (std::size_t k = 0; k < count; ++k) {
      std::uint64_t word;
      std::memcpy(&word, from + k * stride, word_bytes);
      if (word == 0) continue;
      bits[k / 64] |= std::uint64_t{1} << k % 64;
      words_[used++] = word;
      floats = floats && widened(narrowed(word)) == word;
    }
    value(floats);
    append(bits.data(), bits.size() * word_bytes);
    if (!floats) return append(words_.data(), used * word_bytes);
    narrow_.resize(used);
    std::transform(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(used), narrow_.begin(),
                   narrowed);
    append(narrow_.data(), used * sizeof(float));
  }

  std::vector<std::byte>& data_;
  std::vector<std::uint64_t> words_;
  std::vector<float> narrow_;
};

/// Reads what a Packer has written.
class Unpacker {
 public:
  explicit Unpacker(const std::vector<std::byte>& data) : next_(data.data()) {}

  template <class Value>
  void value(Value& value) {
    take(&value, sizeof value);
  }
  template <class Item>
  void list(std::vector<Item>& items) {
    std::size_t count = 0;
    value(count);
    items.resize(count);
    if (items.empty()) return;
    if constexpr (sizeof(Item) % word_bytes == 0) {
      constexpr std::size_t columns = sizeof(Item) / word_bytes;
      for (std::size_t k = 0; k < columns; ++k)
        column(reinterpret_cast<std::byte*>(items.data()) + k * word_bytes, sizeof(Item), count);
    } else {
      take(items.data(), count * sizeof(Item));
    }
  }
  template <class Item>
  void lists(std::vector<std::vector<Item>>& lists) {
    std::size_t count = 0;
    value(count);
    lists.resize(count);
    for (auto& items : lists) list(items);
  }

 private:
  void take(void* to, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, next_, bytes);
    next_ += bytes;
  }
  template <class Value>
  Value take() {
    Value taken;
    value(taken);
    return taken;
  }
  void column(std::byte* to, std::size_t stride, std::size_t count) {
    bool floats = false;
    value(floats);
    std::vector<std::uint64_t> bits((count + 63) / 64);
    take(bits.data(), bits.size() * word_bytes);
    for (std::size_t k = 0; k < count; ++k) {
      std::uint64_t word = 0;
      const bool stored = (bits[k / 64] >> k % 64 & 1) != 0;
      if (stored && floats)
        word = widened(take<float>());
      else if (stored)
        word = take<std::uint64_t>();
      std::memcpy(to + k * stride, &word, word_bytes);
    }
  }

  const std::byte* next_;
};

/// Passes each part of a state to the Packer or Unpacker.
template <class Archive, class State>
void visit_parts(Archive& archive, State& state) {
  archive.value(state.steps);
  archive.value(state.settings);
  archive.value(state.time);
  visit_lists(archive, state);
  archive.list(state.frozen);
  archive.list(state.warm_start.loop_energies);
}

}  // namespace

CompactState::CompactState(const RunState& state) : steps_(state.steps) {
  Packer packer(data_);
  visit_parts(packer, state);
  data_.shrink_to_fit();
}

RunState CompactState::state() const {
  RunState state;
  Unpacker unpacker(data_);
  visit_parts(unpacker, state);
  return state;
}

}  // namespace collidoscope
