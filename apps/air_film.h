#pragma once
#include <filesystem>
#include <string>

#include "apps/air_slices.h"
#include "apps/console.h"
#include "apps/picture_folder.h"
#include "core/simulation.h"

namespace strandcast {

/// Slices through the grids of a simulation or of a recording, frame by frame, as numbered pictures in a
/// folder.
class AirFilm {
 public:
  /// `quantity` as airQuantity(); `axis` "x", "y" or "z", which slices lie across; `size`, pixels along each
  /// edge. Makes the folder. Throws Error.
  AirFilm(const std::string& quantity, const std::string& axis, int size,
          const std::filesystem::path& folder);
  /// Whether the quantity is on a grid there. Throws Error where grids cannot be looked at.
  bool canDraw(Simulation& simulation) const;
  bool canDraw(const AirFields& fields) const;
  const char* settings() const;  ///< that put the quantity on a grid
  /// The next picture. Throws Error where the simulation has no such grid, or one that cannot be looked at.
  void draw(Simulation& simulation);
  /// The same of grids from elsewhere that have the quantity, and the hair at that time: vertices, m, world.
  void draw(const AirFields& fields, std::span<const Vec3> hair);
  int drawn() const { return pictures_.written(); }
  void addTo(Report& out) const;

 private:
  const std::string name_;
  const AirQuantity quantity_;
  const int axis_, size_;
  PictureFolder pictures_;
  double full_ = 0;  // largest value of all pictures
  const char* unit_ = "";
};

}  // namespace strandcast
