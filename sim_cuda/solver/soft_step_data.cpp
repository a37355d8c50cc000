// Member functions of SoftStepSolver that launch no stage: warm-start data between runs, and recorded
// residuals.

#include <algorithm>

#include "sim_cuda/solver/soft_step.h"

namespace collidoscope {

// ---- warm-start data ----

template <class Real>
void SoftStepSolver<Real>::save_warm_start(WarmStartParts& parts) const {
  if (scene_.joints)
    parts.add([joints = scene_.joints->save_warm_start(),
               loop_energies = scene_.joints->save_loop_energies()](WarmStart& warm_start) {
      warm_start.joints = joints;
      warm_start.loop_energies = loop_energies;
    });
  cache_.save(parts);
  planes_.save(parts);
  rolling_.save_warm_start(cache_.size(), parts);
  parts.add([timer = sleeping_.save_warm_start()](WarmStart& warm_start) { warm_start.sleep_timer = timer; });
}

template <class Real>
void SoftStepSolver<Real>::visit_warm_start(const ArrayVisitor& visit) {
  cache_.visit(visit);
  planes_.visit(visit);
  rolling_.visit_warm_start(cache_.size(), visit);
  sleeping_.visit_warm_start(visit);
  if (scene_.joints) scene_.joints->visit_warm_start(visit);
}

template <class Real>
void SoftStepSolver<Real>::list_warm_start(HashedArrays& arrays) const {
  cache_.list(arrays);
  planes_.list(arrays);
  rolling_.list_warm_start(cache_.items(), arrays);
  sleeping_.list_warm_start(arrays);
  if (scene_.joints) scene_.joints->list_warm_start(arrays);
}

template <class Real>
void SoftStepSolver<Real>::load_warm_start(const WarmStart& warm_start) {
  cache_.load(warm_start);
  rolling_.load_warm_start(warm_start,
                           std::max(static_cast<std::size_t>(contact_capacity_), warm_start.contacts.size()));
  if (scene_.joints) {
    scene_.joints->load_warm_start(warm_start.joints);
    scene_.joints->load_loop_energies(warm_start.loop_energies);
  }
  if (scene_.effects.sleeping) sleeping_.load_warm_start(warm_start.sleep_timer);
  planes_.load(warm_start);
}

// ---- residuals ----

template <class Real>
void SoftStepSolver<Real>::record_residuals(bool on) {
  residuals_.enable(on, 1, scene_.substeps * 2 * (scene_.iterations + 1));
}

template <class Real>
std::vector<Residual> SoftStepSolver<Real>::residuals() const {
  std::vector<Residual> residuals;
  const int sums = scene_.iterations + 1;
  for (const ResidualSum& sum : residuals_.kept()) {
    const int k = static_cast<int>(residuals.size());
    residuals.push_back(
        Residuals::residual(k / sums % 2 == 0 ? "solve" : "relax", k / sums / 2, k % sums, sum));
  }
  return residuals;
}

template void SoftStepSolver<float>::save_warm_start(WarmStartParts&) const;
template void SoftStepSolver<float>::visit_warm_start(const ArrayVisitor&);
template void SoftStepSolver<float>::list_warm_start(HashedArrays&) const;
template void SoftStepSolver<float>::load_warm_start(const WarmStart&);
template void SoftStepSolver<float>::record_residuals(bool);
template std::vector<Residual> SoftStepSolver<float>::residuals() const;
template void SoftStepSolver<double>::save_warm_start(WarmStartParts&) const;
template void SoftStepSolver<double>::visit_warm_start(const ArrayVisitor&);
template void SoftStepSolver<double>::list_warm_start(HashedArrays&) const;
template void SoftStepSolver<double>::load_warm_start(const WarmStart&);
template void SoftStepSolver<double>::record_residuals(bool);
template std::vector<Residual> SoftStepSolver<double>::residuals() const;

}  // namespace collidoscope
