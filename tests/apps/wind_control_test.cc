// A daemon's wind sources, over the in-process channel.
#include "air/air_system.h"
#include "core/error.h"
#include "service/commands.h"
#include "service/controls.h"
#include "tests/air/wide_fan.h"
#include "tests/apps/daemon_fixture.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

class DaemonWind : public DaemonFixture {
 protected:
  void begin(Settings settings) {
    settings.scene.body_contact = BodyContact::kSpheres;
    static const Scene scene = makeScene(settings.scene);
    start(settings, scene);
    daemon_->setObserver([this](Simulation& simulation) { simulation_ = &simulation; });
  }
  void SetUp() override { begin(fewStrands()); }

  std::string add(const std::string& name, const WindSource& source) {
    return order(CommandKind::kAddWindSource, windSourceValues(source), name);
  }
  std::string move(const std::string& name, const WindSource& to, WindSourceParts parts, double seconds) {
    return order(CommandKind::kMoveWindSource, windMoveValues(to, parts, seconds), name);
  }
  std::string remove(const std::string& name) { return order(CommandKind::kRemoveWindSource, {}, name); }
  /// Mean x of all vertices, m.
  float meanX() const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : subscriber_->frame()->positions) sum += p;
    return sum.x() / static_cast<float>(subscriber_->frame()->positions.size());
  }
  WindSource source(size_t i) const { return daemon_->windSources().at(i).source; }

  Simulation* simulation_ = nullptr;  ///< set after the first frame
};

TEST_F(DaemonWind, BlowsWhereItIsToldToAndStopsWhenItIsRemoved) {
  cast(30);
  const float still = meanX();
  EXPECT_EQ(add("spot", wideFan(6)), "");
  cast(60);
  EXPECT_GT(meanX(), still + 0.01f);
  WindSource back;
  back.direction = -Vec3::UnitX();
  EXPECT_EQ(move("spot", back, kSourceDirection, 0.5), "");
  cast(90);
  EXPECT_LT(meanX(), still - 0.01f);
  EXPECT_EQ(remove("spot"), "");
  cast(180);
  EXPECT_NEAR(meanX(), still, 0.003f);
  EXPECT_NE(remove("spot").find("unknown source of wind 'spot'"), std::string::npos);
}

TEST_F(DaemonWind, OnAGridMovesTheAir) {
  Settings settings = fewStrands();
  settings.parameters = {{"wind_grid", {1}}, {"grid_cells", {16}}};
  begin(settings);
  cast(1);
  const auto windX = [&] {
    const AirFields* const air = airSystem(simulation_->externalForces());
    return air->at(Vec3(air->box().center()) + Vec3(0, 0, 0.2f)).wind.x();
  };
  EXPECT_LT(std::fabs(windX()), 1e-3f);
  EXPECT_EQ(add("spot", wideFan(6)), "");
  cast(30);
  EXPECT_GT(windX(), 1);
  EXPECT_EQ(move("spot", wideFan(-6), kAllSourceParts, 0), "");
  cast(60);
  EXPECT_LT(windX(), -1);
}

TEST_F(DaemonWind, GoesSmoothlyAndItsOtherPartsGoOn) {
  WindSource fan = wideFan(2), to = fan;
  EXPECT_EQ(add("spot", fan), "");
  to.position = Vec3(0, 0, 1);
  to.direction = Vec3(0, 0, 2);
  EXPECT_EQ(move("spot", to, kSourcePosition | kSourceDirection, 1), "");
  cast(29);
  EXPECT_NEAR(source(0).position.z(), 0.5f, 0.03f);
  EXPECT_NEAR(source(0).direction.normalized().x(), std::sqrt(0.5f), 0.05f) << "it turns evenly";
  EXPECT_NEAR(source(0).direction.normalized().z(), std::sqrt(0.5f), 0.05f);
  to.speed = 9;
  const WindSourceParts speed = 32;  // by docs/wire.md
  EXPECT_EQ(move("spot", to, speed, 0), "");
  EXPECT_EQ(source(0).speed, 9);
  EXPECT_LT(source(0).position.z(), 0.6f);
  cast(31);
  EXPECT_EQ(source(0).position, to.position);
  EXPECT_EQ(source(0).direction, to.direction);
  EXPECT_EQ(source(0).radius, fan.radius);
  EXPECT_EQ(source(0).kind, fan.kind);
}

TEST_F(DaemonWind, OfAConfigurationFileIsSteeredByItsName) {
  Settings settings = fewStrands();
  readConfigText("[[wind]]\nposition = [0, 0, 1]\n[[wind]]\nname = \"left\"\nkind = \"turbine\"\n",
                 "hair.toml", settings);
  begin(settings);
  WindSource to;
  to.position = Vec3(2, 0, 0);
  EXPECT_EQ(move("left", to, kSourcePosition, 0), "");
  EXPECT_EQ(source(1).position, to.position);
  EXPECT_EQ(source(1).kind, WindSource::Kind::kTurbine);
  EXPECT_EQ(remove("wind1"), "") << "the first has no name of its own";
  EXPECT_EQ(daemon_->windSources().size(), 1u);
  EXPECT_EQ(daemon_->windSources()[0].name, "left");
}

TEST_F(DaemonWind, ThatDoesNotFitIsRefusedAndChangesNothing) {
  const WindSource fan = wideFan(3);
  EXPECT_EQ(add("spot", fan), "");
  EXPECT_NE(add("spot", fan).find("unique name"), std::string::npos);
  EXPECT_NE(add("", fan).find("no name"), std::string::npos);
  EXPECT_NE(add("two words", fan).find("no name"), std::string::npos);
  WindSource fast = fan, far = fan, flat = fan, still = fan;
  fast.speed = 101;
  far.position.x() = 1001;
  flat.radius = 0;
  still.direction.setZero();
  for (const WindSource& bad : {fast, far, flat, still}) {
    EXPECT_NE(add("bad", bad), "");
    EXPECT_NE(move("spot", bad, kAllSourceParts, 1), "");
  }
  std::vector<double> kindless = windSourceValues(fan), few = kindless, huge = kindless;
  kindless[0] = 3;
  few.pop_back();
  huge[1] = 1e300;
  for (const std::vector<double>& bad : {kindless, few, huge, std::vector<double>()})
    EXPECT_NE(order(CommandKind::kAddWindSource, bad, "bad"), "");
  const std::vector<std::vector<double>> bad_moves{{},
                                                   {0, 1},
                                                   {256, 1},
                                                   {1.5, 1, 0, 0, 0},
                                                   {1, 1},
                                                   {32, 3601, 1},
                                                   {32, -1, 1},
                                                   {32, 1, 2, 3},
                                                   {4294967297.0, 1, 0, 0, 0}};
  for (const std::vector<double>& bad : bad_moves)
    EXPECT_NE(order(CommandKind::kMoveWindSource, bad, "spot"), "");
  EXPECT_NE(move("spit", fan, kSourcePosition, 1).find("did you mean 'spot'?"), std::string::npos);
  EXPECT_NE(remove("spit").find("did you mean 'spot'?"), std::string::npos);
  cast(60);
  ASSERT_EQ(daemon_->windSources().size(), 1u);
  EXPECT_EQ(windSourceValues(source(0)), windSourceValues(fan));
  size_t taken = 1;
  while (taken <= kMaxWindSources && add("n" + std::to_string(taken), fan).empty()) ++taken;
  EXPECT_EQ(taken, kMaxWindSources);
}

TEST_F(DaemonWind, IsReportedInTheStatusAsItIs) {
  const auto told = [&] { return entriesOf(subscriber_->status()->parameters, kWindSourceEntry); };
  EXPECT_EQ(add("spot%20", wideFan(3)), "");
  WindSource to;
  to.position = Vec3(1, 2, 3);
  EXPECT_EQ(move("spot%20", to, kSourcePosition, 0), "");
  EXPECT_EQ(add("other", wideFan(1)), "");  // its answer comes after the step of the move
  ASSERT_EQ(told().size(), 2u);
  EXPECT_EQ(told()[0].first, "spot%20");
  const WindSource read = windSourceOf(told()[0].second, "test");
  EXPECT_EQ(read.position, to.position);
  EXPECT_EQ(read.kind, WindSource::Kind::kTurbine);
  EXPECT_EQ(read.speed, 3);
  EXPECT_EQ(remove("other"), "");
  for (size_t n = 1; n < kMaxWindSources; ++n)
    EXPECT_EQ(add(std::string(60, 'x') + std::to_string(n), wideFan(3)), "");
  EXPECT_EQ(told().size(), kMaxWindSources) << "there is room for all that there may be";
  EXPECT_EQ(entriesOf(subscriber_->status()->parameters, "").size(), parameterList().size());
  EXPECT_TRUE(isSound(subscriber_->status()->parameters));
}

TEST_F(DaemonWind, SentTwiceIsObeyedOnce) {
  const Command command{.id = 4711,
                        .kind = CommandKind::kAddWindSource,
                        .name = "spot",
                        .values = windSourceValues(wideFan(1))};
  for (int i = 0; i < 2; ++i) {
    subscriber_->send(command);
    cast(1);
    EXPECT_EQ(subscriber_->waitForAnswer(command.id, std::chrono::milliseconds(1000)).value_or("none"), "");
  }
  EXPECT_EQ(daemon_->windSources().size(), 1u);
}

}  // namespace
}  // namespace strandcast
