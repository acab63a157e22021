#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "air/air_system.h"
#include "air/wind_source.h"
#include "core/backend.h"
#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_device.h"
#include "gpu_compute/hair_passes.h"
#include "gpu_compute/wind_passes.h"

namespace strandcast::gpu {

/// Air system (docs/air.md) in the memory of the gpu backend: wind on a grid and forces between hairs.
/// Neither the state of strands nor accelerations pass through the CPU. Not thread-safe.
class GpuAirSystem final : public AirSystem, public MeasuredPasses {
 public:
  explicit GpuAirSystem(std::vector<WindSource> sources);
  ~GpuAirSystem() override;

  bool isNeeded(const Parameters& parameters) const override;
  /// Throws Error unless `backend` is the gpu backend, or if the grids do not fit the GPU's memory. `backend`
  /// must outlive this.
  void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) override;
  void reset(const Vec3& origin) override;
  void moveOrigin(const Vec3& origin) override;
  void setSources(std::vector<WindSource> sources) override;
  void step(StepInput& input, Backend& backend) override;
  std::span<const Vec3> accelerations() override;

  bool hasDensity() const override { return splatted_; }
  bool hasWind() const override { return has_wind_grid_; }
  Box box() const override;
  float cell() const override;
  AirSample at(const Vec3& point) const override;

  void measure(bool each, int steps) override;
  std::vector<std::pair<std::string, double>> drainTimes() override;
  PressureReport pressure() override;

 private:
  struct Passes;
  struct Image;
  /// Makes the grids that these settings need and `our` lacks, and resets air that did not blow in the last
  /// step. Throws Error, with the grids of `our` unchanged, if they do not fit the GPU's memory.
  void makeGrids(Passes& our, const StrandModel& model, const Parameters& parameters);
  void setOrigin(const Vec3& origin);
  /// Sets sources_ to world_sources_ relative to origin_, and uploads them.
  void placeSources();
  const Image& image() const;
  AirSample atOwn(const Vec3& point) const;

  std::vector<WindSource> world_sources_;
  std::vector<WindSource> sources_;  ///< the same relative to origin_, as are all positions in here
  Vec3 origin_ = Vec3::Zero();
  Box box_;                      ///< of the groom at rest, m
  GpuDevice* device_ = nullptr;  ///< of the backend; null until configured
  std::unique_ptr<Passes> passes_;
  bool splatted_ = false, has_wind_grid_ = false;  ///< in the newest step
  Pose head_;                                      ///< at the start of the newest step
  HeadExtrapolation head_extrapolation_;
  Pose grid_head_;      ///< pose of the hair grid: HeadExtrapolation::ahead()
  double seconds_ = 0;  ///< s, length of the newest step
  Ambient::Progress progress_;
  bool restarts_ = false;  ///< the next step starts from the initial state of the air
  std::vector<Vec3> read_;
  mutable std::unique_ptr<Image> image_;  ///< downloaded grids of the newest step; null until needed
};

/// Velocity in a downloaded wind grid of `cells` per axis, m/s. `place`: from the grid's low corner, in
/// cells.
Vec3 windAt(const WindPasses::Image& image, int cells, const Vec3& place);

}  // namespace strandcast::gpu
