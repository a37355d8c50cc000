#include "sim_cuda/solver/chain_contacts.h"

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/dynamics/awake.h"

namespace collidoscope {

namespace {

struct ListChainContacts {
  const Pair* ids;  ///< by place
  ColourView colours;
  ChainView chains;
  SIM_HD void operator()(int place) const {
    const std::uint8_t colour = colours.colour[place];
    if (colour >= Colouring::colours) return;
    const Pair pair = ids[place];
    if (!chains.has_few_contacts(pair.a) || !chains.has_few_contacts(pair.b)) return;
    const std::uint32_t number = atomic_count_labelled(chains.count + colour);
    chains.places[colours.begin[colour] + number] = static_cast<std::uint32_t>(place);
  }
};

struct ListChainBodies {
  ChainView chains;
  SIM_HD void operator()(int body) const {
    const auto id = static_cast<std::uint32_t>(body);
    if (chains.degrees[id] == 0 || !chains.has_few_contacts(id)) return;
    chains.bodies[atomic_count_labelled(chains.count + Colouring::colours)] = id;
  }
};

}  // namespace

ChainContacts::ChainContacts(Executor& executor)
    : executor_(executor),
      count_(executor, "chain contact counts"),
      places_(executor, "chain contacts"),
      listed_bodies_(executor, "chain bodies") {
  count_.resize_discarding(Colouring::colours + 1);
}

void ChainContacts::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  places_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  listed_bodies_.resize_discarding(static_cast<std::size_t>(bodies));
}

void ChainContacts::list(const Pair* ids, const Colouring& colouring, const StepControl* control,
                         const std::uint8_t* asleep) {
  const ChainView chains = view(colouring);
  executor_.begin_stage("prepare");
  count_.fill_zero();
  executor_.run("prepare", ItemCount(&control->contacts, static_cast<std::int64_t>(places_.size())),
                ListChainContacts{ids, colouring.view(), chains});
  executor_.run("prepare", colouring.degrees().bodies(), OfAwakeBodies<ListChainBodies>{{chains}, asleep});
}

}  // namespace collidoscope
