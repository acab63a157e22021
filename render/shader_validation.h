// For tests and `strandcast validate render`: hair and light maps read back from the device, and the same
// hair grown on the CPU in double precision.
#pragma once
#include <Eigen/Core>

#include <span>
#include <vector>

#include "render/hair_growth.h"
#include "render/hair_pass.h"
#include "render/shadow_maps.h"

namespace strandcast {

/// A vertex of grown hair, read back from the device.
struct GrownVertex {
  Vec3 position;  ///< m
  uint32_t hair;  ///< index in HairPass::hairs()
  Vec3 tangent;   ///< unit
  uint32_t node;
};

/// The vertices that the compute shader grew last with this node stride: hair after hair in draw order, root
/// to tip.
std::vector<GrownVertex> readComputed(const HairPass& pass, const GuideNodes& nodes, int node_stride);
/// The same of the bound hairs; a hair of fewer vertices than the one with most repeats its tip.
std::vector<GrownVertex> readBound(const HairPass& pass, int vertex_stride = 1);
/// The vertices that the tessellator grows, by transform feedback: two per line, lines in unspecified order.
std::vector<GrownVertex> readTessellated(const HairPass& pass, const GuideNodes& nodes,
                                         const HairDetail& detail);

/// A fragment of a hair in a texel of the opacity map.
struct LightFragment {
  float x, y;           ///< texels
  float depth;          ///< 0 to 1, in the light's depth range
  float optical_depth;  ///< of this fragment
};

/// The maps' values at a point.
struct LightAnswer {
  float behind;         ///< m, behind the front of the hair
  float optical_depth;  ///< of the hair between the light and the point
};

/// A groom at rest and the light's maps of it, read back for validation. Needs a current context.
class LightProbe {
 public:
  /// Uses the settings growth, hair_width, segments and lights; all lights cast shadows.
  LightProbe(const StrandSet& guides, const RenderSettings& settings);

  /// Every hair fragment that an opacity map of `map_size` texels accumulates, in unspecified order: the
  /// exact data along the light's rays.
  std::vector<LightFragment> fragments(int map_size, size_t light = 0);
  /// Draws the maps of all lights and evaluates those of `light`, by the shaders' own look-up, at points in
  /// its coordinates (0 to 1).
  std::vector<LightAnswer> ask(const OpacityLayers& layers, std::span<const Vec3> points, size_t light = 0);
  /// m, for the light's depth coordinate from 0 to 1.
  float depthRange(size_t light = 0) const { return block_.lights[light].way.w(); }
  /// Tangent of half the view angle of the maps of a light with a position.
  float slope(size_t light = 0) const {
    return 1 / block_.lights[light].view_projection.block<1, 3>(0, 0).norm();
  }

 private:
  void bindScene(const ShadowMaps& maps, const OpacityLayers& layers);

  RenderSettings settings_;
  GuideNodes nodes_;
  HairPass hair_;
  Box box_;
  SceneBlock block_{};
  gl::Buffer scene_;
};

/// Hairs grown on the CPU in double precision with the same kernel source as the shaders (kernels/hair.h):
/// the reference of validation. Slow.
class HairReference {
 public:
  /// `positions`: vertices of all guides, as in a frame. Guides without a curve give zeros.
  HairReference(const StrandSet& rest_guides, std::span<const Vec3> positions, int segments);

  struct Vertex {
    Eigen::Vector3d position;  ///< m
    Eigen::Vector3d tangent;   ///< unit
  };
  /// The vertex at node 0 to `segments`, without bodies. `growth`: the parameters of the hair's growth.
  Vertex at(const Hair& hair, const HairGrowth& growth, int node) const;
  /// Length of the hair's guide 0 as the sum of chords between nodes, m.
  double guideLength(const Hair& hair) const;

 private:
  struct Node {
    Eigen::Vector3d position, derivative, normal;
  };

  int segments_;
  std::vector<Node> nodes_;  ///< segments + 1 per guide
};

}  // namespace strandcast
