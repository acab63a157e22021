#include "collision/tree_broad_phase.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <algorithm>

namespace strandcast {
namespace {

/// An FCL collision object that only serves as a box.
class BoxObject {
 public:
  explicit BoxObject(uint32_t index)
      : index_(index), shape_(std::make_shared<fcl::Boxd>(1, 1, 1)), object_(shape_) {
    object_.setUserData(&index_);
  }
  BoxObject(const BoxObject&) = delete;
  BoxObject& operator=(const BoxObject&) = delete;

  void update(const Box& box) {
    shape_->aabb_local = fcl::AABBd(box.min().cast<double>(), box.max().cast<double>());
    object_.computeAABB();
  }
  fcl::CollisionObjectd* object() { return &object_; }

 private:
  uint32_t index_;
  std::shared_ptr<fcl::Boxd> shape_;
  fcl::CollisionObjectd object_;
};

bool endless(const Box& box) { return box.sizes().maxCoeff() >= kEndless; }

class TreeBroadPhase final : public BroadPhase {
 public:
  void findPairs(std::span<const Box> bodies, std::span<const Box> neighbourhoods,
                 NearBodyLists& out) override {
    update(bodies);
    out.offsets.assign(1, 0);
    out.bodies.clear();
    for (const Box& neighbourhood : neighbourhoods) {
      const auto first = static_cast<ptrdiff_t>(out.bodies.size());
      if (endless(neighbourhood)) {
        for (uint32_t i = 0; i < bodies.size(); ++i) out.bodies.push_back(i);
      } else {
        out.bodies.insert(out.bodies.end(), outside_.begin(), outside_.end());
        query_.update(neighbourhood);
        tree_.collide(query_.object(), &out.bodies, note);
        std::sort(out.bodies.begin() + first, out.bodies.end());
      }
      out.offsets.push_back(static_cast<uint32_t>(out.bodies.size()));
    }
  }

 private:
  static bool note(fcl::CollisionObjectd* body, fcl::CollisionObjectd* /*query*/, void* list) {
    static_cast<std::vector<uint32_t>*>(list)->push_back(*static_cast<uint32_t*>(body->getUserData()));
    return false;  // continue
  }

  /// Updates the tree. Unbounded boxes stay outside: they would enlarge the tree's boxes without bound.
  void update(std::span<const Box> bodies) {
    bool same = bodies.size() == objects_.size();
    for (size_t i = 0; same && i < bodies.size(); ++i) same = endless(bodies[i]) == (objects_[i] == nullptr);
    if (same) {
      for (size_t i = 0; i < bodies.size(); ++i)
        if (objects_[i] != nullptr) objects_[i]->update(bodies[i]);
      tree_.update();
      return;
    }
    tree_.clear();
    objects_.clear();
    outside_.clear();
    std::vector<fcl::CollisionObjectd*> in_tree;
    for (uint32_t i = 0; i < bodies.size(); ++i) {
      objects_.push_back(endless(bodies[i]) ? nullptr : std::make_unique<BoxObject>(i));
      if (objects_[i] == nullptr) {
        outside_.push_back(i);
        continue;
      }
      objects_[i]->update(bodies[i]);
      in_tree.push_back(objects_[i]->object());
    }
    tree_.registerObjects(in_tree);
    tree_.setup();
  }

  std::vector<std::unique_ptr<BoxObject>> objects_;  ///< one per body, null outside the tree
  std::vector<uint32_t> outside_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;  // destroyed before the objects that it refers to
  BoxObject query_{0};
};

}  // namespace

std::unique_ptr<BroadPhase> makeTreeBroadPhase() { return std::make_unique<TreeBroadPhase>(); }

}  // namespace strandcast
