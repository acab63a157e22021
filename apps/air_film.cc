#include "apps/air_film.h"

#include <algorithm>

namespace strandcast {

AirFilm::AirFilm(const std::string& quantity, const std::string& axis, int size,
                 const std::filesystem::path& folder)
    : name_(quantity),
      quantity_(airQuantity(quantity)),
      axis_(axis[0] - 'x'),
      size_(size),
      pictures_(folder) {}

bool AirFilm::canDraw(Simulation& simulation) const { return isOnGrid(simulation, quantity_); }
bool AirFilm::canDraw(const AirFields& fields) const { return isOnGrid(fields, quantity_); }
const char* AirFilm::settings() const { return settingsOf(quantity_); }

void AirFilm::draw(Simulation& simulation) { draw(fieldsWith(simulation, quantity_), simulation.guides()); }

void AirFilm::draw(const AirFields& fields, std::span<const Vec3> hair) {
  const AirSlice slice = airSlice(fields, quantity_, axis_, hair, size_);
  full_ = std::max(full_, slice.full);
  unit_ = slice.unit;
  pictures_.write(slice.image);
}

void AirFilm::addTo(Report& out) const {
  out.add("shown", "shown", name_);
  out.add("full", "largest value of all pictures", full_, unit_, 4);
  out.addCount("frames_drawn", "frames drawn", static_cast<uint64_t>(drawn()));
  out.add("out", "pictures", pictures_.pattern());
}

}  // namespace strandcast
