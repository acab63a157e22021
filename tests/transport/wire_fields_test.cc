#include "transport/wire_fields.h"

#include <gtest/gtest.h>

#include <regex>

#include "golden_messages.h"
#include "transport/lcm/lcm_messages.h"

namespace strandcast {
namespace {

/// The members of a message's struct in strandcast.idl, one a line. A visitor of fields().
class IdlText {
 public:
  template <class Number>
  void key(const char* name, const Number& value) {
    text_ += "@key ";
    number(name, value);
  }
  template <class Number>
  void number(const char* name, const Number&) {
    line(type<Number>(), name);
  }
  void text(const char* name, const std::string&, size_t) { line("string", name); }
  template <class Number, size_t kLength>
  void items(const char* name, const std::array<Number, kLength>&) {
    line(type<Number>(), name + ('[' + std::to_string(kLength) + ']'));
  }
  template <class Number>
  void array(const char* name, const std::vector<Number>&, size_t limit) {
    line("sequence<" + type<Number>() + ", " + std::to_string(limit) + ">", name);
  }
  const std::string& text() const { return text_; }

 private:
  template <class Number>
  static std::string type() {
    if constexpr (std::is_floating_point_v<Number>) return sizeof(Number) == 8 ? "double" : "float";
    switch (sizeof(Number)) {
      case 8:
        return "unsigned long long";
      case 4:
        return "unsigned long";
      case 2:
        return "unsigned short";
      default:
        return "octet";
    }
  }
  void line(const std::string& type, const std::string& name) { text_ += type + ' ' + name + ";\n"; }
  std::string text_;
};

/// The same for strandcast.lcm.
class LcmText {
 public:
  template <class Number>
  void key(const char* name, const Number& value) {
    number(name, value);
  }
  template <class Number>
  void number(const char* name, const Number&) {
    line(lcmType<Number>(), name);
  }
  void text(const char* name, const std::string&, size_t) { line("string", name); }
  template <class Number, size_t kLength>
  void items(const char* name, const std::array<Number, kLength>&) {
    line(lcmType<Number>(), name + ('[' + std::to_string(kLength) + ']'));
  }
  template <class Number>
  void array(const std::string& name, const std::vector<Number>&, size_t) {
    line("int32_t", name + "_length");
    line(lcmType<Number>(), name + '[' + name + "_length]");
  }
  const std::string& text() const { return text_; }

 private:
  void line(std::string_view type, const std::string& name) {
    text_ += std::string(type) + ' ' + name + ";\n";
  }
  std::string text_;
};

/// The members of a struct of a schema file, one a line, without comments and indentation.
std::string membersOf(const std::string& file, const std::string& type) {
  std::ifstream stream(STRANDCAST_SOURCE_DIR "/transport/" + file);
  std::string members;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    line = std::regex_replace(line, std::regex(" *(//.*)?$|^ +"), "");
    if (inside && line.starts_with('}')) break;
    if (inside && !line.empty()) members += line + '\n';
    inside = inside || line == "struct " + type + " {";
  }
  return members;
}

template <class Text, class Message>
std::string listed() {
  Text text;
  const Message any;
  fields(text, any, std::type_identity<Message>());
  return text.text();
}

template <class Message>
void expectIdl() {
  EXPECT_EQ((listed<IdlText, Message>()), membersOf("idl/strandcast.idl", kWireName<Message>));
}

TEST(WireFields, AreThoseOfTheIdl) {
  expectIdl<GroomChunk>();
  expectIdl<HairChunk>();
  expectIdl<BodyChunk>();
  expectIdl<ColliderChunk>();
  expectIdl<GuideChunk>();
  expectIdl<PoseSamples>();
  expectIdl<Command>();
  expectIdl<Status>();
  expectIdl<ReaderReport>();
  expectIdl<Claim>();
  expectIdl<ShowChunk>();
}

TEST(WireFields, AreThoseOfTheLcmSchema) {
  const auto lcm = [](const char* type) { return membersOf("lcm/strandcast.lcm", type); };
  EXPECT_EQ((listed<LcmText, GroomChunk>()), lcm("groom_chunk_t"));
  EXPECT_EQ((listed<LcmText, HairChunk>()), lcm("hair_chunk_t"));
  EXPECT_EQ((listed<LcmText, BodyChunk>()), lcm("body_chunk_t"));
  EXPECT_EQ((listed<LcmText, ColliderChunk>()), lcm("collider_chunk_t"));
  EXPECT_EQ((listed<LcmText, GuideChunk>()), lcm("guide_chunk_t"));
  EXPECT_EQ((listed<LcmText, PoseSamples>()), lcm("pose_samples_t"));
  EXPECT_EQ((listed<LcmText, Command>()), lcm("command_t"));
  EXPECT_EQ((listed<LcmText, Status>()), lcm("status_t"));
  EXPECT_EQ((listed<LcmText, ReaderReport>()), lcm("reader_t"));
}

template <class Message>
void expectGoldenLcm(const std::string& name) {
  for (const bool is_empty : {false, true}) {
    const std::string form = is_empty ? "lcm empty" : "lcm";
    std::vector<uint8_t> bytes, again;
    toBytes(is_empty ? Message() : fullMessage<Message>(), bytes);
    EXPECT_EQ(hexadecimal(bytes), goldenBytes(name, form)) << name << ' ' << form;
    Message back;
    ASSERT_TRUE(fromBytes(bytes, back));
    toBytes(back, again);
    EXPECT_EQ(bytes, again);
  }
}

TEST(WireFields, GiveTheGoldenBytesOfLcm) {
  expectGoldenLcm<GroomChunk>("GroomChunk");
  expectGoldenLcm<HairChunk>("HairChunk");
  expectGoldenLcm<BodyChunk>("BodyChunk");
  expectGoldenLcm<ColliderChunk>("ColliderChunk");
  expectGoldenLcm<GuideChunk>("GuideChunk");
  expectGoldenLcm<Command>("Command");
  expectGoldenLcm<Status>("Status");
  expectGoldenLcm<ReaderReport>("ReaderReport");
}

TEST(WireFields, LongTextsAreCutAndLongArraysRefused) {
  Command command = fullMessage<Command>(), back;
  command.name = std::string(kMaxTextBytes + 2, 'n');
  command.values.resize(kMaxCommandValues);
  std::vector<uint8_t> bytes;
  toBytes(command, bytes);
  ASSERT_TRUE(fromBytes(bytes, back));
  EXPECT_EQ(back.name, std::string(kMaxTextBytes + 1, 'n'));
  EXPECT_FALSE(isSound(back)) << "it is refused, not obeyed under another name";
  EXPECT_EQ(back.values.size(), kMaxCommandValues);
  command.values.resize(kMaxCommandValues + 1);
  toBytes(command, bytes);
  EXPECT_FALSE(fromBytes(bytes, back));
}

}  // namespace
}  // namespace strandcast
