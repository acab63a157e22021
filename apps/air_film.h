#pragma once
#include <filesystem>
#include <string>

#include "apps/air_slices.h"
#include "apps/console.h"
#include "apps/picture_folder.h"
#include "core/simulation.h"

namespace strandcast {

/// Draws slices through the air grids of a simulation or a recording as numbered pictures in a folder, one
/// per frame.
class AirFilm {
 public:
  /// `quantity`: a name of airQuantity(). `axis`: "x", "y" or "z", the normal of the slice. `size`: edge
  /// length of a picture, pixels. Creates the folder. Throws Error.
  AirFilm(const std::string& quantity, const std::string& axis, int size,
          const std::filesystem::path& folder);
  /// Whether the simulation holds the quantity on a grid. Throws Error where the backend's grids cannot be
  /// read.
  bool canDraw(Simulation& simulation) const;
  bool canDraw(const AirFields& fields) const;
  const char* settings() const;  ///< options that put the quantity on a grid
  /// Draws the next picture. Throws Error where the simulation has no such grid or its grids cannot be read.
  void draw(Simulation& simulation);
  /// Draws grids from another source that hold the quantity. `hair`: vertex positions at that time, m, world.
  void draw(const AirFields& fields, std::span<const Vec3> hair);
  int drawn() const { return pictures_.written(); }
  void addTo(Report& out) const;

 private:
  const std::string name_;
  const AirQuantity quantity_;
  const int axis_, size_;
  PictureFolder pictures_;
  double full_ = 0;  // largest value in all pictures
  const char* unit_ = "";
};

}  // namespace strandcast
