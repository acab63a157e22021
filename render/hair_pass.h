// Grows the hairs of a picture, draws them, and draws diagnostic marks.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/bound_hairs.h"
#include "render/guide_nodes.h"
#include "render/hair_bodies.h"
#include "render/hair_growth.h"
#include "render/hair_selection.h"
#include "render/render_settings.h"
#include "render/scene_block.h"

namespace strandcast {

/// Hairs grown by a compute shader, once per picture for all passes: those from a seed, or the bound ones. A
/// vertex is two vec4: position (w: fraction of the hair's length up to it) and unit tangent (w: width over
/// the hair's full width; -1 where a guide of it is not usable). Vertices of a hair are contiguous from the
/// root on; hairs are in the order of the list.
class HairVertices {
 public:
  /// A buffer holds as many hairs as the device allows; there are as many buffers as needed.
  struct Chunk {
    size_t first, hairs;
    gl::Buffer vertices;
  };

  /// Grows `count` hairs, from `first` of the list on, with a vertex at every `node_stride`-th of their
  /// `nodes` nodes and at the last one. `program`: hair_growth.comp or bound_growth.comp. Precondition: the
  /// guides' nodes, the hairs and GrowthBlock are bound.
  void grow(const gl::Program& program, size_t first, size_t count, int nodes, int node_stride);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  size_t first() const { return first_; }  ///< of the list, of those grown last
  size_t hairs() const { return hairs_; }  ///< number grown last
  int nodesPerHair() const { return nodes_per_hair_; }
  size_t bytes() const;  ///< device memory

 private:
  void makeRoom(size_t count, int max_nodes);

  std::vector<Chunk> chunks_;
  size_t room_ = 0, first_ = 0, hairs_ = 0;
  int max_nodes_ = 0, nodes_per_hair_ = 0;
};

/// Grows hairs from guide nodes and draws them. With kCompute they are grown once per picture, and every pass
/// reads them. With kTessellator every pass grows them again by isoline tessellation, 64 hairs of up to 64
/// segments a patch; it draws only lines. Bound hairs are grown by compute shaders on both paths.
class HairPass {
 public:
  HairPass(GrowthPath path, HairGeometry geometry, HairShading shading = HairShading::kVertex,
           const LightCounts& lights = {});
  ~HairPass();
  HairPass(const HairPass&) = delete;
  HairPass& operator=(const HairPass&) = delete;

  void setLights(const LightCounts& lights);
  /// Of `growth`, only the parameters common to all hairs are used.
  /// `bound`: the shapes of bound hairs; null where there are none. Precondition: `hairs` is sorted by
  /// detailKey().
  void setHairs(std::vector<Hair> hairs, const HairGrowth& growth, std::unique_ptr<BoundHairs> bound = {});
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
  /// The bound hairs grown last, with both paths.
  const HairVertices& boundVertices() const { return bound_vertices_; }
  /// Index in hairs() of the n-th of the list: those from a seed, then the bound ones, each in the order of
  /// select().
  uint32_t listed(size_t n) const { return list_[n]; }
  size_t bytes() const;  ///< device memory

 private:
  /// One per fragment shader, for the chosen path.
  struct Programs {
    gl::Program front, opacity, color;
  };
  /// How many of a picture's hairs are of each kind.
  struct Kinds {
    size_t seeded, bound;
  };
  static Programs makePrograms(GrowthPath path, HairGeometry geometry, HairShading shading,
                               const LightCounts& lights);
  static gl::Program colorProgram(GrowthPath path, HairGeometry geometry, HairShading shading,
                                  const LightCounts& lights);
  Kinds kindsOf(size_t hairs) const;
  /// Those that draw bound hairs.
  const Programs& boundPrograms() const { return bound_programs_ ? *bound_programs_ : programs_; }
  void bindHair(const GuideNodes& nodes) const;
  void growBound(const HairDetail& detail);
  /// Draws hairs of both kinds with their programs.
  void drawBoth(gl::Program Programs::*program, const GuideNodes& nodes, const HairDetail& detail,
                bool strips) const;
  void drawGrown(const gl::Program& program, const HairVertices& vertices, size_t count, bool strips) const;

  GrowthPath path_;
  HairGeometry geometry_;
  HairShading shading_;
  LightCounts lights_;
  std::vector<Hair> hairs_;
  std::vector<uint32_t> list_;
  std::vector<uint32_t> bound_before_;  ///< per prefix of select(), its bound hairs; empty without any
  size_t listed_seeded_ = 0;
  GrowthBlock block_{};
  bool keep_out_ = true;
  gl::Buffer hair_buffer_, list_buffer_, block_buffer_, marks_block_buffer_;
  gl::Program free_, among_bodies_;
  HairVertices vertices_, bound_vertices_;
  std::unique_ptr<BoundHairs> bound_;
  uint32_t bound_rest_ = 0;  ///< HairBodies::revision() of which bound hairs have their distances at rest
  HairBodies bodies_;
  Programs programs_;
  std::unique_ptr<Programs> bound_programs_;  ///< null where programs_ draw them too
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
