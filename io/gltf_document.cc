// The JSON, buffers, accessors and extensions of a glTF 2.0 asset (specification, "Accessors", "Sparse
// Accessors", "Animations"; KHR_mesh_quantization).
#include "io/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string_view>

#include "io/file_bytes.h"
#include "io/file_report.h"
#include "io/little_endian.h"
#include "io/text_number.h"

namespace strandcast {
namespace {

using nlohmann::json;

constexpr int kMaxJsonDepth = 64;  ///< real files stay below 10; a limit protects against hostile nesting
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

/// Decodes RFC 4648; empty on a character outside the alphabet.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int digit = base64Digit(c);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> held) & 0xFF));
  }
  return bytes;
}

/// Decodes %20 and the like in a relative URI.
std::string percentDecoded(const std::string& uri) {
  const auto hex = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
      text += static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

/// Offset at which arrays and objects are nested too deeply; empty if none. A separate pass: a parser
/// callback at each value would scan everything read so far, in time quadratic in the file's size.
std::optional<size_t> tooDeep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string) {
      if (c == '\\') ++i;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::nullopt;
}

/// Major and minor of a version such as "2.0". They may have any number of digits.
std::optional<std::pair<double, double>> versionOf(std::string_view text) {
  const size_t point = text.find('.');
  const auto part = [](std::string_view digits) -> std::optional<double> {
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) return {};
    return numberOrInfinite(digits);
  };
  const auto major = part(text.substr(0, point));
  const auto minor = part(point == std::string_view::npos ? "" : text.substr(point + 1));
  if (!major || !minor) return {};
  return std::pair(*major, *minor);
}

}  // namespace

GltfDocument::GltfDocument(std::span<const std::byte> bytes, const std::string& name,
                           const ReadBeside& read_beside, const GltfLimits& limits)
    : name_(name), limits_(limits) {
  const ByteReader reader(bytes, name);
  if (bytes.empty()) reader.fail("the file is empty", 0);
  std::span<const std::byte> binary;
  if (bytes.size() >= 4 && reader.at<uint32_t>(0) == kGlbMagic)
    binary = splitBinary(bytes);
  else
    parseJson(std::as_bytes(std::span(textOfFile(bytes, name))), 0);
  checkRequiredExtensions(*this);
  loadBuffers(binary, read_beside);
}

std::span<const std::byte> GltfDocument::splitBinary(std::span<const std::byte> bytes) {
  const ByteReader reader(bytes, name_);
  const auto version = reader.at<uint32_t>(4);
  if (version != 2)
    reader.fail(fmt::format("this is version {} of glTF", version), 4, "export it as glTF 2.0");
  const uint64_t length = reader.at<uint32_t>(8);
  if (length < 20 || length > reader.size())
    reader.fail(fmt::format("the header says {} bytes, the file has {}", length, reader.size()), 8);
  const auto chunk = [&](uint64_t at, uint32_t type, const char* what) {
    if (reader.at<uint32_t>(at + 4, "chunk header") != type)
      reader.fail(fmt::format("this is not a {}", what), at + 4);
    const uint64_t chunk_bytes = reader.at<uint32_t>(at, "chunk header");
    reader.require(at + 8, chunk_bytes, 1, what);
    return bytes.subspan(at + 8, chunk_bytes);
  };
  const std::span<const std::byte> text = chunk(12, kJsonChunk, "JSON chunk");
  parseJson(text, 20);
  const uint64_t binary_at = 20 + uint64_t{text.size()};
  if (binary_at + 8 > length) return {};
  return chunk(binary_at, kBinaryChunk, "binary chunk");
}

void GltfDocument::parseJson(std::span<const std::byte> text, uint64_t file_offset) {
  const std::string_view characters(reinterpret_cast<const char*>(text.data()), text.size());
  if (const std::optional<size_t> at = tooDeep(characters))
    fail("its JSON is nested too deeply", fmt::format("byte {}", file_offset + *at));
  try {
    root_ = json::parse(characters);
  } catch (const json::parse_error& failure) {
    fail("its JSON cannot be read", fmt::format("byte {}", file_offset + failure.byte));
  } catch (const json::exception&) {
    fail("its JSON holds a number out of range", fmt::format("byte {}", file_offset));
  }
  if (!root_.is_object()) fail("its JSON is not an object", fmt::format("byte {}", file_offset));
  const auto asset = root_.find("asset");
  if (asset == root_.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string() ||
      !(*asset)["version"].get_ref<const std::string&>().starts_with("2."))
    fail("this is not glTF 2.0", "asset.version", "export it as glTF 2.0");
  checkVersion(*asset);
}

void GltfDocument::checkVersion(const json& asset) {
  if (const auto& version = asset["version"].get_ref<const std::string&>(); version != "2.0")
    doubts_.push_back(fmt::format("asset.version is {}: it is read as glTF 2.0", printable(version)));
  const auto least = asset.find("minVersion");
  if (least == asset.end()) return;
  const std::string text = least->is_string() ? least->get<std::string>() : "";
  const auto version = versionOf(text);
  if (!version) doubts_.push_back(fmt::format("asset.minVersion is not a version: '{}'", printable(text)));
  if (version && *version > std::pair(2.0, 0.0))
    fail(fmt::format("the file requires glTF {}, 2.0 is read", printable(text)), "asset.minVersion",
         "export it as glTF 2.0");
}

void GltfDocument::loadBuffers(std::span<const std::byte> binary, const ReadBeside& read_beside) {
  const auto list = root_.find("buffers");
  if (list == root_.end()) return;
  if (!list->is_array()) fail("this is not an array", "buffers");
  std::map<std::string, size_t> read;  // file -> index into owned_
  for (size_t b = 0; b < list->size(); ++b) {
    const std::string part = fmt::format("buffers[{}]", b);
    const json& description = entry("buffers", b, "buffers");
    const auto length = unsignedMember(description, "byteLength", part);
    if (!length) fail("a buffer has no byteLength", part);
    const auto uri = description.find("uri");
    if (uri == description.end()) {
      if (isMeshoptFallback(description)) {  // views of it are refused where they are used
        buffers_.push_back({});
        continue;
      }
      if (b != 0 || binary.empty()) fail("a buffer has neither a uri nor a binary chunk", part);
      buffers_.push_back(binary);
    } else {
      if (!uri->is_string()) fail("a buffer's uri is not a string", part);
      const auto& text = uri->get_ref<const std::string&>();
      const auto [known, is_new] = read.try_emplace(text, owned_.size());
      if (is_new) owned_.push_back(externalBuffer(text, part, read_beside));
      buffers_.push_back(owned_[known->second]);
    }
    if (*length > buffers_.back().size())
      fail(fmt::format("a buffer of {} bytes holds {}", *length, buffers_.back().size()), part);
    buffers_.back() = buffers_.back().first(*length);
  }
}

std::vector<std::byte> GltfDocument::externalBuffer(const std::string& uri, const std::string& part,
                                                    const ReadBeside& read_beside) const {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(";base64,");
    auto bytes =
        comma == std::string::npos ? std::nullopt : decodeBase64(std::string_view(uri).substr(comma + 8));
    if (!bytes) fail("a buffer's data uri is not base64", part);
    return std::move(*bytes);
  }
  const std::filesystem::path relative = percentDecoded(uri);
  const bool leaves_folder = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (!read_beside || relative.empty() || relative.is_absolute() || leaves_folder ||
      uri.find(':') != std::string::npos || relative.native().find('\0') != std::string::npos)
    fail("a buffer names a file that is not read from here", part,
         "export as .glb, which holds everything in one file");
  return read_beside(relative);
}

const json& GltfDocument::entry(const char* array, uint64_t index, const std::string& asked_by) const {
  const auto list = root_.find(array);
  if (list == root_.end() || !list->is_array() || index >= list->size())
    fail(fmt::format("there is no {}[{}]", array, index), asked_by);
  const json& found = (*list)[index];
  if (!found.is_object()) fail("this is not an object", fmt::format("{}[{}]", array, index));
  return found;
}

std::optional<uint64_t> GltfDocument::unsignedMember(const json& object, const char* key,
                                                     const std::string& where) const {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  // Offsets and counts stay below 2^48, so that sums of a few cannot overflow.
  if (!member->is_number_unsigned() || member->get<uint64_t>() >> 48)
    fail(fmt::format("{} is not a whole number in range", key), where);
  return member->get<uint64_t>();
}

std::optional<std::vector<float>> GltfDocument::numbers(const json& object, const char* key,
                                                        const std::string& where) const {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  if (!member->is_array()) fail(fmt::format("{} is not an array", key), where);
  std::vector<float> values;
  for (const json& value : *member) {
    const double number = value.is_number() ? value.get<double>() : HUGE_VAL;
    if (!(std::abs(number) <= FLT_MAX))
      fail(fmt::format("{} holds something that is not a finite number", key), where);
    values.push_back(static_cast<float>(number));
  }
  return values;
}

std::optional<std::vector<float>> GltfDocument::numbers(const json& object, const char* key, size_t count,
                                                        const std::string& where) const {
  auto values = numbers(object, key, where);
  if (values && values->size() != count)
    fail(fmt::format("{} is not an array of {} numbers", key, count), where);
  return values;
}

namespace {

enum ComponentType : uint64_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

uint64_t componentBytes(uint64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

/// Components per element; 0 for an unknown type.
uint64_t componentsOf(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
}

bool isIndexType(uint64_t type) {
  return type == kUnsignedByte || type == kUnsignedShort || type == kUnsignedInt;
}

std::string accessorPart(uint64_t accessor) { return fmt::format("accessors[{}]", accessor); }

/// An integer component as a float, mapped to 0 to 1 or -1 to 1 where it is normalised.
template <class Whole>
float wholeNumber(const std::byte* from, bool is_normalized) {
  Whole whole;
  std::memcpy(&whole, from, sizeof whole);
  const auto value = static_cast<float>(whole);
  if (!is_normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<Whole>::max()), -1.0f);
}

/// A component of any type except 32-bit integers; NaN for those.
float componentAt(const std::byte* from, uint64_t type, bool is_normalized) {
  switch (type) {
    case kFloat: {
      float value = 0;
      std::memcpy(&value, from, sizeof value);
      return value;
    }
    case kByte:
      return wholeNumber<int8_t>(from, is_normalized);
    case kUnsignedByte:
      return wholeNumber<uint8_t>(from, is_normalized);
    case kShort:
      return wholeNumber<int16_t>(from, is_normalized);
    case kUnsignedShort:
      return wholeNumber<uint16_t>(from, is_normalized);
    default:
      return std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

GltfDocument::View GltfDocument::view(uint64_t index, const std::string& asked_by) const {
  const std::string part = fmt::format("bufferViews[{}]", index);
  const json& description = entry("bufferViews", index, asked_by);
  const auto buffer = unsignedMember(description, "buffer", part);
  const auto length = unsignedMember(description, "byteLength", part);
  if (!buffer || *buffer >= buffers_.size()) fail("the view's buffer does not exist", part);
  if (!length) fail("the view has no byteLength", part);
  const uint64_t at = unsignedMember(description, "byteOffset", part).value_or(0);
  const std::span<const std::byte> bytes = buffers_[*buffer];
  if (const char* compression = meshoptOf(description); compression != nullptr && bytes.empty())
    fail(fmt::format("its data is compressed with {}, which is not read", compression), part, kUncompressed);
  if (at > bytes.size() || *length > bytes.size() - at)
    fail(fmt::format("bytes {} to {} lie outside the buffer of {}", at, at + *length, bytes.size()), part);
  auto stride = unsignedMember(description, "byteStride", part);
  if (stride == 0) stride.reset();  // some exporters write 0 for tightly packed elements
  return {bytes.subspan(at, *length), stride};
}

GltfDocument::Elements GltfDocument::elements(uint64_t accessor, const char* type, uint64_t most) const {
  const std::string part = accessorPart(accessor);
  const json& description = entry("accessors", accessor, "a primitive");
  const auto type_member = description.find("type");
  if (type_member == description.end() || *type_member != type)
    fail(fmt::format("the accessor's type is not {}", type), part);
  const uint64_t component = unsignedMember(description, "componentType", part).value_or(0);
  const uint64_t element_bytes = componentBytes(component) * componentsOf(type);
  if (element_bytes == 0) fail(fmt::format("component type {} does not fit here", component), part);
  const auto count = unsignedMember(description, "count", part);
  if (!count) fail("the accessor has no count", part);
  const auto flag = description.find("normalized");
  Elements out;
  out.count = std::min(*count, most);
  out.stride = element_bytes;
  out.component_type = component;
  out.is_normalized = flag != description.end() && flag->is_boolean() && flag->get<bool>();
  const auto view_index = unsignedMember(description, "bufferView", part);
  if (view_index) {
    const View from = view(*view_index, part);
    out.stride = from.stride.value_or(element_bytes);
    if (out.stride < element_bytes)
      fail(fmt::format("a byteStride of {} does not fit elements of {} bytes", out.stride, element_bytes),
           fmt::format("bufferViews[{}]", *view_index));
    const uint64_t at = unsignedMember(description, "byteOffset", part).value_or(0);
    const uint64_t room = from.bytes.size();
    if (*count > 0 &&
        (at > room || element_bytes > room - at || *count - 1 > (room - at - element_bytes) / out.stride))
      fail(fmt::format("{} elements from byte {} on do not fit into a view of {} bytes", *count, at, room),
           part);
    if (out.count > 0) out.data = from.bytes.data() + at;
  }
  const auto sparse = description.find("sparse");
  if (view_index && sparse == description.end()) return out;
  if (*count > limits_.accessor_bytes / element_bytes)
    fail(fmt::format("{} elements that the file does not hold one by one are too many: {} are read", *count,
                     limits_.accessor_bytes / element_bytes),
         part, "export the accessor with a bufferView of its own");
  std::vector<std::byte> own(out.count * element_bytes);
  for (uint64_t i = 0; out.data != nullptr && i < out.count; ++i)
    std::memcpy(own.data() + i * element_bytes, out.data + i * out.stride, element_bytes);
  if (sparse != description.end()) replaceSparse(*sparse, *count, element_bytes, part, own);
  out.own = std::move(own);
  out.data = out.own.data();
  out.stride = element_bytes;
  return out;
}

void GltfDocument::replaceSparse(const json& sparse, uint64_t count, uint64_t element_bytes,
                                 const std::string& part, std::vector<std::byte>& into) const {
  if (!sparse.is_object()) fail("sparse is not an object", part);
  const auto replaced = unsignedMember(sparse, "count", part);
  if (!replaced || *replaced > count) fail(fmt::format("its sparse count is not 0 to {}", count), part);
  if (*replaced == 0) return;
  const auto bytesOf = [&](const char* key, uint64_t each) {
    const auto member = sparse.find(key);
    const auto view_index = member != sparse.end() && member->is_object()
                                ? unsignedMember(*member, "bufferView", part)
                                : std::nullopt;
    if (!view_index) fail(fmt::format("its sparse {} have no bufferView", key), part);
    const std::span<const std::byte> bytes = view(*view_index, part).bytes;
    const uint64_t at = unsignedMember(*member, "byteOffset", part).value_or(0);
    if (at > bytes.size() || *replaced > (bytes.size() - at) / each)
      fail(fmt::format("{} sparse {} do not fit into a view of {} bytes", *replaced, key, bytes.size()),
           part);
    return bytes.data() + at;
  };
  const auto indices = sparse.find("indices");
  const uint64_t index_type = indices != sparse.end() && indices->is_object()
                                  ? unsignedMember(*indices, "componentType", part).value_or(0)
                                  : 0;
  if (!isIndexType(index_type)) fail("its sparse indices are not whole numbers without a sign", part);
  const uint64_t index_bytes = componentBytes(index_type);
  const std::byte* from_index = bytesOf("indices", index_bytes);
  const std::byte* from_value = bytesOf("values", element_bytes);
  for (uint64_t i = 0; i < *replaced; ++i) {
    uint32_t index = 0;  // little endian: a narrow index fills the low bytes of the wide one
    std::memcpy(&index, from_index + i * index_bytes, index_bytes);
    if (index >= count)
      fail(fmt::format("sparse index {} is out of range, there are {}", index, count), part);
    if ((index + uint64_t{1}) * element_bytes > into.size()) continue;  // beyond the requested elements
    std::memcpy(into.data() + index * element_bytes, from_value + i * element_bytes, element_bytes);
  }
}

uint64_t GltfDocument::accessorCount(uint64_t accessor, const char* type) const {
  (void)elements(accessor, type, 0);
  return unsignedMember(entry("accessors", accessor, "a primitive"), "count", accessorPart(accessor)).value();
}

std::vector<Vec3> GltfDocument::positions(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC3", std::numeric_limits<uint64_t>::max());
  if (found.component_type == kUnsignedInt)
    fail("positions are neither 32-bit floats nor of 8 or 16 bits", accessorPart(accessor));
  const uint64_t bytes = componentBytes(found.component_type);
  std::vector<Vec3> points(found.count);
  for (uint64_t i = 0; i < found.count; ++i) {
    for (uint64_t c = 0; c < 3; ++c)
      points[i][static_cast<Eigen::Index>(c)] =
          componentAt(found.data + i * found.stride + c * bytes, found.component_type, found.is_normalized);
    if (!points[i].allFinite())
      fail(fmt::format("position {} is not a finite number", i), accessorPart(accessor));
  }
  return points;
}

std::vector<uint32_t> GltfDocument::indices(uint64_t accessor) const {
  const Elements found = elements(accessor, "SCALAR", std::numeric_limits<uint64_t>::max());
  if (!isIndexType(found.component_type))
    fail("indices are not whole numbers without a sign", accessorPart(accessor));
  std::vector<uint32_t> values(found.count);
  // Little endian: a narrow index fills the low bytes of the wide one.
  for (uint64_t i = 0; i < found.count; ++i)
    std::memcpy(&values[i], found.data + i * found.stride, componentBytes(found.component_type));
  return values;
}

std::vector<std::array<uint32_t, 4>> GltfDocument::joints(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC4", std::numeric_limits<uint64_t>::max());
  if (found.component_type != kUnsignedByte && found.component_type != kUnsignedShort)
    fail("joints are not numbers of 8 or 16 bits", accessorPart(accessor));
  const uint64_t bytes = componentBytes(found.component_type);
  std::vector<std::array<uint32_t, 4>> values(found.count);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < 4; ++c)
      std::memcpy(&values[i][c], found.data + i * found.stride + c * bytes, bytes);
  return values;
}

std::vector<float> GltfDocument::floats(uint64_t accessor, const char* type, bool or_normalized,
                                        uint64_t most) const {
  const Elements found = elements(accessor, type, most);
  if (found.component_type != kFloat && !(or_normalized && found.is_normalized))
    fail(or_normalized ? "its numbers are neither 32-bit floats nor normalised"
                       : "its numbers are not 32-bit floats",
         accessorPart(accessor));
  const uint64_t components = componentsOf(type), bytes = componentBytes(found.component_type);
  std::vector<float> values;
  values.reserve(found.count * components);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < components; ++c) {
      const float value = componentAt(found.data + i * found.stride + c * bytes, found.component_type, true);
      if (!std::isfinite(value))
        fail(fmt::format("element {} is not a finite number", i), accessorPart(accessor));
      values.push_back(value);
    }
  return values;
}

namespace {

constexpr std::array<const char*, 2> kMeshopt{"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Supported extensions.
constexpr std::array<std::string_view, 3> kRead{"KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
                                                "KHR_node_visibility"};
/// Name prefixes of extensions that do not affect a body's surface or motion.
constexpr std::array<std::string_view, 37> kHarmless{"KHR_materials_",
                                                     "EXT_materials_",
                                                     "ADOBE_materials_",
                                                     "MSFT_materials_",
                                                     "FB_materials_",
                                                     "KHR_texture_",
                                                     "EXT_texture_",
                                                     "MSFT_texture_",
                                                     "GOOGLE_texture_",
                                                     "MSFT_packing_",
                                                     "KHR_lights_",
                                                     "EXT_lights_",
                                                     "KHR_techniques_webgl",
                                                     "KHR_xmp",
                                                     "KHR_audio",
                                                     "MSFT_audio",
                                                     "MSFT_lod",
                                                     "KHR_node_selectability",
                                                     "KHR_node_hoverability",
                                                     "KHR_interactivity",
                                                     "KHR_physics_",
                                                     "MSFT_physics",
                                                     "KHR_implicit_shapes",
                                                     "KHR_environment_map",
                                                     "KHR_binary_glTF",
                                                     "KHR_blend",
                                                     "OMI_",
                                                     "VRM",
                                                     "EXT_mesh_features",
                                                     "EXT_instance_features",
                                                     "EXT_structural_metadata",
                                                     "EXT_feature_metadata",
                                                     "EXT_mesh_manifold",
                                                     "CESIUM_primitive_outline",
                                                     "FB_ngon_encoding",
                                                     "AGI_stk_metadata",
                                                     "GODOT_single_root"};
/// Unsupported extensions that change the surface or its motion.
constexpr std::array<std::string_view, 8> kChanging{
    "CESIUM_RTC",        "KHR_animation_pointer",      "EXT_primitive_voxels",       "KHR_gaussian_splatting",
    "AGI_articulations", "KHR_mesh_primitive_restart", "EXT_mesh_primitive_restart", "MPEG_"};

enum class Extension : uint8_t { kIsRead, kIsHarmless, kIsCompression, kIsChanging, kIsUnknown };

Extension meaningOf(std::string_view name) {
  const auto begins = [&](std::string_view with) { return name.starts_with(with); };
  if (std::find(kRead.begin(), kRead.end(), name) != kRead.end()) return Extension::kIsRead;
  if (name == kDraco || std::find(kMeshopt.begin(), kMeshopt.end(), name) != kMeshopt.end())
    return Extension::kIsCompression;
  if (std::any_of(kHarmless.begin(), kHarmless.end(), begins)) return Extension::kIsHarmless;
  if (std::any_of(kChanging.begin(), kChanging.end(), begins)) return Extension::kIsChanging;
  return Extension::kIsUnknown;
}

std::vector<std::string> namesIn(const GltfDocument& document, const char* key) {
  std::vector<std::string> names;
  const auto list = document.root().find(key);
  if (list == document.root().end()) return names;
  if (!list->is_array()) document.fail("this is not an array", key);
  for (const json& name : *list) {
    if (!name.is_string()) document.fail("it holds something that is not a name", key);
    names.push_back(printable(name.get_ref<const std::string&>()));
  }
  return names;
}

}  // namespace

void checkRequiredExtensions(const GltfDocument& document) {
  for (const std::string& name : namesIn(document, "extensionsRequired")) {
    const Extension meaning = meaningOf(name);
    if (meaning == Extension::kIsRead || meaning == Extension::kIsHarmless) continue;
    document.fail(fmt::format("the file requires the extension {}, which is not read", name),
                  "extensionsRequired",
                  meaning == Extension::kIsCompression ? kUncompressed : "export it without that extension");
  }
}

void reportAsset(const GltfDocument& document, GltfReport& report) {
  for (const std::string& doubt : document.doubts()) report.warn(doubt);
  for (const std::string& name : namesIn(document, "extensionsUsed")) {
    const Extension meaning = meaningOf(name);
    if (meaning == Extension::kIsChanging) report.addOmission(fmt::format("the extension {}", name));
    if (meaning == Extension::kIsUnknown) report.addOmission(fmt::format("the unknown extension {}", name));
  }
}

const json* extensionOf(const json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(name);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

const char* meshoptOf(const json& view) {
  for (const char* name : kMeshopt)
    if (extensionOf(view, name) != nullptr) return name;
  return nullptr;
}

bool isMeshoptFallback(const json& buffer) { return meshoptOf(buffer) != nullptr; }

}  // namespace strandcast
