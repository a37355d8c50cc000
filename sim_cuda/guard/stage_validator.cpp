#include "sim_cuda/guard/stage_validator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include "sim_cuda/core/atomics.h"

namespace collidoscope {
namespace {

/// Output of a stage, as bits.
enum Part : unsigned { nothing = 0, boxes = 1, normals = 2, field = 4, motion = 8, pose = 16 };

struct Writes {
  std::string_view stage;
  unsigned parts;
};
constexpr Writes known_stages[] = {
    {"bounds", boxes},  {"keys", nothing},       {"sort", nothing},     {"build", nothing},
    {"pairs", nothing}, {"contacts", normals},   {"colour", nothing},   {"prepare", nothing},
    {"keep", nothing},  {"continuous", nothing}, {"residual", nothing}, {"attractor", field},
    {"forces", motion}, {"drag", motion},        {"joints", motion},    {"relax", motion},
    {"bounce", motion},
};

unsigned parts_of(std::string_view stage) {
  const auto* known = std::ranges::find(known_stages, stage, &Writes::stage);
  return known == std::end(known_stages) ? motion | pose : known->parts;
}

/// Reports a violation of the current stage.
struct ViolationReport {
  FirstViolation* first_violation;
  std::uint64_t stage;  ///< stage number in the run
  SIM_HD bool is_final() const { return first_violation->is_final != 0; }
  SIM_HD void submit(std::uint32_t body) const { atomic_min(&first_violation->key, stage << 32 | body); }
};

template <class Real>
struct CheckBoxes {
  ViolationReport report;
  ValidationLimits<Real> limits;
  const Aabb* boxes;
  SIM_HD void operator()(int body) const {
    if (!report.is_final() && !limits.contains(boxes[body])) report.submit(static_cast<std::uint32_t>(body));
  }
};

template <class Real>
struct CheckNormals {
  ViolationReport report;
  ContactView<Real> contacts;
  SIM_HD void operator()(int contact) const {
    if (!report.is_final() && !ValidationLimits<Real>::unit(contacts.normal[contact]))
      report.submit(contacts.bodies[contact].a);
  }
};

template <class Real>
struct CheckField {
  ViolationReport report;
  const Vector3<Real>* field;
  SIM_HD void operator()(int body) const {
    if (!report.is_final() && !ValidationLimits<Real>::finite(field[body]))
      report.submit(static_cast<std::uint32_t>(body));
  }
};

template <class Real>
struct CheckBodies {
  ViolationReport report;
  ValidationLimits<Real> limits;
  BodyView<Real> bodies;
  unsigned parts;
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow || report.is_final()) return;  // the stage has written nothing
    bool good = true;
    if (parts & motion) {
      good = limits.within(bodies.velocity[body], limits.speed);
      if (bodies.angular_velocity != nullptr)
        good = good && limits.within(bodies.angular_velocity[body], limits.angular_speed);
    }
    if (parts & pose) {
      good = good && limits.within(bodies.position[body], limits.distance);
      if (bodies.orientation != nullptr) good = good && limits.unit(bodies.orientation[body]);
    }
    if (!good) report.submit(static_cast<std::uint32_t>(body));
  }
};

/// Ends a run. If it has a violation, the violation is final.
struct FinishRun {
  FirstViolation* first_violation;
  const StepControl* control;
  SIM_HD void operator()(int) const {
    if (first_violation->is_final) return;
    first_violation->run = control->committed;
    if (first_violation->key != FirstViolation::none && !control->overflow) first_violation->is_final = 1;
  }
};

double magnitude(std::initializer_list<double> components) {
  double sum = 0;
  for (const double c : components) {
    if (!std::isfinite(c)) return c;
    sum += c * c;
  }
  return std::sqrt(sum);
}
template <class Real>
double magnitude(const Vector3<Real>& v) {
  return magnitude({static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())});
}
template <class Real>
double magnitude(const Quaternion<Real>& q) {
  return magnitude({static_cast<double>(q.w()), static_cast<double>(q.x()), static_cast<double>(q.y()),
                    static_cast<double>(q.z())});
}
double magnitude(const Aabb& box) {
  if (is_empty(box)) return std::numeric_limits<double>::quiet_NaN();
  double farthest = 0;
  for (int k = 0; k < 3; ++k)
    farthest = std::max(
        {farthest, std::abs(static_cast<double>(box.min[k])), std::abs(static_cast<double>(box.max[k]))});
  return farthest;
}

}  // namespace

template <class Real>
StageValidator<Real>::StageValidator(Executor& executor, const ValidationSettings& guards)
    : executor_(executor), limits_(guards), first_violation_(executor, "first guard finding") {
  clear();
}

template <class Real>
void StageValidator<Real>::clear() {
  first_violation_.upload({FirstViolation{}});
  described_ = {};
}

template <class Real>
void StageValidator<Real>::run_validated(const ValidationSource<Real>& view,
                                         const std::function<void()>& work) {
  stages_ = 0;
  executor_.run_with_stage_callback([&](const char* stage, int substep) { check(view, stage, substep); },
                                    work);
  executor_.run("guard", 1, FinishRun{first_violation_.data(), view.control});
}

template <class Real>
void StageValidator<Real>::check(const ValidationSource<Real>& view, const char* stage, int substep) {
  const std::uint32_t number = stages_++;
  const unsigned parts = parts_of(stage);
  if (described_.key != FirstViolation::none && described_.stage() == number) {
    finding_ = {};
    finding_.stage = stage;
    finding_.substep = substep + 1;
    finding_.body = described_.body();
    describe(view, parts);
  }
  const ViolationReport report{first_violation_.data(), number};
  if (parts & boxes) executor_.run("guard", view.body_count, CheckBoxes<Real>{report, limits_, view.boxes});
  if (parts & normals)
    executor_.run("guard", ItemCount(&view.control->contacts, view.contact_capacity),
                  CheckNormals<Real>{report, view.contacts});
  if (parts & field && view.field != nullptr)
    executor_.run("guard", view.body_count, CheckField<Real>{report, view.field});
  if (parts & (motion | pose))
    executor_.run("guard", view.body_count,
                  CheckBodies<Real>{report, limits_, view.bodies, parts, view.control});
}

/// Finds the first quantity of the body that fails a check of these parts.
template <class Real>
void StageValidator<Real>::describe(const ValidationSource<Real>& view, unsigned parts) {
  const std::size_t body = finding_.body;
  const auto fetch = [&](const auto* array, std::size_t submit) {
    std::remove_cvref_t<decltype(*array)> value;
    executor_.copy_to_host(&value, array + submit, sizeof value);
    return value;
  };
  const auto violates = [&](FindingQuantity quantity, const auto& value, bool good) {
    if (good) return false;
    finding_.quantity = quantity;
    finding_.value = magnitude(value);
    return true;
  };
  if (parts & boxes) {
    const Aabb box = fetch(view.boxes, body);
    if (violates(FindingQuantity::box, box, limits_.contains(box))) return;
  }
  if (parts & normals) {
    const std::uint32_t count = fetch(&view.control->contacts, 0);
    for (std::size_t k = 0; k < count; ++k) {
      if (fetch(view.contacts.bodies, k).a != body) continue;
      const Vector3<Real> normal = fetch(view.contacts.normal, k);
      if (violates(FindingQuantity::normal, normal, limits_.unit(normal))) return;
    }
  }
  if (parts & field && view.field != nullptr) {
    const Vector3<Real> pull = fetch(view.field, body);
    if (violates(FindingQuantity::acceleration, pull, limits_.finite(pull))) return;
  }
  if (parts & motion) {
    const Vector3<Real> v = fetch(view.bodies.velocity, body);
    if (violates(FindingQuantity::velocity, v, limits_.within(v, limits_.speed))) return;
    if (view.bodies.angular_velocity != nullptr) {
      const Vector3<Real> spin = fetch(view.bodies.angular_velocity, body);
      if (violates(FindingQuantity::spin, spin, limits_.within(spin, limits_.angular_speed))) return;
    }
  }
  if (parts & pose) {
    const Vector3<Real> x = fetch(view.bodies.position, body);
    if (violates(FindingQuantity::position, x, limits_.within(x, limits_.distance))) return;
    if (view.bodies.orientation != nullptr) {
      const Quaternion<Real> q = fetch(view.bodies.orientation, body);
      violates(FindingQuantity::orientation, q, limits_.unit(q));
    }
  }
}

template class StageValidator<float>;
template class StageValidator<double>;

}  // namespace collidoscope
