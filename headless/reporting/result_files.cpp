#include "headless/reporting/result_files.h"

#include "headless/cli/output_file.h"
#include "headless/pictures/chart_picture.h"

namespace collidoscope {
namespace {

bool is_file(const std::string& name) { return !name.empty() && name != "-"; }

void replace(const char* flag, const std::string& name, const std::string& text) {
  if (!is_file(name)) return;
  OutputFile file(flag, name);
  file.write(text);
  file.commit();
}

}  // namespace

ResultFiles::ResultFiles(const Options& options) : options_(options) {
  if (is_file(options.json)) OutputFile("--json", options.json);
  if (is_file(options.bench.csv)) OutputFile("--csv", options.bench.csv);
  if (is_file(options.bench.markdown)) OutputFile("--markdown", options.bench.markdown);
  if (is_file(options.bench.plot)) {
    OutputFile("--plot", options.bench.plot);
    ChartPicture(8, 8);
  }
}

void ResultFiles::write(const std::string& json, const std::string& csv, const std::string& markdown) const {
  replace("--json", options_.json, json);
  replace("--csv", options_.bench.csv, csv);
  replace("--markdown", options_.bench.markdown, markdown);
}

void ResultFiles::plot(const Chart& chart) const {
  if (is_file(options_.bench.plot)) write_png(ChartPicture().draw(chart), options_.bench.plot);
}

}  // namespace collidoscope
