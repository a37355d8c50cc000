#pragma once
// An OpenGL 4.5 core context without a window, through EGL alone. Current on the thread that made it, until
// it is destroyed.

#include <string>
#include <vector>

namespace collidoscope {

class EglContext {
 public:
  /// `cuda_device`: where >= 0, the EGL device of that CUDA device is preferred, so that the two can share
  /// buffers. Then any other hardware device, then software devices, then Mesa's surfaceless platform. Throws
  /// MachineError where none of them gives OpenGL 4.5, with what each answered.
  explicit EglContext(int cuda_device = -1);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Again, after another context was current on this thread.
  void make_current() const;

  const std::string& renderer() const { return renderer_; }
  const std::string& version() const { return version_; }
  bool software() const { return software_; }
  /// CUDA's number of the device that draws; -1 where EGL does not say.
  int cuda_device() const { return cuda_device_; }
  /// One line for each thing that was tried and did not work, or fell short of what was asked.
  const std::vector<std::string>& steps_down() const { return steps_down_; }

 private:
  bool try_display(void* display, const std::string& name);

  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string renderer_, version_;
  bool software_ = false;
  int cuda_device_ = -1;
  std::vector<std::string> steps_down_;
};

}  // namespace collidoscope
