#pragma once
#include <cstddef>
#include <span>

#include "core/guide_packing.h"
#include "transport/messages.h"

namespace strandcast {

/// The guides of a frame where they are, for example in a GPU's memory. Who publishes takes what it needs.
class GuideSource {
 public:
  virtual ~GuideSource() = default;
  virtual size_t vertices() const = 0;
  /// World positions of all vertices, m, natural order, of which only those of `count` vertices from `first`
  /// on need be right. Valid until the next call. May wait for a device.
  virtual std::span<const Vec3> positions(size_t first, size_t count) = 0;
  /// The same guides packed: one entry per run of `grid`, valid until the next call of packed(). Empty where
  /// they are not.
  virtual std::span<const PackedRun> packed(const GuideGrid&, const PackingFrame&) { return {}; }
};

/// Guides that are in a frame.
class FrameGuides final : public GuideSource {
 public:
  /// `frame` must outlive it.
  explicit FrameGuides(const GuideFrame& frame) : positions_(frame.positions) {}
  size_t vertices() const override { return positions_.size(); }
  std::span<const Vec3> positions(size_t, size_t) override { return positions_; }

 private:
  std::span<const Vec3> positions_;
};

/// Copies all guides into the frame.
inline void copyGuides(GuideSource& guides, GuideFrame& frame) {
  const std::span<const Vec3> all = guides.positions(0, guides.vertices());
  frame.positions.assign(all.begin(), all.end());
}

}  // namespace strandcast
