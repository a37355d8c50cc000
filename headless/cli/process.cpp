#include "headless/cli/process.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

#include "sim_cuda/core/atomic_file.h"

namespace collidoscope {
namespace {

void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      // The lowest free number, which is this one. Reading stdin fails, and so does writing to the others.
      if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
}

/// The default action of the signal, which SA_RESETHAND has restored, follows when the handler returns.
void end_by(int signal) {
  remove_temporary_files();
  ::raise(signal);
}

void end_cleanly_by(int signal, bool although_ignored) {
  struct sigaction now {};
  if (!although_ignored && ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = end_by;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigfillset(&action.sa_mask);
  ::sigaction(signal, &action, nullptr);
}

}  // namespace

void prepare_process() {
  open_closed_streams();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) end_cleanly_by(signal, false);
  end_cleanly_by(SIGPIPE, true);
  ::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace collidoscope
