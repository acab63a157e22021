#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "air/ambient.h"
#include "air/wind.h"
#include "air/wind_box.h"
#include "air/wind_source.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/pass_timer.h"
#include "gpu_compute/placed_bodies.h"
#include "gpu_compute/pressure_passes.h"

namespace strandcast::gpu {

/// The air of air/wind_grid.h as compute shaders. What a pass is told goes through `block`, which is sent
/// before it. Every call needs the context that made it current.
class WindPasses {
 public:
  WindPasses(int cells, float cell, Wind::Border border, ProgramCache& programs);

  int cells() const { return cells_; }
  float cell() const { return cell_; }
  Vec3 origin() const { return box_.corner(); }
  Ambient& ambient() { return ambient_; }

  /// Writes where the box is and what blows into the settings.
  void describe(AirSettings& settings, double seconds) const;
  /// As Wind::centreAt. True where the box moved: then carry() is to be called.
  bool moveTo(const Vec3& middle, AirSettings& settings);
  /// As WindBox::moveOrigin: the air stays where it is. Eddies and sources are others' business.
  void moveOrigin(const Vec3& way) {
    box_.moveOrigin(way);
    packed_ = false;
  }
  /// Everything moves by the settings' shift.
  void carry();
  void reset(AirBlock& block);
  void setFaces(std::span<const float> faces);  ///< in the order of shaders/air_settings.glsl

  /// Of `words`, which are in `shapes`. Bodies are copied.
  void takeBodies(std::span<const MovingPrimitive> bodies, AirSettings& settings);
  /// As Wind::takeSources. The settings know of them from describe() on.
  void takeSources(std::vector<WindSource> sources);
  /// Those among them that let out air.
  std::vector<SphereOnGrid> spheres() const;
  /// Sources of wind as shaders/ambient.glsl reads them where there is no grid.
  static gl::Buffer packed(std::span<const WindSource> sources);

  // Passes. Those that others wait for end with what makes their results visible; findDisplacements,
  // findSolids and findExchange do not: finishPass() is to be called once for several.
  void findDisplacements(bool mac_cormack);
  void advect(bool mac_cormack);
  void findSolids(const gl::Buffer& shapes);
  /// Room for air that slips along hair.
  void expectSlip();
  void findExchange(const std::optional<HairOnAir>& hair);
  /// `exchanges`: with what findExchange found, at the end.
  void diffuse(double seconds, double viscosity, bool exchanges);
  /// What findExchange found where air slips along hair: after diffuse(), which exchanges nothing then.
  void exchangeSlipping();
  void closeFaces();
  /// Until no cell has more divergence than is promised. Waits.
  PressureReport project();
  /// The same with as many iterations as it may take, going by steps before; no waiting. The first call makes
  /// room.
  void projectAhead(PassTimer& timer);

  /// How the newest one went; its residual over the fastest component of velocity. Waits.
  PressureReport newestPressure() const;

  const gl::Buffer& centres() const { return centres_; }
  /// Whole arrays, downloaded: velocities of faces (component after component), pressures, and solid or not.
  struct Image {
    std::vector<float> faces, pressures;
    std::vector<std::array<float, 4>> centres;
    std::vector<uint32_t> masks;  ///< shaders/pressure_solve.glsl
  };
  Image download() const;
  int faceAt(int axis, int i, int j, int k) const {
    const int side = cells_ + 1;
    return i + side * (j + side * (k + side * axis));
  }

 private:
  static constexpr int kSlots = 3;
  /// How the pressures of steps before went, on its way to the CPU.
  struct Reports {
    Reports();
    std::array<gl::Buffer, kSlots> buffers;
    std::array<const PressurePasses::State*, kSlots> memory{};
    std::array<Fence, kSlots> fences;
    int step = 0;
  };

  gl::Buffer& faces() { return faces_[now_]; }
  gl::Buffer& next(size_t by = 1) { return faces_[(now_ + by) % faces_.size()]; }
  void advance(size_t by = 1) { now_ = (now_ + by) % faces_.size(); }
  void bindAmbient();
  void bindSources();
  void dispatchFaces() const;
  void dispatchCells() const;
  void subtractGradient();

  ProgramCache& programs_;
  int cells_;
  float cell_;
  WindBox box_;
  Wind::Border border_;
  Ambient ambient_;
  int turbulence_seed_ = -1;
  std::array<gl::Buffer, 3> faces_;
  size_t now_ = 0;
  std::array<gl::Buffer, 2> pressures_;
  gl::Buffer centres_, displacements_, onwards_, solids_, exchange_, slip_;
  gl::Buffer turbulence_, sources_, bodies_, body_settings_;
  std::vector<WindSource> on_grid_;  // sources
  bool packed_ = true;               // they are in sources_, as they lie in the box
  bool spheres_ = false;             // some of them are, and what they let out has a place to go
  size_t bodies_room_ = 0;
  bool bends_ = false;              // some of them
  std::vector<PlacedBody> placed_;  // for bodies_; kept for its memory
  PressurePasses pressure_;
  Reports reports_;
  LazyProgram carry_, centres_of_, displace_, displace_both_, advect_, correct_, solids_of_, bent_solids_of_,
      exchange_of_, exchange_hair_, exchange_slip_, diffuse_, diffuse_exchange_, slip_of_, close_,
      close_spheres_, subtract_;
};

}  // namespace strandcast::gpu
