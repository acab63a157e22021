#pragma once
#include <string>
#include <vector>

#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_bodies.h"
#include "render/hair_detail.h"
#include "render/hair_growth.h"
#include "render/hair_vertices.h"
#include "render/render_settings.h"
#include "render/scene_block.h"

namespace strandcast {

/// Grows hairs from guide nodes and draws them. By kCompute they are grown once per picture and every pass
/// reads them; by kTessellator every pass grows them again, by isoline tessellation, 64 hairs of up to 64
/// segments a patch, which draws lines only.
class HairPass {
 public:
  HairPass(GrowthPath path, HairGeometry geometry, HairShading shading = HairShading::kVertex,
           const LightCounts& lights = {});
  ~HairPass();
  HairPass(const HairPass&) = delete;
  HairPass& operator=(const HairPass&) = delete;

  void setLights(const LightCounts& lights);
  /// Of `growth` what all hairs have in common counts.
  void setHairs(std::vector<Hair> hairs, const HairGrowth& growth);
  /// Which of the hairs a picture is of, in the order in which it draws them: HairDetail::hairs counts them
  /// from the first of these. All, as they were set, until this is called.
  void select(std::span<const uint32_t> hairs);
  /// What the hair is kept out of and how far, m.
  HairBodies& bodies() { return bodies_; }
  /// Or lets it in: then they are only there for marks.
  void keepOut(bool keep) { keep_out_ = keep; }
  void setClearance(float clearance) { block_.clearance = clearance; }
  const std::vector<Hair>& hairs() const { return hairs_; }
  HairDetail all() const { return detailOfPart(hairs_, 1); }

  /// Once per picture, before it draws; `detail` holds what any pass will draw.
  void grow(const GuideNodes& nodes, const HairDetail& detail);
  /// Depth of the hair nearest to a light of SceneBlock::lights.
  /// `line`: texels that a hair is wide in the map, 1 or more.
  void drawFront(const GuideNodes& nodes, const HairDetail& detail, size_t light, float line = 1) const;
  void drawOpacity(const GuideNodes& nodes, const HairDetail& detail, size_t light, int map_size,
                   float line = 1) const;
  void drawColor(const GuideNodes& nodes, const SceneBlock& block, const HairDetail& detail) const;

  /// With any program of grownStages or tessellatedStages, as the path is.
  void draw(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail, bool strips) const;
  /// Makes `program` (of tessellatedStages) current with the buffers and uniforms for what `detail` has.
  void bind(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail) const;
  void drawPatches(const GuideNodes& nodes, const HairDetail& detail) const;
  /// Binds guides, hairs and all obstacles, whether hair is kept out of them or not, until hair is drawn.
  void bindForMarks(const GuideNodes& nodes);
  /// Grown last, by kCompute.
  const HairVertices& vertices() const { return vertices_; }
  size_t bytes() const {
    return hair_buffer_.bytes() + list_buffer_.bytes() + vertices_.bytes() + bodies_.bytes();
  }  ///< of device memory

 private:
  /// With a fragment shader each, for the path that was chosen.
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

/// The stages that read hair grown before; `defines` as hair_strand.vert lists them.
std::vector<gl::ShaderStage> grownStages(const std::string& defines, const char* fragment);
/// The stages that grow hair on the tessellator; `defines` as hair.tese lists them. `fragment` may be null.
std::vector<gl::ShaderStage> tessellatedStages(const char* defines, const char* fragment);

}  // namespace strandcast
