#include "sim_cuda/solver/colouring.h"

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

namespace {

// Sort keys: 0 .. colours-1 are colours; the split set follows, then the unused part of the buffers.
constexpr std::uint8_t uncoloured = Colouring::colours;
constexpr std::uint8_t no_colour_free = Colouring::colours + 1;
constexpr std::uint8_t unused = Colouring::colours + 2;
constexpr int key_bits = 6;
static_assert(unused < (1 << key_bits));

/// Unique, and independent of how contacts are numbered up to order: ties of the hash go by ids.
SIM_HD inline std::uint64_t priority(Pair bodies, std::uint32_t contact) {
  const std::uint64_t ids = static_cast<std::uint64_t>(bodies.a) << 32 | bodies.b;
  return (mix64(ids) & 0xffffffff00000000u) | (static_cast<std::uint64_t>(contact) + 1);
}

struct ClearBodies {
  std::uint64_t* best;
  std::uint32_t *used, *full_since;
  std::uint32_t bodies;
  SIM_HD void operator()(int body) const {
    for (std::uint32_t k = 0; k < 3; ++k) best[k * bodies + static_cast<std::uint32_t>(body)] = 0;
    used[body] = 0;
    full_since[body] = ~std::uint32_t{0};
  }
};

struct ClearContacts {
  const StepControl* control;
  std::uint8_t* colour;
  std::uint32_t* contact;
  SIM_HD void operator()(int k) const {
    colour[k] = static_cast<std::uint32_t>(k) < control->contacts ? uncoloured : unused;
    contact[k] = static_cast<std::uint32_t>(k);
  }
};

/// Whether a round has contacts to look at. Thousands of warps say so at about the same time: each of them in
/// one of some places, far enough apart for the memory to take them side by side.
struct Pending {
  static constexpr std::uint32_t places = 16, apart = 8;  // 32 bytes: a sector

  std::uint32_t* flags;

  SIM_HD std::uint32_t* place(int round, std::uint32_t k) const {
    return flags + (static_cast<std::uint32_t>(round) * places + k) * apart;
  }
  SIM_HD void raise(int round, int contact) const {
    atomic_store(place(round, static_cast<std::uint32_t>(contact) / 32 % places), std::uint32_t{1});
  }
  SIM_HD bool any(int round) const {
    std::uint32_t raised = 0;
    for (std::uint32_t k = 0; k < places; ++k) raised |= *place(round, k);
    return raised != 0;
  }
};

struct ClearRounds {
  const StepControl* control;
  Pending pending;
  SIM_HD void operator()(int round) const {
    for (std::uint32_t k = 0; k < Pending::places; ++k)
      *pending.place(round, k) = round == 0 && control->contacts > 0;
  }
};

/// In each round: decide by the bids of the round before, bid for the next one, clear the bids after that.
struct BidInRounds {
  const Pair* contacts;
  const StepControl* control;
  std::int64_t capacity;
  std::uint32_t bodies;
  std::uint64_t* best;
  std::uint32_t *used, *full_since;
  std::uint8_t* colour;
  Pending pending;

  SIM_HD std::int64_t items(int round) const {
    return pending.any(round) ? min_of(static_cast<std::int64_t>(control->contacts), capacity) : 0;
  }
  SIM_HD std::uint64_t* bids_of(std::uint32_t round) const {
    return best + round % 3 * std::uint64_t{bodies};
  }

  SIM_HD void take(std::uint32_t body, std::uint32_t bit, std::uint32_t round) const {
    used[body] |= bit;
    if (used[body] == ~std::uint32_t{0}) atomic_store(&full_since[body], round);
  }

  SIM_HD void operator()(int now, int contact) const {
    if (colour[contact] != uncoloured) return;
    const auto round = static_cast<std::uint32_t>(now);
    const std::uint64_t* decided = bids_of(round);
    std::uint64_t *bids = bids_of(round + 1), *cleared = bids_of(round + 2);
    const Pair pair = contacts[contact];
    const std::uint64_t mine = priority(pair, static_cast<std::uint32_t>(contact));
    if (round > 0 && decided[pair.a] == mine && decided[pair.b] == mine) {
      // No other contact at either body decides in this round, so the masks are this contact's alone.
      const std::uint32_t taken = used[pair.a] | used[pair.b];
      if (taken == ~std::uint32_t{0}) {
        colour[contact] = no_colour_free;
        return;
      }
      const std::uint32_t lowest_free = ~taken & (taken + 1);
      take(pair.a, lowest_free, round);
      take(pair.b, lowest_free, round);
      std::uint8_t c = 0;
      while ((lowest_free >> c) != 1) ++c;
      colour[contact] = c;
      return;
    }
    // A body without a free colour can be given up at once, but only where that was known before this round
    // began.
    if (atomic_load(&full_since[pair.a]) < round || atomic_load(&full_since[pair.b]) < round) {
      colour[contact] = no_colour_free;
      return;
    }
    atomic_max(&bids[pair.a], mine);
    atomic_max(&bids[pair.b], mine);
    atomic_store(&cleared[pair.a], std::uint64_t{0});
    atomic_store(&cleared[pair.b], std::uint64_t{0});
    pending.raise(now + 1, contact);
  }
};
static_assert(Colouring::colours == 32, "one bit of a word per colour");

/// Where each colour starts in the sorted keys: a lower bound.
struct FindColours {
  const std::uint8_t* sorted;
  std::uint32_t size;
  std::uint32_t *begin, *count;
  StepControl* control;
  SIM_HD std::uint32_t lower_bound(std::uint8_t key) const {
    std::uint32_t low = 0, high = size;
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (sorted[middle] < key)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }
  SIM_HD void operator()(int c) const {
    const bool split = c == Colouring::colours;
    begin[c] = lower_bound(static_cast<std::uint8_t>(c));
    count[c] = lower_bound(split ? unused : static_cast<std::uint8_t>(c + 1)) - begin[c];
    if (split) control->split_contacts = count[c];
  }
};

}  // namespace

Colouring::Colouring(Executor& executor)
    : executor_(executor),
      best_(executor, "colouring bids"),
      used_(executor, "colours used"),
      full_since_(executor, "rounds in which colours ran out"),
      pending_(executor, "colouring rounds"),
      colour_(executor, "contact colours"),
      sorted_colour_(executor, "sorted contact colours"),
      contact_(executor, "contact numbers"),
      order_(executor, "contacts by colour"),
      begin_(executor, "colour starts"),
      count_(executor, "colour sizes"),
      temporary_(executor, "colour sort workspace") {}

void Colouring::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  bodies_ = bodies;
  const auto contacts = static_cast<std::size_t>(contact_capacity);
  best_.resize_discarding(3 * static_cast<std::size_t>(bodies));
  used_.resize_discarding(static_cast<std::size_t>(bodies));
  full_since_.resize_discarding(static_cast<std::size_t>(bodies));
  pending_.resize_discarding((rounds + 2) * Pending::places * Pending::apart);
  colour_.resize_discarding(contacts);
  sorted_colour_.resize_discarding(contacts);
  contact_.resize_discarding(contacts);
  order_.resize_discarding(contacts);
  begin_.resize_discarding(colours + 1);
  count_.resize_discarding(colours + 1);
  temporary_.resize_discarding(sort_temporary_bytes<std::uint8_t>(executor_, contact_capacity, key_bits));
}

void Colouring::colour(const Pair* contacts, StepControl* control) {
  const auto capacity = static_cast<std::int64_t>(order_.size());
  const auto bodies = static_cast<std::uint32_t>(bodies_);
  executor_.run("colour", bodies_, ClearBodies{best_.data(), used_.data(), full_since_.data(), bodies});
  executor_.run("colour", capacity, ClearContacts{control, colour_.data(), contact_.data()});
  executor_.run("colour", rounds + 2, ClearRounds{control, {pending_.data()}});
  executor_.run_rounds("colour", rounds + 1, capacity,
                       BidInRounds{contacts,
                                   control,
                                   capacity,
                                   bodies,
                                   best_.data(),
                                   used_.data(),
                                   full_since_.data(),
                                   colour_.data(),
                                   {pending_.data()}});
  sort_by_key(executor_, "colour", capacity, key_bits, colour_.data(), sorted_colour_.data(), contact_.data(),
              order_.data(), temporary_.data(), temporary_.bytes());
  executor_.run("colour", colours + 1,
                FindColours{sorted_colour_.data(), static_cast<std::uint32_t>(capacity), begin_.data(),
                            count_.data(), control});
}

}  // namespace collidoscope
