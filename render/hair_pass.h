// Grows the hairs of a picture, draws them, and draws diagnostic marks.
#pragma once
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_bodies.h"
#include "render/hair_growth.h"
#include "render/hair_selection.h"
#include "render/render_settings.h"
#include "render/scene_block.h"

namespace strandcast {

/// Hairs grown by a compute shader, once per picture for all passes. A vertex is two vec4: position (w:
/// fraction of the hair's length up to it) and unit tangent (w: 1 where all its guides are usable). Vertices
/// of a hair are contiguous from the root on; hairs are in their given order.
class HairVertices {
 public:
  /// A buffer holds as many hairs as the device allows; there are as many buffers as needed.
  struct Chunk {
    size_t first, hairs;
    gl::Buffer vertices;
  };

  HairVertices();

  /// Grows the first `count` of the bound hairs with a vertex at every `node_stride`-th node, and keeps them
  /// out of bodies where `bodies` is set. Precondition: the guides' nodes, the hairs and GrowthBlock are
  /// bound.
  void grow(size_t count, int segments, int node_stride, bool bodies);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  size_t hairs() const { return hairs_; }  ///< number grown last
  int nodesPerHair() const { return nodes_per_hair_; }
  size_t bytes() const;  ///< device memory

 private:
  void makeRoom(size_t count, int max_nodes);

  gl::Program free_, among_bodies_;
  std::vector<Chunk> chunks_;
  size_t room_ = 0, hairs_ = 0;
  int max_nodes_ = 0, nodes_per_hair_ = 0;
};

/// Grows hairs from guide nodes and draws them. With kCompute they are grown once per picture, and every pass
/// reads them. With kTessellator every pass grows them again by isoline tessellation, 64 hairs of up to 64
/// segments a patch; it draws only lines.
class HairPass {
 public:
  HairPass(GrowthPath path, HairGeometry geometry, HairShading shading = HairShading::kVertex,
           const LightCounts& lights = {});
  ~HairPass();
  HairPass(const HairPass&) = delete;
  HairPass& operator=(const HairPass&) = delete;

  void setLights(const LightCounts& lights);
  /// Of `growth`, only the parameters common to all hairs are used.
  void setHairs(std::vector<Hair> hairs, const HairGrowth& growth);
  /// Selects the hairs of a picture and their order; HairDetail::hairs counts from the first of these.
  /// Initially all, in their given order.
  void select(std::span<const uint32_t> hairs);
  /// The bodies whose penetration by hair is resolved, and the clearance, m.
  HairBodies& bodies() { return bodies_; }
  /// Whether penetration into bodies is resolved; otherwise they serve only for marks.
  void keepOut(bool keep) { keep_out_ = keep; }
  void setClearance(float clearance) { block_.clearance = clearance; }
  const std::vector<Hair>& hairs() const { return hairs_; }
  HairDetail all() const { return detailOfPart(hairs_, 1); }

  /// Call once per picture before drawing; `detail` must cover what any pass draws.
  void grow(const GuideNodes& nodes, const HairDetail& detail);
  /// Draws the depth of the hair nearest to a light of SceneBlock::lights. `line`: width of a hair in the
  /// map, texels, at least 1.
  void drawFront(const GuideNodes& nodes, const HairDetail& detail, size_t light, float line = 1) const;
  void drawOpacity(const GuideNodes& nodes, const HairDetail& detail, size_t light, int map_size,
                   float line = 1) const;
  void drawColor(const GuideNodes& nodes, const SceneBlock& block, const HairDetail& detail) const;

  /// `program`: any program of grownStages() or tessellatedStages(), matching the path.
  void draw(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail, bool strips) const;
  /// Makes `program` (of tessellatedStages()) current with the buffers and uniforms for `detail`.
  void bind(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail) const;
  void drawPatches(const GuideNodes& nodes, const HairDetail& detail) const;
  /// Binds guides, hairs and all obstacles, even where penetration is not resolved, until hair is drawn.
  void bindForMarks(const GuideNodes& nodes);
  /// The vertices grown last, with kCompute.
  const HairVertices& vertices() const { return vertices_; }
  size_t bytes() const {
    return hair_buffer_.bytes() + list_buffer_.bytes() + vertices_.bytes() + bodies_.bytes();
  }  ///< device memory

 private:
  /// One per fragment shader, for the chosen path.
  struct Programs {
    gl::Program front, opacity, color;
  };
  static Programs makePrograms(GrowthPath path, HairGeometry geometry, HairShading shading,
                               const LightCounts& lights);
  static gl::Program colorProgram(GrowthPath path, HairGeometry geometry, HairShading shading,
                                  const LightCounts& lights);
  void bindHair(const GuideNodes& nodes) const;
  void drawGrown(const gl::Program& program, size_t count, bool strips) const;

  GrowthPath path_;
  HairGeometry geometry_;
  HairShading shading_;
  std::vector<Hair> hairs_;
  GrowthBlock block_{};
  bool keep_out_ = true;
  gl::Buffer hair_buffer_, list_buffer_, block_buffer_, marks_block_buffer_;
  HairVertices vertices_;
  HairBodies bodies_;
  Programs programs_;
  GLuint empty_vertices_ = 0;
};

/// The stages that read grown hair; `defines` are listed in hair_strand.vert.
std::vector<gl::ShaderStage> grownStages(const std::string& defines, const char* fragment);
/// The stages that grow hair on the tessellator; `defines` are listed in hair.tese. `fragment` may be null.
std::vector<gl::ShaderStage> tessellatedStages(const char* defines, const char* fragment);

/// Draws marks over a picture, with depth test.
class Marks {
 public:
  Marks();
  ~Marks();
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  /// `reach`: distance that counts as touching, m. Precondition: the hair was grown for this picture.
  void draw(const MarkSettings& marks, const GuideNodes& nodes, HairPass& hair, float reach) const;

 private:
  gl::Program guides_, tangents_, collided_, inside_;
  GLuint empty_vertices_ = 0;
};

}  // namespace strandcast
