#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "validation/specimen.h"

namespace strandcast {

/// Whether this build has Bullet; otherwise `reason` says why not.
bool bulletAvailable(std::string* reason = nullptr);
/// "3.24"; empty without Bullet.
std::string bulletVersion();

/// Strands as soft-body ropes of the Bullet physics library, for comparison. Each strand is one rope made by
/// btSoftBodyHelpers::CreateRope, with rigid links (m_kLST = 1). The links are solved from root to tip, which
/// is the best order for hanging ropes. There is no collision and no bending. The ropes' own steps are called
/// as a world calls them, without the world's overhead. Single-threaded: Bullet's soft bodies support nothing
/// else.
class BulletRopes {
 public:
  /// Straight strands of equal edge lengths, m. `mass_per_length` in kg/m: a vertex has the mass of half of
  /// each adjacent edge; the first vertex is fixed. Throws Error without Bullet.
  BulletRopes(const std::vector<StrandPoints>& strands, double mass_per_length);
  ~BulletRopes();

  /// `frame`: duration of a frame, s. `substeps` per frame, `iterations` per substep. `drag` in 1/s.
  void configure(double frame, int substeps, int iterations, double drag);
  /// Simulates a frame. The roots move from `begin` to `end` by linear interpolation.
  void step(const Pose& begin, const Pose& end);
  /// m, strand after strand.
  std::vector<Vec3> positions() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace strandcast
