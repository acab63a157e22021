#pragma once
#include <vector>

#include "core/parameters.h"
#include "core/strand_model.h"
#include "validation/specimen.h"

namespace strandcast {

/// Amplitude 0.1 m and 45 degrees at 1 Hz, ramped over 0.5 s.
inline constexpr Shake kSlowShake{.ramp = 0.5};

/// The protocol of every trial, with frames of 1/60 s. The strand settles under high drag, then its root is
/// shaken. The root's pose is interpolated between frames, for the reference as for the solvers.
struct StrandTrial {
  static constexpr float kFrame = 1.0f / 60.0f;              ///< s
  static constexpr int kSettlingFrames = 240, kFrames = 90;  ///< 4 s of settling, and 1.5 s of shaking
  static constexpr float kSettlingDrag = 10, kDrag = 2;      ///< 1/s
  static Pose rootAt(int frame, const Shake& shake) {        ///< relative to the rest pose
    return shakenRoot(static_cast<double>(frame) * kFrame, shake);
  }
};

/// A strand of 25 cm with its reference solution by NewtonRod: both rest shapes, and the trajectory of the
/// tip while the root is shaken.
struct ShakenStrand {
  Shake shake;
  std::vector<Vec3> points;                        ///< upright, as groomed, m
  StrandModel poses;                               ///< the strand twice: root upright, then level
  std::vector<std::vector<Eigen::Vector3d>> rest;  ///< rest shapes per pose and vertex, m
  std::vector<Eigen::Vector3d> tip;                ///< trajectory of the upright strand's tip, per frame, m
  double truth_error = 0;  ///< m, rms difference of the tip between the reference and one at half its substep
                           ///< rate
};
/// Compute the reference of a straight strand and of a helix of radius 1 cm.
ShakenStrand straightTruth(const Shake& shake = kSlowShake);
ShakenStrand curlTruth(const Shake& shake = kSlowShake);

/// Error of a solver with given parameters on a strand.
struct StrandError {
  float shape_rate = 0, shape_rate_tip = 0;  ///< 1/s, the rates used
  double rest = 0;  ///< m, rms distance of the vertices of both rest shapes from the reference
  double tip = 0;   ///< m, rms distance of the shaken tip from the reference
  double mean_stretch = 0, max_stretch = 0;  ///< of both poses, while shaken
};
/// Uses `parameters` except for time step, drag and, for gauss_seidel, the shape rates. That solver has no
/// Young's modulus, so the shape rates are those of a grid that minimise its rest error. Runs on the simd
/// backend.
StrandError errorOf(const ShakenStrand& strand, Parameters parameters);
/// The same with the shape rates of `parameters`.
StrandError errorWith(const ShakenStrand& strand, Parameters parameters);

/// Time per vertex of one frame of `copies` of both shaken strands, s: the minimum over `frames` frames.
double costOf(const ShakenStrand& straight, const ShakenStrand& curl, Parameters parameters, int copies,
              int frames, int threads);

}  // namespace strandcast
