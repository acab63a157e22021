#include "collision/brick_search.h"

#include <algorithm>
#include <array>
#include <bit>

namespace strandcast {
namespace {

/// A cube of 2^level bricks per edge, clipped to the grid. Level 0: a brick.
struct Cube {
  std::array<uint32_t, 3> at;
  uint32_t level;
};

class BrickSearch {
 public:
  explicit BrickSearch(const FieldGrid& grid) : grid_(grid) {}

  std::vector<uint32_t> run(const MeshQuery& query, BakeLoop& loop, const BakeProgress& progress,
                            double done) const {
    std::vector<uint32_t> index(size_t{grid_.bricks[0]} * grid_.bricks[1] * grid_.bricks[2], kOutsideBrick);
    uint32_t level = std::bit_width(std::max({grid_.bricks[0], grid_.bricks[1], grid_.bricks[2]}) - 1);
    for (std::vector<Cube> cubes{{{0, 0, 0}, level}};; --level) {
      std::vector<uint8_t> near(cubes.size());
      loop.run(cubes.size(), progress, "finding bricks", done, done,
               [&](size_t i) { near[i] = comesNear(cubes[i], query); });
      std::vector<Cube> finer;
      for (size_t i = 0; i < cubes.size(); ++i) {
        if (near[i] == 0) continue;
        if (level > 0)
          split(cubes[i], finer);
        else
          index[brickNumber(cubes[i].at)] = kCandidate;
      }
      if (level == 0) return index;
      cubes = std::move(finer);
    }
  }

 private:
  size_t brickNumber(const std::array<uint32_t, 3>& at) const {
    return (size_t{at[2]} * grid_.bricks[1] + at[1]) * grid_.bricks[0] + at[0];
  }

  bool comesNear(const Cube& cube, const MeshQuery& query) const {
    Vec3 centre, half;
    for (int a = 0; a < 3; ++a) {
      const uint32_t end = std::min(cube.at[a] + (1u << cube.level), grid_.bricks[a]);
      half[a] = 0.5f * grid_.cell * static_cast<float>((end - cube.at[a]) * kBrickCells);
      centre[a] = grid_.origin[a] + grid_.cell * static_cast<float>(cube.at[a] * kBrickCells) + half[a];
    }
    const float reach = grid_.band + half.norm();
    return query.distance(centre, reach) < reach;
  }

  void split(const Cube& cube, std::vector<Cube>& finer) const {
    const uint32_t side = 1u << (cube.level - 1);
    for (uint32_t child = 0; child < 8; ++child) {
      Cube part{cube.at, cube.level - 1};
      for (int a = 0; a < 3; ++a) part.at[a] += (child >> a & 1) * side;
      if (part.at[0] < grid_.bricks[0] && part.at[1] < grid_.bricks[1] && part.at[2] < grid_.bricks[2])
        finer.push_back(part);
    }
  }

  const FieldGrid& grid_;
};

}  // namespace

std::vector<uint32_t> findBricks(const FieldGrid& grid, const MeshQuery& query, BakeLoop& loop,
                                 const BakeProgress& progress, double done) {
  return BrickSearch(grid).run(query, loop, progress, done);
}

}  // namespace strandcast
