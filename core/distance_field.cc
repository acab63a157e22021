#include "core/distance_field.h"

#include "kernels/scalar_float.h"

namespace strandcast {
namespace {

namespace k = kernels::f32;

k::real3 lanes(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 vector(const k::real3& v) { return {v.x, v.y, v.z}; }

/// Trilinear interpolant of the eight numbers `get(n)`, n from `first` with these strides per axis.
template <class Get>
float interpolate(Get get, uint32_t first, uint32_t row, uint32_t slice, const k::real3& t,
                  k::real3& gradient) {
  const uint32_t above = first + slice;
  return k::trilinear(get(first), get(first + 1), get(first + row), get(first + row + 1), get(above),
                      get(above + 1), get(above + row), get(above + row + 1), t, gradient);
}

}  // namespace

size_t DistanceField::bytes() const {
  return sizeof(grid) + sizeof(uint32_t) * (index.size() + samples.size()) + sizeof(float) * corners.size();
}

FieldSample DistanceField::at(const Vec3& point) const {
  const k::real3 counts{static_cast<float>(grid.bricks[0]), static_cast<float>(grid.bricks[1]),
                        static_cast<float>(grid.bricks[2])};
  const k::FieldPlace place =
      k::fieldPlace(lanes(point), {grid.origin[0], grid.origin[1], grid.origin[2]}, grid.cell, counts);
  FieldSample out;
  k::real3 gradient;
  if (k::dot(place.outside, place.outside) > 0) {
    out.distance = k::distanceOutsideGrid(place.outside, grid.band, gradient);
    out.gradient = vector(gradient);
    return out;
  }
  const uint32_t entry = index[static_cast<uint32_t>(place.brick)];
  if (entry < kInsideBrick) {
    const uint32_t* brick = samples.data() + size_t{entry} * kBrickWords;
    const float value = interpolate([&](uint32_t n) { return static_cast<float>(fieldSample(brick, n)); },
                                    static_cast<uint32_t>(place.first_sample), kBrickSide,
                                    kBrickSide * kBrickSide, place.in_cell, gradient);
    out.distance = value * grid.quantum;
    out.gradient = vector(gradient) * (grid.quantum / grid.cell);
    return out;
  }
  const uint32_t row = grid.bricks[0] + 1;
  const float at_corners =
      interpolate([&](uint32_t n) { return corners[n]; }, static_cast<uint32_t>(place.corner), row,
                  row * (grid.bricks[1] + 1), place.in_brick, gradient);
  const float edge = grid.cell * kBrickCells;
  out.distance =
      k::farDistance(at_corners, place.in_brick, edge, entry == kOutsideBrick ? 1.0f : -1.0f, grid.band);
  out.gradient = vector(gradient) / edge;
  return out;
}

Vec3 samplePosition(const FieldGrid& grid, uint32_t i, uint32_t j, uint32_t k) {
  return {grid.origin[0] + grid.cell * static_cast<float>(i),
          grid.origin[1] + grid.cell * static_cast<float>(j),
          grid.origin[2] + grid.cell * static_cast<float>(k)};
}

}  // namespace strandcast
