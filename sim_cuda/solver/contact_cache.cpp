#include "sim_cuda/solver/contact_cache.h"

#include <algorithm>

#include "sim_cuda/solver/wide_vectors.h"

namespace collidoscope {

template <class Real>
ContactCache<Real>::ContactCache(Executor& executor, std::int64_t body_count, bool with_friction)
    : body_count_(body_count),
      with_friction_(with_friction),
      known_contacts_(executor, "contacts of the last step"),
      known_first_(executor, "first contacts of the last step"),
      known_impulse_(executor, "impulses of the last step"),
      known_grip_(executor, "friction of the last step"),
      known_count_(executor, "number of contacts of the last step") {
  known_count_.upload({0});
  known_first_.upload(std::vector<std::uint32_t>(static_cast<std::size_t>(body_count), 0));
}

template <class Real>
void ContactCache<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const std::size_t known = std::max(static_cast<std::size_t>(contact_capacity), loaded_);
  known_contacts_.resize_keeping(known);
  known_impulse_.resize_keeping(known);
  if (with_friction_) known_grip_.resize_keeping(known);
}

template <class Real>
KeepContacts<Real> ContactCache<Real>::keeping(const Pair* contacts, const std::uint32_t* place_of,
                                               const StoredContact<Real>* soft, const ContactSums<Real>* sums,
                                               Real* total) const {
  return {contacts,
          place_of,
          soft,
          sums,
          known_grip_.data(),
          total,
          known_contacts_.data(),
          known_first_.data(),
          known_impulse_.data()};
}

template <class Real>
void ContactCache<Real>::save(SolverMemory& memory) const {
  const std::size_t count = size();
  const std::vector<Pair> contacts = known_contacts_.download(count);
  const std::vector<Real> impulse = known_impulse_.download(count);
  for (std::size_t k = 0; k < count; ++k)
    memory.contacts.push_back({contacts[k].a, contacts[k].b, static_cast<double>(impulse[k])});
  if (with_friction_) memory.grips = widened_vectors<Real>(known_grip_.download(count), count);
}

template <class Real>
void ContactCache<Real>::load(const SolverMemory& memory) {
  const std::size_t count = memory.contacts.size();
  const bool grips = with_friction_ && memory.grips.size() == count;
  loaded_ = count;
  const auto m = std::max(static_cast<std::size_t>(contact_capacity_), count);
  std::vector<Pair> contacts(m);
  std::vector<Real> impulse(m);
  std::vector<Vector3<Real>> grip(with_friction_ ? m : 0, Vector3<Real>::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    contacts[k] = {memory.contacts[k].a, memory.contacts[k].b};
    impulse[k] = static_cast<Real>(memory.contacts[k].impulse);
    if (grips) grip[k] = narrowed_vector<Real>(memory.grips[k]);
  }
  known_contacts_.upload(contacts);
  std::vector<std::uint32_t> first(static_cast<std::size_t>(body_count_), 0);
  for (std::uint32_t k = 0; k < count; ++k)
    if (KnownContacts::is_first(contacts.data(), k)) first[contacts[k].a] = k;
  known_first_.upload(first);
  known_impulse_.upload(impulse);
  known_grip_.upload(grip);
  known_count_.upload({static_cast<std::uint32_t>(count)});
}

template <class Real>
void ContactCache<Real>::visit(const ArrayVisit& visit) const {
  const std::size_t known = *known_count_.data();
  visit(known_count_.data(), known_count_.bytes());
  visit(known_contacts_.data(), known * sizeof(Pair));
  visit(known_impulse_.data(), known * sizeof(Real));
  if (known_grip_.size() > 0) visit(known_grip_.data(), known * sizeof(Vector3<Real>));
}

template class ContactCache<float>;
template class ContactCache<double>;

}  // namespace collidoscope
