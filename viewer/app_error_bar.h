#pragma once
// Definition of App::with_error_bar(), for the source files of App.

#include <exception>

#include "sim_cuda/core/cancellation.h"
#include "viewer/app.h"
#include "viewer/user_error_text.h"

namespace collidoscope {

template <class Action>
bool App::with_error_bar(Action action, bool step) {
  try {
    action();
    return true;
  } catch (const Cancelled&) {
    cancelled_ = true;
  } catch (const std::exception& error) {
    report_error(plain_text(error), step);
  } catch (...) {
    report_error("Internal error: unknown error", step);
  }
  return false;
}

}  // namespace collidoscope
