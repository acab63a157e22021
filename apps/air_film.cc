#include "apps/air_film.h"

#include <algorithm>

#include "apps/picture_folder.h"
#include "core/error.h"

namespace strandcast {

AirFilm::AirFilm(const std::string& quantity, const std::string& axis, int size,
                 const std::filesystem::path& folder)
    : name_(quantity),
      quantity_(airQuantity(quantity)),
      axis_(axis[0] - 'x'),
      size_(size),
      folder_(folder),
      made_(folder) {}

void AirFilm::draw(Simulation& simulation) {
  const AirFields* fields = airFields(simulation.surroundings());
  if (fields == nullptr)
    throw Error("this backend's grids cannot be looked at", simulation.backend().name(), "choose simd");
  draw(*fields, simulation.guides());
}

void AirFilm::draw(const AirFields& fields, std::span<const Vec3> hair) {
  checkHas(fields, quantity_);
  const AirSlice slice = airSlice(fields, quantity_, axis_, hair, size_);
  full_ = std::max(full_, slice.full);
  unit_ = slice.unit;
  writePng(picturePath(folder_, drawn_), slice.image);
  ++drawn_;
}

void AirFilm::addTo(Report& out) const {
  out.add("shown", "shown", name_);
  out.add("full", "largest value, of all pictures", full_, unit_, 4);
  out.addCount("frames_drawn", "frames drawn", static_cast<uint64_t>(drawn_));
  out.add("out", "pictures", (folder_ / "frame_*.png").string());
}

}  // namespace strandcast
