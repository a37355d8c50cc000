#include "headless/validate.h"

#include <fmt/format.h>

#include "headless/cli/standard_output.h"
#include "headless/reporting/report.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/plugin/validation.h"

namespace collidoscope {

int validate_command(const CommandLine& line) {
  ValidationOptions how;
  how.timeout = line.options.validation_timeout;
  how.poll = [&] {
    if (line.options.run.cancellation->poll()) throw Cancelled();
  };
  const PluginValidation validation = validate_plugin(full_plugin_path(line.operands[0]), how);
  std::string text = fmt::format("{}{}\n\n  {:<40}{:>9}{:>11}  result\n", validation.path,
                                 validation.name.empty() ? "" : ": broad phase " + validation.name, "test",
                                 "boxes", "pairs");
  for (const PluginTest& test : validation.tests) {
    const bool last = &test == &validation.tests.back();
    text += fmt::format("  {:<40}{:>9}{:>11}  {}\n", test.name, grouped(test.boxes), grouped(test.pairs),
                        !test.fault.empty()                 ? test.fault
                        : last && !validation.ended.empty() ? validation.ended
                                                            : "passed");
  }
  if (validation.tests.empty())
    text += fmt::format("  {}\n", validation.ended.empty() ? "no test on this machine" : validation.ended);
  print(text);
  return validation.passed() && !validation.tests.empty() ? 0 : 1;
}

}  // namespace collidoscope
