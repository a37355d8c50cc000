#pragma once
// Work that completes a value on the host from data that were copied before, for example on another thread.

#include <functional>
#include <utility>
#include <vector>

namespace collidoscope {

template <class Value>
class DeferredParts {
 public:
  /// `work` must own the data that it reads.
  void add(std::function<void(Value&)> work) { works_.push_back(std::move(work)); }
  /// Does the work in the order of add(), once.
  void complete(Value& value) {
    for (const auto& work : std::exchange(works_, {})) work(value);
  }

 private:
  std::vector<std::function<void(Value&)>> works_;
};

}  // namespace collidoscope
