#include "bench/bullet_ropes.h"
#include "core/error.h"

namespace strandcast {

struct BulletRopes::World {};

bool bulletAvailable(std::string* reason) {
  if (reason != nullptr)
    *reason = "this build has no Bullet: install libbullet-dev (./dev setup) and configure again";
  return false;
}
std::string bulletVersion() { return ""; }

BulletRopes::BulletRopes(const std::vector<StrandPoints>&, double) {
  throw Error("this build has no Bullet", "Bullet's ropes", "install libbullet-dev (./dev setup)");
}
BulletRopes::~BulletRopes() = default;
void BulletRopes::configure(double, int, int, double) {}
void BulletRopes::step(const Pose&, const Pose&) {}
std::vector<Vec3> BulletRopes::positions() const { return {}; }

}  // namespace strandcast
