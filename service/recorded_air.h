#pragma once
#include <cstdint>

#include "air/air_system.h"
#include "service/stream.h"
#include "transport/recording/recorder.h"

namespace strandcast {

/// Samples the fields at the middle of each cell: air and hair, or hair alone where there is no wind grid.
AirGrids gridsOf(const AirFields& fields);

/// An observer that records the grids of every `every`th frame (from 1), beginning with the first, where the
/// settings need a grid. `to` must outlive it.
SimulationObserver gridRecorder(RecordingPublisher& to, uint32_t every);

/// Warns where no grids were recorded.
void warnWithoutGrids(const Recorder& recorder);

/// Recorded grids with the interface of a simulation's. Wind is interpolated between the middles of cells;
/// other values are constant within a cell.
class RecordedAir final : public AirFields {
 public:
  /// `grids` must be valid and must outlive this.
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
