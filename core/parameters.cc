#include "core/parameters.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/material.h"
#include "core/name_lookup.h"

namespace strandcast {
namespace {

struct Entry {
  ParameterInfo info;
  std::function<double(const Parameters&, int)> get;
  std::function<void(Parameters&, int, double)> set;
};

template <class T>
Entry scalar(const char* name, const char* unit, double low, double high, const char* range, const char* help,
             T Parameters::*member, int multiple = 1) {
  return {{name, unit, range, help, 1, low, high, std::is_integral_v<T>, multiple},
          [=](const Parameters& p, int) { return static_cast<double>(p.*member); },
          [=](Parameters& p, int, double v) { p.*member = static_cast<T>(v); }};
}

Entry vector(const char* name, const char* unit, const char* help, double limit, Vec3 Parameters::*member) {
  return {{name, unit, fmt::format("each within +-{:g}", limit), help, 3, -limit, limit, false},
          [=](const Parameters& p, int c) { return static_cast<double>((p.*member)[c]); },
          [=](Parameters& p, int c, double v) { (p.*member)[c] = static_cast<float>(v); }};
}

const std::vector<Entry>& entries() {
  using P = Parameters;
  static const std::vector<Entry> list = {
      scalar("time_step", "s", 1e-5, 1.0 / 30, "1e-5 to 1/30",
             "length of a simulation step; below 1/4000 s the rod has visible rounding errors in single "
             "precision",
             &P::time_step),
      scalar(
          "substeps", "", 1, 64, "1 to 64",
          "solver passes per step; the rod keeps each from 1/4000 s (unless the step is shorter) to 1/60 s",
          &P::substeps),
      scalar("iterations", "", 1, 64, "1 to 64", "constraint sweeps per substep", &P::iterations),
      vector("gravity", "m/s^2", "acceleration of all hair", static_cast<double>(kStrongestGravity),
             &P::gravity),
      vector("wind", "m/s", "uniform velocity of the air", 100, &P::wind),
      scalar("air_drag", "1/s", 0, 1000, "0 to 1000", "rate at which hair approaches the air's velocity",
             &P::air_drag),
      scalar("shape_rate", "1/s", 0, 1e6, "0 to 1e6",
             "rate at which the groomed shape is restored, at the root", &P::shape_rate),
      scalar("shape_rate_tip", "1/s", 0, 1e6, "0 to 1e6",
             "rate at which the groomed shape is restored, at the tip", &P::shape_rate_tip),
      scalar("damping_time", "s", 0, 1, "0 to 1",
             "internal damping of the rod: damping ratio = omega x damping_time / 2", &P::damping_time),
      scalar("goal_rate", "1/s", 0, 1000, "0 to 1000",
             "spring towards the rest shape as the root carries it: acceleration = goal_rate^2 x distance; 0 "
             "= off",
             &P::goal_rate),
      scalar("hair_radius", "m", 0, static_cast<double>(kThickestHair), "0 to 0.01",
             "distance kept between a hair's axis and every body", &P::hair_radius),
      scalar("grid_cells", "", 16, 128, "16 to 128, a multiple of 16",
             "cells per axis of the grids of air and of hair", &P::grid_cells, 16),
      scalar("wind_grid", "", 0, 1, "0 or 1",
             "1: wind flows through a grid, in which bodies and hair block it; 0: nothing blocks it",
             &P::wind_grid),
      scalar("mac_cormack", "", 0, 1, "0 or 1", "1: less numerical viscosity of the air, at more cost",
             &P::mac_cormack),
      scalar("air_viscosity", "m^2/s", 0, 0.01, "0 to 0.01", "kinematic viscosity of the air on the grid",
             &P::air_viscosity),
      scalar(
          "air_drag_along", "", 0, 1, "0 to 1",
          "drag along a strand over drag across it, of air on strands and of strands on air; thin rods: 0.5",
          &P::air_drag_along),
      scalar("hairs_per_strand", "", 0, 1e4, "0 to 1e4",
             "number of hairs that a strand represents in its drag on the air", &P::hairs_per_strand),
      scalar("gust", "", 0, 2, "0 to 2", "rms speed of gusts over the speed of the wind", &P::gust),
      scalar("gust_period", "s", 0.1, 1000, "0.1 to 1000", "period of the slowest gust", &P::gust_period),
      scalar("turbulence", "", 0, 2, "0 to 2",
             "rms speed of each component of turbulence over the speed of the wind", &P::turbulence),
      scalar("turbulence_length", "m", 0.01, 100, "0.01 to 100", "size of the largest eddies",
             &P::turbulence_length),
      scalar("wind_seed", "", 0, 1e6, "0 to 1e6", "seed of gusts and turbulence", &P::wind_seed),
      scalar("volume_stiffness", "m^2/s^2", 0, 100, "0 to 100",
             "pressure that pushes apart hair denser than at rest: square of the speed of pressure waves; 0 "
             "= off",
             &P::volume_stiffness),
      scalar("volume_hold", "1/s", 0, 10, "0 to 10",
             "rate at which that pressure grows while hair stays denser than at rest, so that a lasting load "
             "does not compress it",
             &P::volume_hold),
      scalar("volume_target", "", 0.1, 10, "0.1 to 10",
             "volume that hair keeps, relative to its volume at rest", &P::volume_target),
      scalar("hair_friction", "1/s", 0, 1000, "0 to 1000",
             "rate at which hair approaches the mean velocity of the hair around it; 0 = off",
             &P::hair_friction),
  };
  return list;
}

const Entry& entry(const std::string& name, const std::string& where) {
  const auto& list = entries();
  for (const Entry& e : list)
    if (e.info.name == name) return e;
  std::vector<std::string> names;
  for (const Entry& e : list) names.push_back(e.info.name);
  std::string advice = didYouMean(name, names);
  if (advice.empty()) advice = "`strandcastd --help` lists them";
  for (const MaterialSettingInfo& setting : materialSettingList())
    if (setting.name == name) advice = "it belongs to the hair's material: --material all:" + name + "=VALUE";
  throw Error("unknown parameter '" + name + "'", where, advice);
}

void checkRange(const Entry& e, const std::vector<double>& value, const std::string& where) {
  const ParameterInfo& info = e.info;
  // The limits are valid as floats, too.
  const double least = info.low - 1e-6 * std::fabs(info.low) - 1e-12;
  const double most = info.high + 1e-6 * std::fabs(info.high);
  for (double v : value) {
    if (!std::isfinite(v) || v < least || v > most || (info.whole && std::fmod(v, info.multiple) != 0))
      throw Error(fmt::format("'{}' = {} is out of range", info.name, v), where,
                  fmt::format("give {}{} {}", info.whole ? "a whole number, " : "", info.range, info.unit));
  }
}

std::vector<double> valueOf(const Entry& e, const Parameters& parameters) {
  std::vector<double> value(e.info.components);
  for (int c = 0; c < e.info.components; ++c) value[c] = e.get(parameters, c);
  return value;
}

}  // namespace

SolverKind solverKind(const std::string& name) {
  for (const SolverKind kind : {SolverKind::kGaussSeidel, SolverKind::kRod})
    if (solverName(kind) == name) return kind;
  throw Error("unknown solver", name, "choose one of gauss_seidel, rod");
}

std::string solverName(SolverKind solver) { return solver == SolverKind::kRod ? "rod" : "gauss_seidel"; }

const std::vector<ParameterInfo>& parameterList() {
  static const std::vector<ParameterInfo> list = [] {
    std::vector<ParameterInfo> infos;
    for (const Entry& e : entries()) infos.push_back(e.info);
    return infos;
  }();
  return list;
}

std::vector<double> parameter(const Parameters& parameters, const std::string& name) {
  return valueOf(entry(name, "parameter list"), parameters);
}

void setParameter(Parameters& parameters, const std::string& name, const std::vector<double>& value,
                  const std::string& where) {
  const Entry& e = entry(name, where);
  if (value.size() != static_cast<size_t>(e.info.components))
    throw Error(fmt::format("'{}' takes {} number{}, not {}", name, e.info.components,
                            e.info.components == 1 ? "" : "s", value.size()),
                where, "");
  checkRange(e, value, where);
  for (int c = 0; c < e.info.components; ++c) e.set(parameters, c, value[c]);
}

void checkParameters(const Parameters& parameters, const std::string& where) {
  if (parameters.solver != SolverKind::kGaussSeidel && parameters.solver != SolverKind::kRod)
    throw Error("unknown solver", where, "choose kGaussSeidel or kRod");
  for (const Entry& e : entries()) checkRange(e, valueOf(e, parameters), where);
}

}  // namespace strandcast
