#pragma once
#include <cstdint>

#include "air/air_fields.h"
#include "apps/channel.h"
#include "transport/recording/recording_publisher.h"

namespace strandcast {

/// What there is now in the middle of each cell: of a grid of air, or of hair alone.
AirGrids gridsOf(const AirFields& fields);

/// Records the grids of every `every`th frame (from 1), the first one too, where settings put air or hair on
/// a grid. `to` outlives it.
SimulationObserver gridRecorder(RecordingPublisher& to, uint32_t every);

/// Says so where grids were asked for and none came.
void warnWithoutGrids(const Recorder& recorder);

/// Recorded grids, to be looked at as those of a simulation are: wind is interpolated between the middles of
/// cells, everything else is a cell's.
class RecordedAir final : public AirFields {
 public:
  /// Sound ones, which outlive it.
  explicit RecordedAir(const AirGrids& grids) : grids_(grids) {}
  bool hasDensity() const override { return !grids_.of(GridValue::kDensity).empty(); }
  bool hasWind() const override { return !grids_.of(GridValue::kWindX).empty(); }
  Box box() const override;
  float cell() const override { return grids_.cell; }
  AirSample at(const Vec3& point) const override;

 private:
  float valueAt(GridValue value, size_t cell) const;
  float between(GridValue value, const Vec3& place) const;

  const AirGrids& grids_;
};

}  // namespace strandcast
