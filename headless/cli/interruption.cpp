#include "headless/cli/interruption.h"

#include <signal.h>
#include <sys/time.h>

#include <atomic>
#include <cstdlib>

#include "headless/cli/standard_output.h"
#include "sim_cuda/core/atomic_file.h"

namespace collidoscope {
namespace {

constexpr suseconds_t patience = 900'000;  // us

volatile sig_atomic_t noted = 0;
std::atomic<Cancellation*> requested = nullptr;
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
  ::signal(noted, SIG_DFL);
  ::raise(noted);
}

void note(int signal) {
  noted = signal;
  ::sigaction(signal, &before(signal), nullptr);
  if (Cancellation* const cancellation = requested) cancellation->request();
  if (timed) set_timer(patience);
}

void install() {
  noted = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    ::sigaction(signal, nullptr, &before(signal));
    if (before(signal).sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace

Interruption::Interruption() { install(); }

Interruption::Interruption(Cancellation& cancellation, bool at_once) {
  requested = &cancellation;
  if (at_once) ::signal(SIGALRM, end_at_once);
  timed = at_once;
  install();
}

Interruption::~Interruption() {
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &before(signal), nullptr);
  met();
}

bool Interruption::wished() const { return noted != 0; }

void Interruption::met() {
  requested = nullptr;
  wait_for_work();
}

void Interruption::wait_for_work() {
  if (!timed.exchange(false)) return;
  set_timer(0);
  ::signal(SIGALRM, SIG_DFL);
}

void Interruption::obey() {
  flush_stdout();
  ::signal(noted, SIG_DFL);
  ::raise(noted);
  std::abort();  // not reached: neither signal's default lets a program go on
}

int until_interrupted(const std::function<int(Cancellation&)>& work) {
  static Cancellation cancellation;
  const Interruption interruption(cancellation, true);
  try {
    const int status = work(cancellation);
    if (!interruption.wished()) return status;
  } catch (const Cancelled&) {
  }
  Interruption::obey();
}

}  // namespace collidoscope
