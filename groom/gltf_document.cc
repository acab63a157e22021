#include "groom/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <set>

#include "groom/byte_reader.h"
#include "groom/file_bytes.h"

namespace strandcast {
namespace {

using nlohmann::json;

constexpr int kMaxJsonDepth =
    64;  ///< real files stay below 10; a limit keeps hostile ones from nesting for ever
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
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

/// Components of an element.
uint64_t componentsOf(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
}

/// The number that a normalised whole number stands for (glTF 2.0 specification, "Animations").
template <class Whole>
float normalized(const std::byte* from) {
  Whole whole;
  std::memcpy(&whole, from, sizeof whole);
  return std::max(static_cast<float>(whole) / static_cast<float>(std::numeric_limits<Whole>::max()), -1.0f);
}

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

/// RFC 4648; empty on a character that does not belong.
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

/// %20 and its like in a relative URI.
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

/// Where arrays and objects are nested too deeply. A parser that is asked at every value looks through all
/// that it has read: its time grows with the square of the file.
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

}  // namespace

GltfDocument::GltfDocument(std::span<const std::byte> bytes, const std::string& name,
                           const std::optional<std::filesystem::path>& folder)
    : name_(name) {
  const ByteReader reader(bytes, name);
  if (bytes.empty()) reader.fail("the file is empty", 0);
  std::span<const std::byte> binary;
  if (bytes.size() >= 4 && reader.at<uint32_t>(0) == kGlbMagic)
    binary = splitBinary(bytes);
  else
    parseJson(bytes, 0);
  loadBuffers(binary, folder);
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
}

uint64_t GltfDocument::bufferBytes() const {
  uint64_t sum = 0;
  for (const auto& buffer : buffers_) sum += buffer.size();
  return sum;
}

void GltfDocument::loadBuffers(std::span<const std::byte> binary,
                               const std::optional<std::filesystem::path>& folder) {
  const auto list = root_.find("buffers");
  if (list == root_.end()) return;
  if (!list->is_array()) fail("this is not an array", "buffers");
  std::set<std::string> opened;
  for (size_t b = 0; b < list->size(); ++b) {
    const std::string part = fmt::format("buffers[{}]", b);
    const json& description = entry("buffers", b, "buffers");
    const auto length = unsignedMember(description, "byteLength", part);
    if (!length) fail("a buffer has no byteLength", part);
    const auto uri = description.find("uri");
    if (uri == description.end()) {
      // Only the first buffer can be the binary chunk; more of them would count its bytes again and again.
      if (b != 0 || binary.empty()) fail("a buffer has neither a uri nor a binary chunk", part);
      buffers_.push_back(binary);
    } else {
      if (!uri->is_string()) fail("a buffer's uri is not a string", part);
      const auto& text = uri->get_ref<const std::string&>();
      const auto file = std::filesystem::path(percentDecoded(text)).lexically_normal();
      if (!text.starts_with("data:") && !opened.insert(file.string()).second)
        fail("two buffers name the same file", part);
      owned_.push_back(externalBuffer(text, part, folder));
      buffers_.push_back(owned_.back());
    }
    if (*length > buffers_.back().size())
      fail(fmt::format("a buffer of {} bytes holds {}", *length, buffers_.back().size()), part);
    buffers_.back() = buffers_.back().first(*length);
  }
}

std::vector<std::byte> GltfDocument::externalBuffer(
    const std::string& uri, const std::string& part,
    const std::optional<std::filesystem::path>& folder) const {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(";base64,");
    auto bytes =
        comma == std::string::npos ? std::nullopt : decodeBase64(std::string_view(uri).substr(comma + 8));
    if (!bytes) fail("a buffer's data uri is not base64", part);
    return std::move(*bytes);
  }
  const std::filesystem::path relative = percentDecoded(uri);
  const bool leaves_folder = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (!folder || relative.empty() || relative.is_absolute() || leaves_folder ||
      uri.find(':') != std::string::npos || relative.native().find('\0') != std::string::npos)
    fail("a buffer names a file that is not read from here", part,
         "export as .glb, which holds everything in one file");
  return readFileBytes(*folder / relative);
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
  // Beyond 2^48 no offset or count can be meant, and sums of a few stay far from wrapping round.
  if (!member->is_number_unsigned() || member->get<uint64_t>() >> 48)
    fail(fmt::format("{} is not a whole number in range", key), where);
  return member->get<uint64_t>();
}

std::optional<std::vector<float>> GltfDocument::numbers(const json& object, const char* key, size_t count,
                                                        const std::string& where) const {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  if (!member->is_array() || member->size() != count)
    fail(fmt::format("{} is not an array of {} numbers", key, count), where);
  std::vector<float> values;
  for (const json& value : *member) {
    const double number = value.is_number() ? value.get<double>() : HUGE_VAL;
    if (!(std::abs(number) <= FLT_MAX))
      fail(fmt::format("{} holds something that is not a finite number", key), where);
    values.push_back(static_cast<float>(number));
  }
  return values;
}

GltfDocument::Elements GltfDocument::elements(uint64_t accessor, const char* type) const {
  const std::string part = fmt::format("accessors[{}]", accessor);
  const json& description = entry("accessors", accessor, "a primitive");
  const auto type_member = description.find("type");
  if (type_member == description.end() || *type_member != type)
    fail(fmt::format("the accessor's type is not {}", type), part);
  if (description.contains("sparse")) fail("sparse accessors are not read", part, "export without them");
  const uint64_t component = unsignedMember(description, "componentType", part).value_or(0);
  const uint64_t element_bytes = componentBytes(component) * componentsOf(type);
  if (element_bytes == 0) fail(fmt::format("component type {} does not fit here", component), part);
  const auto count = unsignedMember(description, "count", part);
  const auto view_index = unsignedMember(description, "bufferView", part);
  if (!count || *count == 0) fail("the accessor has no elements", part);
  if (!view_index) fail("the accessor has no bufferView", part);

  const std::string view_part = fmt::format("bufferViews[{}]", *view_index);
  const json& view = entry("bufferViews", *view_index, part);
  const auto buffer = unsignedMember(view, "buffer", view_part);
  const auto view_bytes = unsignedMember(view, "byteLength", view_part);
  if (!buffer || *buffer >= buffers_.size()) fail("the view's buffer does not exist", view_part);
  if (!view_bytes) fail("the view has no byteLength", view_part);
  const uint64_t view_at = unsignedMember(view, "byteOffset", view_part).value_or(0);
  const std::span<const std::byte> bytes = buffers_[*buffer];
  if (view_at > bytes.size() || *view_bytes > bytes.size() - view_at)
    fail(fmt::format("bytes {} to {} lie outside the buffer of {}", view_at, view_at + *view_bytes,
                     bytes.size()),
         view_part);
  const uint64_t stride = unsignedMember(view, "byteStride", view_part).value_or(element_bytes);
  if (stride < element_bytes || stride > 252)
    fail(fmt::format("a byteStride of {} does not fit elements of {} bytes", stride, element_bytes),
         view_part);
  const uint64_t at = unsignedMember(description, "byteOffset", part).value_or(0);
  if (at > *view_bytes || element_bytes > *view_bytes - at ||
      *count - 1 > (*view_bytes - at - element_bytes) / stride)
    fail(fmt::format("{} elements from byte {} on do not fit into a view of {} bytes", *count, at,
                     *view_bytes),
         part);
  return {bytes.data() + view_at + at, *count, stride, component};
}

uint64_t GltfDocument::accessorCount(uint64_t accessor, const char* type) const {
  return elements(accessor, type).count;
}

std::vector<Vec3> GltfDocument::positions(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC3");
  const std::string part = fmt::format("accessors[{}]", accessor);
  if (found.component_type != kFloat)
    fail("positions are not 32-bit floats", part, "export without quantisation");
  std::vector<Vec3> points(found.count);
  for (uint64_t i = 0; i < found.count; ++i) {
    std::memcpy(points[i].data(), found.data + i * found.stride, 12);
    if (!points[i].allFinite()) fail(fmt::format("position {} is not a finite number", i), part);
  }
  return points;
}

std::vector<uint32_t> GltfDocument::indices(uint64_t accessor) const {
  const Elements found = elements(accessor, "SCALAR");
  if (found.component_type == kFloat || found.component_type == kByte || found.component_type == kShort)
    fail("indices are not whole numbers without a sign", fmt::format("accessors[{}]", accessor));
  std::vector<uint32_t> values(found.count);
  // Little endian: a narrow index fills the low bytes of the wide one.
  for (uint64_t i = 0; i < found.count; ++i)
    std::memcpy(&values[i], found.data + i * found.stride, componentBytes(found.component_type));
  return values;
}

std::vector<std::array<uint32_t, 4>> GltfDocument::joints(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC4");
  if (found.component_type != kUnsignedByte && found.component_type != kUnsignedShort)
    fail("joints are not numbers of 8 or 16 bits", fmt::format("accessors[{}]", accessor));
  const uint64_t bytes = componentBytes(found.component_type);
  std::vector<std::array<uint32_t, 4>> values(found.count);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < 4; ++c)
      std::memcpy(&values[i][c], found.data + i * found.stride + c * bytes, bytes);
  return values;
}

std::vector<float> GltfDocument::floats(uint64_t accessor, const char* type, bool or_normalized) const {
  const Elements found = elements(accessor, type);
  const std::string part = fmt::format("accessors[{}]", accessor);
  const json& description = entry("accessors", accessor, part);
  const auto flag = description.find("normalized");
  const bool is_normalized = flag != description.end() && flag->is_boolean() && flag->get<bool>();
  if (found.component_type != kFloat && !(or_normalized && is_normalized))
    fail(or_normalized ? "its numbers are neither 32-bit floats nor normalised"
                       : "its numbers are not 32-bit floats",
         part);
  const uint64_t components = componentsOf(type), bytes = componentBytes(found.component_type);
  std::vector<float> values;
  values.reserve(found.count * components);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < components; ++c) {
      const std::byte* from = found.data + i * found.stride + c * bytes;
      float value = 0;
      switch (found.component_type) {
        case kFloat:
          std::memcpy(&value, from, sizeof value);
          break;
        case kByte:
          value = normalized<int8_t>(from);
          break;
        case kUnsignedByte:
          value = normalized<uint8_t>(from);
          break;
        case kShort:
          value = normalized<int16_t>(from);
          break;
        case kUnsignedShort:
          value = normalized<uint16_t>(from);
          break;
        default:
          fail("its numbers are not normalised", part);
      }
      if (!std::isfinite(value)) fail(fmt::format("element {} is not a finite number", i), part);
      values.push_back(value);
    }
  return values;
}

}  // namespace strandcast
