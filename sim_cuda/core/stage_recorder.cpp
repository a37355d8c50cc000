#include "sim_cuda/core/stage_recorder.h"

#include <cstring>
#include <utility>

#if SIM_CUDA
#include <nvtx3/nvToolsExt.h>
#endif

namespace collidoscope {

namespace {

void push_range([[maybe_unused]] const char* name) {
#if SIM_CUDA
  nvtxRangePushA(name);
#endif
}
void pop_range() {
#if SIM_CUDA
  nvtxRangePop();
#endif
}

}  // namespace

#if SIM_CUDA
std::size_t StageRecorder::nodes_in_capture() const {
  cudaStreamCaptureStatus status{};
  cudaGraph_t graph = nullptr;
  check(cudaStreamGetCaptureInfo(stream_, &status, nullptr, &graph, nullptr, nullptr, nullptr),
        "query the capture of the stream");
  if (status != cudaStreamCaptureStatusActive) return 0;
  std::size_t nodes = 0;
  check(cudaGraphGetNodes(graph, nullptr, &nodes), "count the nodes of a graph");
  return nodes;
}
#endif

void StageRecorder::begin(const char* name, bool library_launch) {
  if (merged_ != nullptr) name = merged_;
  if (stage_ != nullptr && std::strcmp(stage_, name) == 0) {
    if (library_launch) clock_.entry(name).library_launch = true;
    return;
  }
  end();
  StageClock::Entry& entry = clock_.entry(name);
  if (library_launch) entry.library_launch = true;
  stage_ = name;
  stage_entry_ = clock_.index(entry);
  stage_substep_ = substep_;
  push_range(name);
#if SIM_CUDA
  if (capturing_) {
    if (began_) began_(stage_entry_);
    stage_nodes_ = nodes_in_capture();
  }
#endif
  if (timing_) stage_start_ = std::chrono::steady_clock::now();
}

void StageRecorder::end() {
  const char* ended = stage_;
  close();
  if (stage_callback_ == nullptr || ended == nullptr) return;
  const StageCallback* watch = std::exchange(stage_callback_, nullptr);
  (*watch)(ended, stage_substep_);
  close();
  stage_callback_ = watch;
}

void StageRecorder::run_with_stage_callback(const StageCallback& ended, const std::function<void()>& work) {
  end();
  substep_ = 0;
  stage_callback_ = &ended;
  struct ResetOnExit {  // also if `work` throws
    const StageCallback*& watch;
    ~ResetOnExit() { watch = nullptr; }
  } watched{stage_callback_};
  work();
  end();
}

void StageRecorder::close() {
  if (stage_ == nullptr) return;
  if (timing_)
    clock_.add(
        stage_entry_,
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - stage_start_).count());
#if SIM_CUDA
  if (capturing_ && counting_) {
    const int launches = static_cast<int>(nodes_in_capture() - stage_nodes_);
    clock_.entry(stage_).launches += launches;
  }
#endif
  stage_ = nullptr;
  pop_range();
}

void StageRecorder::begin_step(bool timed) {
  end();
  clock_.clear_launches();
  clock_.clear_shapes();
  counting_ = true;
  timing_ = timed;
}

void StageRecorder::end_step() {
  end();
  timing_ = counting_ = false;
}

void StageRecorder::cancel_step() {
  merged_ = nullptr;
  stage_callback_ = nullptr;
  close();
  timing_ = counting_ = false;
}

void StageRecorder::count_launches(int launches) {
  if (counting_ && stage_ != nullptr) clock_.at(stage_entry_).launches += launches;
}

void StageRecorder::count_loop(const StageLaunch& loop) {
  if (!counting_ || stage_ == nullptr) return;
  count_launches(1);
  clock_.add_launch(stage_entry_, loop);
}

#if SIM_CUDA
void StageRecorder::begin_capture(cudaStream_t stream, StageBeginCallback began) {
  capturing_ = true;
  stream_ = stream;
  began_ = std::move(began);
  counting_ = !began_;
  clock_.clear_shapes();
  if (!began_) clock_.clear_launches();
}

void StageRecorder::end_capture() {
  capturing_ = false;
  began_ = nullptr;
  counting_ = false;
}

void StageRecorder::drop_capture() {
  end_capture();
  stage_ = merged_ = nullptr;
}

void StageRecorder::note_launch(const StageLaunch& launch) {
  if (capturing_) clock_.add_launch(stage_entry_, launch);
}
#endif

}  // namespace collidoscope
