#include "sim_cuda/run/contact_records.h"

#include "sim_cuda/run/simulation.h"

namespace collidoscope {

void ContactRecords::record_impulses(bool on) {
  if (on == impulses_) return;
  run_.runner().discard_graphs();
  run_.pipeline().record_impulses(on);
  impulses_ = on;
  impulses_new_ = false;
}

std::vector<ContactImpulse> ContactRecords::impulses() {
  keep();
  return run_.pipeline().impulses();
}

void ContactRecords::record_residuals(bool on) {
  if (on == residuals_) return;
  run_.runner().discard_graphs();
  run_.pipeline().record_residuals(on);
  residuals_ = on;
  residuals_known_ = false;
}

std::vector<Residual> ContactRecords::residuals() {
  return residuals_known_ ? run_.pipeline().residuals() : std::vector<Residual>{};
}

void ContactRecords::record_hashes(bool on) {
  if (on == hashes_) return;
  run_.runner().discard_graphs();
  run_.pipeline().record_hashes(on);
  hashes_ = on;
}

StateHashes ContactRecords::hashes() {
  return hashes_known_ ? StateHashes::of(run_.runner().control().hash_sums) : run_.pipeline().hashes();
}

void ContactRecords::set_up(Pipeline& pipeline) const {
  pipeline.record_impulses(impulses_);
  pipeline.record_residuals(residuals_);
  pipeline.record_hashes(hashes_);
}

void ContactRecords::step_made() {
  impulses_new_ = impulses_;
  residuals_known_ = residuals_;
  hashes_known_ = hashes_;
}

void ContactRecords::keep() {
  if (impulses_new_) run_.pipeline().keep_impulses();
  impulses_new_ = false;
}

}  // namespace collidoscope
