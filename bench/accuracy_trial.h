#pragma once
#include <vector>

#include "core/parameters.h"
#include "core/strand_model.h"
#include "validation/shaken_root.h"

namespace strandcast {

/// By 0.1 m and 45 degrees at 1 Hz, which grows over half a second.
inline constexpr Shake kSlowShake{.ramp = 0.5};

/// How every strand is tried: frames of 1/60 s; the root goes straight from one to the next, for the truth as
/// for the solvers. It settles under much drag, then its root is shaken.
struct StrandTrial {
  static constexpr float kFrame = 1.0f / 60.0f;              ///< s
  static constexpr int kSettlingFrames = 240, kFrames = 90;  ///< 4 s, and 1.5 s of shaking
  static constexpr float kSettlingDrag = 10, kDrag = 2;      ///< 1/s
  static Pose rootAt(int frame, const Shake& shake) {        ///< relative to rest
    return shakenRoot(static_cast<double>(frame) * kFrame, shake);
  }
};

/// A strand of 25 cm and what it truly does, by NewtonRod: its two rest shapes, and the way of its tip while
/// its root is shaken.
struct ShakenStrand {
  Shake shake;
  std::vector<Vec3> points;                        ///< upright, as made, m
  StrandModel poses;                               ///< the strand twice: its root upright, then level
  std::vector<std::vector<Eigen::Vector3d>> rest;  ///< per pose, per vertex, m
  std::vector<Eigen::Vector3d> tip;                ///< per frame, m, of the upright one
  double truth_error = 0;  ///< m, rms distance of the tip to that of the truth at half its rate
};
ShakenStrand straightTruth(const Shake& shake = kSlowShake);
ShakenStrand curlTruth(const Shake& shake = kSlowShake);

/// How a solver with some parameters does on a strand.
struct StrandError {
  float shape_rate = 0, shape_rate_tip = 0;  ///< 1/s, that it was done with
  double rest = 0;  ///< m, rms distance of the vertices of both rest shapes from the true ones
  double tip = 0;   ///< m, rms distance of the shaken tip from the true one
  double mean_stretch = 0, max_stretch = 0;  ///< of both, while shaken
};
/// `parameters` as they are, but for time step, drag and, for gauss_seidel, the shape rates: that solver does
/// not know Young's modulus, so it gets those of all on a grid with which its rest shapes are nearest to the
/// true ones. On the simd backend.
StrandError errorOf(const ShakenStrand& strand, Parameters parameters);
/// The same with the shape rates that are given.
StrandError errorWith(const ShakenStrand& strand, Parameters parameters);

/// Time of one frame of `copies` of both strands, shaken, per vertex: the shortest of `frames`, s.
double costOf(const ShakenStrand& straight, const ShakenStrand& curl, Parameters parameters, int copies,
              int frames, int threads);

}  // namespace strandcast
