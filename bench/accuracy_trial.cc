#include "bench/accuracy_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/simulation.h"
#include "simd/simd_backend.h"
#include "validation/newton_rod.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kEdges = 32;
constexpr double kLength = 0.25;    // m
constexpr int kTruthSubsteps = 96;  // per frame: 5760 per second
constexpr float kFrame = StrandTrial::kFrame, kSettlingDrag = StrandTrial::kSettlingDrag,
                kDrag = StrandTrial::kDrag;
constexpr int kFrames = StrandTrial::kFrames, kSettlingFrames = StrandTrial::kSettlingFrames;

Parameters truthParameters(int substeps, float drag) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = kFrame;
  parameters.substeps = substeps;
  parameters.air_drag = drag;
  return parameters;
}

// The strand twice: upright and level.
StrandModel inBothPoses(const StrandPoints& points) {
  const Quat level(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Eigen::Vector3f::UnitZ()));
  StrandPoints turned;
  for (const Vec3& p : points) turned.push_back(level * p);
  return modelOf({points, turned});
}

NewtonRod restingRod(const StrandModel& model, size_t strand) {
  constexpr int kSubsteps = 6;
  const Pose root = model.rest_roots[strand];
  NewtonRod rod(model, strand, truthParameters(kSubsteps, kSettlingDrag), root);
  for (int frame = 0; frame < 2 * kSettlingFrames; ++frame) rod.step(root, root);
  return rod;
}

std::vector<Eigen::Vector3d> tipOf(NewtonRod rod, const Pose& root, const Shake& shake, int substeps) {
  rod.setParameters(truthParameters(substeps, kDrag));
  std::vector<Eigen::Vector3d> tip;
  for (int frame = 1; frame <= kFrames; ++frame) {
    rod.step(StrandTrial::rootAt(frame - 1, shake) * root, StrandTrial::rootAt(frame, shake) * root);
    tip.push_back(rod.positions().back());
  }
  return tip;
}

double rms(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

ShakenStrand truthOf(const StrandPoints& points, const Shake& shake) {
  ShakenStrand out;
  out.shake = shake;
  out.points = points;
  out.poses = inBothPoses(points);
  const NewtonRod upright = restingRod(out.poses, 0);
  out.rest = {upright.positions(), restingRod(out.poses, 1).positions()};
  out.tip = tipOf(upright, out.poses.rest_roots[0], shake, kTruthSubsteps);
  out.truth_error = rms(out.tip, tipOf(upright, out.poses.rest_roots[0], shake, kTruthSubsteps / 2));
  return out;
}

// A simulation of both poses at rest, settled under kSettlingDrag.
Simulation rested(const ShakenStrand& strand, Parameters parameters) {
  parameters.air_drag = kSettlingDrag;
  Simulation simulation(strand.poses, {}, parameters, makeSimdBackend(1));
  for (int frame = 0; frame < kSettlingFrames; ++frame) simulation.step();
  parameters.air_drag = kDrag;
  simulation.setParameters(parameters);
  return simulation;
}

double restError(const ShakenStrand& strand, Simulation& simulation) {
  std::vector<Eigen::Vector3d> truth, found;
  for (const auto& shape : strand.rest) truth.insert(truth.end(), shape.begin(), shape.end());
  for (const Vec3& p : simulation.guides()) found.push_back(p.cast<double>());
  return rms(found, truth);
}

void chooseShapeRates(const ShakenStrand& strand, Parameters& parameters) {
  // An iteration restores 1 - exp(-rate h / iterations) of the shape, h the substep.
  const double unit = parameters.iterations * parameters.substeps / static_cast<double>(kFrame);
  Parameters trial = parameters;
  double least = std::numeric_limits<double>::infinity();
  for (const double strength : {0.0, 0.003, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.999})
    for (const double part : {1.0, 0.5, 0.25, 0.125, 0.0}) {
      const double rate = -std::log1p(-strength) * unit;
      trial.shape_rate = static_cast<float>(rate);
      trial.shape_rate_tip = static_cast<float>(part * rate);
      Simulation simulation = rested(strand, trial);
      const double error = restError(strand, simulation);
      if (!(error < least)) continue;
      least = error;
      parameters = trial;
    }
}

}  // namespace

ShakenStrand straightTruth(const Shake& shake) {
  return truthOf(straightStrand(kLength, kEdges, -Vec3::UnitY()), shake);
}
ShakenStrand curlTruth(const Shake& shake) {
  return truthOf(helixStrand(0.01, 0.01, kLength, kEdges), shake);
}

StrandError errorOf(const ShakenStrand& strand, Parameters parameters) {
  parameters.time_step = kFrame;
  if (parameters.solver == SolverKind::kGaussSeidel) chooseShapeRates(strand, parameters);
  return errorWith(strand, parameters);
}

StrandError errorWith(const ShakenStrand& strand, Parameters parameters) {
  parameters.time_step = kFrame;
  Simulation simulation = rested(strand, parameters);
  StrandError out;
  out.shape_rate = parameters.shape_rate;
  out.shape_rate_tip = parameters.shape_rate_tip;
  out.rest = restError(strand, simulation);
  std::vector<Eigen::Vector3d> tip;
  for (int frame = 1; frame <= kFrames; ++frame) {
    simulation.setHeadPose(StrandTrial::rootAt(frame, strand.shake));
    simulation.step();
    tip.push_back(simulation.guides()[kEdges].cast<double>());
    const Measurement measured = simulation.measure();
    out.mean_stretch += measured.mean_stretch / kFrames;
    out.max_stretch = std::max(out.max_stretch, measured.max_stretch);
  }
  out.tip = rms(tip, strand.tip);
  return out;
}

double costOf(const ShakenStrand& straight, const ShakenStrand& curl, Parameters parameters, int copies,
              int frames, int threads) {
  parameters.time_step = kFrame;
  parameters.air_drag = kDrag;
  std::vector<StrandPoints> strands;
  for (int i = 0; i < copies; ++i) {
    strands.push_back(straight.points);
    strands.push_back(curl.points);
  }
  Simulation simulation(modelOf(strands), {}, parameters, makeSimdBackend(threads));
  double shortest = std::numeric_limits<double>::infinity();
  for (int frame = 1; frame <= frames; ++frame) {
    simulation.setHeadPose(StrandTrial::rootAt(frame, straight.shake));
    const auto start = std::chrono::steady_clock::now();
    simulation.step();
    simulation.guides();
    shortest =
        std::min(shortest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return shortest / static_cast<double>(simulation.model().vertices());
}

}  // namespace strandcast
