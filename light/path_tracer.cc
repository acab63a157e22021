#include "light/path_tracer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "kernels/scalar_picture.h"
#include "light/chiang_fibre.h"
#include "light/random_stream.h"

namespace strandcast {
namespace {

using Color = Eigen::Array3d;
using Direction = Eigen::Vector3d;

constexpr double kTau = 2 * std::numbers::pi;
constexpr int kTileSide = 16;           // pixels
constexpr int kSureBounces = 4;         // scatterings before Russian roulette
constexpr double kLongestOdds = 0.999;  // of going on, so that every path ends
constexpr double kNearestLight = 1e-3;  // m: a point light is not brighter than at this distance

/// Share of one of two ways to draw a direction (Veach 1997, power heuristic with exponent 2).
double powerHeuristic(double own, double other) {
  return own > 0 ? 1 / (1 + (other / own) * (other / own)) : 0;
}

}  // namespace

/// A light as paths meet it. Radiant quantities are in the unit of kernels/picture.h.
struct TracedLight {
  Light light;
  Direction place, axis, across, up;  ///< m, relative to the scene's origin; unit
  ConeCosines cone;
  Color power;      ///< irradiance of a directional light, radiant intensity of others
  Color radiance;   ///< of a rectangle
  double area = 0;  ///< m^2, of a rectangle
  bool casts_shadow = true;

  /// Whether paths may meet it by chance.
  bool isMet() const { return light.kind == LightKind::kRectangle && casts_shadow; }
};

namespace {

TracedLight tracedLight(const Light& light, bool shadows, const Eigen::Vector3d& origin) {
  TracedLight t{light, light.position.cast<double>() - origin, {}, {}, {}, coneCosines(light), {}, {}};
  t.axis = light.direction.cast<double>().normalized();
  const RectangleAxes axes = rectangleAxes(Vec3(t.axis.cast<float>()));
  t.across = axes.across.cast<double>();
  t.up = axes.up.cast<double>();
  const kernels::f32::real3 sun = kernels::f32::sunIrradiance();
  t.power = std::numbers::pi * static_cast<double>(light.intensity) * light.color.cast<double>().array() *
            Color(sun.x, sun.y, sun.z);
  t.area = static_cast<double>(light.width) * static_cast<double>(light.height);
  t.radiance = t.power / t.area;
  t.casts_shadow = shadows && light.casts_shadow;
  return t;
}

/// A direction to a light from a point, and what arrives along it.
struct LightSample {
  Direction direction{0, 0, 1};
  double distance = std::numeric_limits<double>::infinity();  ///< m
  Color arriving{0, 0, 0};  ///< irradiance across the direction of a light without area, else radiance
  double pdf = 0;           ///< per solid angle; 0: the light has no area
};

LightSample sampleOf(const TracedLight& t, const Eigen::Vector3d& point, double u, double v) {
  LightSample s;
  if (t.light.kind == LightKind::kDirectional) {
    s.direction = -t.axis;
    s.arriving = t.power;
    return s;
  }
  Eigen::Vector3d place = t.place;
  if (t.light.kind == LightKind::kRectangle)
    place += (u - 0.5) * static_cast<double>(t.light.width) * t.across +
             (v - 0.5) * static_cast<double>(t.light.height) * t.up;
  const Eigen::Vector3d off = place - point;
  s.distance = std::max(off.norm(), kNearestLight);
  s.direction = off / s.distance;
  const double cosine = -s.direction.dot(t.axis);
  if (t.light.kind == LightKind::kRectangle) {
    if (!(cosine > 0)) return s;
    s.arriving = t.radiance;
    s.pdf = s.distance * s.distance / (t.area * cosine);
  } else {
    s.arriving = t.power * static_cast<double>(coneFalloff(t.cone, static_cast<float>(cosine))) /
                 (s.distance * s.distance);
  }
  return s;
}

/// Roughly the irradiance that a light gives at a point: the weight with which it is chosen.
double importanceOf(const TracedLight& t, const Eigen::Vector3d& point) {
  if (t.light.kind == LightKind::kDirectional) return t.power.mean();
  const Eigen::Vector3d off = t.place - point;
  const double squared = std::max(off.squaredNorm(), kNearestLight * kNearestLight);
  if (t.light.kind == LightKind::kRectangle) {
    // A point may see a part of the rectangle although its centre is edge-on: never less than a tenth.
    const double reach =
        std::hypot(static_cast<double>(t.light.width), static_cast<double>(t.light.height)) / 2;
    const double before = -off.dot(t.axis);
    if (before <= 0) return 0;
    return t.power.mean() * std::max(before / std::sqrt(squared), 0.1) / std::max(squared, reach * reach / 4);
  }
  const auto cosine = static_cast<float>(-off.dot(t.axis) / std::sqrt(squared));
  return t.power.mean() * static_cast<double>(coneFalloff(t.cone, cosine)) / squared;
}

/// A point where a path scatters: fibre or surface, in world directions, with the cosine.
class Scattering {
 public:
  struct Sample {
    Direction direction{0, 0, 1};
    double pdf = 0;
    Color weight{0, 0, 0};  ///< f cos / pdf
  };

  Scattering(const TracedHit& hit, const Direction& to_eye, const ChiangFibre& fibre, double u)
      : fibre_(&fibre) {
    x_ = hit.tangent;
    Direction side = to_eye - to_eye.dot(x_) * x_;
    const double length = side.norm();
    side = length > 1e-9 ? Direction(side / length) : Direction(x_.unitOrthogonal());
    y_ = side;
    z_ = x_.cross(y_);
    eye_ = inside(to_eye);
    // Across the ray, about the segment's own axis. A ray along it meets any part of the width.
    Direction aside = hit.axis.cross(to_eye);
    const double sine = aside.norm();
    h_ = sine > 1e-6 ? std::clamp((hit.position - hit.center).dot(aside) / (sine * hit.radius), -1.0, 1.0)
                     : 2 * u - 1;
  }
  Scattering(const TracedHit& hit, const Direction& to_eye, const CoatedDiffuse& surface)
      : surface_(&surface), geometric_(hit.normal) {
    // Where an interpolated normal turns away from the eye, the triangle's own is used.
    z_ = hit.shading.dot(to_eye) > 1e-3 ? hit.shading : hit.normal;
    x_ = z_.unitOrthogonal();
    y_ = z_.cross(x_);
    eye_ = inside(to_eye);
  }

  struct Value {
    Color f_cos{0, 0, 0};
    double pdf = 0;  ///< of sample()
  };
  Value value(const Direction& to_light) const {
    const Direction wi = inside(to_light);
    if (fibre_ != nullptr) {
      const ChiangFibre::Sample both = fibre_->evaluate(eye_, wi, h_);
      return {both.f * std::hypot(wi.y(), wi.z()), both.pdf};
    }
    if (to_light.dot(geometric_) <= 0) return {};
    return {surface_->f(eye_, wi) * std::max(wi.z(), 0.0), surface_->pdf(eye_, wi)};
  }
  Sample sample(SampleStream& random) const {
    Sample s;
    const double u0 = random.uniform(), u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    if (fibre_ != nullptr) {
      const ChiangFibre::Sample drawn = fibre_->sample(eye_, h_, u0, u1, u2, u3);
      if (!(drawn.pdf > 0)) return s;
      s = {outside(drawn.wi), drawn.pdf, drawn.f * (std::hypot(drawn.wi.y(), drawn.wi.z()) / drawn.pdf)};
    } else {
      const CoatedDiffuse::Sample drawn = surface_->sample(eye_, u0, u1, u2);
      if (!(drawn.pdf > 0)) return s;
      s = {outside(drawn.wi), drawn.pdf, drawn.f * (drawn.wi.z() / drawn.pdf)};
      if (s.direction.dot(geometric_) <= 0) return {};
    }
    return s;
  }
  Sample uniformSample(SampleStream& random) const {
    const double height = 1 - 2 * random.uniform(), phi = kTau * random.uniform();
    const double radius = std::sqrt(std::max(1 - height * height, 0.0));
    const Direction direction(radius * std::cos(phi), radius * std::sin(phi), height);
    return {direction, 1 / (2 * kTau), value(direction).f_cos * (2 * kTau)};
  }

 private:
  Direction inside(const Direction& w) const { return {w.dot(x_), w.dot(y_), w.dot(z_)}; }
  Direction outside(const Direction& w) const { return (w.x() * x_ + w.y() * y_ + w.z() * z_).normalized(); }

  const ChiangFibre* fibre_ = nullptr;
  const CoatedDiffuse* surface_ = nullptr;
  Direction x_, y_, z_, eye_, geometric_{0, 0, 1};
  double h_ = 0;
};

}  // namespace

struct PathTracer::Impl {
  explicit Impl(PathScene given)
      : scene(std::move(given)),
        geometry(std::move(scene.hair), std::move(scene.meshes)),
        fibre(scene.fibre) {
    if (scene.width < 1 || scene.height < 1 || scene.width > 16384 || scene.height > 16384)
      throw Error("the size of a picture is out of range", "path tracer", "give 1 to 16384 pixels a side");
    if (!(scene.camera.lens_radius >= 0 && scene.camera.focus > 0 && scene.camera.view.allFinite()))
      throw Error("the camera's lens is invalid", "path tracer", "give a radius of 0 or more, and a focus");
    if (!scene.backdrop.empty() &&
        scene.backdrop.size() != static_cast<size_t>(scene.width) * static_cast<size_t>(scene.height))
      throw Error("the backdrop does not have the picture's size", "path tracer", "");
    for (const Light& light : scene.lights) {
      if (!(light.direction.norm() > 1e-6f) || !(light.width > 0 && light.height > 0))
        throw Error("a light has no direction or no size", "path tracer", "give both");
      lights.push_back(tracedLight(light, scene.shadows, geometry.origin()));
    }
    const Eigen::Matrix4d view = scene.camera.view.cast<double>();
    axes = view.topLeftCorner<3, 3>().transpose();
    eye = -axes * view.block<3, 1>(0, 3) - geometry.origin();
    slope = std::tan(0.5 * static_cast<double>(scene.camera.vertical_fov));
  }

  struct Ray {
    Eigen::Vector3d start;
    Direction direction;
  };

  Ray eyeRay(size_t pixel, SampleStream& random) const {
    const auto width = static_cast<size_t>(scene.width);
    const double x = (static_cast<double>(pixel % width) + random.uniform()) / scene.width,
                 y = (static_cast<double>(pixel / width) + random.uniform()) / scene.height;
    const double aspect = static_cast<double>(scene.width) / scene.height;
    // On the plane at distance 1; eye space.
    const Eigen::Vector3d through((2 * x - 1) * slope * aspect, (1 - 2 * y) * slope, -1);
    const double u = random.uniform(), v = random.uniform();
    const auto lens = static_cast<double>(scene.camera.lens_radius);
    if (lens == 0) return {eye, (axes * through).normalized()};
    const double r = lens * std::sqrt(u);
    const Eigen::Vector3d from(r * std::cos(kTau * v), r * std::sin(kTau * v), 0);
    const Eigen::Vector3d sharp = static_cast<double>(scene.camera.focus) * through;
    return {eye + axes * from, (axes * (sharp - from)).normalized()};
  }

  /// Weights with which the lights are chosen at a point: each of `lights`, then the sky. The sum is 1, or
  /// all are 0.
  struct Choice {
    std::array<double, kMaxLights + 1> odds{};
    size_t count = 0;
    double sky() const { return odds[count - 1]; }
  };
  Choice choiceAt(const Eigen::Vector3d& point, bool with_area) const {
    Choice choice;
    double sum = 0;
    for (const TracedLight& light : lights)
      sum += choice.odds[choice.count++] =
          with_area || light.light.kind != LightKind::kRectangle ? importanceOf(light, point) : 0;
    sum += choice.odds[choice.count++] = with_area ? std::numbers::pi * scene.sky.mean().mean() : 0;
    for (double& odds : choice.odds) odds = sum > 0 ? odds / sum : 0;
    return choice;
  }

  /// Light of one light, chosen by `choice`, that reaches the point and is scattered to the eye.
  Color direct(const TracedHit& hit, const Scattering& scattering, const Choice& choice,
               bool first_is_uniform, SampleStream& random) const {
    double u = random.uniform();
    const double a = random.uniform(), b = random.uniform();
    size_t chosen = choice.count;
    for (size_t i = 0; i < choice.count && chosen == choice.count; ++i) {
      if (choice.odds[i] > 0 && u < choice.odds[i]) chosen = i;
      u -= choice.odds[i];
    }
    if (chosen == choice.count) return {0, 0, 0};
    const bool is_sky = chosen + 1 == choice.count;
    LightSample light;
    if (is_sky) {
      const Sky::Sample sky = scene.sky.sample(a, b);
      if (!(sky.pdf > 0)) return {0, 0, 0};
      light.direction = sky.direction;
      light.arriving = sky.radiance;
      light.pdf = sky.pdf;
    } else {
      light = sampleOf(lights[chosen], hit.position, a, b);
    }
    if (!(light.arriving > 0).any()) return {0, 0, 0};
    const double odds = choice.odds[chosen];
    const Scattering::Value value = scattering.value(light.direction);
    Color scattered = value.f_cos * light.arriving / odds;
    if (light.pdf > 0) {
      scattered /= light.pdf;
      if ((is_sky || lights[chosen].isMet()) && !first_is_uniform)
        scattered *= powerHeuristic(odds * light.pdf, value.pdf);
    }
    if (!(scattered > 0).any()) return {0, 0, 0};
    const bool may_shade = is_sky || lights[chosen].casts_shadow;
    const Eigen::Vector3d start = geometry.departure(hit, light.direction);
    if (may_shade && geometry.isBlocked(start, light.direction, light.distance * (1 - 1e-6), &hit))
      return {0, 0, 0};
    return scattered;
  }

  /// Radiance of lights and sky that a scattered path meets. `pdf`: of its direction, or 0 where no other way
  /// to draw it counts. `reached`: m, where something blocks it; infinite: nothing does.
  Color met(const Ray& ray, double reached, double pdf, const Choice& choice) const {
    Color sum{0, 0, 0};
    if (std::isinf(reached)) {
      const double other = choice.sky() * scene.sky.pdf(ray.direction);
      sum += scene.sky.radiance(ray.direction) * (pdf > 0 ? powerHeuristic(pdf, other) : 1.0);
    }
    for (size_t i = 0; i < lights.size(); ++i) {
      const TracedLight& t = lights[i];
      const double cosine = -ray.direction.dot(t.axis);
      if (!t.isMet() || !(cosine > 0)) continue;
      const double distance = (ray.start - t.place).dot(t.axis) / cosine;
      if (!(distance > 0 && distance < reached)) continue;
      const Eigen::Vector3d off = ray.start + distance * ray.direction - t.place;
      if (std::abs(off.dot(t.across)) > 0.5 * static_cast<double>(t.light.width) ||
          std::abs(off.dot(t.up)) > 0.5 * static_cast<double>(t.light.height))
        continue;
      const double other = choice.odds[i] * distance * distance / (t.area * cosine);
      sum += t.radiance * (pdf > 0 ? powerHeuristic(pdf, other) : 1.0);
    }
    return sum;
  }

  Color behind(size_t pixel, const Direction& direction) const {
    return scene.backdrop.empty() ? scene.sky.radiance(direction) : scene.backdrop[pixel].cast<double>();
  }

  /// Whether a sample of a ground is one of the backdrop that it fades into.
  static bool fades(const SurfaceMaterial& material, const Eigen::Vector3d& world, double u) {
    if (!material.fades_from) return false;
    const Eigen::Vector3d off = world - material.fades_from->cast<double>();
    const double part = std::hypot(off.x(), off.z()) / static_cast<double>(material.fade_radius);
    return u < static_cast<double>(kernels::f32::groundFade(static_cast<float>(part)));
  }

  Color absorptionAt(const TracedHit& hit) const {
    const auto& ends = geometry.hair().absorption[hit.part];
    return ends[0].cast<double>().array() +
           hit.along * (ends[1].cast<double>().array() - ends[0].cast<double>().array());
  }

  PathSample sample(size_t pixel, uint64_t number) const {
    SampleStream random(scene.seed, pixel, number);
    PathSample result;
    Ray ray = eyeRay(pixel, random);
    Color throughput{1, 1, 1};
    double pdf = 0;
    Choice choice;
    TracedHit from;
    for (int scatterings = 0;; ++scatterings) {
      const TracedHit hit = geometry.hit(ray.start, ray.direction, scatterings > 0 ? &from : nullptr);
      const bool nothing = hit.kind == TracedHit::Kind::kNothing;
      if (scatterings > 0) {
        const double reached = nothing ? std::numeric_limits<double>::infinity() : hit.distance;
        (scatterings == 1 ? result.single : result.multiple) += throughput * met(ray, reached, pdf, choice);
      }
      if (nothing) {
        if (scatterings == 0) result.seen = behind(pixel, ray.direction);
        return result;
      }
      const SurfaceMaterial* surface =
          hit.kind == TracedHit::Kind::kSurface ? &scene.materials[geometry.material(hit.part)] : nullptr;
      if (scatterings == 0) {
        if (surface != nullptr && fades(*surface, hit.position + geometry.origin(), random.uniform())) {
          result.seen = behind(pixel, ray.direction);
          return result;
        }
        result.depth = (axes.col(2).dot(eye - hit.position));
        result.hair = surface == nullptr;
      }
      if (scene.max_bounces > 0 && scatterings >= scene.max_bounces) return result;

      std::optional<ChiangFibre> own;
      if (surface == nullptr) own = fibre.withAbsorption(absorptionAt(hit));
      const Scattering scattering = surface == nullptr
                                        ? Scattering(hit, -ray.direction, *own, random.uniform())
                                        : Scattering(hit, -ray.direction, surface->scattering);
      const bool uniform =
          scatterings == 0 && scene.first_direction == FirstDirection::kUniform && surface == nullptr;
      choice = choiceAt(hit.position, !uniform);
      (scatterings == 0 ? result.single : result.multiple) +=
          throughput * direct(hit, scattering, choice, uniform, random);

      const Scattering::Sample next = uniform ? scattering.uniformSample(random) : scattering.sample(random);
      if (!(next.pdf > 0)) return result;
      throughput *= next.weight;
      pdf = uniform ? 0 : next.pdf;
      if (!(throughput > 0).any()) return result;
      if (scatterings >= kSureBounces) {
        const double odds = std::min(throughput.maxCoeff(), kLongestOdds);
        if (random.uniform() >= odds) return result;
        throughput /= odds;
      }
      ray = {geometry.departure(hit, next.direction), next.direction};
      from = hit;
    }
  }

  PathScene scene;  ///< its hair and meshes are in `geometry`
  TracedScene geometry;
  ChiangFibre fibre;  ///< of all hairs, but for its absorption
  std::vector<TracedLight> lights;
  Eigen::Matrix3d axes;  ///< eye to world space
  Eigen::Vector3d eye;   ///< m, relative to the scene's origin
  double slope = 0;      ///< tangent of half the vertical field of view
};

PathTracer::PathTracer(PathScene scene) {
  for (const TracedMesh& mesh : scene.meshes)
    if (mesh.material >= scene.materials.size())
      throw Error("a surface has no material", "path tracer",
                  fmt::format("there are {}", scene.materials.size()));
  if (scene.lights.size() > kMaxLights)
    throw Error(fmt::format("a picture has at most {} lights", kMaxLights), "path tracer", "leave one out");
  impl_ = std::make_unique<Impl>(std::move(scene));
}

PathTracer::~PathTracer() = default;

const TracedScene& PathTracer::geometry() const { return impl_->geometry; }

PathSample PathTracer::sample(size_t pixel, uint64_t number) const { return impl_->sample(pixel, number); }

bool PathTracer::trace(PathFilm& film, uint32_t samples, const std::function<bool(uint64_t)>& goes_on) const {
  const int across = (film.width() + kTileSide - 1) / kTileSide,
            down = (film.height() + kTileSide - 1) / kTileSide;
  std::atomic<bool> stop{false};
  std::mutex mutex;
  uint64_t done = 0;
  tbb::parallel_for(0, across * down, [&](int tile) {
    const int left = tile % across * kTileSide, top = tile / across * kTileSide;
    const int right = std::min(left + kTileSide, film.width()),
              bottom = std::min(top + kTileSide, film.height());
    uint64_t added = 0;
    for (int y = top; y < bottom && !stop; ++y)
      for (int x = left; x < right; ++x) {
        const size_t pixel =
            static_cast<size_t>(y) * static_cast<size_t>(film.width()) + static_cast<size_t>(x);
        for (uint32_t n = film.samples(pixel); n < samples; ++n, ++added) film.add(pixel, sample(pixel, n));
      }
    if (stop || !goes_on) return;
    const std::scoped_lock lock(mutex);
    done += added;
    if (!stop && !goes_on(done)) stop = true;
  });
  return !stop;
}

}  // namespace strandcast
