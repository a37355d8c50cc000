#pragma once
// The last impact sweeps of a substep on a GPU, by one block (impact_sweeps.h). A sweep tests the bodies that
// the last one has changed, and their contacts, colour by colour.
//
// The block lists these bodies and contacts. It tests all listed contacts at the same time. Contacts before
// the lowest colour with an impact have none, and change nothing; so the block solves the contacts of this
// colour, lists the contacts of bodies that they have hit, and tests the contacts of later colours again. A
// sweep takes one test per colour with impacts, not one per colour.

#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/round_kernels.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/impact.h"

namespace collidoscope {

/// Memory of the last sweeps.
struct LastSweepLists {
  std::uint32_t* size_of = nullptr;  ///< by sweep, max_impact_sweeps numbers; 0 before the substep
  std::uint32_t* bodies = nullptr;   ///< tested in a sweep
  std::uint32_t* next = nullptr;     ///< tested in the next sweep
  std::uint32_t* places = nullptr;   ///< of the contacts to test
  std::uint32_t* listed = nullptr;   ///< a bit by place: it is in `places`; 0 before the substep

  /// Earlier sweeps change too many bodies.
  static constexpr int first_sweep = 2;
  /// Measured, H200: with 1024, a step of 50,000 falling spheres takes 19 % longer.
  static constexpr std::uint32_t most_bodies = 128;

  SIM_HD bool on() const { return bodies != nullptr; }
  SIM_HD std::uint32_t size(int sweep) const { return atomic_load(size_of + sweep); }
  /// Call for each body that the first round of a sweep tests.
  SIM_HD void add([[maybe_unused]] std::uint32_t id, [[maybe_unused]] int sweep) const {
#if defined(__CUDA_ARCH__)
    if (!on() || sweep < first_sweep) return;
    const auto group = cooperative_groups::coalesced_threads();
    std::uint32_t begin = 0;
    if (group.thread_rank() == 0) begin = atomicAdd(size_of + sweep, group.size());
    bodies[group.shfl(begin, 0) + group.thread_rank()] = id;
#endif
  }
  /// Call at the end of a substep.
  SIM_HD void clear() const {
    for (int sweep = 0; on() && sweep < max_impact_sweeps; ++sweep) size_of[sweep] = 0;
  }
};

#if defined(__CUDACC__)

/// A contact in the list.
template <class Real>
struct ListedContact {
  Real x, y, z;  ///< normal
  Pair ids;
  std::uint32_t place;
  int colour;  ///< Colouring::colours: none
};

/// Shared memory of the block.
template <class Real>
struct LastSweepMemory {
  static constexpr std::uint32_t most_contacts = 40'000 / sizeof(ListedContact<Real>);
  ListedContact<Real> contacts[most_contacts];  ///< the first ones; the others are loaded from their places
  std::uint32_t begin[Colouring::colours + 1];  ///< of the colours
  std::uint32_t bodies, next_bodies, places;    ///< numbers of entries in the lists
  std::uint32_t lowest;                         ///< colour, of find_colour()
};

/// The last sweeps, in one block. All threads of the block call the functions with a barrier.
template <class Sweeps>
struct LastSweeps {
  using Real = typename Sweeps::Number;
  using Contact = ListedContact<Real>;
  Sweeps sweeps;
  LastSweepLists lists;
  LastSweepMemory<Real>& memory;

  __device__ Contact load(std::uint32_t place) const {
    int low = 0,
        high = Colouring::colours + 1;  // begin[low] <= place, and place < begin[high] if there is one
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (place < memory.begin[middle] ? high : low) = middle;
    }
    const Vector3<Real> normal = sweeps.contacts.contacts.soft[place].normal;
    return {normal.x(), normal.y(), normal.z(), sweeps.contacts.contacts.ids[place], place, low};
  }
  __device__ Contact contact(std::uint32_t i) const {
    return i < LastSweepMemory<Real>::most_contacts ? memory.contacts[i] : load(lists.places[i]);
  }
  __device__ bool is_tested(int sweep, const Contact& contact) const {
    return sweeps.approaches(sweep, contact.ids, Vector3<Real>(contact.x, contact.y, contact.z));
  }
  /// Lists the contacts of bodies [first, memory.bodies) that are not listed yet.
  __device__ void list_contacts(std::uint32_t first) const {
    const unsigned threads_per_body = blockDim.x < 8 ? blockDim.x : 8;
    const StruckMarks& struck = sweeps.contacts.act.struck;
    if (struck.control->contacts > 0) {
      const unsigned lane = threadIdx.x % threads_per_body;
      for (std::uint32_t i = first + threadIdx.x / threads_per_body; i < memory.bodies;
           i += blockDim.x / threads_per_body) {
        const std::uint32_t id = lists.bodies[i], n = struck.contacts_of.count[id];
        for (std::uint32_t k = lane; k < n; k += threads_per_body)
          list_contact(struck.contacts_of.end(static_cast<int>(id), k).contact);
      }
    }
    __syncthreads();
  }
  __device__ void list_contact(std::uint32_t place) const {
    const std::uint32_t bit = 1u << place % 32;
    if ((atomicOr(lists.listed + place / 32, bit) & bit) != 0) return;
    const std::uint32_t i = atomicAdd(&memory.places, 1u);
    lists.places[i] = place;
    if (i < LastSweepMemory<Real>::most_contacts) memory.contacts[i] = load(place);
  }
  /// Returns the lowest colour from `first` on that has a contact to solve, or Colouring::colours.
  __device__ int find_colour(int sweep, int first) const {
    if (threadIdx.x == 0) memory.lowest = Colouring::colours;
    __syncthreads();
    std::uint32_t lowest = Colouring::colours;
    for (std::uint32_t i = threadIdx.x; i < memory.places; i += blockDim.x) {
      const Contact k = contact(i);
      const auto colour = static_cast<std::uint32_t>(k.colour);
      if (k.colour >= first && colour < lowest && is_tested(sweep, k)) lowest = colour;
    }
    if (lowest < Colouring::colours) atomicMin(&memory.lowest, lowest);
    __syncthreads();
    return static_cast<int>(memory.lowest);
  }
  /// Solves the listed contacts of a colour. Adds the bodies that they hit to the list.
  __device__ void solve(int sweep, int colour) const {
    const auto contacts = sweeps.contacts_in(sweep);
    const std::uint8_t* const struck = contacts.act.struck.body;
    for (std::uint32_t i = threadIdx.x; i < memory.places; i += blockDim.x) {
      const Contact k = contact(i);
      if (k.colour != colour || !is_tested(sweep, k)) continue;
      const bool a_listed = struck[k.ids.a] > sweep, b_listed = struck[k.ids.b] > sweep;
      run_item(contacts, colour, static_cast<int>(k.place - memory.begin[colour]));
      if (!a_listed && struck[k.ids.a] > sweep) lists.bodies[atomicAdd(&memory.bodies, 1u)] = k.ids.a;
      if (!b_listed && struck[k.ids.b] > sweep) lists.bodies[atomicAdd(&memory.bodies, 1u)] = k.ids.b;
    }
    __syncthreads();
  }
  /// Lists the bodies that the sweep has changed for the next one.
  __device__ void list_changed(int sweep) {
    if (threadIdx.x == 0) memory.next_bodies = 0;
    for (std::uint32_t i = threadIdx.x; i < memory.places; i += blockDim.x)
      atomicAnd(lists.listed + lists.places[i] / 32, ~(1u << lists.places[i] % 32));
    __syncthreads();
    for (std::uint32_t i = threadIdx.x; i < memory.bodies; i += blockDim.x)
      if (sweeps.contacts.act.struck.body[lists.bodies[i]] > sweep + 1)
        lists.next[atomicAdd(&memory.next_bodies, 1u)] = lists.bodies[i];
    __syncthreads();
    if (threadIdx.x == 0) {
      memory.bodies = memory.next_bodies;
      memory.places = 0;
    }
    std::uint32_t* const next = lists.next;
    lists.next = lists.bodies;
    lists.bodies = next;
    __syncthreads();
  }
};

/// Runs `sweep` after its first round, which has listed its bodies, and the sweeps after it. For one block.
/// Precondition: no contact is without a colour.
template <class Sweeps>
__device__ void run_last_sweeps(const Sweeps& sweeps, int sweep) {
  __shared__ LastSweepMemory<typename Sweeps::Number> memory;
  for (unsigned colour = threadIdx.x; colour <= Colouring::colours; colour += blockDim.x)
    memory.begin[colour] = sweeps.contacts.contacts.begin[colour];
  if (threadIdx.x == 0) {
    memory.bodies = sweeps.last.size(sweep);
    memory.places = 0;
  }
  LastSweeps<Sweeps> block{sweeps, sweeps.last, memory};
  block.sweeps.last = {};  // the first rounds list nothing
  __syncthreads();
  while (true) {
    block.list_contacts(0);
    for (int colour = block.find_colour(sweep, 0); colour < Colouring::colours;
         colour = block.find_colour(sweep, colour + 1)) {
      const std::uint32_t known = memory.bodies;
      __syncthreads();
      block.solve(sweep, colour);
      block.list_contacts(known);
    }
    block.list_changed(sweep++);
    if (sweep == max_impact_sweeps || atomic_load(sweeps.needed + sweep) == 0) return;
    for (std::uint32_t i = threadIdx.x; i < memory.bodies; i += blockDim.x)
      block.sweeps.bounce_off_walls(sweep, static_cast<int>(block.lists.bodies[i]));
    __syncthreads();
  }
}

#endif

}  // namespace collidoscope
