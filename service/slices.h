// Slices through the grids of air and through distance fields, as pictures.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "air/air_system.h"
#include "core/distance_field.h"
#include "core/simulation.h"
#include "io/image.h"
#include "options/console.h"
#include "options/output_folder.h"

namespace strandcast {

/// The quantity that a slice through the air shows.
enum class AirQuantity { kDensity, kWind, kPressure, kDivergence };
/// "density", "wind", "pressure" or "divergence"; Error otherwise.
AirQuantity airQuantity(const std::string& name);
/// The options that put the quantity on a grid: "--set wind_grid=1".
const char* settingsOf(AirQuantity quantity);
/// Whether the fields hold the quantity.
bool isOnGrid(const AirFields& fields, AirQuantity quantity);
/// Whether the newest step computed the quantity on a grid. Throws Error where this backend's grids cannot be
/// read.
bool isOnGrid(Simulation& simulation, AirQuantity quantity);
/// The fields of the newest step. Throws Error where the quantity is on no grid, naming the setting that puts
/// it there, or where this backend's grids cannot be read.
const AirFields& fieldsWith(Simulation& simulation, AirQuantity quantity);

/// A slice as a picture, with the scale of its colours.
struct AirSlice {
  Image image;
  double full = 0;   ///< value that the fullest colour stands for
  const char* unit;  ///< unit of `full`
};

/// A slice across `axis` (0 to 2) through the middle of the grid, `size` pixels along each edge. Colour runs
/// from white to the full colour at the slice's largest absolute value: red above 0, blue below. Bodies are
/// grey. Hair within one cell of the slice is drawn as dots. Wind is drawn as its speed, with arrows two
/// cells apart.
AirSlice airSlice(const AirFields& fields, AirQuantity quantity, int axis, std::span<const Vec3> hair,
                  int size);

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

/// A slice through the field across `axis` (0 to 2) at the fraction `part` (0 to 1) of its grid. Blue is
/// outside, red inside, both paler towards the surface, which is a black line. Near the surface a thin line
/// marks every four cells.
Image fieldSlice(const DistanceField& field, int axis, double part);

/// Writes three slices per axis (x_25.png, x_50.png, ...) into the folder, which it creates. Returns their
/// paths.
std::vector<std::filesystem::path> writeFieldSlices(const DistanceField& field,
                                                    const std::filesystem::path& folder);

}  // namespace strandcast
