#pragma once
// App::guarded(), for the files that App is written in.

#include <exception>
#include <new>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/out_of_memory.h"
#include "viewer/app.h"

namespace collidoscope {

template <class Action>
void App::guarded(Action action) {
  try {
    action();
  } catch (const Cancelled&) {
    cancelled_ = true;
  } catch (const OutOfMemory& error) {
    report_error(std::string("out of memory while ") + error.what() + "; fewer bodies need less");
  } catch (const std::bad_alloc&) {
    report_error("out of memory: the machine refused an allocation; fewer bodies need less");
  } catch (const std::exception& error) {
    report_error(error.what());
  }
}

}  // namespace collidoscope
