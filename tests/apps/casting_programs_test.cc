// The programs as a user runs them over a network: daemons that cast and execute commands, and their
// receivers.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/apps/program_fixture.h"
#include "tests/transport/dds_domain.h"

namespace strandcast {
namespace {

class CastingPrograms : public ProgramFixture {
 protected:
  const std::string domain_ = std::to_string(testDomain(0));
};

/// Children of `parent` that have not ended.
std::vector<pid_t> childrenOf(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    pid_t child = 0, of = 0;
    std::string name, state;
    if (stat >> child >> name >> state >> of && of == parent && state != "Z") children.push_back(child);
  }
  return children;
}

TEST_F(CastingPrograms, ValidateWireMeasuresBetweenTwoProcesses) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const Outcome r = run(program_ + " validate wire --only 'dds delta16 1000x32 120 Hz' --json");
  ASSERT_LE(r.exit_code, 1) << r.err;  // the latency limit may fail on a busy machine
  const nlohmann::json results = nlohmann::json::parse(r.out)["results"];
  ASSERT_EQ(results.size(), 7u) << r.out;
  EXPECT_GT(results[0]["value"], 1);
  EXPECT_LE(results[0]["value"], 4);
  EXPECT_GT(results[1]["value"], 0) << "what came is compared with what was sent";
  EXPECT_LE(results[1]["value"], 0.0100001);
  EXPECT_LT(results[2]["value"], 60) << "of 240 frames";
  EXPECT_GT(results[3]["value"], 0);
  EXPECT_GE(results[4]["value"], results[3]["value"]);
  EXPECT_GT(results[5]["value"], 0);
  EXPECT_GT(results[6]["value"], 0);
}

TEST_F(CastingPrograms, ValidateWireOutlivesItsReader) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  struct Run {
    int signal;
    const char* end;
    std::string out;
    pid_t validate = 0;
    std::set<pid_t> readers = {};  // the first reader is that of the unloaded latency
    std::chrono::steady_clock::time_point second = {};
  };
  // Both run concurrently: they mostly wait, the second one for a reader that does not answer.
  std::vector<Run> runs{{SIGKILL, "signal 9", "killed.json"}, {SIGSTOP, "still running", "stopped.json"}};
  for (Run& one : runs)
    one.validate =
        start({program_, "validate", "wire", "--only", "dds delta16 1000x32 120 Hz", "--json"}, one.out);
  for (std::vector<Run*> waiting{&runs[0], &runs[1]}; !waiting.empty();) {
    std::erase_if(waiting, [&](Run* one) {
      if (!isRunning(one->validate)) return true;
      for (const pid_t child : childrenOf(one->validate)) one->readers.insert(child);
      const auto now = std::chrono::steady_clock::now();
      if (one->readers.size() < 2) return false;
      if (one->second == std::chrono::steady_clock::time_point{}) one->second = now;
      if (now - one->second < std::chrono::seconds(1)) return false;
      for (const pid_t reader : childrenOf(one->validate)) kill(reader, one->signal);
      return true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  for (Run& one : runs) {
    ASSERT_EQ(one.readers.size(), 2u);
    EXPECT_EQ(wait(one.validate), 1);
    const nlohmann::json report = nlohmann::json::parse(contents(folder_ / one.out));
    EXPECT_EQ(report["failed"], 7) << report;
    EXPECT_NE(report["results"][0]["note"].get<std::string>().find(one.end), std::string::npos) << report;
    EXPECT_TRUE(report["results"][0]["value"].is_null()) << report;
  }
}

TEST_F(CastingPrograms, DaemonCastsToARendererAndObeys) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::vector<std::string> words{daemon_, "--scene", "straight", "--strands",  "200", "--domain",
                                       domain_, "--json",  "--quiet",  "--duration", "120"};
  const pid_t first = start(words, "daemon.json");
  const std::string network = " --domain " + domain_;
  ASSERT_EQ(run(program_ + " ctl wind 3 0 0" + network + " --timeout 60").exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl motion nod" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl head 0 0.01 0 20" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl reset" + network).exit_code, 0);
  const Outcome refused = run(program_ + " ctl set air_drag -5" + network);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("air_drag"), std::string::npos) << refused.err;
  const std::string fan = program_ + " ctl fan ";
  EXPECT_EQ(run(fan + "add spot cone 0 0.2 -0.6 --direction 0 0 1 --speed -2" + network).exit_code, 0);
  EXPECT_EQ(run(fan + "move spot --direction 0 -1 0 --angle 30" + network).exit_code, 0);
  const Outcome unknown = run(fan + "move spat 0 0 0" + network);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("did you mean 'spot'?"), std::string::npos) << unknown.err;
  for (const char* bad :
       {"move spot", "move spot 0 0", "move spot --speed 101", "move spot --direction 0 0 0",
        "add s storm 0 0 0", "add s cone 0 0", "move spot --seconds 1"})
    EXPECT_EQ(run(fan + bad + network).exit_code, 2) << bad;
  const Outcome fans = run(fan + "list --json" + network);
  EXPECT_EQ(fans.exit_code, 0) << fans.err;
  const nlohmann::json spot = nlohmann::json::parse(fans.out)["fans"].at(0);
  EXPECT_EQ(spot["name"], "spot");
  EXPECT_EQ(spot["kind"], "cone");
  EXPECT_EQ(spot["position"], nlohmann::json::parse("[0.0, 0.2, -0.6]"));
  EXPECT_EQ(spot["speed"], -2.0);
  const Outcome table = run(fan + "list" + network);
  EXPECT_NE(table.out.find("spot"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("speed -2 m/s"), std::string::npos) << table.out;
  EXPECT_EQ(run(fan + "remove spot" + network).exit_code, 0);
  EXPECT_EQ(run(fan + "list" + network).out, "no sources of wind\n");
  const std::string collider = program_ + " ctl collider ";
  EXPECT_EQ(run(collider + "add 'a ball' sphere 0 0.1 0.75 0.05" + network).exit_code, 0);
  const nlohmann::json listed =
      nlohmann::json::parse(run(collider + "list --json" + network).out)["colliders"];
  ASSERT_EQ(listed.size(), 3u) << listed;
  EXPECT_TRUE(listed[0]["name"].is_null()) << "the scene's";
  EXPECT_EQ(listed[0]["follows_head"], true);
  EXPECT_EQ(listed[2]["name"], "a ball");
  EXPECT_EQ(listed[2]["shapes"], nlohmann::json::parse("[\"sphere\"]"));
  EXPECT_EQ(listed[2]["position"], nlohmann::json::parse("[0.0, 0.1, 0.75]"));
  const Outcome balls = run(collider + "list" + network);
  EXPECT_NE(balls.out.find("at 0 0.1 0.75"), std::string::npos) << balls.out;
  EXPECT_EQ(run(collider + "remove 'a ball'" + network).exit_code, 0);
  const Outcome far = run(program_ + " ctl head 2000 0 0" + network);
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_NE(far.err.find("within 1000"), std::string::npos) << far.err;
  // Remote commands must not open the daemon's files.
  const Outcome file = run(program_ + " ctl motion " + write("walk.bvh", "HIERARCHY").string() + network);
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_NE(file.err.find("still"), std::string::npos) << file.err;
#ifdef STRANDCAST_EXAMPLE_READER
  const Outcome read = run(std::string(STRANDCAST_EXAMPLE_READER) + " " + domain_ + " 5");
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_NE(read.out.find("200 strands"), std::string::npos) << read.out;
  EXPECT_NE(read.out.find("0 lost"), std::string::npos) << read.out;
#endif
  const Outcome told = run(program_ + " ctl status --json" + network);
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const nlohmann::json parameters = nlohmann::json::parse(told.out)["parameters"];
  EXPECT_EQ(parameters["wind"], (std::vector<double>{3, 0, 0}));
  EXPECT_EQ(parameters["air_drag"], 5) << "of the scene";
  EXPECT_NE(run(program_ + " ctl status" + network).out.find("    wind               3 0 0 m/s\n"),
            std::string::npos);

  const Outcome conflict = run(daemon_ + " --scene straight --strands 20 --quiet" + network);
  EXPECT_EQ(conflict.exit_code, 2);
  EXPECT_NE(conflict.err.find("another daemon"), std::string::npos) << conflict.err;

  const Outcome drawn =
      run(program_ + " render --json --frames 60 --width 160 --height 120 --hairs 2000 --out " +
          (folder_ / "pictures").string() + network);
  if (drawn.err.find("OpenGL") == std::string::npos) {
    ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
    const nlohmann::json report = nlohmann::json::parse(drawn.out);
    EXPECT_EQ(report["frames_drawn"], 60);
    EXPECT_EQ(report["frames_lost"], 0);
    EXPECT_EQ(report["strands"], 200);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "frame_0002.png"));
    const Outcome seen = run(program_ + " ctl status --json" + network);
    const double pixels = nlohmann::json::parse(seen.out)["metrics"]["largest_pixels"];
    EXPECT_GT(pixels, 40) << "of a picture 120 pixels high, to a daemon that hears its reader for 3 s more";
    EXPECT_LT(pixels, 200);
  }
  // A paused daemon gives one frame to record, not a film of it.
  EXPECT_EQ(run(program_ + " ctl pause" + network).exit_code, 0);
  const std::filesystem::path take = folder_ / "paused.rec";
  const pid_t record = start(
      {program_, "record", take.string(), "--timeout", "4", "--json", "--domain", domain_}, "record.json");
  for (int i = 0; i < 300 && !std::filesystem::exists(take) && isRunning(record); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::seconds(5));
  ASSERT_TRUE(isRunning(record)) << "it is no silence";
  interrupt(record);
  EXPECT_EQ(wait(record), 130);
  EXPECT_LE(nlohmann::json::parse(contents(folder_ / "record.json"))["frames"], 2);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(first), 0);
  const nlohmann::json summary = nlohmann::json::parse(contents(folder_ / "daemon.json"));
  EXPECT_GT(summary["frames_published"], 10);
  EXPECT_EQ(summary["non_finite"], 0);
}

TEST_F(CastingPrograms, CollidersAreMadeOfTheDaemonsFiles) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  std::filesystem::create_directory(folder_ / "open");
  const std::filesystem::path outside = write("outside.obj", kCube);
  write("open/a cube.obj", kCube);
  write("open/broken.obj", "v 0 0 0\nf 1 2 x\n");
  std::filesystem::create_symlink(outside, folder_ / "open" / "link.obj");
  const std::filesystem::path named = write("named.toml", R"(scene = "straight"
[body]
name = "bust"
[[body.primitives]]
name = "a stone"
radius = 0.02
follows_head = false
a = [0, 0.2, 0.9]
)");
  const std::string network = " --domain " + domain_;
  const std::vector<std::string> words{daemon_,    "--config", named.string(), "--strands",  "200",
                                       "--domain", domain_,    "--quiet",      "--duration", "120"};
  std::vector<std::string> opens = words;
  opens.insert(opens.end(), {"--collider-folder", "open"});
  const pid_t daemon = start(opens, "daemon.txt");
  ASSERT_EQ(run(program_ + " ctl wind 0 0 0 --timeout 60" + network).exit_code, 0);
  const std::string collider = program_ + " ctl collider ", add = collider + "add ";
  const Outcome convex = run(add + "box convex 'a cube.obj' --at 0 0.1 0.6" + network);
  EXPECT_EQ(convex.exit_code, 0) << convex.err;
  const Outcome mesh =
      run(add + "'a mesh' mesh 'a cube.obj' --at -.2 0.1 0.75 90 --cell 0.004 --timeout 60" + network);
  EXPECT_EQ(mesh.exit_code, 0) << mesh.err;
  EXPECT_EQ(run(add + "hat convex 'a cube.obj' --at 0 0.5 0 --head --unit-meters 0.5" + network).exit_code,
            0);
  EXPECT_EQ(run(collider + "move box 0 0.2 0.6 --seconds 0" + network).exit_code, 0);
  EXPECT_EQ(run(collider + "move 'a stone' 0 0.3 0.9 --seconds 0" + network).exit_code, 0);
  nlohmann::json listed;
  const auto list = [&] {
    listed = nlohmann::json::parse(run(collider + "list --json" + network).out)["colliders"];
    return listed.size();
  };
  ASSERT_EQ(list(), 6u) << listed;
  for (const size_t part : {0, 1}) EXPECT_EQ(listed[part]["name"], "bust");
  EXPECT_EQ(listed[2]["name"], "a stone");
  EXPECT_EQ(listed[2]["position"], nlohmann::json::parse("[0.0, 0.3, 0.9]"));
  EXPECT_EQ(listed[3]["name"], "box");
  EXPECT_EQ(listed[3]["shapes"], nlohmann::json::parse("[\"convex\"]"));
  EXPECT_EQ(listed[3]["position"], nlohmann::json::parse("[0.0, 0.2, 0.6]"));
  EXPECT_EQ(listed[4]["name"], "a mesh");
  EXPECT_EQ(listed[4]["shapes"], nlohmann::json::parse("[\"mesh\"]"));
  EXPECT_EQ(listed[4]["position"], nlohmann::json::parse("[-0.2, 0.1, 0.75]"));
  EXPECT_EQ(listed[5]["follows_head"], true);
  const auto refusal = [&](const std::string& what) {
    const Outcome r = run(what + network);
    EXPECT_EQ(r.exit_code, 2) << what;
    return r.err;
  };
  const std::pair<std::string, const char*> bad[] = {{"box mesh 'a cube.obj'", "unique name"},
                                                     {"bust sphere 0 0 0 1", "unique name"},
                                                     {"x mesh ../outside.obj", "no name within"},
                                                     {"x convex " + outside.string(), "no name within"},
                                                     {"x convex link.obj", "link out of"},
                                                     {"x mesh absent.obj", "is not in"},
                                                     {"x mesh broken.obj", "line 2"},
                                                     {"x mesh", "VALUE is required"},
                                                     {"x mesh a b", "one file"},
                                                     {"x convex 'a cube.obj' --cell 0.1", "has cells"},
                                                     {"x mesh 'a cube.obj' --at 2000 0 0", "within 1000"},
                                                     {"x sphere 0 0 0 1 --at 0 0 0", "--at"}};
  for (const auto& [what, told] : bad) {
    const std::string err = refusal(add + what);
    EXPECT_NE(err.find(told), std::string::npos) << what << "\n" << err;
  }
  // The daemon casts during a bake and can end during it.
  const pid_t waits = start({program_, "ctl", "collider", "add", "slow", "mesh", "a cube.obj", "--cell",
                             "0.0001", "--timeout", "60", "--domain", domain_},
                            "slow.txt");
  for (int i = 0; i < 100 && refusal(add + "slow mesh absent.obj").find("is being made") == std::string::npos;
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto frames = [&] {
    return nlohmann::json::parse(run(program_ + " ctl status --json" + network).out)["frames"]
        .get<uint64_t>();
  };
  const uint64_t before = frames();
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_GT(frames(), before + 10);
  EXPECT_TRUE(isRunning(waits));
  EXPECT_EQ(list(), 6u);
  EXPECT_EQ(run(collider + "remove box" + network).exit_code, 0);
  EXPECT_EQ(run(collider + "remove 'a stone'" + network).exit_code, 0);
  EXPECT_EQ(run(collider + "remove 'a mesh'" + network).exit_code, 0);
  EXPECT_EQ(list(), 3u) << listed;
  interrupt(daemon);
  EXPECT_EQ(wait(daemon), 130);
  EXPECT_EQ(wait(waits), 2);

  const pid_t closed = start(words, "daemon.txt");
  ASSERT_EQ(run(program_ + " ctl wind 0 0 0 --timeout 60" + network).exit_code, 0);
  EXPECT_NE(refusal(add + "x mesh 'a cube.obj'").find("--collider-folder DIR"), std::string::npos);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(closed), 0);
}

TEST_F(CastingPrograms, StepsWaitForThoseThatOthersAskedFor) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::string network = " --domain " + domain_;
  const pid_t daemon = start({daemon_, "--scene", "wavy", "--strands", "300", "--backend", "simd",
                              "--threads", "1", "--set", "substeps=32", "--domain", domain_, "--quiet"},
                             "daemon.txt");
  ASSERT_EQ(run(program_ + " ctl pause --timeout 60" + network).exit_code, 0);
  const pid_t others = start({program_, "ctl", "step", "150", "--domain", domain_}, "others.txt");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const Outcome own = run(program_ + " ctl step 1 --timeout 1" + network);
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(wait(others), 0);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(daemon), 0);
}

TEST_F(CastingPrograms, AnInterruptWhileADaemonListensForOthersEndsItAtOnce) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::filesystem::path take = write("take.rec", "an old take");
  // Listening for conflicting daemons takes longest with a discovery server.
  const std::string line = "exec " + daemon_ +
                           " --scene straight --strands 20 --body-contact spheres --backend reference" +
                           " --domain " + domain_ + " --discovery-server 127.0.0.1:1 --claim 1 --record " +
                           take.string() + " 2>&1";
  const pid_t daemon = start({"sh", "-c", line}, "daemon.txt");
  const auto has_said = [&] {
    return contents(folder_ / "daemon.txt").find("listening for up to") != std::string::npos;
  };
  for (int i = 0; i < 600 && !has_said() && isRunning(daemon); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(has_said()) << contents(folder_ / "daemon.txt");
  interrupt(daemon);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(wait(daemon), 130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3)) << "it would listen for 6 s";
  EXPECT_EQ(contents(take), "an old take");
}

TEST_F(CastingPrograms, CtlWaitsNoLongerThanItIsToldTo) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const auto seconds = [&](const std::string& command, int exit_code) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome r = run(command);
    EXPECT_EQ(r.exit_code, exit_code) << command << "\n" << r.out << r.err;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const std::string ctl = program_ + " ctl wind 1 0 0 --domain " + domain_;
  EXPECT_LT(seconds(ctl + " --timeout 0.1", 2), 1.5);
  for (const char* verb : {"wind 1 0 0", "status", "list"}) {
    const pid_t child = ProgramFixture::start(
        {"sh", "-c", "exec " + program_ + " ctl " + verb + " --domain " + domain_}, "ctl.txt");
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    interrupt(child);
    EXPECT_EQ(wait(child), 130) << verb;
    EXPECT_EQ(contents(folder_ / "ctl.txt"), "") << verb;
  }
}

TEST_F(CastingPrograms, DaemonCastsOverLcm) {
  const std::string network = " --transport lcm --domain " + domain_;
  const pid_t daemon = start({daemon_, "--scene", "straight", "--strands", "200", "--transport", "lcm",
                              "--domain", domain_, "--codec", "oct12", "--quiet", "--duration", "120"},
                             "daemon.txt");
  const Outcome wind = run(program_ + " ctl wind 1 0 0 --timeout 60" + network);
  if (wind.err.find("LCM cannot") != std::string::npos || wind.err.find("LCM is not") != std::string::npos) {
    kill(daemon, SIGKILL);
    GTEST_SKIP() << wind.err;
  }
  ASSERT_EQ(wind.exit_code, 0) << wind.err;
  nlohmann::json status;
  for (int i = 0; i < 100 && (i == 0 || status["bytes_per_frame"] == 0);
       ++i) {  // the first status has no frame yet
    const Outcome r = run(program_ + " ctl status --json --timeout 60" + network);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    status = nlohmann::json::parse(r.out);
  }
  EXPECT_EQ(status["codec"], "oct12");
  EXPECT_EQ(status["parameters"]["wind"], (std::vector<double>{1, 0, 0}));
  EXPECT_GT(status["bytes_per_vertex"], 1);
  EXPECT_LT(status["bytes_per_vertex"], 5);
  EXPECT_LE(status["codec_worst_error_mm"], 0.0100001);
  EXPECT_EQ(run(program_ + " ctl stop --timeout 60" + network).exit_code, 0);
  EXPECT_EQ(wait(daemon), 0);

  const Outcome refused = run(daemon_ + " --scene straight --strands 20 --quiet --codec temporal" + network);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("loses nothing"), std::string::npos) << refused.err;
}

TEST_F(CastingPrograms, OfTwoDaemonsStartedAtOnceOneCasts) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::vector<std::string> words{daemon_,    "--scene", "straight", "--strands",  "20",
                                       "--domain", domain_,   "--quiet",  "--duration", "120"};
  const pid_t daemons[] = {start(words, "one.txt"), start(words, "two.txt")};
  const std::string network = " --domain " + domain_;
  ASSERT_EQ(run(program_ + " ctl wind 1 0 0 --timeout 60" + network).exit_code, 0);
  const size_t who_casts = isRunning(daemons[0]) ? 0 : 1;
  EXPECT_FALSE(isRunning(daemons[1 - who_casts]));
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(daemons[who_casts]), 0);
  EXPECT_EQ(wait(daemons[1 - who_casts]), 2);
}

TEST_F(CastingPrograms, InterruptEndsTheDaemonCleanly) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const pid_t child =
      start({daemon_, "--scene", "straight", "--strands", "50", "--domain", domain_, "--json", "--quiet"},
            "daemon.json");
  ASSERT_EQ(run(program_ + " ctl wind 1 0 0 --timeout 60 --domain " + domain_).exit_code, 0);
  interrupt(child);
  EXPECT_EQ(wait(child), 130);
  EXPECT_TRUE(nlohmann::json::accept(contents(folder_ / "daemon.json")));
}

}  // namespace
}  // namespace strandcast
