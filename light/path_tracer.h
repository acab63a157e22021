#pragma once
#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry.h"
#include "light/coated_diffuse.h"
#include "light/fibre_material.h"
#include "light/light_sources.h"
#include "light/path_film.h"
#include "light/sky.h"
#include "light/traced_scene.h"

namespace strandcast {

/// A camera with a thin lens; with radius 0 a pinhole, whose pixels are those of the renderer.
struct TracedCamera {
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();  ///< world to eye space: looks along -Z, Y up
  float vertical_fov = 0.6f;                           ///< rad
  float lens_radius = 0;                               ///< m
  float focus = 1;                                     ///< m along the axis, of the sharp plane; above 0
};

/// A surface's material. A ground fades: the share of its pixels where the eye sees the backdrop instead
/// grows from 0 at 0.15 of the radius to 1 at the radius.
struct SurfaceMaterial {
  CoatedDiffuse scattering;
  std::optional<Vec3> fades_from{};  ///< m, world: centre of a ground
  float fade_radius = 1;             ///< m
};

/// How the direction of the first scattering is chosen. kUniform: uniformly over the sphere, without sampling
/// of lights with an area: an independent check of the sampling.
enum class FirstDirection { kByImportance, kUniform };

/// A picture to trace.
struct PathScene {
  TracedHair hair;
  FibreMaterial fibre;  ///< of all hairs, but for its absorption
  std::vector<TracedMesh> meshes;
  std::vector<SurfaceMaterial> materials;  ///< TracedMesh::material
  std::vector<Light> lights;               ///< valid, with unit directions
  bool shadows = true;                     ///< of lights that cast them; the sky always does
  Sky sky;
  /// What is seen behind everything, per pixel; empty: the sky. It lights nothing.
  std::vector<Eigen::Array3f> backdrop;
  TracedCamera camera;
  int width = 0, height = 0;  ///< pixels
  uint64_t seed = 1;
  int max_bounces = 0;  ///< scatterings of a path; 0: no limit
  FirstDirection first_direction = FirstDirection::kByImportance;
};

/// Path tracing with multiple importance sampling (Veach 1997, power heuristic) of lights and scattering. The
/// hair's fibres scatter as ChiangFibre, at the point of their width that a ray meets. Every scattering
/// samples one light, chosen by what it would give there unshadowed. Paths end by Russian roulette, without
/// bias, so white hair scatters hundreds of times.
///
/// A pixel's value depends on scene and seed alone: neither on the number of threads, nor on interruptions.
class PathTracer {
 public:
  /// Throws Error as TracedScene() and on an invalid material or size.
  explicit PathTracer(PathScene scene);
  ~PathTracer();

  const TracedScene& geometry() const;
  /// Adds samples until every pixel has `samples`. `goes_on` is called after each tile, from one thread at a
  /// time, with the number of samples that this call added; false ends the call soon. Returns whether all
  /// samples are there.
  bool trace(PathFilm& film, uint32_t samples, const std::function<bool(uint64_t)>& goes_on = {}) const;
  /// One sample of a pixel.
  PathSample sample(size_t pixel, uint64_t number) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
