#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "validation/specimen.h"

namespace strandcast {

/// Whether this build has Bullet, and why not.
bool bulletAvailable(std::string* reason = nullptr);
/// "3.24"; empty where there is none.
std::string bulletVersion();

/// Strands as soft-body ropes of the Bullet physics library, a peer to compare with: one rope each, made by
/// btSoftBodyHelpers::CreateRope, of links that do not give (m_kLST = 1), left in their order from root to
/// tip, which is the best one for hanging ropes. Nothing collides. The bodies' own steps are called, as a
/// world calls them, without what a world adds to their cost. One thread: Bullet's soft bodies have no other
/// way. Ropes have no bending.
class BulletRopes {
 public:
  /// Straight strands of edges of one length, m. `mass_per_length` in kg/m: a vertex has that of half the
  /// edges beside it; the first is held. Throws Error without Bullet.
  BulletRopes(const std::vector<StrandPoints>& strands, double mass_per_length);
  ~BulletRopes();

  /// Per frame and per step. `drag` in 1/s.
  void configure(double frame, int substeps, int iterations, double drag);
  /// A frame, in which the roots go straight from where `begin` has them to where `end` has them.
  void step(const Pose& begin, const Pose& end);
  /// m, strand after strand.
  std::vector<Vec3> positions() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace strandcast
