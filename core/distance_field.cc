#include "core/distance_field.h"

#include <algorithm>

#include "kernels/scalar_float.h"

namespace strandcast {
namespace {

namespace k = kernels::f32;

k::real3 lanes(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 vector(const k::real3& v) { return {v.x, v.y, v.z}; }

/// Trilinear interpolant of the eight values `get(n)`, n from `first` with these strides per axis.
template <class Get>
float interpolate(Get get, uint32_t first, uint32_t row, uint32_t slice, const k::real3& t,
                  k::real3& gradient) {
  const uint32_t above = first + slice;
  return k::trilinear(get(first), get(first + 1), get(first + row), get(first + row + 1), get(above),
                      get(above + 1), get(above + row), get(above + row + 1), t, gradient);
}

/// Range of the differences of neighbouring samples, per axis, in sample units.
struct Steps {
  Vec3 least = Vec3::Constant(1e9f), most = -least;
  void add(int axis, float step) {
    least[axis] = std::min(least[axis], step);
    most[axis] = std::max(most[axis], step);
  }
  // Every gradient of the interpolant lies in the box of these differences. Seen from 0, the box lies in a
  // cone of half angle asin(half its diagonal / distance of its centre).
  bool even() const {
    constexpr float kWide = 0.45f;  // 27 degrees of half angle: below 60 between two normals
    return (most - least).norm() < kWide * (most + least).norm();
  }
};

/// Adds the differences in the cells `first` to `end` of a brick, per axis.
void addSteps(const uint32_t* brick, const uint32_t (&first)[3], const uint32_t (&end)[3], Steps& steps) {
  const uint32_t strides[3] = {1, kBrickSide, kBrickSide * kBrickSide};
  for (uint32_t z = first[2]; z <= end[2]; ++z)
    for (uint32_t y = first[1]; y <= end[1]; ++y)
      for (uint32_t x = first[0]; x <= end[0]; ++x) {
        const uint32_t at[3] = {x, y, z}, n = (z * kBrickSide + y) * kBrickSide + x;
        for (int axis = 0; axis < 3; ++axis)
          if (at[axis] < end[axis])
            steps.add(axis,
                      static_cast<float>(fieldSample(brick, n + strides[axis]) - fieldSample(brick, n)));
      }
}

}  // namespace

bool DistanceField::hasInside() const {
  const auto is_inside = [](uint32_t words) {
    return (words & 0x80008000u) != 0;
  };  // sign bits of both samples
  const float deep =
      -0.5f * grid.quantum;  // corners on a sheet without volume are rounded to either side of it
  return std::any_of(corners.begin(), corners.end(), [&](float distance) { return distance < deep; }) ||
         std::any_of(samples.begin(), samples.end(), is_inside);
}

std::vector<uint32_t> DistanceField::evenness() const {
  constexpr int kMostCells = 2;
  std::vector<uint32_t> words((storedBricks() + kEvennessesPerWord - 1) / kEvennessesPerWord);
  const auto brickAt = [&](const int(&at)[3]) -> const uint32_t* {
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= static_cast<int>(grid.bricks[axis])) return nullptr;
    const uint32_t entry =
        index[(static_cast<size_t>(at[2]) * grid.bricks[1] + at[1]) * grid.bricks[0] + at[0]];
    return entry < kInsideBrick ? samples.data() + size_t{entry} * kBrickWords : nullptr;
  };
  // Whether a brick with this many cells around it is even.
  const auto isEven = [&](const int(&at)[3], int cells) {
    Steps steps;
    for (int n = 0; n < 27; ++n) {
      const int side[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      if (cells == 0 && n != 13) continue;
      const int other[3] = {at[0] + side[0], at[1] + side[1], at[2] + side[2]};
      const uint32_t* brick = brickAt(other);
      if (brick == nullptr) return false;
      uint32_t first[3], end[3];
      for (int axis = 0; axis < 3; ++axis) {
        first[axis] = side[axis] < 0 ? kBrickCells - cells : 0;
        end[axis] = side[axis] > 0 ? cells : kBrickCells;
      }
      addSteps(brick, first, end, steps);
      if (!steps.even()) return false;
    }
    return true;
  };
  int at[3];
  for (at[2] = 0; at[2] < static_cast<int>(grid.bricks[2]); ++at[2])
    for (at[1] = 0; at[1] < static_cast<int>(grid.bricks[1]); ++at[1])
      for (at[0] = 0; at[0] < static_cast<int>(grid.bricks[0]); ++at[0]) {
        const uint32_t* brick = brickAt(at);
        if (brick == nullptr) continue;
        uint32_t even = 0;
        while (static_cast<int>(even) <= kMostCells && isEven(at, static_cast<int>(even))) ++even;
        const auto entry = static_cast<uint32_t>((brick - samples.data()) / kBrickWords);
        words[entry / kEvennessesPerWord] |= even << (2 * (entry % kEvennessesPerWord));
      }
  return words;
}

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
