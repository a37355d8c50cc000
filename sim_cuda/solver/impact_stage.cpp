#include "sim_cuda/solver/impact_stage.h"

#include <algorithm>
#include <vector>

#include "sim_cuda/solver/impact_sweeps.h"

namespace collidoscope {

template <class Real>
ImpactStage<Real>::ImpactStage(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      h_(scene.time_step / static_cast<Real>(scene.substeps)),
      needed_(executor, "impact sweep flags"),
      struck_(executor, "struck bodies"),
      struck_contacts_(executor, "contacts of struck bodies"),
      driven_(executor, "bodies hit by heavy ones"),
      supported_(executor, "bodies with impulses of the ground"),
      last_sizes_(executor, "sizes of the last sweeps"),
      last_bodies_(executor, "bodies of the last sweeps"),
      last_next_(executor, "bodies of the next sweep"),
      last_places_(executor, "contacts of the last sweeps"),
      last_listed_(executor, "listed contacts") {
  const auto n = static_cast<std::size_t>(scene.body_count);
  needed_.upload(std::vector<std::uint32_t>(max_impact_sweeps + 2, 0));
  struck_.resize_discarding(n);
  driven_.resize_discarding(n);
  supported_.resize_discarding(n);
  driven_.fill_zero();
  supported_.fill_zero();
  if (!executor.on_device()) return;
  last_sizes_.upload(std::vector<std::uint32_t>(max_impact_sweeps, 0));
  last_bodies_.resize_discarding(n);
  last_next_.resize_discarding(n);
}

template <class Real>
void ImpactStage<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const auto m = static_cast<std::size_t>(contact_capacity);
  if (executor_.on_device()) {
    last_places_.resize_discarding(m);
    last_listed_.resize_discarding(m / 32 + 1);
    last_listed_.fill_zero();
  } else {
    struck_contacts_.resize_discarding(m);
    struck_contacts_.fill_zero();
  }
}

template <class Real>
const std::uint32_t* ImpactStage<Real>::any_moving() const {
  return needed_.data() + max_impact_sweeps + 1;
}

template <class Real>
template <bool with_friction>
void ImpactStage<Real>::resolve(const OrderedContacts<Real, with_friction>& contacts,
                                const PlaneContacts<Real>& planes, const ContactsByBodyView& by_body,
                                const std::uint8_t* asleep, std::uint32_t* chain_counts) {
  ImpactLaw<Real> law{scene_.restitution, scene_.gravity, scene_.effects.attractor ? scene_.field : nullptr,
                      h_, 0};
  if (law.field == nullptr) law.slow = law.rest_speed(scene_.gravity);
  const StruckMarks struck{struck_.data(), struck_contacts_.data(), by_body, scene_.control};
  const ShockMarks shocks{driven_.data(), supported_.data()};
  LastSweepLists last;
  if (executor_.on_device())
    last = {last_sizes_.data(), last_bodies_.data(), last_next_.data(), last_places_.data(),
            last_listed_.data()};
  const auto with = [&]<bool with_box_obstacles, bool unequal_moments>() {
    using Sweeps = ImpactSweeps<Real, with_friction, with_box_obstacles, unequal_moments>;
    using Contacts = typename Sweeps::Contacts;
    std::uint32_t* const needed = needed_.data();
    const std::int64_t items = std::max(scene_.body_count, contact_capacity_);
    Sweeps sweeps{
        Contacts{contacts, scene_.bodies, {law, nullptr, struck, shocks, scene_.static_impulses, 0}},
        planes.template view<with_friction, with_box_obstacles>(1 / h_),
        needed,
        asleep,
        scene_.control,
        0,
        last};
    // On a GPU, sweeps over contacts without barriers are faster. Sweeps with barriers read less of contacts
    // at rest, which matters where memory is the limit.
    const int without_barriers = scene_.body_count > 200'000 ? 0 : 3;
    if (executor_.on_device() && Contacts::sync_free_rounds > 0)
      for (; sweeps.first < without_barriers; ++sweeps.first) {
        const auto now = static_cast<std::uint8_t>(sweeps.first + 2);
        executor_.run("bounce", scene_.body_count, FirstRound<Sweeps>{sweeps});
        executor_.run_rounds("bounce", Contacts::rounds, std::min(contact_capacity_, scene_.body_count / 2),
                             Contacts{contacts,
                                      scene_.bodies,
                                      {law, needed + sweeps.first + 1, struck, shocks, scene_.static_impulses,
                                       now, needed + sweeps.first}});
      }
    executor_.run_rounds("bounce", sweeps.rounds(), items, sweeps);
  };
  // For unequal moments there is one version, with boxes: each takes long to compile.
  if (with_friction && scene_.unequal_moments)
    with.template operator()<true, with_friction>();
  else if (scene_.boxes.count > 0)
    with.template operator()<true, false>();
  else
    with.template operator()<false, false>();
  executor_.run("bounce", 1, EndImpacts{needed_.data(), last, struck, chain_counts, scene_.control});
}

template class ImpactStage<float>;
template class ImpactStage<double>;
template void ImpactStage<float>::resolve(const OrderedContacts<float, true>&, const PlaneContacts<float>&,
                                          const ContactsByBodyView&, const std::uint8_t*, std::uint32_t*);
template void ImpactStage<float>::resolve(const OrderedContacts<float, false>&, const PlaneContacts<float>&,
                                          const ContactsByBodyView&, const std::uint8_t*, std::uint32_t*);
template void ImpactStage<double>::resolve(const OrderedContacts<double, true>&, const PlaneContacts<double>&,
                                           const ContactsByBodyView&, const std::uint8_t*, std::uint32_t*);
template void ImpactStage<double>::resolve(const OrderedContacts<double, false>&,
                                           const PlaneContacts<double>&, const ContactsByBodyView&,
                                           const std::uint8_t*, std::uint32_t*);

}  // namespace collidoscope
