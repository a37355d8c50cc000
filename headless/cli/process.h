#pragma once
// What both programs set up before anything else: standard streams and signals. A free function.

namespace collidoscope {

/// Call first in main(), once.
/// - A standard stream that the parent closed is opened so that its use fails: no file that is opened later
///   takes its number.
/// - SIGINT, SIGTERM, SIGHUP and SIGQUIT end the program as ever, but delete its temporary files before. One
///   that the parent ignores stays ignored.
/// - SIGPIPE does the same (`| head`), also where the parent ignores it: no message, no temporary file.
/// - SIGXFSZ is ignored: a write beyond the limit of a file's size fails with a message.
void prepare_process();

}  // namespace collidoscope
