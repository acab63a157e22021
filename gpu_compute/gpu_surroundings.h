#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "air/air_fields.h"
#include "air/steered_air.h"
#include "air/wind_source.h"
#include "core/surroundings.h"
#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_device.h"
#include "gpu_compute/hair_passes.h"
#include "gpu_compute/wind_passes.h"

namespace strandcast::gpu {

/// Wind on a grid and forces between hairs (docs/air.md) in the memory of the gpu backend: no state of
/// strands and no acceleration comes to the CPU or goes from there.
class GpuSurroundings final : public Surroundings,
                              public AirFields,
                              public SteeredAir,
                              public MeasuredPasses {
 public:
  explicit GpuSurroundings(std::vector<WindSource> sources);
  ~GpuSurroundings() override;

  bool isNeeded(const Parameters& parameters) const override;
  /// Throws Error where the backend is not that of this GPU.
  void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) override;
  void reset(const Vec3& origin) override;
  void moveOrigin(const Vec3& origin) override;
  void setSources(std::vector<WindSource> sources) override;
  void step(StepInput& input, Backend& backend) override;
  std::span<const Vec3> accelerations() override;

  bool hasDensity() const override { return splatted_; }
  bool hasWind() const override { return blows_; }
  Box box() const override;
  float cell() const override;
  AirSample at(const Vec3& point) const override;

  void measure(bool each, int steps) override;
  std::vector<std::pair<std::string, double>> takeTimes() override;
  PressureReport pressure() override;

 private:
  struct Passes;
  struct Image;
  /// Those that these settings need and `our` has not, and air that did not blow as at the start. Throws
  /// Error and leaves `our` as it was where they do not fit the GPU.
  void makeGrids(Passes& our, const StrandModel& model, const Parameters& parameters);
  void takeOrigin(const Vec3& origin);
  /// Those of the world, from origin_, to the GPU.
  void placeSources();
  const Image& image() const;
  AirSample atOwn(const Vec3& point) const;

  std::vector<WindSource> world_sources_;
  std::vector<WindSource> sources_;  ///< the same, from origin_, as are all places in here
  Vec3 origin_ = Vec3::Zero();
  Box box_;                      ///< of the groom at rest
  GpuDevice* device_ = nullptr;  ///< of the backend; null until configured
  std::unique_ptr<Passes> passes_;
  bool splatted_ = false, blows_ = false;  ///< in the newest step
  Pose head_;                              ///< at its start
  HeadCourse course_;
  Pose grid_head_;      ///< that carries the grid of hair: HeadCourse
  double seconds_ = 0;  ///< its length
  Ambient::Progress progress_;
  bool restarts_ = false;  ///< before the next step all is as at the start
  std::vector<Vec3> read_;
  mutable std::unique_ptr<Image> image_;  ///< of the newest step; null until it is looked at
};

/// What an image of a wind of `cells` has at a place in cells from its low corner, m/s.
Vec3 windAt(const WindPasses::Image& image, int cells, const Vec3& place);

}  // namespace strandcast::gpu
