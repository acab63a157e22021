#include "render/hair_detail.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

constexpr double kFade = 0.25;  // of the drawn hairs thin out, where few are drawn

}  // namespace

HairWidths::HairWidths(std::span<const Hair> hairs) : sums_(1, 0.0), moments_(1, 0.0) {
  const double all = static_cast<double>(hairs.size());
  for (size_t i = 0; i < hairs.size(); ++i) {
    const double width = hairs[i].width, rank = (static_cast<double>(i) + 0.5) / all;
    sums_.push_back(sums_.back() + width);
    moments_.push_back(moments_.back() + width * rank);
  }
}

HairDetail HairWidths::detail(float part) const {
  const size_t all = sums_.size() - 1;
  HairDetail detail;
  detail.hairs = all;
  if (all == 0 || !(part < 1)) return detail;
  const double count = static_cast<double>(all), kept = std::max(static_cast<double>(part), 1 / count);
  // The fade shrinks to nothing as all hairs come back.
  const double fade = kFade * kept * (1 - kept) + 0.5 / count;
  const auto upTo = [&](double rank) {  // hairs whose rank is below it
    return static_cast<size_t>(std::clamp(std::ceil(rank * count - 0.5), 0.0, count));
  };
  const size_t whole = upTo(kept - fade), last = std::max<size_t>(upTo(kept), 1);
  // Sum of width x min((kept - rank) / fade, 1).
  const double fading = (kept * (sums_[last] - sums_[whole]) - (moments_[last] - moments_[whole])) / fade;
  const double drawn = sums_[whole] + fading;
  detail.part = static_cast<float>(kept);
  detail.width_scale = drawn > 0 ? static_cast<float>(sums_[all] / drawn) : 1;
  detail.fade = static_cast<float>(1 / fade);
  detail.hairs = last;
  return detail;
}

float partFor(float hair_pixels, float finest) {
  return finest > 0 && hair_pixels < finest ? std::max(hair_pixels / finest, 0.0f) : 1.0f;
}

int strideFor(float segment_pixels, float longest, int segments, int least_segments) {
  int stride = 1;
  while (2 * stride * segment_pixels <= longest && segments >= 2 * stride * std::max(least_segments, 1))
    stride *= 2;
  return stride;
}

}  // namespace strandcast
