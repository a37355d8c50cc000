#include "headless/compare.h"

#include <fmt/format.h>

#include "headless/cli/standard_output.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {

ImageDifference compare_images(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw InputError(fmt::format("compare: the pictures are {}x{} and {}x{}; expected the same size", a.width,
                                 a.height, b.width, b.height));
  const capture::Comparison channels = capture::compare(pixels_of(a), pixels_of(b), capture::tight(5));
  if (channels.different == 0) return {};
  const capture::Comparison seen = capture::compare(pixels_of(a), pixels_of(b), capture::loose());
  return {.max_channel = channels.max_difference,
          .share_over_5 = static_cast<double>(channels.beyond) / (static_cast<double>(a.width) * a.height),
          .perceptual_mean = seen.flip_mean,
          .perceptual_p99 = seen.flip_p99};
}

int run_compare(const std::string& a, const std::string& b, bool json) {
  const Image first = read_png(a), second = read_png(b);
  const ImageDifference d = compare_images(first, second);
  if (json)
    print(fmt::format(
        "{{\"max_channel\": {}, \"share_over_5\": {}, \"perceptual_mean\": {}, \"perceptual_p99\": {}}}\n",
        d.max_channel, d.share_over_5, d.perceptual_mean, d.perceptual_p99));
  else
    print(
        fmt::format("largest channel difference  {} of 255\npixels over 5 of 255        {:.4f} %\n"
                    "FLIP, mean                  {:.6f}\nFLIP, 99th percentile       {:.6f}\n",
                    d.max_channel, 100 * d.share_over_5, d.perceptual_mean, d.perceptual_p99));
  return d.max_channel == 0 ? 0 : 1;
}

}  // namespace collidoscope
