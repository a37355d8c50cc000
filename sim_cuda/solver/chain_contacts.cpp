#include "sim_cuda/solver/chain_contacts.h"

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/dynamics/awake.h"

namespace collidoscope {

namespace {

constexpr std::uint32_t is_body = std::uint32_t{1} << 31;

SIM_HD bool has_few_contacts(const std::uint32_t* degrees, std::uint32_t body) {
  return degrees[body] <= ChainContacts::most_contacts;
}

struct Members {
  const std::uint32_t* degrees;  ///< contacts by body
  std::uint32_t *members, *count;
  SIM_HD void add(std::uint32_t member) const { members[atomic_count_labelled(count)] = member; }
};

struct ListContacts {
  Members chains;
  const Pair* ids;  ///< by place
  const std::uint8_t* colour;
  SIM_HD void operator()(int place) const {
    if (colour[place] >= ChainView::colours) return;
    const Pair pair = ids[place];
    if (has_few_contacts(chains.degrees, pair.a) && has_few_contacts(chains.degrees, pair.b))
      chains.add(static_cast<std::uint32_t>(place));
  }
};

struct ListBodies {
  Members chains;
  SIM_HD void operator()(int body) const {
    const auto id = static_cast<std::uint32_t>(body);
    if (chains.degrees[id] > 0 && has_few_contacts(chains.degrees, id)) chains.add(id | is_body);
  }
};

/// An item is a member.
template <class Real>
struct ListMoving {
  MovingContacts<Real> contacts;
  ColourView colours;
  const std::uint32_t *degrees, *members;
  ChainView chains;
  SIM_HD void operator()(int item) const {
    if (*contacts.moving == 0) return;
    const std::uint32_t member = members[item];
    if ((member & is_body) != 0) {
      const std::uint32_t body = member & ~is_body;
      if (has_moving_contact(body))
        chains.bodies[atomic_count_labelled(chains.count + ChainView::of_bodies)] = body;
    } else if (is_moving(member)) {
      const std::uint8_t colour = colours.colour[member];
      chains.places[colours.begin[colour] + atomic_count_labelled(chains.count + colour)] = member;
    }
  }
  SIM_HD bool is_moving(std::uint32_t place) const {
    const Pair pair = contacts.ids[place];
    const std::uint8_t mark = max_of(contacts.struck[pair.a], contacts.struck[pair.b]);
    if (mark != 1) return mark > 1;
    return contacts.soft[place].impulse > 0 || !(contacts.soft[place].gap > contacts.near_gap);
  }
  SIM_HD bool has_moving_contact(std::uint32_t body) const {
    for (std::uint32_t k = 0; k < contacts.by_body.count[body]; ++k) {
      const std::uint32_t place = contacts.by_body.end(static_cast<int>(body), k).contact;
      const Pair pair = contacts.ids[place];
      if (has_few_contacts(degrees, pair.a == body ? pair.b : pair.a) && is_moving(place)) return true;
    }
    return false;
  }
};

}  // namespace

ChainContacts::ChainContacts(Executor& executor)
    : executor_(executor),
      members_(executor, "chain members"),
      member_count_(executor, "number of chain members"),
      count_(executor, "moving chain counts"),
      places_(executor, "moving chain contacts"),
      bodies_(executor, "moving chain bodies") {}

void ChainContacts::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  const auto n = static_cast<std::size_t>(bodies), m = static_cast<std::size_t>(contact_capacity);
  members_.resize_discarding(n + m);
  member_count_.resize_discarding(1);
  count_.resize_discarding(ChainView::counts);
  places_.resize_discarding(m);
  bodies_.resize_discarding(n);
}

void ChainContacts::list(const Pair* ids, const Colouring& colouring, const StepControl* control,
                         const std::uint8_t* asleep) {
  const Members chains{colouring.degrees().view().count, members_.data(), member_count_.data()};
  executor_.begin_stage("prepare");
  member_count_.fill_zero();
  executor_.run("prepare", ItemCount(&control->contacts, static_cast<std::int64_t>(places_.size())),
                ListContacts{chains, ids, colouring.view().colour});
  executor_.run("prepare", colouring.degrees().bodies(), OfAwakeBodies<ListBodies>{{chains}, asleep});
}

template <class Real>
void ChainContacts::list_moving(const MovingContacts<Real>& contacts, const Colouring& colouring) {
  executor_.run("solve", ItemCount(member_count_.data(), static_cast<std::int64_t>(members_.size())),
                ListMoving<Real>{contacts, colouring.view(), colouring.degrees().view().count,
                                 members_.data(), view()});
}
template void ChainContacts::list_moving<float>(const MovingContacts<float>&, const Colouring&);
template void ChainContacts::list_moving<double>(const MovingContacts<double>&, const Colouring&);

}  // namespace collidoscope
