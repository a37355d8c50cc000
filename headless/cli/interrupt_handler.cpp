#include "headless/cli/interrupt_handler.h"

#include <signal.h>
#include <sys/time.h>

#include <atomic>
#include <cstdlib>

#include "headless/cli/standard_output.h"
#include "sim_cuda/core/whole_file.h"

namespace collidoscope {
namespace {

constexpr suseconds_t end_delay = 900'000;  // us

volatile sig_atomic_t received_signal = 0;
std::atomic<Cancellation*> cancellation_on_signal = nullptr;
std::atomic<bool> timed = false;
struct sigaction before_int, before_term;

struct sigaction& before(int signal) {
  return signal == SIGINT ? before_int : before_term;
}

/// Starts the timer that ends the program; 0 stops it.
void set_timer(suseconds_t microseconds) {
  itimerval timer{};
  timer.it_value.tv_usec = microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void end_at_once(int) {
  remove_temporary_files();
  ::signal(received_signal, SIG_DFL);
  ::raise(received_signal);
}

void note(int signal) {
  received_signal = signal;
  ::sigaction(signal, &before(signal), nullptr);
  if (Cancellation* const cancellation = cancellation_on_signal) cancellation->request();
  if (timed) set_timer(end_delay);
}

void install() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    ::sigaction(signal, nullptr, &before(signal));
    if (before(signal).sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace

InterruptHandler::InterruptHandler() { install(); }

InterruptHandler::InterruptHandler(Cancellation& cancellation, bool at_once) {
  cancellation_on_signal = &cancellation;
  if (at_once) ::signal(SIGALRM, end_at_once);
  timed = at_once;
  install();
}

InterruptHandler::~InterruptHandler() {
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &before(signal), nullptr);
  work_ended();
}

bool InterruptHandler::requested() const { return received_signal != 0; }

void InterruptHandler::work_ended() {
  cancellation_on_signal = nullptr;
  wait_for_work();
}

void InterruptHandler::wait_for_work() {
  if (!timed.exchange(false)) return;
  set_timer(0);
  ::signal(SIGALRM, SIG_DFL);
}

void InterruptHandler::reraise() {
  flush_stdout();
  ::signal(received_signal, SIG_DFL);
  ::raise(received_signal);
  std::abort();  // not reached: neither signal's default lets a program go on
}

int run_interruptible(const std::function<int(Cancellation&)>& work) {
  static Cancellation cancellation;
  const InterruptHandler interrupt_handler(cancellation, true);
  try {
    const int status = work(cancellation);
    if (!interrupt_handler.requested()) return status;
  } catch (const Cancelled&) {
  }
  InterruptHandler::reraise();
}

}  // namespace collidoscope
