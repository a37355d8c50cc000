#pragma once
// An OpenGL 4.5 core context without a window, created with EGL. Current on the constructing thread until
// destruction.

#include <string>
#include <vector>

namespace collidoscope {

class EglContext {
 public:
  /// `cuda_device`: if >= 0, prefer the EGL device of that CUDA device, so that both can share buffers.
  /// Further candidates in order: other hardware devices, software devices, Mesa's surfaceless platform.
  /// Throws MachineError with all errors if none of them provides OpenGL 4.5.
  explicit EglContext(int cuda_device = -1);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes the context current again after another context was current on this thread.
  void make_current() const;

  const std::string& renderer() const { return renderer_; }
  const std::string& version() const { return version_; }
  bool software() const { return software_; }
  /// CUDA index of the drawing device; -1 if EGL does not report it.
  int cuda_device() const { return cuda_device_; }
  /// One line for each candidate that failed or did not match the request.
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
