#pragma once
// Some of the settings, each with a value or unset: what a change, a command line, a hard case or a point of
// an accuracy study sets. Plain data.

#include <optional>
#include <tuple>

#include "sim_cuda/scene/settings.h"

namespace collidoscope {

class SettingsPatch {
 public:
  template <auto member>
  using Value = typename Field<member>::Value;

  /// Unset: the patch leaves the setting alone. Use: patch.get<&Physics::solver>().
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
  /// Whether the state depends on anything in it.
  bool physical() const {
    return any([](const auto& setting) { return is_physical(setting); });
  }
  /// Whether it has a setting of the scene's generator.
  bool of_generator() const {
    return any([](const auto& setting) { return is_of_generator(setting); });
  }
  /// Whether it has a setting for which test(field) is true.
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

  /// The other's values replace those here.
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

/// Puts the patch's values into a scene, which has one generator if the patch sets one of its settings, and
/// into options.
void apply(const SettingsPatch& patch, Scene& scene, RunOptions& run);
/// Only those that the state depends on.
void apply(const SettingsPatch& patch, Scene& scene);
void apply(const SettingsPatch& patch, RunSettings& all);

/// What turns `before` into `after`. Only settings that can change while a run runs.
SettingsPatch difference(const RunSettings& before, const RunSettings& after);

/// Those of a scene and options; `generator` is the default one unless the scene has exactly one.
RunSettings settings_of(const Scene& scene, const RunOptions& run);

/// Whether two settings are the same value, to the bit for numbers.
bool equal_settings(const RunSettings& a, const RunSettings& b);

}  // namespace collidoscope
