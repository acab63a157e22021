#pragma once
#include <Eigen/Geometry>

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_report.h"
#include "io/usda_text.h"

namespace strandcast {

/// A property of a prim. Its value is the default; without a default, the earliest time sample.
struct UsdaProperty {
  std::string type;             ///< as declared, without brackets: "float2", "token"
  std::vector<double> numbers;  ///< of all values, flat; may hold infinities and NaN, as in the text
  std::vector<std::string> strings;
  std::string misfit;         ///< how the tuples of the value disagree with the type, or empty
  bool has_value = false;     ///< false where the property is only declared, or blocked by `None`
  bool sampled = false;       ///< the value is a time sample
  bool has_samples = false;   ///< there are time samples, with or without a default that overrides them
  size_t source = 0;          ///< number of the block of the text that holds the value; 0 if none
  double time = 0;            ///< of the sample
  std::string interpolation;  ///< as named in its metadata, or empty
  std::optional<double> element_size;      ///< from the metadata; 1 if empty
  std::optional<double> unauthored_index;  ///< from the metadata; -1 if empty
  size_t line = 0;                         ///< 1-based
};

/// A prim (node) of the stage with the properties that were asked for.
struct UsdaPrim {
  static constexpr size_t kNoParent = std::numeric_limits<size_t>::max();

  std::string type, name;
  size_t line = 0;
  size_t parent = kNoParent;  ///< index into UsdaStage::prims, less than the prim's own
  std::map<std::string, UsdaProperty, std::less<>> properties;
  std::set<std::string> other_primvars;  ///< names of other primvars that have a value

  // Inherited from ancestors.
  bool is_active = true;      ///< neither the prim nor an ancestor has `active = false`
  bool is_abstract = false;   ///< the prim or an ancestor is a `class`
  bool is_defined = true;     ///< the prim and each ancestor has a `def` or `class`, not only an `over`
  bool is_there = true;       ///< defined and active, and not abstract
  bool is_prototype = false;  ///< below a PointInstancer: not drawn in place
  bool is_visible = true;     ///< computed visibility
  std::string purpose;        ///< computed purpose: "default", "render", "proxy" or "guide"
  bool is_sampled = false;    ///< the prim or an ancestor has time samples of a property that is kept
  /// Constant primvars by name, each with the index of the prim that holds it. Null: none.
  std::shared_ptr<const std::map<std::string, size_t, std::less<>>> constant_primvars;
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
  std::string fault;      ///< why `to_world` is undefined, or empty
  size_t fault_line = 0;  ///< line of that fault

  const UsdaProperty* find(std::string_view property) const;
  /// The first string of a property, or `otherwise`.
  std::string token(std::string_view property, std::string_view otherwise) const;
};

/// Contents of a .usda text: the stage and its prims. Files that it refers to are not read.
struct UsdaStage {
  double meters_per_unit = 0;  ///< 0 when not stated
  char up = 'Y';
  std::vector<UsdaPrim> prims;  ///< parents before their children
  FileReport report;            ///< references, sublayers, unselected variants, faulty operations

  /// Path of the prim, "/head/fringe"; a long path is shortened in the middle.
  std::string pathOf(size_t prim) const;
};

/// A fault that makes one prim unreadable; the rest of the file is read.
struct UsdaFault {
  std::string what;
  size_t line;
};

/// Parses the text. Keeps the properties that place or hide a prim; of prims of type `wanted` also those
/// named in `properties`; of other prims the primvars among these, since primvars are inherited. Names
/// "primvars:..." include their ":indices".
///
/// Selected variants are read. Opinions of the prim itself are stronger, whatever the order in the text, then
/// the variant sets in the order of `variantSets`. Throws Error (file, line, remedy).
UsdaStage readUsdaStage(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties);

/// Numbers per value of a type: 2 for "texCoord2f", 16 for "matrix4d", 4 for "quatf".
size_t usdaNumbersOf(std::string_view type);

/// World transform of a prim. An operation without a value, or without its property, is the identity. Source:
/// UsdGeomXformable and UsdGeomXformOp of OpenUSD.
struct UsdaPlacement {
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
  std::vector<std::string> missing;  ///< operations that are named but have no value
};

/// Composes `above`, the transform of the parent, with the operations of `xformOpOrder`. `!resetXformStack!`
/// discards `above`. Throws UsdaFault for an operation that is unknown, has a wrong count of numbers or one
/// that is not finite, or is to be inverted and cannot be.
UsdaPlacement usdaPlacementOf(const UsdaPrim& prim, const Eigen::Affine3d& above);

}  // namespace strandcast
