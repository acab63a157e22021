#include "message_fuzz.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "bound_hairs.h"
#include "moving_hair.h"
#include "transport/assembler.h"
#include "transport/cdr.h"
#include "transport/codec/hair_codec.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/metrics.h"
#include "transport/parameter_table.h"
#include "transport/pose_inbox.h"
#include "transport/show.h"

namespace strandcast {

namespace {

// Feed a decoded message to what receives it.

void use(GroomChunk& chunk) { GroomAssembler(1).add(std::move(chunk)); }
void use(BodyChunk& chunk) { BodyAssembler(1).add(std::move(chunk)); }
void use(ColliderChunk& chunk) { ColliderAssembler(1).add(std::move(chunk)); }
const std::shared_ptr<const GroomDescription>& knownGroom() {
  static const auto kGroom =
      std::make_shared<const GroomDescription>(hairGroom(40, [](size_t s) { return 1 + s % 20; }));
  return kGroom;
}
void use(HairChunk& chunk) {
  HairAssembler assembler(1);
  assembler.setGroom(knownGroom());
  if (const auto hairs = assembler.add(std::move(chunk))) checkHairs(*hairs, knownGroom()->guides, "fuzz");
}
void use(GuideChunk& chunk) {
  GuideAssembler assembler(true);
  assembler.setGroom(knownGroom());
  if (const auto frame = assembler.add(chunk)) {
    for (const Vec3& position : frame->positions) {
      if (!position.allFinite()) std::abort();
    }
  }
}
void use(PoseSamples& samples) {
  PoseInbox inbox(1);
  if (!inbox.push(std::move(samples))) return;
  const PoseSamples taken = *inbox.take();
  if (!taken.names.empty() && posedNames(taken).size() != posesPerSample(taken)) std::abort();
  if (!taken.weight_names.empty() && weightNames(taken).size() != weightsPerSample(taken)) std::abort();
  if (!allFinite(taken.poses)) std::abort();
}
void use(Command& command) { isSound(command); }
void use(ReaderReport& report) { isSound(report); }
void use(Status& status) {
  if (isSound(status.parameters) &&
      namedValues(status.parameters).size() != status.parameters.components.size())
    std::abort();
  if (isSound(status.metrics)) namedValues(status.metrics);
}
void use(Claim&) {}
void use(const Show& show) {
  for (const Vec3& position : show.hair.positions)
    if (!position.allFinite()) std::abort();
}
void use(ShowChunk& chunk) {
  if (const auto show = ShowAssembler(1, ShowChunk::kState).add(std::move(chunk))) use(*show);
}

template <class Message>
size_t useLcm(std::span<const uint8_t> bytes) {
  Message message;
  if (!fromBytes(bytes, message)) return 0;
  use(message);
  return 1;
}

template <class Message>
size_t useCdr(std::span<const uint8_t> bytes) {
  Message message;
  if (!readCdr(bytes, message)) return 0;
  cdrKey(message);
  use(message);
  return 1;
}

/// Types of fuzzCdr(), by its first byte, with the names of their seeds.
struct CdrType {
  std::string of;
  size_t (*use)(std::span<const uint8_t> bytes);
};
const CdrType kCdrTypes[] = {
    {"groom", useCdr<GroomChunk>},        {"hairs", useCdr<HairChunk>},    {"body", useCdr<BodyChunk>},
    {"colliders", useCdr<ColliderChunk>}, {"guides", useCdr<GuideChunk>},  {"pose", useCdr<PoseSamples>},
    {"command", useCdr<Command>},         {"status", useCdr<Status>},      {"claim", useCdr<Claim>},
    {"show", useCdr<ShowChunk>},          {"reader", useCdr<ReaderReport>}};

ReaderReport sampleReport() {
  ReaderReport report;
  report.reader = report.session = 5;
  report.wants = ReaderReport::kGroomAndBody;
  report.pixels = 700;
  return report;
}

Show fuzzedShow() {
  Show show;
  show.entries = {{ShowKind::kParameter, "wind", {7, 0, 1}}, {ShowKind::kAnswered, "5 refused", {}}};
  return show;
}

}  // namespace

size_t fuzzMessages(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  size_t read = useLcm<GroomChunk>(bytes) + useLcm<BodyChunk>(bytes) + useLcm<ColliderChunk>(bytes) +
                useLcm<HairChunk>(bytes) + useLcm<GuideChunk>(bytes) + useLcm<PoseSamples>(bytes) +
                useLcm<Command>(bytes) + useLcm<ReaderReport>(bytes) + useLcm<Status>(bytes);
  if (const auto show = showOf(bytes)) ++read, use(*show);
  return read;
}

size_t fuzzCdr(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  return kCdrTypes[data[0] % std::size(kCdrTypes)].use({data + 1, size - 1});
}

namespace {

/// Calls add(name, message) with valid messages; those of one name in a row.
template <class Add>
void addSamples(const Add& add) {
  const GroomDescription groom = hairGroom(40, [](size_t s) { return 1 + s % 20; });
  add("groom", splitGroom(groom)[0]);
  add("groom", splitGroom(sampleGroom(6, [](size_t s) { return 1 + s; }))[0]);  // every array
  add("body", splitBody(sampleBody(10))[0]);
  ColliderSet few = sampleColliders();
  few.colliders[1].shapes.resize(5);  // so that one chunk holds all
  add("colliders", splitColliders(few)[0]);
  add("colliders", splitColliders(sampleColliders())[1]);
  for (const bool with_arrays : {true, false})
    add("hairs", encodeHairs(boundHairs(
                                 groom.guides, 20, [](size_t h) { return 2 + h % 5; }, with_arrays),
                             groom.guides, kDefaultHairError)[0]);
  add("guides", splitFrame(groom, [&] {
        GuideFrame frame = hairFrame(groom, 1);
        frame.colliders = {{3, Pose{}, {}}, {4, Pose{}, sampleBend(1)}};
        return frame;
      }())[0]);
  for (const CodecInfo& info : codecList())
    add("guides", splitFrame(groom, hairFrame(groom, 1), {info.codec})[0]);
  add("pose", samplePoses());
  add("pose", [] {
    PoseSamples scaled = samplePoses();
    scaled.names.clear(), scaled.weight_names.clear();
    scaled.scales.assign(3 * 6, 1.5f);
    return scaled;
  }());
  add("command", Command{1, 7, CommandKind::kSetParameter, "wind", {1, 2, 3}});
  add("command", Command{1, 8, CommandKind::kMoveWindSource, "spot", {33, 2, 0, 0.2, 0.6, 8}});
  add("command", Command{1,
                         9,
                         CommandKind::kAddColliderFile,
                         "chair arm%20chair.obj",
                         {7, 0, 0, -1, 0.5, 0, 0, 0, 1, 0.3, 0, 0.004}});
  add("status", Status());
  Status telling;
  telling.session = 5;
  telling.groom_name = "bob";
  telling.parameters = parameterTable(Parameters());
  telling.metrics = {"rate budget_ms", {60, 16}};
  add("status", telling);
}

/// The list of seeds that the input of `of` is added to.
std::vector<uint8_t>& nextInput(std::vector<FuzzSeeds>& seeds, const std::string& of) {
  if (seeds.empty() || seeds.back().of != of) seeds.push_back({of, {}});
  return seeds.back().inputs.emplace_back();
}

}  // namespace

std::vector<FuzzSeeds> messageSeeds() {
  std::vector<FuzzSeeds> seeds;
  addSamples([&](const char* of, const auto& message) { toBytes(message, nextInput(seeds, of)); });
  toBytes(sampleReport(), nextInput(seeds, "reader"));
  Show show = fuzzedShow();
  nextInput(seeds, "show") = showBytes(show);
  show.hair.positions = show.hair.velocities = {{1, 2, 3}, {4, 5, 6}};
  nextInput(seeds, "show") = showBytes(show);
  return seeds;
}

std::vector<FuzzSeeds> cdrSeeds() {
  std::vector<FuzzSeeds> seeds;
  const auto add = [&](const std::string& of, const auto& message) {
    std::vector<uint8_t>& input = nextInput(seeds, of);
    const auto* const type = std::find_if(std::begin(kCdrTypes), std::end(kCdrTypes),
                                          [&](const CdrType& t) { return t.of == of; });
    input.resize(1 + writeCdr(message, {}));
    input[0] = static_cast<uint8_t>(type - kCdrTypes);
    writeCdr(message, std::span(input).subspan(1));
  };
  addSamples(add);
  add("claim", Claim{5, 1});
  add("show", splitShow(fuzzedShow(), 1).at(0));
  add("reader", sampleReport());
  return seeds;
}

}  // namespace strandcast
