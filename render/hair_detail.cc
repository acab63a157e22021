#include "render/hair_detail.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

float detailKey(const Hair& hair) { return hair.width * hair.importance / std::max(1 - hair.dither, 1e-7f); }

float HysteresisSize::of(float size, float band) {
  const float widen = 1 + band;
  if (!(size <= held_ && size * widen * widen >= held_)) held_ = size * widen;
  return held_;
}

HairDetail detailOfPart(std::span<const Hair> hairs, float part) {
  HairDetail detail;
  detail.hairs = hairs.size();
  if (hairs.empty() || !(part < 1)) return detail;
  const double wanted = std::ceil(static_cast<double>(part) * static_cast<double>(hairs.size()));
  detail.hairs = std::clamp<size_t>(static_cast<size_t>(wanted), 1, hairs.size());
  detail.threshold = 1 / std::max(detailKey(hairs[detail.hairs - 1]), 1e-9f);
  return detail;
}

HairDetail detailOfSize(std::span<const Hair> hairs, float hair_pixels, float finest) {
  HairDetail detail;
  detail.hairs = hairs.size();
  if (!(hair_pixels > 0 && finest > 0)) return detail;
  detail.threshold = hair_pixels / finest;
  // Slightly below 1, so that rounding in the shader never selects a hair that is not in the list.
  const float least = 0.999f / detail.threshold;
  const auto end = std::partition_point(hairs.begin(), hairs.end(),
                                        [&](const Hair& hair) { return detailKey(hair) >= least; });
  detail.hairs = static_cast<size_t>(end - hairs.begin());
  return detail;
}

double lengthKept(const StrandSet& strands, int pieces) {
  double chords = 0, arcs = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const auto points = strands.strand(s);
    const float length = arcLength(points);
    if (points.size() < 2 || !std::isfinite(length) || !(length > 0)) continue;
    arcs += length;
    Vec3 last = points.front();
    int piece = 1;
    float run = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const float edge = (points[i] - points[i - 1]).norm();
      for (; piece < pieces && run + edge >= length * static_cast<float>(piece) / static_cast<float>(pieces);
           ++piece) {
        const float part =
            (length * static_cast<float>(piece) / static_cast<float>(pieces) - run) / std::max(edge, 1e-12f);
        const Vec3 at = Vec3(points[i - 1] + part * (points[i] - points[i - 1]));
        chords += static_cast<double>((at - last).norm());
        last = at;
      }
      run += edge;
    }
    chords += static_cast<double>((points.back() - last).norm());
  }
  return arcs > 0 ? chords / arcs : 1;
}

int strideFor(float segment_pixels, float longest, int segments, int min_segments) {
  int stride = 1;
  while (2 * static_cast<float>(stride) * segment_pixels <= longest &&
         segments >= 2 * stride * std::max(min_segments, 1))
    stride *= 2;
  return stride;
}

}  // namespace strandcast
