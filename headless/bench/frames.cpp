#include "headless/bench/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/pictures/egl_context.h"
#include "headless/pictures/panel_picture.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/report.h"
#include "viewer/render/interop/display_link.h"
#include "viewer/render/value_range.h"
#include "viewer/session/live_world.h"

namespace collidoscope {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Times in ms of one part in every frame. Parts are in the order of first use.
struct Part {
  std::string_view name;
  std::vector<float> ms;
  double sum = 0;
};

class Parts {
 public:
  void add(std::string_view name, double ms) {
    auto known = std::ranges::find(parts_, name, &Part::name);
    if (known == parts_.end()) known = parts_.insert(parts_.end(), Part{name, {}, 0});
    known->ms.push_back(static_cast<float>(ms));
    known->sum += ms;
  }
  const std::vector<Part>& all() const { return parts_; }

 private:
  std::vector<Part> parts_;
};

struct MeasuredFrames {
  Parts parts, passes;  ///< wall-clock times; GPU timestamps within the part "draw"
  Part frame{"frame", {}, 0};
  PublishCounts drawn;
};

/// The viewer's frame without a window: the operations of SceneView and App, in the same order.
class PanelBench {
 public:
  PanelBench(const Scene& scene, const Options& options)
      : request_(options.capture),
        live_(scene, options.run),
        context_(request_.drawing_gpu(live_.world().info().gpu)),
        log_([](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }),
        options_(live_options(request_.draw, context_.software(),
                              static_cast<std::int64_t>(live_.world().initial().size()))),
        view_(request_.layers.ui ? PanelPicture::scene_rect(request_.width, request_.height)
                                 : ScreenRect{0, 0, static_cast<float>(request_.width),
                                              static_cast<float>(request_.height)}),
        renderer_(static_cast<int>(view_.width), static_cast<int>(view_.height), options_),
        link_(live_.world().info(), request_.display_path, log_) {
    for (const std::string& line : context_.steps_down()) log_(line);
    World& world = live_.world();
    world.records().record_impulses(request_.layers.contacts);
    renderer_.set_scene(frame_scene(world.scene(), world.initial()));
    camera_ = scene_camera(world.scene().camera, renderer_.scene().bounds,
                           static_cast<double>(renderer_.width()) / renderer_.height());
    if (!request_.layers.ui) return;
    gui_.emplace(workspace_font_size(request_.width, request_.height, 1));
    panels_.emplace(world, request_.layers, request_.width, request_.height, true);
    panels_->set_renderer(context_.renderer(), context_.software(), display_path_name(link_.path()));
  }

  void frame(MeasuredFrames& to) {
    const Clock::time_point start = Clock::now();
    Clock::time_point before = start;
    const auto part = [&](const char* name) {
      const Clock::time_point now = Clock::now();
      to.parts.add(name, std::chrono::duration<double, std::milli>(now - before).count());
      before = now;
    };
    live_.step(true);
    part("simulate");
    link_.publish(live_.world(), request_.layers, renderer_.instances());
    part("publish");
    const ValueRange range = value_range(live_.world(), renderer_.scene(), request_.layers, live_.stats());
    renderer_.draw(camera_, request_.layers, range, &passes_);
    Renderer::finish();
    part("draw");
    if (panels_) {
      panels_->fill(live_.world(), live_.stats(), live_.history(), live_.level_sizes(request_.layers.boxes),
                    range);
      part("fill");
      panels_->build(*gui_);
      part("ui");
      panels_->rasterise(*gui_, renderer_);
      Renderer::finish();
      part("rasterise");
    }
    const double whole = std::chrono::duration<double, std::milli>(before - start).count();
    to.frame.ms.push_back(static_cast<float>(whole));
    to.frame.sum += whole;
    to.drawn = renderer_.instances().counts;
    for (const auto& [name, ms] : passes_.read()) to.passes.add(name, ms);
  }

  LiveWorld& live() { return live_; }
  const EglContext& context() const { return context_; }
  const Renderer& renderer() const { return renderer_; }
  DisplayPath path() const { return link_.path(); }

 private:
  CaptureRequest request_;
  LiveWorld live_;
  EglContext context_;
  DisplayLink::LogCallback log_;
  DrawOptions options_;
  ScreenRect view_;
  Renderer renderer_;
  DisplayLink link_;
  OrbitCamera camera_;
  gl::PassClock passes_;
  std::optional<GuiPass> gui_;
  std::optional<PanelPicture> panels_;
};

const char* meaning(std::string_view part) {
  if (part == "simulate") return "simulate: step with statistics";
  if (part == "publish") return "publish: map, pack, unmap";
  if (part == "draw") return "draw: 3D view";
  if (part == "fill") return "fill: collect data of panels";
  if (part == "ui") return "ui: panels, CPU";
  return "rasterise: panels";
}

std::string layer_names(const FrameLayers& layers) {
  std::vector<std::string> names;
  if (layers.spheres) names.emplace_back("spheres");
  if (layers.boxes)
    names.push_back(layers.first_level == 0 && layers.last_level == 63
                        ? "bvh"
                        : fmt::format("bvh:{}-{}", layers.first_level, layers.last_level));
  if (layers.contacts) names.emplace_back("contacts");
  if (!layers.grid) names.emplace_back("no-grid");
  if (!layers.walls) names.emplace_back("no-walls");
  if (layers.ui) names.emplace_back("ui");
  return fmt::format("{}", fmt::join(names, ","));
}

/// Result data other than times.
struct FramesSetting {
  RunReport run;
  std::string renderer, opengl, display_path, quality, layers;
  bool software, compute;
  int supersampling, width, height, warm_up;
};

Json part_json(const Part& part, double frames_sum) {
  const Percentiles ms = percentiles_of(part.ms);
  return {{"name", part.name},
          {"median_ms", ms.median},
          {"p5_ms", ms.p5},
          {"p95_ms", ms.p95},
          {"share", frames_sum > 0 ? part.sum / frames_sum : 0}};
}

double frames_per_second(const MeasuredFrames& measured) {
  return 1000 * static_cast<double>(measured.frame.ms.size()) / measured.frame.sum;
}

Json result_json(const FramesSetting& setting, const MeasuredFrames& measured) {
  Json json{{"suite", "frames"}};
  json.update(json_of(setting.run));
  json["renderer"] = setting.renderer;
  json["software_renderer"] = setting.software;
  json["opengl"] = setting.opengl;
  json["display_path"] = setting.display_path;
  json["width"] = setting.width;
  json["height"] = setting.height;
  json["layers"] = setting.layers;
  json["quality"] = setting.quality;
  json["supersampling"] = setting.supersampling;
  json["sphere_method"] = setting.compute ? "compute" : "quads";
  json["drawn"] = {{"bodies", measured.drawn.bodies},
                   {"boxes", measured.drawn.boxes},
                   {"contacts", measured.drawn.contacts}};
  json["frames"] = measured.frame.ms.size();
  json["warm_up_frames"] = setting.warm_up;
  json["frames_per_second"] = frames_per_second(measured);
  json["frame"] = part_json(measured.frame, measured.frame.sum);
  for (const auto& [name, parts] : {std::pair{"parts", &measured.parts}, {"draw_passes", &measured.passes}}) {
    json[name] = Json::array();
    for (const Part& part : parts->all()) json[name].push_back(part_json(part, measured.frame.sum));
  }
  return json;
}

std::string result_text(const FramesSetting& setting, const MeasuredFrames& measured) {
  constexpr const char* row = "  {:<34}{:>10}{:>10}{:>10}{:>10}\n";
  const auto line = [&](const std::string& name, const Part& part) {
    const Percentiles ms = percentiles_of(part.ms);
    return fmt::format(row, name, fmt::format("{:.3f}", ms.median), fmt::format("{:.3f}", ms.p5),
                       fmt::format("{:.3f}", ms.p95),
                       fmt::format("{:.1f} %", 100 * part.sum / measured.frame.sum));
  };
  std::string text = title_text(setting.run);
  text += fmt::format("renderer {}{}\ndisplay path {}; {}x{}, {} x {} samples, quality {}, spheres by {}\n",
                      setting.renderer, setting.software ? " (software renderer)" : "", setting.display_path,
                      setting.width, setting.height, setting.supersampling, setting.supersampling,
                      setting.quality, setting.compute ? "compute" : "quads");
  text += fmt::format("layers {}: {} bodies, {} boxes, {} touching contacts; {} pairs\n\n", setting.layers,
                      grouped(measured.drawn.bodies), grouped(measured.drawn.boxes),
                      grouped(measured.drawn.contacts), grouped(setting.run.final.pairs));
  text += fmt::format(row, "part", "median ms", "p5 ms", "p95 ms", "share");
  for (const Part& part : measured.parts.all()) {
    text += line(meaning(part.name), part);
    if (part.name != "draw") continue;
    for (const Part& pass : measured.passes.all())
      if (pass.sum >= 0.0005 * static_cast<double>(pass.ms.size()))
        text += line(fmt::format("  {}, GPU", pass.name), pass);
  }
  text += line("whole frame", measured.frame);
  const RunTimes& times = setting.run.times;
  if (times.steps_timed > 0)
    text += fmt::format(row, "step without statistics", fmt::format("{:.3f}", times.step_median_ms), "",
                        fmt::format("{:.3f}", times.step_p95_ms), "");
  return text + fmt::format(
                    "\n  {:.1f} frames per second over {} frames, after {} warm-up frames\n"
                    "  state {}, hash {:016x}\n",
                    frames_per_second(measured), measured.frame.ms.size(), setting.warm_up,
                    setting.run.final.step, setting.run.state_hash);
}

}  // namespace

int bench_frames(const CommandLine& line) {
  // The first frames record graphs, grow buffers and compile shaders.
  constexpr int warm_up = 10;
  const Options& options = line.options;
  const Scene scene = load_scene(line);
  std::optional<OutputFile> file;
  if (!options.json.empty() && options.json != "-") file.emplace("--json", options.json);

  PanelBench panel_bench(scene, options);
  const StepStats initial = panel_bench.live().world().measure();
  MeasuredFrames measured;
  {
    Progress progress("frames", options.frames);
    for (int k = 0; k < warm_up; ++k) {
      MeasuredFrames forgotten;
      panel_bench.frame(forgotten);
    }
    for (std::int64_t k = 0; k < options.frames; ++k) {
      panel_bench.frame(measured);
      progress.update(k + 1);
    }
  }
  const DrawOptions& drawing = panel_bench.renderer().options();
  const FramesSetting setting{make_report(panel_bench.live().world(), initial, std::nullopt),
                              panel_bench.context().renderer(),
                              panel_bench.context().version(),
                              display_path_name(panel_bench.path()),
                              quality_name(drawing.light),
                              layer_names(options.capture.layers),
                              panel_bench.context().software(),
                              panel_bench.renderer().computes_spheres(),
                              drawing.supersampling,
                              options.capture.width,
                              options.capture.height,
                              warm_up};
  const std::string json = json_text(result_json(setting, measured));
  if (file) {
    file->write(json);
    file->commit();
  }
  print(options.json == "-" ? json : result_text(setting, measured));
  return 0;
}

}  // namespace collidoscope
