#pragma once
#include <cmath>
#include <random>

#include "sample_messages.h"

namespace strandcast {

/// Wavy hair of inextensible strands on a head that turns and nods while the strands sway: typical input of
/// the codecs. Strand s has `length` m and `vertices(s)` vertices.
template <class VerticesOf>
GroomDescription hairGroom(size_t strands, VerticesOf vertices, float length = 0.25f);

/// Positions of strand s at a time, in the head's frame: edges of equal length, directions that bend, wave
/// and sway along the strand.
inline void swayingStrand(size_t s, double time, float length, std::span<Vec3> out) {
  std::minstd_rand random(static_cast<uint32_t>(s) + 1);
  random.discard(8);
  std::uniform_real_distribution<float> unit(-1, 1);
  const float azimuth = 3.14f * unit(random), height = 0.5f + 0.5f * unit(random), phase = 3 * unit(random);
  const float waves = 12 + 6 * unit(random), own = 0.1f * unit(random);
  const Vec3 up(std::sqrt(1 - height * height) * std::sin(azimuth), height,
                std::sqrt(1 - height * height) * std::cos(azimuth));
  const float edge = out.size() > 1 ? length / static_cast<float>(out.size() - 1) : 0;
  out[0] = 0.1f * up;
  for (size_t i = 1; i < out.size(); ++i) {
    const float along = static_cast<float>(i) / static_cast<float>(out.size());
    const auto sway = 0.35f * along * static_cast<float>(std::sin(5 * time + 2 * along)) + own;
    const float wave = 0.35f * std::sin(waves * along + phase);
    Vec3 direction = (1 - along) * up + along * Vec3(sway, -1.2f, 0.5f * sway) +
                     wave * Vec3(std::cos(azimuth), 0.1f, -std::sin(azimuth));
    out[i] = out[i - 1] + edge * direction.normalized();
  }
}

template <class VerticesOf>
GroomDescription hairGroom(size_t strands, VerticesOf vertices, float length) {
  GroomDescription groom;
  groom.groom_id = 1;
  groom.session = 11;
  groom.revision = 1;
  groom.name = "hair";
  std::vector<Vec3> points;
  for (size_t s = 0; s < strands; ++s) {
    points.resize(vertices(s));
    swayingStrand(s, 0, length, points);
    groom.guides.append(points);
  }
  return groom;
}

/// Header of frame `number` at 60 Hz, without positions.
inline GuideFrame frameOf(const GroomDescription& groom, uint64_t number) {
  GuideFrame frame;
  frame.groom_id = groom.groom_id;
  frame.session = groom.session;
  frame.revision = groom.revision;
  frame.frame = number;
  frame.simulation_time = static_cast<double>(number) / 60;
  frame.publish_time = systemTime();
  return frame;
}

inline GuideFrame hairFrame(const GroomDescription& groom, uint64_t number, float length = 0.25f) {
  GuideFrame frame = frameOf(groom, number);
  const double time = frame.simulation_time;
  const auto turn = static_cast<float>(0.8 * std::sin(3 * time));
  frame.head.rotation = Quat(Eigen::AngleAxisf(turn, Eigen::Vector3f::UnitY()) *
                             Eigen::AngleAxisf(0.3f * turn, Eigen::Vector3f::UnitX()));
  frame.head.position = Vec3(0.1f * turn, 0.02f, 0.3f);
  frame.positions.resize(groom.guides.vertices());
  for (size_t s = 0; s < groom.guides.strands(); ++s) {
    const std::span<Vec3> strand(frame.positions.data() + groom.guides.offsets[s],
                                 groom.guides.verticesOf(s));
    swayingStrand(s, time, length, strand);
    for (Vec3& point : strand) point = frame.head.apply(point);
  }
  return frame;
}

}  // namespace strandcast
