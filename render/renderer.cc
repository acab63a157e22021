#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"
#include "render/body_pass.h"
#include "render/framebuffer.h"
#include "render/hair_pass.h"
#include "render/shadow_map.h"

namespace strandcast {
namespace {

constexpr float kMaxCoordinate = 1e3f;  // m; a guide farther out does not widen the shadow map

constexpr double kLengthKept = 0.99;  // of hair of fewer segments
constexpr float kShadowHairs = 8;     // times as many cast shadows as are drawn, up to all

Box boundsOf(std::span<const Vec3> positions) {
  Box box;
  for (const Vec3& p : positions)
    if (p.allFinite() && p.cwiseAbs().maxCoeff() < kMaxCoordinate) box.extend(Eigen::Vector3f(p));
  return box;
}

Box moved(const Box& box, const Pose& pose) {
  Box result;
  if (box.isEmpty()) return result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(Eigen::Vector3f(pose.apply(box.corner(static_cast<Box::CornerType>(corner)))));
  return result;
}

/// Time stamps of the device between passes.
class PassClock {
 public:
  static constexpr int kStamps = 7;
  PassClock() { glCreateQueries(GL_TIMESTAMP, kStamps, queries_.data()); }
  ~PassClock() { glDeleteQueries(kStamps, queries_.data()); }
  PassClock(const PassClock&) = delete;
  PassClock& operator=(const PassClock&) = delete;
  void stamp(int i) { glQueryCounter(queries_[i], GL_TIMESTAMP); }
  double milliseconds(int from) const {
    GLuint64 begin = 0, end = 0;
    glGetQueryObjectui64v(queries_[from], GL_QUERY_RESULT, &begin);
    glGetQueryObjectui64v(queries_[from + 1], GL_QUERY_RESULT, &end);
    return end > begin ? 1e-6 * static_cast<double>(end - begin) : 0;
  }

 private:
  std::array<GLuint, kStamps> queries_{};
};

/// As few segments as leave hair its length, and with it the area that it covers, and eight a turn of a curl.
int leastSegments(const StrandSet& guides, int segments, const std::vector<Hair>& hairs) {
  float turns = 0;
  for (const Hair& hair : hairs)
    if (hair.curl_radius > 0) turns = std::max(turns, hair.curl_turns);
  int least = segments;
  while (least >= 8 && static_cast<float>(least / 2) >= 8 * turns &&
         lengthKept(guides, least / 2) > kLengthKept)
    least /= 2;
  return least;
}

/// Both paths read buffers in a stage where a device need not be able to.
void requireBuffers(GrowthPath path) {
  const bool tessellator = path == GrowthPath::kTessellator;
  GLint blocks = 0;
  glGetIntegerv(
      tessellator ? GL_MAX_TESS_EVALUATION_SHADER_STORAGE_BLOCKS : GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS,
      &blocks);
  if (blocks < (tessellator ? 5 : 3))
    throw Error(
        "the OpenGL device cannot grow hair",
        std::string(tessellator ? "tessellation" : "vertex") + " shaders read " + std::to_string(blocks) +
            " storage buffers",
        tessellator ? "grow it in compute" : "grow it on the tessellator, or use LIBGL_ALWAYS_SOFTWARE=1");
}

void setPassState() {
  for (GLenum off : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_SAMPLE_ALPHA_TO_COVERAGE})
    glDisable(off);
  for (GLenum on : {GL_DEPTH_TEST, GL_MULTISAMPLE, GL_FRAMEBUFFER_SRGB}) glEnable(on);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(const RenderSettings& wanted)
      : settings(clipped(wanted)),
        picture(settings.width * settings.supersampling, settings.height * settings.supersampling,
                settings.samples),
        shadows(settings.opacity),
        nodes(settings.segments),
        hair(settings.growth_path, settings.geometry),
        scene_buffer(sizeof(SceneBlock), nullptr, GL_DYNAMIC_STORAGE_BIT) {
    if (settings.supersampling > 1)
      still = std::make_unique<Supersampling>(settings.width, settings.height, settings.supersampling,
                                              settings.filter);
    hair.setClearance(settings.clearance);
    GLfloat range[2] = {1, 1};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, range);
    widest_line = std::max(range[1], 1.0f);
  }

  Box content() const {
    Box box = boundsOf(guides);
    box.extend(moved(body.bounds(), head));
    box.extend(body.bounds());  // a part of it stays
    return box;
  }

  /// Pixels across a hair of width 1 where the hair is nearest to the eye.
  float widestHair(const SceneBlock& block, const Box& box) const {
    const float distance = box.isEmpty() ? 1 : box.exteriorDistance(block.eye.head<3>());
    return block.hair_color.w() * block.eye.w() / std::max(distance, 0.02f);
  }

  void placeGround(SceneBlock& block) const {
    const Box& base = body.bounds().isEmpty() ? rest_bounds : body.bounds();
    if (base.isEmpty()) {
      block.ground = {0, -0.5f, 0, 2};
      return;
    }
    const float drop = body.bounds().isEmpty() ? 0.05f : 0.0f;
    block.ground << base.center().x(), base.min().y() - drop, base.center().z(),
        std::max(4 * base.diagonal().norm(), 0.1f);
  }

  /// `widest`: pixels of a hair of width 1 where it is nearest.
  HairDetail detailFor(const SceneBlock& block, float widest) const {
    const LevelOfDetail& wanted = settings.detail;
    const float finest =
        wanted.finest_hair > 0 ? wanted.finest_hair : 1 / static_cast<float>(picture.samples());
    HairDetail detail = wanted.part > 0 ? detailOfPart(hair.hairs(), wanted.part)
                                        : detailOfSize(hair.hairs(), widest, finest);
    const float segment_pixels =
        longest_guide / static_cast<float>(settings.segments) * widest / block.hair_color.w();
    detail.node_stride = strideFor(segment_pixels, wanted.longest_segment, settings.segments, least_segments);
    return detail;
  }

  /// Light reaches through many hairs, so that with as few as the eye sees its maps would be grainy.
  HairDetail shadowDetailFor(const HairDetail& seen) const {
    HairDetail detail = detailOfSize(hair.hairs(), kShadowHairs * seen.threshold, 1);
    detail.node_stride = seen.node_stride;
    return detail;
  }

  void drawShadows(const HairDetail& detail) {
    shadows.beginSolids();
    body.drawDepth(head);
    shadows.beginHairFront();
    hair.drawFront(nodes, detail);
    shadows.beginHairOpacity();
    hair.drawOpacity(nodes, detail, shadows.opacitySize());
    shadows.end();
  }

  void accept(const GuideFrame& frame) {
    const bool fits = frame.positions.size() == nodes.vertices() && frame.head.position.allFinite() &&
                      frame.head.rotation.coeffs().allFinite() && frame.head.rotation.norm() > 1e-6f;
    if (!fits) {
      ++statistics.frames_ignored;
      return;
    }
    guides = frame.positions;
    head = frame.head;
    colliders = frame.colliders;
  }

  void draw(const Camera& camera) {
    RenderSettings large = settings;
    large.width *= settings.supersampling;
    large.height *= settings.supersampling;
    SceneBlock block = makeSceneBlock(large, camera);
    shadows.fit(block, content());
    placeGround(block);
    const float widest = widestHair(block, boundsOf(guides));
    block.sampling.x() = static_cast<float>(picture.samples());
    const HairDetail detail = detailFor(block, widest);
    block.sampling.y() = std::clamp(1.25f * widest * std::max(1 / detail.threshold, 1.0f), 1.0f, widest_line);
    scene_buffer.write(std::span<const SceneBlock>(&block, 1));
    glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene_buffer.id());

    setPassState();
    clock.stamp(0);
    statistics.guides_unusable = nodes.update(guides, head);
    clock.stamp(1);
    hair.bodies().place(head, colliders);
    const HairDetail shadow_detail = shadowDetailFor(detail);
    hair.grow(nodes, shadow_detail.hairs > detail.hairs ? shadow_detail : detail);
    clock.stamp(2);
    if (settings.shadows) drawShadows(shadow_detail);
    clock.stamp(3);
    picture.bindForDrawing();
    glClear(GL_DEPTH_BUFFER_BIT);
    shadows.bindTextures();
    body.drawBackground();
    body.drawBody(head);
    body.drawGround();
    clock.stamp(4);
    if (settings.coverage == HairCoverage::kAlphaToCoverage && picture.samples() > 1)
      glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    hair.drawColor(nodes, block, detail);
    glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    statistics.hairs_drawn = detail.hairs;
    statistics.segments_drawn = (settings.segments + detail.node_stride - 1) / detail.node_stride;
    clock.stamp(5);
    picture.resolve();
    if (still) still->draw(picture.resolvedTexture());
    clock.stamp(6);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glUseProgram(0);
    ++statistics.frames_drawn;
  }

  GLuint shownTexture() const { return still ? still->texture().id() : picture.resolvedTexture(); }
  GLuint shownFramebuffer() const {
    return still ? still->framebuffer().id() : picture.resolvedFramebuffer();
  }

  RenderSettings settings;
  PictureBuffer picture;
  std::unique_ptr<Supersampling> still;  // null without supersampling
  ShadowMap shadows;
  GuideNodes nodes;
  HairPass hair;
  BodyPass body;
  PassClock clock;
  gl::Buffer scene_buffer;
  float widest_line = 1;
  std::vector<Vec3> guides;  // of the newest frame that fitted
  Pose head;
  std::vector<PlacedCollider> colliders;
  Box rest_bounds;
  float longest_guide = 0;  // m
  int least_segments = 1;
  RenderStatistics statistics;
};

Renderer::Renderer(const RenderSettings& settings) {
  requireBuffers(settings.growth_path);
  impl_ = std::make_unique<Impl>(settings);
}

Renderer::~Renderer() = default;

void Renderer::setGroom(const GroomDescription& groom) {
  const StrandSet& guides = groom.guides;
  if (guides.offsets.empty() || guides.offsets.back() != guides.positions.size())
    throw Error("a groom is damaged", groom.name, "its strands and its vertices do not fit together");
  impl_->nodes.setGroom(guides);
  const HairGrowth& growth = impl_->settings.growth;
  impl_->hair.setHairs(growHairs(guides, growth), growth.lock_profile);
  impl_->least_segments = leastSegments(guides, impl_->settings.segments, impl_->hair.hairs());
  impl_->longest_guide = 0;
  for (size_t g = 0; g < guides.strands(); ++g) {
    const float length = arcLength(guides.strand(g));
    if (std::isfinite(length)) impl_->longest_guide = std::max(impl_->longest_guide, length);
  }
  impl_->guides = guides.positions;
  impl_->head = Pose{};
  impl_->rest_bounds = boundsOf(guides.positions);
  impl_->statistics.guides = guides.strands();
  impl_->statistics.hairs_grown = impl_->hair.hairs().size();
}

void Renderer::setBody(const BodyDescription& body) { impl_->body.setBody(body); }

void Renderer::setObstacles(std::vector<HairObstacle> obstacles) {
  impl_->hair.bodies().setObstacles(std::move(obstacles));
}

void Renderer::draw(const GuideFrame& frame, const Camera& camera) {
  impl_->accept(frame);
  impl_->draw(camera);
}

Image Renderer::read() {
  Image image;
  image.width = impl_->settings.width;
  image.height = impl_->settings.height;
  const size_t row = static_cast<size_t>(image.width) * 3;
  std::vector<uint8_t> bottom_up(row * image.height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(impl_->shownTexture(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                    static_cast<GLsizei>(bottom_up.size()), bottom_up.data());
  image.rgb.reserve(bottom_up.size());
  for (int y = image.height - 1; y >= 0; --y)
    image.rgb.insert(image.rgb.end(), bottom_up.begin() + row * y, bottom_up.begin() + row * (y + 1));
  return image;
}

void Renderer::present(int window_width, int window_height) {
  if (window_width <= 0 || window_height <= 0) return;
  glDisable(GL_FRAMEBUFFER_SRGB);  // the picture is stored as it is shown
  glBlitNamedFramebuffer(impl_->shownFramebuffer(), 0, 0, 0, impl_->settings.width, impl_->settings.height, 0,
                         0, window_width, window_height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

RenderStatistics Renderer::statistics() const {
  RenderStatistics statistics = impl_->statistics;
  if (statistics.frames_drawn == 0) return statistics;
  double RenderStatistics::*const passes[] = {&RenderStatistics::guides_ms, &RenderStatistics::growth_ms,
                                              &RenderStatistics::shadow_ms, &RenderStatistics::body_ms,
                                              &RenderStatistics::hair_ms,   &RenderStatistics::resolve_ms};
  for (int i = 0; i < 6; ++i) statistics.*passes[i] = impl_->clock.milliseconds(i);
  statistics.device_bytes = impl_->nodes.bytes() + impl_->hair.bytes() + impl_->shadows.bytes();
  return statistics;
}

}  // namespace strandcast
