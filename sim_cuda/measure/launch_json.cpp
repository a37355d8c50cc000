#include "sim_cuda/measure/launch_json.h"

#include <nlohmann/json.hpp>

namespace collidoscope {

nlohmann::ordered_json launch_json(const StageLaunch& launch) {
  using Json = nlohmann::ordered_json;
  if (launch.threads == 0) return nullptr;
  const bool gpu = launch.multiprocessors > 0;
  const auto where = [](bool there, auto value) { return there ? Json(value) : Json(nullptr); };
  return {{"items", launch.items},
          {"blocks", launch.blocks},
          {"threads", launch.threads},
          {"chunk", where(!gpu, launch.chunk)},
          {"resident_blocks", where(gpu, launch.resident_blocks)},
          {"multiprocessors", where(gpu, launch.multiprocessors)},
          {"registers", where(gpu, launch.registers)},
          {"shared_bytes", where(gpu, launch.shared_bytes)},
          {"occupancy", where(gpu, launch.occupancy)},
          {"limit", name_of(launch.limit)}};
}

}  // namespace collidoscope
