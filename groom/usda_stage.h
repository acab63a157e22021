#pragma once
#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "groom/file_report.h"
#include "groom/usda_text.h"

namespace strandcast {

/// A property of a prim: its numbers, or its strings; of one with time samples only, the first of them.
struct UsdaProperty {
  std::vector<double> numbers;
  std::vector<std::string> strings;
  std::string interpolation;  ///< that its metadata name, or none
  size_t line = 0;
};

/// A prim (node) of the scene with what is wanted of it.
struct UsdaPrim {
  std::string type, name;
  size_t line = 0;
  bool is_there = true;  ///< defined, and active, and so are those above it
  std::map<std::string, UsdaProperty> properties;
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
};

/// What a .usda text says of itself and its prims. Layers that it refers to are not read.
struct UsdaStage {
  double meters_per_unit = 0;  ///< 0 where it is not said
  char up = 'Y';
  std::vector<UsdaPrim> prims;  ///< those above before those below
  FileReport report;            ///< what else is in it that may bear on hair: "references", "variants"
};

/// Parses the text. Of the properties only transforms are kept, and of prims of type `wanted` those that are
/// named in `properties`. Throws Error (file, line, remedy).
UsdaStage readUsdaStage(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties);

}  // namespace strandcast
