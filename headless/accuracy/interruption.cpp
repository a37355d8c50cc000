#include "headless/accuracy/interruption.h"

#include <signal.h>

#include <cstdlib>

#include "headless/standard_output.h"

namespace collidoscope {
namespace {

volatile sig_atomic_t noted = 0;
struct sigaction before_int, before_term;

struct sigaction& before(int signal) {
  return signal == SIGINT ? before_int : before_term;
}

void note(int signal) {
  noted = signal;
  ::sigaction(signal, &before(signal), nullptr);
}

}  // namespace

Interruption::Interruption() {
  noted = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    ::sigaction(signal, nullptr, &before(signal));
    if (before(signal).sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);
  }
}

Interruption::~Interruption() {
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &before(signal), nullptr);
}

bool Interruption::wished() const { return noted != 0; }

void Interruption::obey() {
  flush_stdout();
  ::signal(noted, SIG_DFL);
  ::raise(noted);
  std::abort();  // not reached: neither signal's default lets a program go on
}

}  // namespace collidoscope
