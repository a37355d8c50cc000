#pragma once
// Ctrl-C (SIGINT) and SIGTERM as something to look at between two pieces of work. One object at a time. While
// it lives, the first signal is only noted; a second one does what it did before. A signal that the parent
// ignores stays ignored.

namespace collidoscope {

class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool wished() const;
  /// Ends the program as the signal would have, so that shells and scripts see that it was.
  [[noreturn]] static void obey();
};

}  // namespace collidoscope
