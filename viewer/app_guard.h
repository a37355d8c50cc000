#pragma once
// App::guarded(), for the files that App is written in.

#include <exception>
#include <new>

#include "viewer/app.h"

namespace collidoscope {

template <class Action>
void App::guarded(Action action) {
  try {
    action();
  } catch (const std::bad_alloc&) {
    report_error("out of memory: the machine refused an allocation; fewer bodies need less");
  } catch (const std::exception& error) {
    report_error(error.what());
  }
}

}  // namespace collidoscope
