#include "sim_cuda/solver/contact_cache.h"

#include <algorithm>

#include "sim_cuda/solver/wide_vectors.h"

namespace collidoscope {

template <class Real>
ContactCache<Real>::ContactCache(Executor& executor, std::int64_t body_count, bool with_friction)
    : body_count_(body_count),
      with_friction_(with_friction),
      previous_contacts_(executor, "previous contacts"),
      previous_first_(executor, "first previous contacts"),
      previous_impulse_(executor, "previous impulses"),
      previous_friction_(executor, "previous friction"),
      previous_count_(executor, "previous contact count") {
  previous_count_.upload({0});
  previous_first_.upload(std::vector<std::uint32_t>(static_cast<std::size_t>(body_count), 0));
}

template <class Real>
void ContactCache<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const std::size_t previous = std::max(static_cast<std::size_t>(contact_capacity), loaded_);
  previous_contacts_.resize_keeping(previous);
  previous_impulse_.resize_keeping(previous);
  if (with_friction_) previous_friction_.resize_keeping(previous);
}

template <class Real>
StoreImpulses<Real> ContactCache<Real>::store_stage(const Pair* contacts, const std::uint32_t* place_of,
                                                    const PackedContact<Real>* soft,
                                                    const ContactSums<Real>* sums, Real* total) const {
  return {contacts,
          place_of,
          soft,
          sums,
          previous_friction_.data(),
          total,
          previous_contacts_.data(),
          previous_first_.data(),
          previous_impulse_.data()};
}

template <class Real>
void ContactCache<Real>::save(WarmStartParts& parts) const {
  const std::size_t count = size();
  parts.add([count, contacts = previous_contacts_.download(count),
             impulse = previous_impulse_.download(count)](WarmStart& warm_start) {
    warm_start.contacts.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
      warm_start.contacts.push_back({contacts[k].a, contacts[k].b, static_cast<double>(impulse[k])});
  });
  if (with_friction_)
    parts.add([friction = previous_friction_.download(count)](WarmStart& warm_start) {
      warm_start.friction = widened_vectors<Real>(friction, friction.size());
    });
}

template <class Real>
void ContactCache<Real>::load(const WarmStart& warm_start) {
  const std::size_t count = warm_start.contacts.size();
  const bool has_friction = with_friction_ && warm_start.friction.size() == count;
  loaded_ = count;
  const auto m = std::max(static_cast<std::size_t>(contact_capacity_), count);
  std::vector<Pair> contacts(m);
  std::vector<Real> impulse(m);
  std::vector<Vector3<Real>> friction(with_friction_ ? m : 0, Vector3<Real>::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    contacts[k] = {warm_start.contacts[k].a, warm_start.contacts[k].b};
    impulse[k] = static_cast<Real>(warm_start.contacts[k].impulse);
    if (has_friction) friction[k] = narrowed_vector<Real>(warm_start.friction[k]);
  }
  previous_contacts_.upload(contacts);
  std::vector<std::uint32_t> first(static_cast<std::size_t>(body_count_), 0);
  for (std::uint32_t k = 0; k < count; ++k)
    if (PreviousContacts::is_first(contacts.data(), k)) first[contacts[k].a] = k;
  previous_first_.upload(first);
  previous_impulse_.upload(impulse);
  previous_friction_.upload(friction);
  previous_count_.upload({static_cast<std::uint32_t>(count)});
}

template <class Real>
void ContactCache<Real>::visit(const ArrayVisitor& visit) const {
  const std::size_t previous = size();
  visit(previous_first_.data(), previous_first_.bytes());
  visit(previous_count_.data(), previous_count_.bytes());
  visit(previous_contacts_.data(), previous * sizeof(Pair));
  visit(previous_impulse_.data(), previous * sizeof(Real));
  if (previous_friction_.size() > 0) visit(previous_friction_.data(), previous * sizeof(Vector3<Real>));
}

template <class Real>
void ContactCache<Real>::list(HashedArrays& arrays) const {
  arrays.add<std::uint32_t>(previous_contacts_.data(), items());
  arrays.add<Real>(previous_impulse_.data(), items());
  if (previous_friction_.size() > 0) arrays.add<Real>(previous_friction_.data(), items());
}

template class ContactCache<float>;
template class ContactCache<double>;

}  // namespace collidoscope
