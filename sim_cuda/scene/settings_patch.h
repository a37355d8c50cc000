#pragma once
// A partial set of settings: each one has a value or is unset. Used by changes, command lines, hard cases and
// points of an accuracy study. Plain data.

#include <optional>
#include <tuple>

#include "sim_cuda/scene/settings.h"

namespace collidoscope {

class SettingsPatch {
 public:
  template <auto member>
  using Value = typename Field<member>::Value;

  /// The value of a setting. Unset: the patch does not change the setting. Example:
  /// patch.get<&Physics::solver>().
  template <auto member>
  const std::optional<Value<member>>& get() const {
    return std::get<place<member>()>(values_);
  }
  template <auto member>
  std::optional<Value<member>>& get() {
    return std::get<place<member>()>(values_);
  }
  template <auto member>
  SettingsPatch& set(Value<member> value) {
    get<member>() = std::move(value);
    return *this;
  }
  template <auto member>
  bool has() const {
    return get<member>().has_value();
  }

  bool empty() const {
    return !any([](const auto&) { return true; });
  }
  /// True if the patch affects the state.
  bool physical() const {
    return any([](const auto& setting) { return is_physical(setting); });
  }
  /// True if the patch contains a setting of the scene's generator.
  bool of_generator() const {
    return any([](const auto& setting) { return is_of_generator(setting); });
  }
  /// True if the patch contains a setting for which test(field) is true.
  template <class Test>
  bool any(const Test& test) const {
    bool found = false;
    for_each_set([&](const auto& setting, const auto&) { found = found || test(setting); });
    return found;
  }

  /// Calls use(field, value) for each setting that has a value.
  template <class Use>
  void for_each_set(const Use& use) const {
    for_each_setting([&]<auto member>(const Field<member>& setting) {
      if (const auto& value = get<member>()) use(setting, *value);
    });
  }

  /// Copies all values of the other patch into this one.
  void merge(const SettingsPatch& other) {
    other.for_each_set([&]<auto member>(const Field<member>&, const Value<member>& value) {
      set<member>(value);
    });
  }

  friend bool operator==(const SettingsPatch&, const SettingsPatch&) = default;

 private:
  template <class>
  struct Values;
  template <class... Fields>
  struct Values<std::tuple<Fields...>> {
    using Type = std::tuple<std::optional<typename Fields::Value>...>;
    template <auto member>
    static constexpr std::size_t place() {
      std::size_t k = 0;
      const bool found = ((std::is_same_v<Fields, Field<member>> || (++k, false)) || ...);
      return found ? k : sizeof...(Fields);
    }
  };
  using All = std::remove_const_t<decltype(all_settings)>;
  template <auto member>
  static constexpr std::size_t place() {
    constexpr std::size_t k = Values<All>::template place<member>();
    static_assert(k < setting_count, "the member has no row in settings.h");
    return k;
  }
  typename Values<All>::Type values_;
};

/// Writes the patch's values into a scene and into options. If the patch contains a generator setting, the
/// scene must have a generator.
void apply(const SettingsPatch& patch, Scene& scene, RunOptions& run);
/// Writes only the physical settings of the patch.
void apply(const SettingsPatch& patch, Scene& scene);
void apply(const SettingsPatch& patch, RunSettings& all);

/// The patch that turns `before` into `after`. Contains only settings that can change during a run.
SettingsPatch difference(const RunSettings& before, const RunSettings& after);

/// The settings of a scene and options. `generator` has default values unless the scene has exactly one
/// generator.
RunSettings settings_of(const Scene& scene, const RunOptions& run);

/// True if all settings compare equal. Numbers are compared without a tolerance.
bool equal_settings(const RunSettings& a, const RunSettings& b);

}  // namespace collidoscope
