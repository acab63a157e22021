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

#include "groom/file_report.h"
#include "groom/usda_text.h"

namespace strandcast {

/// A property of a prim. Its value is its default, or the earliest of its time samples where it has no
/// default.
struct UsdaProperty {
  std::string type;             ///< as declared, without brackets: "float2", "token"
  std::vector<double> numbers;  ///< of all values, flat; infinite ones and NaN as the text has them
  std::vector<std::string> strings;
  std::string misfit;         ///< how the tuples of the value do not fit the type, or empty
  bool has_value = false;     ///< false where it is only declared, or blocked by `None`
  bool sampled = false;       ///< the value is a time sample
  bool has_samples = false;   ///< there are time samples, whether or not a default goes before them
  size_t source = 0;          ///< number of the block of the text that has the value; 0 where none has
  double time = 0;            ///< of the sample
  std::string interpolation;  ///< as its metadata names it, or empty
  std::optional<double> element_size;      ///< of its metadata; 1 where it is not given
  std::optional<double> unauthored_index;  ///< likewise; -1
  size_t line = 0;                         ///< 1-based
};

/// A prim (node) of the stage with what is wanted of it.
struct UsdaPrim {
  static constexpr size_t kNoParent = std::numeric_limits<size_t>::max();

  std::string type, name;
  size_t line = 0;
  size_t parent = kNoParent;  ///< index into UsdaStage::prims, less than the prim's own
  std::map<std::string, UsdaProperty, std::less<>> properties;
  std::set<std::string> other_primvars;  ///< names of primvars that have a value and are not wanted

  // Inherited from the prims above.
  bool is_active = true;     ///< neither it nor a prim above has `active = false`
  bool is_abstract = false;  ///< it, or a prim above, is a `class`
  bool is_defined = true;    ///< it and those above are each a `def` or `class` somewhere, not only an `over`
  bool is_there = true;      ///< defined and active, and not abstract
  bool is_prototype = false;  ///< of a PointInstancer: it does not show where it stands
  bool is_visible = true;     ///< computed visibility
  std::string purpose;        ///< computed purpose: "default", "render", "proxy" or "guide"
  bool is_sampled = false;    ///< it, or a prim above, has time samples of what is kept
  /// Constant primvars by name, each with the index of the prim that has it. Empty pointer: none.
  std::shared_ptr<const std::map<std::string, size_t, std::less<>>> constant_primvars;
  Eigen::Affine3d to_world = Eigen::Affine3d::Identity();
  std::string fault;      ///< why `to_world` cannot be told, or empty
  size_t fault_line = 0;  ///< where that is

  const UsdaProperty* find(std::string_view property) const;
  /// The first string of a property, or `otherwise`.
  std::string token(std::string_view property, std::string_view otherwise) const;
};

/// What a .usda text says of itself and its prims. Other files that it refers to are not read.
struct UsdaStage {
  double meters_per_unit = 0;  ///< 0 where it is not said
  char up = 'Y';
  std::vector<UsdaPrim> prims;  ///< parents before their children
  FileReport report;            ///< references, sublayers, variants that are not selected, faulty operations

  /// The prim's place, "/head/fringe"; the middle of a long one is left out.
  std::string pathOf(size_t prim) const;
};

/// What makes one prim unreadable, and nothing else of the file.
struct UsdaFault {
  std::string what;
  size_t line;
};

/// Parses the text. Of the properties those are kept that place or hide a prim; of prims of type `wanted`
/// those named in `properties`; of other prims the primvars among them, since primvars are inherited. Those
/// named "primvars:..." bring their ":indices". Of variants the selected ones are read. What the prim itself
/// says is stronger, whatever the order in the text, then the variant sets as `variantSets` lists them.
/// Throws Error (file, line, remedy).
UsdaStage readUsdaStage(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties);

/// Numbers that a value of a type has: 2 of "texCoord2f", 16 of "matrix4d", 4 of "quatf".
size_t usdaNumbersOf(std::string_view type);

}  // namespace strandcast
