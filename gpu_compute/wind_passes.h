#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "air/wind.h"
#include "air/wind_source.h"
#include "gl/timers.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/pressure_passes.h"
#include "gpu_compute/step_input.h"

namespace strandcast::gpu {

/// Passes of the wind grid (air/wind_grid.h) as compute shaders. Passes read their settings from an AirBlock:
/// call describe() and AirBlock::send() before them. Precondition of every call: the context in which it was
/// constructed is current.
class WindPasses {
 public:
  /// `cells`: per axis, 16 to 128, a multiple of 16; `cell`: edge of a cell, m. Compiles shaders of the
  /// pressure solve; may throw Error, as may the first call of each pass.
  WindPasses(int cells, float cell, Wind::Border border, ProgramCache& programs);

  int cells() const { return cells_; }
  float cell() const { return cell_; }
  Vec3 origin() const { return box_.corner(); }  ///< low corner of the box, m
  Ambient& ambient() { return ambient_; }

  /// Writes the settings of the passes: position of the box, ambient wind, sources. `seconds`: time step.
  void describe(AirSettings& settings, double seconds) const;
  /// As Wind::centreAt(). True if the box moved: send the settings, then call carry().
  bool moveTo(const Vec3& middle, AirSettings& settings);
  /// Origin rebasing of the box, as WindBox::moveOrigin(): air keeps its position in the world. The caller
  /// rebases ambient() and the sources.
  void moveOrigin(const Vec3& way) {
    box_.moveOrigin(way);
    packed_ = false;
  }
  /// Shifts the grid's contents by AirSettings::shift; air keeps its position in the world.
  void carry();
  /// Fills the grid with the ambient wind.
  void reset(AirBlock& block);
  void setFaces(std::span<const float> faces);  ///< m/s, in the order of shaders/air_settings.glsl

  /// Sets the bodies of computeSolids(). Their shape data must be in its `shapes`. Bodies are copied.
  void setBodies(std::span<const MovingPrimitive> bodies, AirSettings& settings);
  /// As Wind::setSources(). Takes effect with the next describe().
  void setSources(std::vector<WindSource> sources);
  /// The spheres among the sources, if the border is open: they set target divergences.
  std::vector<SphereOnGrid> spheres() const;
  /// Sources of wind in the layout of shaders/ambient.glsl, for use without a grid.
  static gl::Buffer packed(std::span<const WindSource> sources);

  // Passes. They end with finishPass(), but for computeDisplacements(), computeSolids() and
  // computeExchange(): the caller calls it once for several of these.
  void computeDisplacements(bool mac_cormack);
  void advect(bool mac_cormack);
  void computeSolids(const gl::Buffer& shapes);
  /// Allocates the memory for air that slips along hair.
  void reserveSlip();
  /// Momentum exchange of the step with sources and, if given, `hair`.
  void computeExchange(const std::optional<HairOnAir>& hair);
  /// `viscosity` in m^2/s. `exchanges`: afterwards applies the result of computeExchange().
  void diffuse(double seconds, double viscosity, bool exchanges);
  /// Applies the result of computeExchange() for air that slips along hair. After diffuse() without exchange.
  void exchangeSlipping();
  /// Boundary conditions and right-hand sides of the pressure solve; project() and projectAhead() call it.
  void closeFaces();
  /// Projection, with iterations until the residual reaches the tolerance (kResidual, kStill), at most
  /// kMaxPressureIterations. Waits for the GPU.
  PressureReport project();
  /// Projection with a fixed number of iterations, one more than the step before last took. Waits at most for
  /// that step.
  void projectAhead(gl::PassTimer& timer);

  /// Report of the newest projection; its residual is relative to the largest velocity component. Waits for
  /// the GPU.
  PressureReport newestPressure() const;

  /// Cell-centre velocities, 4 floats per cell, xyz in m/s.
  const gl::Buffer& centres() const { return centres_; }
  /// Downloaded arrays, in the order of shaders/air_settings.glsl.
  struct Image {
    std::vector<float> faces, pressures;        ///< m/s, both
    std::vector<std::array<float, 4>> centres;  ///< m/s
    std::vector<uint32_t> masks;                ///< per cell, see shaders/pressure_solve.glsl
  };
  /// Waits for the GPU.
  Image download() const;
  /// Index in Image::faces.
  int faceAt(int axis, int i, int j, int k) const {
    const int side = cells_ + 1;
    return i + side * (j + side * (k + side * axis));
  }

 private:
  static constexpr int kSlots = 3;
  /// Asynchronous download of the pressure solves' states.
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
  std::vector<WindSource> on_grid_;  // sources, as onGrid() adapts them
  bool packed_ = true;               // sources_ is up to date with on_grid_ and the box
  bool spheres_ = false;             // some sources are spheres, and the border is open
  size_t bodies_room_ = 0;           // capacity of bodies_
  bool bends_ = false;               // some bodies are fields that bend
  std::vector<PlacedBody> placed_;   // staging copy of bodies_; kept for its memory
  PressurePasses pressure_;
  Reports reports_;
  LazyProgram carry_, centres_of_, displace_, displace_both_, advect_, correct_, solids_of_, bent_solids_of_,
      exchange_of_, exchange_hair_, exchange_slip_, diffuse_, diffuse_exchange_, slip_of_, close_,
      close_spheres_, subtract_;
};

}  // namespace strandcast::gpu
