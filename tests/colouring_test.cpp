// Tests the graph colouring of contacts against its definition, at every launch shape. Contacts of one colour
// are solved in parallel, so they may share no body.
#include "sim_cuda/solver/colouring.h"

#include <algorithm>
#include <set>

#include "sim_cuda/solver/chain_contacts.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "tests/executors.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

struct Coloured {
  std::vector<std::vector<std::uint32_t>> colours;  ///< contact numbers by colour; the last is the split set
  std::vector<std::uint32_t> used;                  ///< bit mask of used colours, by body
};

class ColouringTest : public OnEachExecutor {
 protected:
  Coloured colour(const std::vector<Pair>& contacts, std::uint32_t bodies, RunOptions o) {
    Executor executor(o);
    Colouring colouring(executor);
    const auto capacity = static_cast<std::int64_t>(contacts.size()) + 13;  // surplus capacity stays unused
    colouring.reserve(bodies, capacity);
    Buffer<Pair> pairs(executor, "contacts");
    pairs.upload(contacts);
    Buffer<StepControl> control(executor, "control");
    StepControl c{};
    c.contacts = static_cast<std::uint32_t>(contacts.size());
    control.upload({c});
    colouring.colour(pairs.data(), control.data());
    executor.synchronize();

    std::vector<std::uint32_t> begin(Colouring::colours + 1), count(Colouring::colours + 1);
    std::vector<std::uint32_t> order(static_cast<std::size_t>(capacity));
    executor.copy_to_host(begin.data(), colouring.view().begin, begin.size() * 4);
    executor.copy_to_host(count.data(), colouring.view().count, count.size() * 4);
    executor.copy_to_host(order.data(), colouring.view().order, order.size() * 4);
    Coloured result;
    for (std::size_t k = 0; k < begin.size(); ++k)
      result.colours.emplace_back(order.begin() + begin[k], order.begin() + begin[k] + count[k]);
    EXPECT_EQ(control.download()[0].uncoloured_contacts, count.back());
    std::vector<std::uint8_t> colour_of(order.size());
    executor.copy_to_host(colour_of.data(), colouring.view().colour, colour_of.size());
    for (std::size_t j = 0; j < Colouring::colours; ++j)
      for (std::uint32_t k = begin[j]; k < begin[j] + count[j]; ++k) EXPECT_EQ(colour_of[k], j);
    std::vector<ColouredBody> coloured(bodies);
    executor.copy_to_host(coloured.data(), colouring.view().bodies, coloured.size() * sizeof coloured[0]);
    for (const ColouredBody& body : coloured) result.used.push_back(body.used);
    return result;
  }

  /// Checks the colouring: every contact occurs exactly once, no body occurs twice in a colour, and no
  /// contact with a free colour is in the split set.
  void expect_proper(const Coloured& coloured, const std::vector<Pair>& contacts, std::uint32_t bodies) {
    std::vector<int> seen(contacts.size(), 0);
    std::vector<std::set<std::size_t>> used(bodies);
    for (std::size_t c = 0; c < coloured.colours.size(); ++c) {
      std::set<std::uint32_t> touched;
      for (const std::uint32_t contact : coloured.colours[c]) {
        ++seen[contact];
        if (c == Colouring::colours) continue;
        EXPECT_TRUE(touched.insert(contacts[contact].a).second);
        EXPECT_TRUE(touched.insert(contacts[contact].b).second);
        used[contacts[contact].a].insert(c);
        used[contacts[contact].b].insert(c);
      }
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
  }
};
ON_EACH_EXECUTOR(ColouringTest);

std::vector<Pair> random_contacts(std::uint32_t bodies, std::size_t count, unsigned seed) {
  Random random(seed);
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  while (pairs.size() < count) {
    const std::uint32_t a = random() % bodies, b = random() % bodies;
    if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
  }
  std::vector<Pair> contacts;
  for (const auto& [a, b] : pairs) contacts.push_back({a, b});
  return contacts;
}

TEST_P(ColouringTest, IsProperAndCompleteOnRandomGraphs) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::uint32_t bodies = 50 + 40 * seed;
    const auto contacts = random_contacts(bodies, bodies * 3, seed);
    const Coloured coloured = colour(contacts, bodies, options());
    expect_proper(coloured, contacts, bodies);
    EXPECT_TRUE(coloured.colours.back().empty()) << "six contacts a body need no mass splitting";
  }
}

/// Passes over chains visit no other colours.
TEST_P(ColouringTest, ChainContactsHaveTheLowestColours) {
  std::size_t highest = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto contacts = random_contacts(2000, 1500 + 300 * (seed % 10), seed);
    std::vector<std::uint32_t> degree(2000);
    for (const Pair& pair : contacts) ++degree[pair.a], ++degree[pair.b];
    const Coloured coloured = colour(contacts, 2000, options());
    for (std::size_t c = 0; c < coloured.colours.size(); ++c)
      for (const std::uint32_t contact : coloured.colours[c])
        if (std::max(degree[contacts[contact].a], degree[contacts[contact].b]) <=
            ChainContacts::most_contacts)
          highest = std::max(highest, c);
  }
  EXPECT_EQ(highest, ChainView::colours - 1u);
}

TEST_P(ColouringTest, AHubOverflowsIntoTheSplitSet) {
  std::vector<Pair> contacts;
  for (std::uint32_t b = 1; b <= 500; ++b) contacts.push_back({0, b});
  const Coloured coloured = colour(contacts, 501, options());
  expect_proper(coloured, contacts, 501);
  EXPECT_EQ(coloured.colours.back().size(),
            500u - Colouring::colours);  // the hub uses every colour once
}

TEST_P(ColouringTest, DoesNotDependOnTheOrderOfWork) {
  const auto contacts = random_contacts(300, 3000, 9);  // 20 contacts per body, also saturated bodies
  RunOptions first = options();
  const Coloured expected = colour(contacts, 300, first);
  for (const LaunchShape shape :
       {LaunchShape{1, 1}, LaunchShape{2, 4}, LaunchShape{3, 37}, LaunchShape{8, 64},
        LaunchShape{5000, 512}})  // more than a GPU runs at once
    for (const LaneOrder order : {LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled})
      for (const int threads : {1, 2}) {
        RunOptions o = options();
        o.shape = shape;
        o.lane_order = order;
        o.cpu_threads = threads;
        EXPECT_EQ(colour(contacts, 300, o).colours, expected.colours);
      }
}

TEST_P(ColouringTest, TurnsLetEachBodysContactsPassInTheOrderOfTheirColours) {
  const auto contacts = random_contacts(300, 2000, 21);
  const Coloured coloured = colour(contacts, 300, options());
  struct Waiting {
    Pair bodies;
    DependencyCounters counters;
    int colour;
  };
  std::vector<Waiting> waiting;
  for (int c = 0; c < Colouring::colours; ++c)
    for (const std::uint32_t k : coloured.colours[static_cast<std::size_t>(c)]) {
      const auto [a, b] = contacts[k];
      waiting.push_back({contacts[k], DependencyCounters::of(coloured.used[a], coloured.used[b], c), c});
    }
  std::reverse(waiting.begin(), waiting.end());  // process the last ready contact first
  std::vector<std::uint8_t> count(300, 0);
  std::vector<int> last(300, -1);
  while (!waiting.empty()) {
    std::vector<Waiting> still;
    for (const Waiting& w : waiting) {
      const auto [a, b] = w.bodies;
      if (count[a] != w.counters.a || count[b] != w.counters.b) {
        still.push_back(w);
        continue;
      }
      EXPECT_GT(w.colour, std::max(last[a], last[b]));
      last[a] = last[b] = w.colour;
      count[a] = w.counters.next_a;
      count[b] = w.counters.next_b;
    }
    ASSERT_LT(still.size(), waiting.size()) << "they wait for each other";
    waiting = still;
  }
  EXPECT_EQ(count, std::vector<std::uint8_t>(300, 0)) << "ready for the next sweep";
}

TEST_P(ColouringTest, OfNothingIsEmpty) {
  const Coloured coloured = colour({}, 5, options());
  for (const auto& c : coloured.colours) EXPECT_TRUE(c.empty());
}

}  // namespace
}  // namespace collidoscope
