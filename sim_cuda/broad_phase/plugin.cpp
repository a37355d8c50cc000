// A broad phase from a shared library (sim_cuda/plugin/include/collidoscope/broad_phase.h). The library
// writes its pairs to a list of its own. From there each valid pair of overlapping boxes goes to the sink
// once: a hash table finds duplicates. Optionally, the pairs of lbvh_ropes are looked up in the table, which
// finds missing ones.

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_sink.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/import/tree_file.h"
#include "sim_cuda/plugin/include/collidoscope/broad_phase.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {

namespace {

static_assert(sizeof(Aabb) == sizeof(collidoscope_box));

constexpr std::uint64_t longest_plugin_list = 1 << 29;  // pairs
constexpr std::int64_t fence_length = 256;              // entries behind the list that must stay unchanged
constexpr std::uint32_t fence_byte = 0xa5, fence_word = 0xa5a5a5a5;
constexpr std::uint64_t free_slot = ~std::uint64_t{0};

/// Written by the stages of one run, in the executor's memory.
struct RunFaults {
  std::uint64_t count;            ///< written by the library
  std::uint32_t accepted, slots;  ///< entries that are read; size of the hash table, a power of two
  std::uint32_t written_beyond, absurd_count;
  std::uint64_t pairs[pair_faults];
  std::uint32_t examples;  ///< also counts those that do not fit
  FaultyPair example[PairCheck::most_examples];

  SIM_HD void add(std::uint32_t a, std::uint32_t b, PairFault fault) {
    atomic_add(&pairs[static_cast<std::size_t>(fault)], 1);
    const std::uint32_t place = atomic_add(&examples, 1);
    if (place < PairCheck::most_examples) example[place] = {a, b, fault};
  }
};

/// Sums over runs, in the executor's memory.
struct AllFaults {
  std::uint64_t attempts;  ///< with those that overflowed
  std::uint64_t runs, wrong_runs, first_wrong;
  std::uint64_t pairs[pair_faults];
  std::uint64_t writes_beyond, absurd_counts;
  std::uint64_t run_of_examples;
  std::uint32_t examples;
  FaultyPair example[PairCheck::most_examples];
};

/// The pairs of a library and the places of its stages.
struct PluginRun {
  const collidoscope_pair* listed;
  std::uint64_t capacity;
  RunFaults* faults;
  AllFaults* all;
  std::uint64_t* table;  ///< pairs found so far; see slot_of()

  /// The slot that contains the pair, or a free one.
  SIM_HD std::uint32_t slot_of(std::uint64_t key, std::uint32_t step) const {
    return (static_cast<std::uint32_t>(mix64(key)) + step) & (faults->slots - 1);
  }
};

/// Accepts the number of pairs, and checks the fence behind the list. One item for each entry of the fence.
struct AcceptList {
  PluginRun run;
  std::uint32_t most_slots;
  SIM_HD void operator()(int entry) const {
    RunFaults& faults = *run.faults;
    const collidoscope_pair& fence = run.listed[run.capacity + static_cast<std::uint64_t>(entry)];
    if (fence.a != fence_word || fence.b != fence_word) atomic_store(&faults.written_beyond, 1u);
    if (entry != 0) return;
    const bool absurd = faults.count > longest_plugin_list;
    faults.absurd_count = absurd ? 1 : 0;
    faults.accepted = absurd || faults.count > run.capacity ? 0 : static_cast<std::uint32_t>(faults.count);
    faults.slots = 64;
    while (faults.slots < 2 * faults.accepted && faults.slots < most_slots) faults.slots *= 2;
  }
};

struct ClearTable {
  std::uint64_t* table;
  SIM_HD void operator()(int slot) const { table[slot] = free_slot; }
};

/// Passes each pair of overlapping boxes to the sink once.
struct AddCanonical {
  PluginRun run;
  PairSink sink;
  const Aabb* boxes;
  std::uint32_t bodies;
  SIM_HD void operator()(int entry) const {
    const auto [a, b] = run.listed[entry];
    if (a >= bodies || b >= bodies || a == b) return run.faults->add(a, b, PairFault::out_of_range);
    if (!overlap(boxes[a], boxes[b])) return run.faults->add(a, b, PairFault::apart);
    const std::uint64_t key = a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
    for (std::uint32_t step = 0;; ++step) {
      const std::uint64_t before =
          atomic_compare_exchange(&run.table[run.slot_of(key, step)], free_slot, key);
      if (before == key) return run.faults->add(a, b, PairFault::duplicate);
      if (before == free_slot) return sink.add(a, b);
    }
  }
};

/// Looks up the pairs of another method.
struct FindMissing {
  PluginRun run;
  const FoundPair* expected;
  SIM_HD void operator()(int place) const {
    const Pair pair = expected[place].pair;
    const std::uint64_t key = std::uint64_t{pair.a} << 32 | pair.b;
    for (std::uint32_t step = 0;; ++step) {
      const std::uint64_t found = run.table[run.slot_of(key, step)];
      if (found == key) return;
      if (found == free_slot) return run.faults->add(pair.a, pair.b, PairFault::missing);
    }
  }
};

/// Requests a longer list, or adds the faults of the run to those of all runs. One item.
struct FinishRun {
  PluginRun run;
  std::uint64_t* total;           ///< of the sink
  const std::uint64_t* expected;  ///< number of pairs of the other method; null: not compared
  SIM_HD void operator()(int) const {
    const RunFaults& now = *run.faults;
    AllFaults& all = *run.all;
    ++all.attempts;
    const bool overflow = now.count > run.capacity && now.absurd_count == 0;
    if (overflow) *total = now.count;
    if (expected != nullptr && *expected > run.capacity) {
      if (*expected > *total) *total = *expected;
      return;
    }
    if (overflow) return;
    const bool wrong = now.pairs[0] + now.pairs[1] + now.pairs[2] + now.written_beyond + now.absurd_count > 0;
    static_assert(static_cast<std::size_t>(PairFault::apart) == 3);
    if (wrong && all.wrong_runs++ == 0) all.first_wrong = all.runs;
    for (std::size_t k = 0; k < pair_faults; ++k) all.pairs[k] += now.pairs[k];
    all.writes_beyond += now.written_beyond;
    all.absurd_counts += now.absurd_count;
    if (now.examples > 0) {
      all.run_of_examples = all.runs;
      all.examples = now.examples;
      for (std::size_t k = 0; k < PairCheck::most_examples; ++k) all.example[k] = now.example[k];
    }
    ++all.runs;
  }
};

class Plugin final : public BroadPhase {
 public:
  Plugin(Executor& executor, const BroadPhaseMethod& method)
      : executor_(executor),
        name_(method.name),
        library_(*method.plugin),
        compares_(executor.options().check_pairs == PairComparison::on || method.has_wrong_pairs),
        listed_(executor, "pairs of the plug-in"),
        table_(executor, "pairs of the plug-in"),
        run_faults_(executor, "faults of pairs"),
        all_faults_(executor, "faults of pairs"),
        expected_(executor, "pairs to compare"),
        expected_count_(executor, "pairs to compare") {
    run_faults_.resize_discarding(1);
    all_faults_.resize_discarding(1);
    if (!executor_.is_dry_run()) all_faults_.fill_zero();
    if (compares_) reference_ = make_lbvh_ropes(executor);
  }
  ~Plugin() override { destroy(); }

  void reserve(std::int64_t bodies) override {
    bodies_ = bodies;
    if (reference_) {
      reference_->reserve(bodies);
      expected_count_.resize_discarding(static_cast<std::size_t>(bodies) + 2);
    }
    if (executor_.is_dry_run()) return;
    destroy();
    if (bodies == 0) return;
    object_ = library_.create(memory(), static_cast<std::uint32_t>(bodies));
    if (object_ == nullptr)
      throw MachineError("broad phase " + name_ + ": the plug-in cannot create an object for " +
                         std::to_string(bodies) + " boxes");
  }

  void reserve_pairs(std::int64_t capacity) override {
    const auto pairs = static_cast<std::size_t>(capacity);
    listed_.resize_discarding(pairs + fence_length);
    std::size_t slots = 64;
    while (slots < 2 * pairs && slots < longest_plugin_list * 2) slots *= 2;
    table_.resize_discarding(slots);
    if (reference_) expected_.resize_discarding(pairs);
    if (!executor_.is_dry_run())
      executor_.fill(listed_.data() + pairs, fence_byte, fence_length * sizeof(collidoscope_pair));
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    boxes_ = boxes;
    extent_ = extent;
  }

  void find_pairs(const PairSink& sink) override {
    if (bodies_ == 0) return;
    const PluginRun run{listed_.data(), listed_.size() - fence_length, run_faults_.data(), all_faults_.data(),
                        table_.data()};
    executor_.begin_stage("plug-in", true);
    executor_.count_launches(1);
    run_faults_.fill_zero();
    call_library(run.capacity);
    const ItemCount accepted(&run.faults->accepted, static_cast<std::int64_t>(run.capacity));
    executor_.run("canonical", fence_length, AcceptList{run, static_cast<std::uint32_t>(table_.size())});
    executor_.run("canonical", ItemCount(&run.faults->slots, static_cast<std::int64_t>(table_.size())),
                  ClearTable{run.table});
    executor_.run("canonical", accepted,
                  AddCanonical{run, sink, boxes_, static_cast<std::uint32_t>(bodies_)});
    const std::uint64_t* expected = nullptr;
    if (reference_)
      executor_.run_as_stage("compare", [&] {
        expected = reinterpret_cast<const std::uint64_t*>(expected_count_.data());
        find_missing(run);
      });
    executor_.run("canonical", 1, FinishRun{run, sink.total, expected});
  }

  std::int64_t tree_nodes() const override { return static_cast<std::int64_t>(tree().box.size()); }
  void write_tree(const TreeSink& sink) const override { write_given_tree(executor_, tree(), sink); }

  std::optional<PairCheck> pair_check() const override {
    const AllFaults all = totals();
    PairCheck check;
    check.compares = compares_;
    check.runs = all.runs;
    check.wrong_runs = all.wrong_runs;
    check.first_wrong = all.first_wrong;
    std::copy(all.pairs, all.pairs + pair_faults, check.pairs);
    check.writes_beyond = all.writes_beyond;
    check.absurd_counts = all.absurd_counts;
    check.examples.assign(all.example,
                          all.example + std::min<std::size_t>(all.examples, PairCheck::most_examples));
    std::ranges::sort(check.examples, {},
                      [](const FaultyPair& each) { return std::tuple(each.fault, each.a, each.b); });
    check.examples_are_of_last_run = all.examples > 0 && all.run_of_examples + 1 == all.runs;
    check.tree_faults = tree_faults_;
    return check;
  }

 private:
  std::uint32_t memory() const { return executor_.on_device() ? COLLIDOSCOPE_CUDA : COLLIDOSCOPE_HOST; }

  void destroy() {
    if (object_ != nullptr) library_.destroy(object_);
    object_ = nullptr;
  }

  AllFaults totals() const {
    AllFaults all;
    executor_.copy_to_host(&all, all_faults_.data(), sizeof all);
    return all;
  }

  void call_library(std::uint64_t capacity) {
    const auto begin_stage = [](void* plugin, const char* stage) {
      static_cast<Plugin*>(plugin)->begin_stage(stage);
    };
    collidoscope_find arguments{};
    arguments.boxes = reinterpret_cast<const collidoscope_box*>(boxes_);
    arguments.count = static_cast<std::uint32_t>(bodies_);
    arguments.threads = static_cast<std::uint32_t>(executor_.cpu_threads());
#if SIM_CUDA
    if (executor_.on_device()) arguments.stream = executor_.stream();
#endif
    arguments.pairs = listed_.data();
    arguments.capacity = capacity;
    arguments.pair_count = &run_faults_.data()->count;
    arguments.begin_stage = begin_stage;
    arguments.context = this;
    if (const int status = library_.find(object_, &arguments); status != 0)
      throw MachineError("broad phase " + name_ + ": the plug-in failed to find pairs, with status " +
                         std::to_string(status));
  }

  void begin_stage(const char* stage) {
    if (stage == nullptr) return;
    std::string name(stage);
    if (name.empty() || name.size() > 32 ||
        std::ranges::any_of(name, [](char c) { return c < ' ' || c > '~'; }))
      name = "plug-in";
    executor_.begin_stage(stages_.insert(std::move(name)).first->c_str(), true);
    executor_.count_launches(1);
  }

  void find_missing(const PluginRun& run) {
    auto* total = reinterpret_cast<std::uint64_t*>(expected_count_.data());
    reference_->update(boxes_, extent_);
    expected_count_.fill_zero();
    reference_->find_pairs({expected_.data(), run.capacity, total, expected_count_.data() + 2});
    executor_.run("compare", ItemCount(expected_count_.data(), static_cast<std::int64_t>(run.capacity)),
                  FindMissing{run, expected_.data()});
  }

  /// The tree of the last run; empty if the library has none or it is not valid.
  const GivenTree& tree() const {
    if (library_.tree == nullptr || object_ == nullptr || boxes_ == nullptr) return tree_;
    const std::uint64_t attempts = totals().attempts;
    if (attempts == tree_of_ || attempts == 0) return tree_;
    tree_of_ = attempts;
    tree_ = {};
    tree_faults_.clear();
    std::vector<collidoscope_node> nodes(2 * static_cast<std::size_t>(bodies_));
    const std::uint32_t count =
        library_.tree(object_, nodes.data(), static_cast<std::uint32_t>(nodes.size()));
    TreeRows rows;
    if (count > nodes.size()) {
      tree_faults_ = {"tree: " + std::to_string(count) + " nodes for " + std::to_string(bodies_) +
                      " boxes, expected at most " + std::to_string(nodes.size())};
      return tree_;
    }
    nodes.resize(count);
    for (const collidoscope_node& node : nodes) {
      rows.box.push_back(
          {Vector3f(node.min[0], node.min[1], node.min[2]), Vector3f(node.max[0], node.max[1], node.max[2])});
      rows.parent.push_back(static_cast<std::uint32_t>(node.parent));
      rows.leaf.push_back(static_cast<std::uint32_t>(node.box));
    }
    std::vector<Aabb> boxes(static_cast<std::size_t>(bodies_));
    executor_.copy_to_host(boxes.data(), boxes_, boxes.size() * sizeof(Aabb));
    try {
      tree_ = tree_of_rows(std::move(rows), boxes, "tree");
    } catch (const InputError& error) {
      tree_faults_ = error.lines();
    }
    return tree_;
  }

  Executor& executor_;
  const std::string name_;
  const collidoscope_broad_phase& library_;
  const bool compares_;
  void* object_ = nullptr;  ///< of the library
  std::int64_t bodies_ = 0;
  const Aabb *boxes_ = nullptr, *extent_ = nullptr;
  Buffer<collidoscope_pair> listed_;  ///< the capacity, and the fence
  Buffer<std::uint64_t> table_;
  Buffer<RunFaults> run_faults_;
  Buffer<AllFaults> all_faults_;
  std::unique_ptr<BroadPhase> reference_;  ///< null: pairs are not compared
  Buffer<FoundPair> expected_;
  Buffer<std::uint32_t> expected_count_;  ///< as PairList::count_
  std::set<std::string> stages_;          ///< names that the stage recorder points to
  mutable GivenTree tree_;
  mutable std::uint64_t tree_of_ = 0;  ///< AllFaults::attempts at which the tree was read
  mutable std::vector<std::string> tree_faults_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_plugin(Executor& executor, const BroadPhaseMethod& method) {
  return std::make_unique<Plugin>(executor, method);
}

}  // namespace collidoscope
