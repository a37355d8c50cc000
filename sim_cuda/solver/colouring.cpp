#include "sim_cuda/solver/colouring.h"

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

namespace {

// Sort keys: 0 to colours-1 are colours. The mass-split set follows, then the unused entries.
constexpr std::uint8_t uncoloured = Colouring::colours;
constexpr std::uint8_t no_colour_free = Colouring::colours + 1;
constexpr std::uint8_t unused = Colouring::colours + 2;
constexpr int key_bits = 6;
static_assert(unused < (1 << key_bits));

/// Bit beside a colour: proposed, not decided yet.
constexpr std::uint8_t tentative = 0x40;

/// Priority of a proposal. It is unique: ties of the hash are broken by the contact number, which depends
/// only on the ids. Later rounds have higher values, so proposals need no clearing between rounds.
SIM_HD inline std::uint64_t proposal(std::uint64_t hash, std::uint32_t round, std::uint32_t contact) {
  return static_cast<std::uint64_t>(round + 1) << 56 | (hash & 0x00ffffff00000000u) | contact;
}

/// Index of the n-th set bit, from the lowest. Precondition: more than n bits are set.
SIM_HD inline std::uint8_t nth_set_bit(std::uint32_t bits, std::uint32_t n) {
  while (n-- > 0) bits &= bits - 1;
  return static_cast<std::uint8_t>(count_bits((bits & -bits) - 1));
}

struct BeginBodies {
  DegreeView degrees;
  ColouredBody* bodies;
  SIM_HD void operator()(int body) const {
    const std::uint32_t degree = degrees.count[body];
    bodies[body] = {0, degree, degree > 0 ? 2 * degrees.begin[body] : 0};
  }
};

/// The proposal slot of a colour at a body. A body has min(2 * degree, colours) slots.
SIM_HD inline std::uint64_t* proposal_slot(std::uint64_t* proposals, const ColouredBody& body,
                                           std::uint8_t colour) {
  const std::uint32_t places = min_of(2 * body.degree, static_cast<std::uint32_t>(Colouring::colours));
  return proposals + body.proposals + colour % places;
}
constexpr std::uint32_t proposals_per_contact = 4;  // two per contact end, two ends

struct ClearContacts {
  std::uint8_t first;  // initial colour
  const StepControl* control;
  std::uint8_t* colour;
  std::uint32_t* contact;
  std::uint64_t* proposals;
  SIM_HD void operator()(int k) const {
    contact[k] = static_cast<std::uint32_t>(k);
    const bool exists = static_cast<std::uint32_t>(k) < control->contacts;
    colour[k] = exists ? first : unused;
    if (!exists || proposals == nullptr) return;
    for (std::uint32_t i = 0; i < proposals_per_contact; ++i)
      proposals[proposals_per_contact * static_cast<std::uint64_t>(k) + i] = 0;
  }
};

struct ExcludeSleeping {
  const Pair* contacts;
  const std::uint8_t* asleep;
  std::uint8_t* colour;
  SIM_HD void operator()(int contact) const {
    if (asleep[contacts[contact].a] || asleep[contacts[contact].b]) colour[contact] = unused;
  }
};

/// Flags: does a round have uncoloured contacts? Thousands of warps set the flag at about the same time.
/// Each round has 16 copies in separate sectors, so that the stores do not serialize.
struct Pending {
  static constexpr std::uint32_t places = 16, apart = 8;  // 8 words = 32 bytes, one sector

  std::uint32_t* flags;

  SIM_HD std::uint32_t* place(std::uint32_t round, std::uint32_t k) const {
    return flags + (round * places + k) * apart;
  }
  SIM_HD void raise(std::uint32_t round, std::uint32_t contact) const {
    atomic_store(place(round, contact / 32 % places), std::uint32_t{1});
  }
  SIM_HD bool any(std::uint32_t round) const {
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
      *pending.place(static_cast<std::uint32_t>(round), k) = round == 0 && control->contacts > 0;
  }
};

/// Each round has two halves. First all contacts propose; then those that won at both bodies take the
/// colour.
struct ProposeInRounds {
  const Pair* contacts;
  const StepControl* control;
  std::int64_t capacity;
  ColouredBody* bodies;
  std::uint64_t* proposals;
  std::uint8_t* colour;
  Pending pending;

  SIM_HD std::int64_t items(int half) const {
    return pending.any(static_cast<std::uint32_t>(half) / 2)
               ? min_of(static_cast<std::int64_t>(control->contacts), capacity)
               : 0;
  }
  SIM_HD void operator()(int half, int contact) const {
    const std::uint32_t round = static_cast<std::uint32_t>(half) / 2,
                        number = static_cast<std::uint32_t>(contact);
    half % 2 == 0 ? propose(round, number) : decide(round, number);
  }
  struct Half;
  Half round(int half) const;

  SIM_HD static std::uint64_t hash_of(Pair pair) {
    return mix64(static_cast<std::uint64_t>(pair.a) << 32 | pair.b);
  }

  SIM_HD void propose(std::uint32_t round, std::uint32_t contact) const {
    if (colour[contact] != uncoloured) return;
    const Pair pair = contacts[contact];
    const ColouredBody a = bodies[pair.a], b = bodies[pair.b];
    const std::uint32_t free = ~(a.used | b.used);
    if (free == 0) {
      colour[contact] = no_colour_free;
      return;
    }
    // Each coloured contact has set one bit in `used`.
    const std::uint32_t left = max_of(a.degree - count_bits(a.used), b.degree - count_bits(b.used));
    const std::uint32_t choices = min_of((left + 1) / 2, count_bits(free));
    const std::uint64_t hash = hash_of(pair);
    const auto random = static_cast<std::uint32_t>(mix64(hash + round));
    const std::uint8_t chosen =
        nth_set_bit(free, static_cast<std::uint32_t>(static_cast<std::uint64_t>(random) * choices >> 32));
    colour[contact] = chosen | tentative;
    atomic_max_unchecked(proposal_slot(proposals, a, chosen), proposal(hash, round, contact));
    atomic_max_unchecked(proposal_slot(proposals, b, chosen), proposal(hash, round, contact));
  }

  SIM_HD void decide(std::uint32_t round, std::uint32_t contact) const {
    if ((colour[contact] & tentative) == 0) return;
    const std::uint8_t chosen = colour[contact] & static_cast<std::uint8_t>(~tentative);
    const Pair pair = contacts[contact];
    const std::uint64_t own = proposal(hash_of(pair), round, contact);
    if (*proposal_slot(proposals, bodies[pair.a], chosen) == own &&
        *proposal_slot(proposals, bodies[pair.b], chosen) == own) {
      colour[contact] = chosen;
      atomic_or(&bodies[pair.a].used, std::uint32_t{1} << chosen);
      atomic_or(&bodies[pair.b].used, std::uint32_t{1} << chosen);
    } else {
      colour[contact] = uncoloured;
      pending.raise(round + 1, contact);
    }
  }
};
struct ProposeInRounds::Half {
  ProposeInRounds rounds;
  int number;
  SIM_HD void operator()(int contact) const { rounds(number, contact); }
  ItemMarks marks() const { return {rounds.colour, number % 2 == 0 ? uncoloured : tentative}; }
};
ProposeInRounds::Half ProposeInRounds::round(int half) const { return {*this, half}; }
static_assert(Colouring::colours == 32, "a 32-bit word has one bit per colour");

/// Finds the start of each colour in the sorted keys, by lower bound.
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
    const bool uncoloured_set = c == Colouring::colours;
    begin[c] = lower_bound(static_cast<std::uint8_t>(c));
    count[c] = lower_bound(uncoloured_set ? unused : static_cast<std::uint8_t>(c + 1)) - begin[c];
    if (uncoloured_set) control->uncoloured_contacts = count[c];
  }
};

}  // namespace

Colouring::Colouring(Executor& executor, bool enabled)
    : executor_(executor),
      enabled_(enabled),
      degrees_(executor),
      proposals_(executor, "colouring proposals"),
      coloured_(executor, "body colours"),
      pending_(executor, "colouring state"),
      colour_(executor, "contact colours"),
      sorted_colour_(executor, "sorted contact colours"),
      contact_(executor, "contact numbers"),
      order_(executor, "contacts by colour"),
      begin_(executor, "colour starts"),
      count_(executor, "colour sizes"),
      temporary_(executor, "colour sort workspace") {}

void Colouring::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  const auto contacts = static_cast<std::size_t>(contact_capacity);
  degrees_.reserve(bodies, contact_capacity);
  if (enabled_) {
    proposals_.resize_discarding(proposals_per_contact * contacts);
    coloured_.resize_discarding(static_cast<std::size_t>(bodies));
    pending_.resize_discarding((rounds + 1) * Pending::places * Pending::apart);
  }
  colour_.resize_discarding(contacts);
  sorted_colour_.resize_discarding(contacts);
  contact_.resize_discarding(contacts);
  order_.resize_discarding(contacts);
  begin_.resize_discarding(colours + 1);
  count_.resize_discarding(colours + 1);
  temporary_.resize_discarding(sort_temporary_bytes<std::uint8_t>(executor_, contact_capacity, key_bits));
}

void Colouring::colour(const Pair* contacts, StepControl* control, const std::uint8_t* asleep) {
  const auto capacity = static_cast<std::int64_t>(order_.size());
  const ContactSet all{contacts, nullptr, nullptr, &control->contacts};
  degrees_.count("colour", all);
  executor_.run("colour", capacity,
                ClearContacts{enabled_ ? uncoloured : no_colour_free, control, colour_.data(),
                              contact_.data(), proposals_.data()});
  if (asleep != nullptr)
    executor_.run("colour", ItemCount(&control->contacts, capacity),
                  ExcludeSleeping{contacts, asleep, colour_.data()});
  if (enabled_) {
    executor_.run("colour", degrees_.bodies(), BeginBodies{degrees_.view(), coloured_.data()});
    executor_.run("colour", rounds + 1, ClearRounds{control, {pending_.data()}});
    executor_.run_rounds("colour", 2 * rounds, capacity,
                         ProposeInRounds{contacts,
                                         control,
                                         capacity,
                                         coloured_.data(),
                                         proposals_.data(),
                                         colour_.data(),
                                         {pending_.data()}});
  }
  sort_by_key(executor_, "colour", capacity, key_bits, colour_.data(), sorted_colour_.data(), contact_.data(),
              order_.data(), temporary_.data(), temporary_.bytes());
  executor_.run("colour", colours + 1,
                FindColours{sorted_colour_.data(), static_cast<std::uint32_t>(capacity), begin_.data(),
                            count_.data(), control});
}

}  // namespace collidoscope
