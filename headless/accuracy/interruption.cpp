#include "headless/accuracy/interruption.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace collidoscope {
namespace {

volatile std::sig_atomic_t noted = 0;

void note(int signal) {
  noted = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Interruption::Interruption() {
  noted = 0;
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

Interruption::~Interruption() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool Interruption::wished() const { return noted != 0; }

void Interruption::obey() {
  std::fflush(stdout);
  std::signal(noted, SIG_DFL);
  std::raise(noted);
  std::abort();  // not reached: neither signal's default lets a program go on
}

}  // namespace collidoscope
