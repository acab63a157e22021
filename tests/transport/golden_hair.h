#pragma once
#include <cmath>
#include <cstdint>
#include <random>

#include "transport/codec/guide_payload.h"
#include "transport/messages.h"

namespace strandcast {

/// Strands of 1 to 41 vertices; their number is a multiple of no lane count. Their bits are equal on every
/// machine: the only library function is the square root. At frame 0 they are at rest.
inline std::vector<Vec3> goldenStrand(uint32_t number, uint64_t frame) {
  std::minstd_rand random(number + 1);
  const auto unit = [&] { return static_cast<float>(random() % 65536) / 32768 - 1; };
  const Vec3 base(unit(), unit(), unit()), bend(unit(), -1, unit()), wave(unit(), unit(), unit());
  const float sway = 0.02f * static_cast<float>(frame) * unit();
  std::vector<Vec3> strand(1 + number * number % 41);
  strand[0] = 0.1f * base;
  for (size_t i = 1; i < strand.size(); ++i) {
    const float along = static_cast<float>(i) / static_cast<float>(strand.size());
    const float zigzag = static_cast<float>(i % 7) / 7 - 0.5f;
    const Vec3 way = (1.0f - along) * base + (along + sway) * bend + zigzag * wave;
    const float length = std::sqrt(way.x() * way.x() + way.y() * way.y() + way.z() * way.z());
    strand[i] = strand[i - 1] + (0.008f / length) * way;
  }
  return strand;
}

inline constexpr uint32_t kGoldenStrands = 203;

inline GroomDescription goldenGroom() {
  GroomDescription groom;
  groom.groom_id = 1;
  groom.session = 11;
  groom.revision = 1;
  for (uint32_t s = 0; s < kGoldenStrands; ++s) groom.guides.append(goldenStrand(s, 0));
  return groom;
}

/// One strand is far away, so that it is sent as float32.
inline GuideFrame goldenFrame(uint64_t number) {
  GuideFrame frame;
  frame.groom_id = 1;
  frame.session = 11;
  frame.revision = 1;
  frame.frame = number;
  frame.head.rotation = Quat(0.8f, 0, 0.6f, 0);
  frame.head.position = Vec3(0.25f, 0.5f * static_cast<float>(number), -0.125f);
  const HeadFrame head(frame.head);
  for (uint32_t s = 0; s < kGoldenStrands; ++s) {
    for (const Vec3& point : goldenStrand(s, number))
      frame.positions.push_back(head.toWorld(point) + (s == 31 ? Vec3(900, 0, 0) : Vec3(0, 0, 0)));
  }
  return frame;
}

}  // namespace strandcast
