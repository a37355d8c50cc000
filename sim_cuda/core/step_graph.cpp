#include "sim_cuda/core/step_graph.h"

#include <utility>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/compute_device.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/stage_recorder.h"

namespace collidoscope {

StepGraph::StepGraph(Executor& executor, bool instrumented, std::function<void()> enqueue)
    : executor_(executor), instrumented_(instrumented), enqueue_(std::move(enqueue)) {
#if SIM_CUDA
  if (!executor_.on_device()) return;
  StageRecorder& stages = executor_.stages_;
  const cudaStream_t stream = executor_.stream();
  stages.end();
  check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "begin the capture of a step");
  StageRecorder::StageBeginCallback began;
  if (instrumented_) began = [this](std::size_t entry) { mark(entry); };
  stages.begin_capture(stream, std::move(began));
  cudaGraph_t graph = nullptr;
  try {
    enqueue_();
    stages.end();
    if (instrumented_) mark(0);
  } catch (...) {
    stages.drop_capture();
    cudaStreamEndCapture(stream, &graph);
    if (graph != nullptr) cudaGraphDestroy(graph);
    throw;
  }
  stages.end_capture();
  check(cudaStreamEndCapture(stream, &graph), "end the capture of a step");
  const cudaError_t status = cudaGraphInstantiate(&graph_, graph, 0);
  cudaGraphDestroy(graph);
  check(status, "instantiate the graph of a step");
#endif
}

StepGraph::~StepGraph() {
#if SIM_CUDA
  if (gpu_abandoned()) return;
  if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
  for (cudaEvent_t event : events_) cudaEventDestroy(event);
#endif
}

#if SIM_CUDA
void StepGraph::mark(std::size_t entry) {
  cudaEvent_t event = nullptr;
  check(cudaEventCreate(&event), "create an event");
  events_.push_back(event);
  event_entries_.push_back(entry);
  check(cudaEventRecordWithFlags(event, executor_.stream(), cudaEventRecordExternal), "record an event");
}
#endif

void StepGraph::launch() {
#if SIM_CUDA
  if (executor_.on_device())
    return check(cudaGraphLaunch(graph_, executor_.stream()), "launch the graph of a step");
#endif
  StageRecorder& stages = executor_.stages_;
  stages.begin_step(instrumented_);
  try {
    enqueue_();
    stages.end_step();
  } catch (const Cancelled&) {
    stages.cancel_step();
    throw;
  }
}

void StepGraph::collect() {
#if SIM_CUDA
  if (!executor_.on_device()) return;
  for (std::size_t k = 0; k + 1 < events_.size(); ++k) {
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, events_[k], events_[k + 1]), "read the time of a stage");
    executor_.clock().add(event_entries_[k], milliseconds);
  }
#endif
}

}  // namespace collidoscope
