#include "sim_cuda/narrow_phase/contact_list.h"

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/scan.h"

namespace collidoscope {

namespace {

/// Tests whether a body touches others, now or within the margin. `with_margin`: any bound except
/// MotionBound::none. It is a template parameter because a run-time branch costs 1 % of a step of the solver
/// `impulse` (50,000 bodies of the paper, H200).
template <class Real, bool with_margin>
struct TouchTest {
  SphereView<Real> spheres;
  SpeculativeMargin<Real> margin;
  Vector3<Real> x, v;
  Real r;
  SIM_HD TouchTest(const SphereView<Real>& all, const SpeculativeMargin<Real>& speculative, int body)
      : spheres(all), margin(speculative), x(all.position[body]), r(all.radius[body]) {
    if constexpr (with_margin) v = speculative.velocity[body];
  }
  SIM_HD bool with(std::uint32_t other) const {
    const Vector3<Real> y = spheres.position[other];
    const Real s = spheres.radius[other];
    if constexpr (with_margin)
      return spheres_will_touch<Real>(x, r, v, y, s, margin.velocity[other], margin);
    else
      return spheres_touch<Real>(x, r, y, s);
  }
};

/// The pairs of a body (the one with the smaller id), and the test whether they are contacts. `excluding`:
/// some pairs are excluded. It is a template parameter because a run-time branch costs 4 % of a step of the
/// solver `impulse` (as above).
template <class Real, bool with_margin, bool excluding>
struct TestedPairs {
  PairView pairs;
  SphereView<Real> spheres;
  SpeculativeMargin<Real> margin;
  ExcludedPairs excluded_pairs;
  const StepControl* control;

  SIM_HD TouchTest<Real, with_margin> of(int body) const { return {spheres, margin, body}; }
  SIM_HD std::uint32_t begin(int body) const { return pairs.offset[body]; }
  SIM_HD std::uint32_t end(int body) const { return pairs.offset[body + 1]; }
  SIM_HD bool is_contact(const TouchTest<Real, with_margin>& touch, int body, std::uint32_t k) const {
    const std::uint32_t other = pairs.second[k];
    return touch.with(other) && !(excluding && excluded(static_cast<std::uint32_t>(body), other));
  }
  SIM_HD bool is_large(int body) const {
    return !control->overflow && end(body) - begin(body) > large_list_size;
  }

 private:
  /// Two kinematic or static bodies, or two bodies connected by a joint, have no contact.
  SIM_HD bool excluded(std::uint32_t a, std::uint32_t b) const {
    const Real* inverse_mass = spheres.inverse_mass;
    if (inverse_mass != nullptr && inverse_mass[a] == 0 && inverse_mass[b] == 0) return true;
    return excluded_pairs.count > 0 && excluded_pairs.contains(a, b);
  }
};

template <class Real, bool with_margin, bool excluding>
struct CountContacts {
  TestedPairs<Real, with_margin, excluding> tested;
  std::uint32_t* count;
  SIM_HD void operator()(int body) const {
    if (tested.control->overflow) return;
    const auto touch = tested.of(body);
    std::uint32_t touching = 0;
    for (std::uint32_t k = tested.begin(body); k < tested.end(body); ++k)
      touching += tested.is_contact(touch, body, k);
    count[body] = touching;
  }

  SIM_HD bool is_large(int body) const { return tested.is_large(body); }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    const auto touch = tested.of(body);
    BlockRanks ranks;
    for (std::uint32_t from = tested.begin(body), end = tested.end(body); from < end; from += blockDim.x)
      ranks.rank(from + threadIdx.x < end && tested.is_contact(touch, body, from + threadIdx.x));
    if (threadIdx.x == 0) count[body] = ranks.total();
  }
#endif
};

struct AcceptContacts {
  const std::uint32_t* total;
  std::uint64_t capacity;
  StepControl* control;
  SIM_HD void operator()(int) const {
    control->contacts = 0;
    if (control->overflow) return;
    control->contacts_needed = *total;
    if (*total > capacity)
      control->overflow = 1;
    else
      control->contacts = *total;
  }
};

template <class Real, bool with_margin, bool excluding>
struct WriteContacts {
  TestedPairs<Real, with_margin, excluding> tested;
  const std::uint32_t* offset;
  Pair* bodies_of;
  Vector3<Real>* normal;
  SIM_HD void operator()(int body) const {
    if (has_none(body)) return;
    const auto touch = tested.of(body);
    std::uint32_t at = offset[body];
    for (std::uint32_t k = tested.begin(body); k < tested.end(body); ++k)
      if (tested.is_contact(touch, body, k)) write(touch, body, k, at++);
  }

  SIM_HD bool is_large(int body) const { return tested.is_large(body) && !has_none(body); }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    const auto touch = tested.of(body);
    BlockRanks ranks;
    for (std::uint32_t from = tested.begin(body), end = tested.end(body); from < end; from += blockDim.x) {
      const std::uint32_t k = from + threadIdx.x;
      const bool found = k < end && tested.is_contact(touch, body, k);
      const std::uint32_t rank = ranks.rank(found);
      if (found) write(touch, body, k, offset[body] + rank);
    }
  }
#endif

 private:
  SIM_HD bool has_none(int body) const {
    return tested.control->overflow || offset[body] == offset[body + 1];
  }
  SIM_HD void write(const TouchTest<Real, with_margin>& touch, int body, std::uint32_t k,
                    std::uint32_t at) const {
    const std::uint32_t other = tested.pairs.second[k];
    bodies_of[at] = {static_cast<std::uint32_t>(body), other};
    normal[at] =
        separate<Real>(touch.x, touch.r, tested.spheres.position[other], tested.spheres.radius[other]).normal;
  }
};

}  // namespace

template <class Real>
ContactList<Real>::ContactList(Executor& executor)
    : executor_(executor),
      count_(executor, "contacts per body"),
      offset_(executor, "contact offsets"),
      bodies_of_(executor, "contact bodies"),
      normal_(executor, "contact normals"),
      temporary_(executor, "scan workspace") {}

template <class Real>
void ContactList<Real>::reserve(std::int64_t bodies, std::int64_t capacity) {
  bodies_ = bodies;
  count_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  offset_.resize_discarding(static_cast<std::size_t>(bodies) + 1);
  bodies_of_.resize_discarding(static_cast<std::size_t>(capacity));
  normal_.resize_discarding(static_cast<std::size_t>(capacity));
  temporary_.resize_discarding(scan_temporary_bytes(executor_, bodies));
  executor_.fill(count_.data(), 0, count_.bytes());
}

template <class Real>
void ContactList<Real>::find(const PairView& pairs, const SphereView<Real>& spheres,
                             const SpeculativeMargin<Real>& margin, const ExcludedPairs& excluded_pairs,
                             StepControl* control) {
  const auto with = [&]<bool with_margin, bool excluding>() {
    const TestedPairs<Real, with_margin, excluding> tested{pairs, spheres, margin, excluded_pairs, control};
    executor_.run("contacts", bodies_, CountContacts<Real, with_margin, excluding>{tested, count_.data()});
    exclusive_scan(executor_, "contacts", bodies_, count_.data(), offset_.data(), temporary_.data(),
                   temporary_.bytes());
    executor_.run("contacts", 1, AcceptContacts{offset_.data() + bodies_, bodies_of_.size(), control});
    executor_.run("contacts", bodies_,
                  WriteContacts<Real, with_margin, excluding>{tested, offset_.data(), bodies_of_.data(),
                                                              normal_.data()});
  };
  const bool with_margin = margin.bound != MotionBound::none;
  if (excluded_pairs.count > 0 || spheres.inverse_mass != nullptr)
    with_margin ? with.template operator()<true, true>() : with.template operator()<false, true>();
  else
    with_margin ? with.template operator()<true, false>() : with.template operator()<false, false>();
}

template class ContactList<float>;
template class ContactList<double>;

}  // namespace collidoscope
