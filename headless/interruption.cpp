#include "headless/interruption.h"

#include <sys/time.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace collidoscope {
namespace {

constexpr suseconds_t patience = 900'000;  // us

volatile std::sig_atomic_t noted = 0;
std::atomic<Cancellation*> requested = nullptr;
std::atomic<bool> timed = false;

/// Arms or, with 0, disarms what ends the program.
void set_timer(suseconds_t microseconds) {
  itimerval timer{};
  timer.it_value.tv_usec = microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void end_at_once(int) {
  std::signal(noted, SIG_DFL);
  std::raise(noted);
}

void note(int signal) {
  noted = signal;
  std::signal(signal, SIG_DFL);
  if (Cancellation* const cancellation = requested) cancellation->request();
  if (timed) set_timer(patience);
}

void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

Interruption::Interruption() {
  noted = 0;
  handle(note);
}

Interruption::Interruption(Cancellation& cancellation, bool at_once) {
  noted = 0;
  requested = &cancellation;
  if (at_once) std::signal(SIGALRM, end_at_once);
  timed = at_once;
  handle(note);
}

Interruption::~Interruption() {
  handle(SIG_DFL);
  met();
}

bool Interruption::wished() const { return noted != 0; }

void Interruption::met() {
  requested = nullptr;
  if (!timed.exchange(false)) return;
  set_timer(0);
  std::signal(SIGALRM, SIG_DFL);
}

void Interruption::obey() {
  std::fflush(stdout);
  std::signal(noted, SIG_DFL);
  std::raise(noted);
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
