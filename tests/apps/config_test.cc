#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "options/settings.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

std::string configErrorOf(const std::string& text) {
  Settings settings;
  return errorOf([&] { readConfigText(text, "hair.toml", settings); });
}

constexpr const char* kFull = R"(
scene = "curly"
motion = "nod+turn"
seed = 7
[groom]
files = ["a.tfx", "b.tfx"]
unit_meters = 0.0025
up = "z"
strands = 500
vertices = 16
[body]
file = "head.obj"
unit_meters = 0.1
up = "x"
clip_unit_meters = 0.01
contact = "spheres"
cell = 0.003
friction = 0.1
clip = "Walk.BVH"
joint = "Head"
roots = "joint"
name = "the bust"
fitted_spheres = 12
[[body.primitives]]
kind = "capsule"
a = [0, 1, 0]
b = [0, 2, 0]
radius = 0.1
friction = 0.5
[[body.primitives]]
kind = "ellipsoid"
extent = [0.1, 0.2, 0.1]
rotation = [0, 0, 2, 0]
[[body.primitives]]
kind = "mesh"
file = "chair.obj"
unit_meters = 0.5
up = "z"
a = [0, 0, -1]
cell = 0.005
follows_head = false
[[body.primitives]]
kind = "convex"
file = "hat.obj"
[[material]]
youngs_modulus = 3e9
[[material]]
parts = ["a", 1]
shear_modulus = 1.2e9
radius_curve = [[0, 1], [1, 0.4]]
stiffness_curve = 0.5
density_curve = [[0, 1], [1, 3]]
damping_curve = [[0, 2], [1, 0]]
friction_curve = 0.25
[[pin]]
part = "a"
bone = "ribbon"
from = 0.5
to = 0.6
[[wind]]
kind = "turbine"
position = [0, 1.5, 0.5]
direction = [0, 0, -1]
radius = 0.25
angle = 30
swirl = 2
[daemon]
backend = "reference"
threads = 2
rate = 120
duration = 10
collider_folder = "props"
[transport]
kind = "dds"
profile = "secure"
keys = "daemon_keys"
peers = ["192.0.2.1", "192.0.2.2"]
discovery_server = "192.0.2.3:11811"
domain = 3
groom_id = 9
codec = "temporal"
codec_error_mm = 0.05
key_interval = 20
[parameters]
wind = [1, 0, -2.5]
substeps = 8
)";

TEST(Config, ReadsEveryKey) {
  Settings s;
  readConfigText(kFull, "some/hair.toml", s);
  EXPECT_EQ(s.scene.name, "curly");
  EXPECT_EQ(s.scene.motion, "nod+turn");
  EXPECT_EQ(s.profile, "secure");
  EXPECT_EQ(s.keys, "some/daemon_keys");
  EXPECT_EQ(s.peers, (std::vector<std::string>{"192.0.2.1", "192.0.2.2"}));
  EXPECT_EQ(s.discovery_server, "192.0.2.3:11811");
  EXPECT_EQ(s.scene.seed, 7u);
  ASSERT_EQ(s.scene.groom.size(), 2u);
  EXPECT_EQ(s.scene.groom[1], "some/b.tfx") << "paths are relative to the file that names them";
  EXPECT_FLOAT_EQ(s.scene.units.unit_meters, 0.0025f);
  EXPECT_EQ(s.scene.units.up, UpAxis::kZ);
  EXPECT_EQ(s.scene.strands, 500);
  EXPECT_EQ(s.scene.vertices, 16);
  EXPECT_EQ(s.scene.body, "some/head.obj");
  EXPECT_FLOAT_EQ(s.scene.body_units.unit_meters, 0.1f);
  EXPECT_EQ(s.scene.body_units.up, UpAxis::kX);
  EXPECT_FLOAT_EQ(s.scene.clip_unit_meters, 0.01f);
  EXPECT_EQ(s.scene.body_primitives, 12);
  EXPECT_EQ(s.scene.body_contact, BodyContact::kSpheres);
  EXPECT_FLOAT_EQ(s.scene.body_cell, 0.003f);
  ASSERT_TRUE(s.scene.skinned);
  EXPECT_EQ(s.scene.skinned->clip, "some/Walk.BVH");
  EXPECT_EQ(s.scene.skinned->joint, "Head");
  EXPECT_EQ(s.scene.skinned->roots, BodyRoots::kJoint);
  EXPECT_EQ(s.scene.body_name, "the bust");
  EXPECT_FLOAT_EQ(s.scene.body_friction, 0.1f);
  ASSERT_EQ(s.scene.primitives.size(), 4u);
  const ScenePrimitive &capsule = s.scene.primitives[0], &ellipsoid = s.scene.primitives[1];
  EXPECT_EQ(ellipsoid.shape.kind, PrimitiveKind::kEllipsoid);
  EXPECT_FLOAT_EQ(ellipsoid.shape.extent.y(), 0.2f);
  EXPECT_FLOAT_EQ(ellipsoid.shape.rotation.z(), 1) << "made of unit length";
  EXPECT_FLOAT_EQ(ellipsoid.shape.friction, 0.3f);
  EXPECT_EQ(capsule.shape.kind, PrimitiveKind::kCapsule);
  EXPECT_FLOAT_EQ(capsule.shape.b.y(), 2);
  EXPECT_FLOAT_EQ(capsule.shape.friction, 0.5f);
  EXPECT_TRUE(capsule.follows_head);
  const ScenePrimitive& mesh = s.scene.primitives[2];
  EXPECT_EQ(mesh.shape.kind, PrimitiveKind::kField);
  EXPECT_EQ(mesh.file, "some/chair.obj") << "relative to the file that names it";
  EXPECT_FLOAT_EQ(mesh.shape.a.z(), -1);
  EXPECT_FLOAT_EQ(mesh.units.unit_meters, 0.5f);
  EXPECT_EQ(mesh.units.up, UpAxis::kZ);
  EXPECT_FLOAT_EQ(mesh.cell, 0.005f);
  EXPECT_FALSE(mesh.follows_head);
  EXPECT_EQ(mesh.where, "some/hair.toml line 34");
  EXPECT_EQ(s.scene.primitives[3].shape.kind, PrimitiveKind::kConvex);
  EXPECT_EQ(s.scene.primitives[3].file, "some/hat.obj");
  ASSERT_EQ(s.scene.materials.size(), 2u);
  EXPECT_EQ(s.scene.materials[1].parts, (std::vector<std::string>{"a", "1"}));
  const std::vector<Material> materials = partMaterials(s.scene.materials, {"a", "b", "c"});
  EXPECT_FLOAT_EQ(materials[2].youngs_modulus, 3e9f);
  EXPECT_FLOAT_EQ(materials[1].poisson_ratio, 0.25f);
  EXPECT_FLOAT_EQ(materials[0].radius_scale.at(0.5f), 0.7f);
  EXPECT_FLOAT_EQ(materials[0].stiffness_scale.at(0.5f), 0.5f);
  EXPECT_FLOAT_EQ(materials[0].density_scale.at(0.5f), 2);
  EXPECT_FLOAT_EQ(materials[0].damping_curve.at(0.25f), 1.5f);
  EXPECT_FLOAT_EQ(materials[0].friction_curve.at(0.25f), 0.25f);
  ASSERT_EQ(s.scene.pins.size(), 1u);
  EXPECT_EQ(s.scene.pins[0].parts, std::vector<std::string>{"a"});
  EXPECT_EQ(s.scene.pins[0].bone, "ribbon");
  EXPECT_FLOAT_EQ(s.scene.pins[0].from, 0.5f);
  EXPECT_FLOAT_EQ(s.scene.pins[0].to, 0.6f);
  EXPECT_EQ(s.backend, "reference");
  EXPECT_EQ(s.threads, 2);
  EXPECT_DOUBLE_EQ(s.rate, 120);
  EXPECT_DOUBLE_EQ(s.duration, 10);
  EXPECT_EQ(s.collider_folder, "some/props");
  EXPECT_EQ(s.domain, 3);
  EXPECT_EQ(s.groom_id, 9u);
  EXPECT_EQ(s.codec.codec, Codec::kTemporal);
  EXPECT_FLOAT_EQ(s.codec.max_error, 5e-5f);
  EXPECT_EQ(s.codec.key_interval, 20u);
  ASSERT_EQ(s.parameters.size(), 2u);
}

TEST(Config, APrimitiveHasAJointOrANameOrBoth) {
  const std::string ball = "[[body.primitives]]\nradius = 0.1\n";
  Settings settings;
  readConfigText(ball + "joint = \"LeftHand\"\nname = \"a ring\"\n" + ball, "hair.toml", settings);
  ASSERT_EQ(settings.scene.primitives.size(), 2u);
  EXPECT_EQ(settings.scene.primitives[0].joint, "LeftHand");
  EXPECT_EQ(settings.scene.primitives[0].name, "a ring");
  EXPECT_EQ(settings.scene.primitives[1].joint, "");
  EXPECT_EQ(settings.scene.primitives[1].name, "");
  EXPECT_EQ(configErrorOf(ball + "joint = \"\""),
            "a joint has no name: hair.toml line 3; name one, or leave it out");
  EXPECT_EQ(configErrorOf(ball + "joint = \"LeftHand\"\nfollows_head = false"),
            "a primitive with a joint always follows that joint: hair.toml line 4; leave out follows_head or "
            "joint");
  for (const std::string& name : {std::string(), std::string("a\\nb"), std::string(256, 'n')})
    EXPECT_NE(configErrorOf(ball + "name = \"" + name + "\"").find("hair.toml line 3; give 1 to 255 bytes"),
              std::string::npos)
        << name;
}

TEST(Config, SourcesOfWindAreReadAndChecked) {
  Settings settings;
  readConfigText(kFull, "hair.toml", settings);
  ASSERT_EQ(settings.wind_sources.size(), 1u);
  EXPECT_EQ(settings.wind_sources[0].name, "wind1");
  const WindSource& source = settings.wind_sources[0].source;
  EXPECT_EQ(source.kind, WindSource::Kind::kTurbine);
  EXPECT_EQ(source.position, Vec3(0, 1.5f, 0.5f));
  EXPECT_NEAR(source.angle, 0.5236, 1e-4);
  EXPECT_EQ(source.swirl, 2);
  EXPECT_NE(configErrorOf("[[wind]]\nkind = \"storm\"").find("cone, sphere, turbine"), std::string::npos);
  EXPECT_NE(configErrorOf("[[wind]]\ndirection = [0, 0, 0]").find("hair.toml line 1"), std::string::npos);
  EXPECT_NE(configErrorOf("[[wind]]\nspeed = 1e9").find("wind.speed"), std::string::npos);
  EXPECT_NE(configErrorOf("[[wind]]\nname = \"a fan\"").find("without spaces"), std::string::npos);
  EXPECT_NE(configErrorOf("[[wind]]\nname = \"wind2\"\n[[wind]]").find("two sources"), std::string::npos);
}

TEST(Config, UnknownKeysAreRefusedWithTheirLine) {
  EXPECT_NE(configErrorOf("seed = 1\ncolour = 3\n").find("hair.toml line 2"), std::string::npos);
  EXPECT_NE(configErrorOf("[groom]\nfile = \"a.tfx\"\n").find("'groom.file'"), std::string::npos);
  const std::string typo = configErrorOf("[parameters]\nair_darg = 1\n");
  EXPECT_NE(typo.find("air_drag"), std::string::npos) << typo;
  EXPECT_NE(typo.find("line 2"), std::string::npos) << typo;
  EXPECT_EQ(configErrorOf("[[material]]\npart = 0\nraduis = 1e-5\n"),
            "unknown material setting 'raduis': hair.toml line 3; did you mean 'radius'?");
  EXPECT_EQ(configErrorOf("[[material]]\nradius = 1\n"),
            "'radius' = 1 is out of range: hair.toml line 2; give 1e-06 to 0.005 m");
}

TEST(Config, WrongTypesAndRangesAreRefused) {
  for (const char* text : {"seed = \"one\"",
                           "scene = 3",
                           "groom = 3",
                           "[groom]\nfiles = [1]",
                           "[groom]\nunit_meters = 0",
                           "[groom]\nup = \"w\"",
                           "[daemon]\nrate = -1",
                           "[daemon]\nrate = nan",
                           "[transport]\ndomain = 233",
                           "[transport]\nprofile = \"fastest\"",
                           "[parameters]\nwind = 3",
                           "[parameters]\nsubsteps = 2.5",
                           "[parameters]\nsubsteps = 0",
                           "[[body.primitives]]\nkind = \"torus\"",
                           "[[body.primitives]]\nkind = \"box\"",
                           "[[body.primitives]]\nkind = \"sphere\"\na = [0, 1, 0]",
                           "[[body.primitives]]\nkind = \"capsule\"\nradius = 0",
                           "[[body.primitives]]\nkind = \"tapered_capsule\"",
                           "[[body.primitives]]\nkind = \"ellipsoid\"\nradius = 1",
                           "[[body.primitives]]\nradius = 1\nfriction = -0.1",
                           "[[body.primitives]]\nradius = 1\nfollows_head = 1",
                           "[[body.primitives]]\nradius = 1\nfile = \"a.obj\"",
                           "[[body.primitives]]\nradius = 1\ncell = 0.01",
                           "[[body.primitives]]\nradius = 1\nunit_meters = 0.01",
                           "[[body.primitives]]\nradius = 1\nup = \"z\"",
                           "[body]\nunit_meters = 0",
                           "[body]\nup = \"w\"",
                           "[body]\nclip_unit_meters = -1",
                           "[[body.primitives]]\nkind = \"convex\"",
                           "[[body.primitives]]\nkind = \"convex\"\nfile = \"a.obj\"\ncell = 0.01",
                           "[[body.primitives]]\nkind = \"mesh\"\nfile = \"\"",
                           "[body]\nfriction = -1",
                           "[[body.primitives]]\nkind = \"box\"\nextent = [1, 1, 1]\nrotation = [0, 0, 0, 0]",
                           "seed = 1.5",
                           "motion = \"\"",
                           "[groom]\nfiles = []",
                           "[groom]\nstrands = 10.5",
                           "[daemon]\nthreads = 1.7",
                           "[transport]\ngroom_id = 1.5",
                           "[transport]\npeers = []",
                           "[body]\ncontact = \"cage\"",
                           "[[body.primitives]]\nkind = \"plane\"\nb = [0, 0, 0]",
                           "[parameters]\ngravity = [0, inf, 0]",
                           "[parameters]\ngravity = [[0, -9], 0]",
                           "material = 1",
                           "[material]\nradius = 1e-5",
                           "[[material]]\npart = 1.5",
                           "[[pin]]\nfrom = -0.1",
                           "[[pin]]\nfrom = 0.5\nto = 0.4",
                           "[[pin]]\nbones = 1",
                           "[[material]]\nparts = []",
                           "[[material]]\nradius_curve = [[0, 1, 2]]",
                           "[[material]]\nradius_curve = [[1, 1], [0, 1]]",
                           "[[material]]\nradius_curve = [[0, 1], [0, 2]]",
                           "[[material]]\npoisson_ratio = 0.3\nshear_modulus = 2e9",
                           "[daemon]\ncollider_folder = \"\"",
                           "a = [",
                           "= 3",
                           "[groom",
                           "seed = 1\nseed = 2"}) {
    const std::string error = configErrorOf(text);
    EXPECT_NE(error.find("hair.toml"), std::string::npos) << text << ": " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << "one line: " << error;
  }
  EXPECT_EQ(configErrorOf("[transport]\ngroom_id = 1.5"),
            "'transport.groom_id': 1.5 is not a whole number from 1 to 4294967295: hair.toml line 2");
  EXPECT_EQ(configErrorOf("seed = 7.0"), "") << "it is whole";
}

TEST(Config, OtherThanAsciiIsForStringsAndComments) {
  Settings settings;
  readConfigText(
      "\xef\xbb\xbf# gr\xc3\xbc\xc3\x9f\n[groom]\nfiles = [\"M\xc3\xbcller\\\" 1.tfx\", '\xc3\xa4']\n",
      "hair.toml", settings);
  ASSERT_EQ(settings.scene.groom.size(), 2u);
  EXPECT_EQ(settings.scene.groom[1], "\xc3\xa4");
  readConfigText("[body]\nfile = \"\"\"\n\"\xc3\xa4\"\"\"\"  # \xc3\xa4\n", "hair.toml", settings);
  readConfigText("motion = \"\"\"\\\n\xc3\xa4\"\"\"\n", "hair.toml", settings);
  EXPECT_EQ(settings.scene.motion, "\xc3\xa4");
  // Found by libFuzzer: each triggered undefined behaviour in toml++.
  for (const char* text :
       {"\nseed = [1\xc3\xa4]", "\nseed = 1 \xe2\x80\x83", "\n\xc3\xa4 = 1", "\nfiles = M\xc3\xbcller",
        "\nseed = --!-'\xef\xbb\x9f'", "\nseed = 1..\"\"\"\xef\xb9\xbf\"\"\"",
        "\n\"\"\"\xef\xb9\xbf\"\"\" = 1", "\n\"\"\"\\\xef\xb9\xbf\"\"\" = 1"}) {
    EXPECT_NE(configErrorOf(text).find("not valid TOML"), std::string::npos)
        << text << ": " << configErrorOf(text);
    EXPECT_NE(configErrorOf(text).find("hair.toml line 2"), std::string::npos)
        << text << ": " << configErrorOf(text);
  }
}

TEST(Config, KeysOfVeryManyPartsAreRefused) {
  const auto parts = [](int n, const std::string& part) {
    std::string key = part;
    for (int i = 1; i < n; ++i) key += " ." + part;
    return key;
  };
  // The first of these overflowed the stack.
  for (const std::string& text : {parts(100000, "a") + "=1", "[" + parts(65, "a") + "]",
                                  "[[" + parts(65, "'a'") + "]]", "a = {" + parts(65, "\"a\"") + " = 1}"})
    EXPECT_NE(configErrorOf("\n" + text).find("more than 64 parts: hair.toml line 2"), std::string::npos)
        << text;
  EXPECT_EQ(configErrorOf("[" + parts(64, "a") + "]").find("parts"), std::string::npos);
  EXPECT_EQ(configErrorOf("motion = \"" + parts(100, "a") + "\"  # " + parts(100, "a")), "");
  EXPECT_EQ(configErrorOf("[parameters]\nwind = [" + parts(1, "1.5") + ", 0.0, 1.5]"), "");
}

constexpr const char* kCast = R"(
scene = "curly"
seed = 7
[daemon]
rate = 30
[[material]]
radius = 4e-5
[parameters]
wind = [1, 0, 0]
substeps = 8
[[character]]
groom_id = 4
[[character]]
name = "ada"
groom_id = 2
seed = 8
budget_ms = 3
record = "ada.rec"
[character.daemon]
rate = 90
[[character.material]]
density = 1300
[character.parameters]
substeps = 6
[character.transport]
domain = 5
)";

TEST(Characters, HaveTheSettingsOfTheFileAndTheirOwnOverThem) {
  const std::vector<CharacterSettings> cast = readCharactersText(kCast, "some/cast.toml");
  ASSERT_EQ(cast.size(), 2u);
  const CharacterSettings &first = cast[0], &ada = cast[1];
  EXPECT_EQ(first.label(), "groom 4");
  EXPECT_EQ(first.settings.groom_id, 4u);
  EXPECT_EQ(first.settings.scene.seed, 7u);
  EXPECT_EQ(first.settings.rate, 30);
  EXPECT_EQ(first.budget_ms, 0);
  EXPECT_TRUE(first.record.empty());
  ASSERT_EQ(first.settings.scene.materials.size(), 1u);
  EXPECT_EQ(first.settings.scene.materials[0].settings[0].name, "radius");
  EXPECT_EQ(ada.label(), "ada");
  EXPECT_EQ(ada.settings.groom_id, 2u);
  EXPECT_EQ(ada.settings.scene.name, "curly");
  EXPECT_EQ(ada.settings.scene.seed, 8u);
  EXPECT_EQ(ada.settings.rate, 90);
  EXPECT_EQ(ada.settings.domain, 5);
  EXPECT_EQ(ada.budget_ms, 3);
  EXPECT_EQ(ada.record, "some/ada.rec");
  ASSERT_EQ(ada.settings.scene.materials.size(), 1u) << "a repeated table replaces the file's";
  EXPECT_EQ(ada.settings.scene.materials[0].settings[0].name, "density");
  EXPECT_EQ(ada.settings.parameters.back().second, std::vector<double>{6}) << "the last one counts";
  EXPECT_EQ(ada.settings.given.at("daemon.rate"), "some/cast.toml line 20");
  EXPECT_TRUE(readCharactersText(kFull, "hair.toml").empty());
}

TEST(Characters, TheExampleIsRead) {
  const std::filesystem::path file = std::filesystem::path(STRANDCAST_SOURCE_DIR) / "docs/cast.toml";
  EXPECT_EQ(readCharactersText(configText(file), file.string()).size(), 3u);
}

TEST(Characters, ErrorsNameTheCharacterAndTheKey) {
  const auto expectRefused = [](const std::string& text, const std::vector<std::string>& parts) {
    SCOPED_TRACE(text);
    expectError([&] { readCharactersText(text, "cast.toml"); }, parts);
  };
  const std::string one = "[[character]]\ngroom_id = 1\n",
                    ada = "[[character]]\nname = \"ada\"\ngroom_id = 2\n";
  expectRefused(ada + "[character.groom]\nstrand = 3\n",
                {"character ada: unknown key 'character.groom.strand': cast.toml line 5", "strands"});
  expectRefused(one + "[character.daemon]\nrate = 0\n",
                {"character groom 1: 'character.daemon.rate': 0 is not", "cast.toml line 4"});
  expectRefused(ada + "colour = 3\n",
                {"character ada: unknown key 'character.colour'", "budget_ms", "record"});
  expectRefused(ada + "[character.transport]\ngroom_id = 3\n",
                {"character ada", "its own groom_id", "line 5"});
  expectRefused("[transport]\ngroom_id = 3\n" + ada, {"its own groom_id: cast.toml line 2"});
  expectRefused("[[character]]\nname = \"ada\"\n", {"has no groom_id: cast.toml line 1"});
  expectRefused(one + "[[character]]\ngroom_id = 1\n", {"the groom_id 1: cast.toml line 4"});
  expectRefused(ada + "[[character]]\nname = \"ada\"\ngroom_id = 3\n",
                {"two characters are called 'ada'", "line 5"});
  expectRefused(ada + "record = \"a.rec\"\n" + one + "record = \"./a.rec\"\n",
                {"record to one file", "line 7"});
  expectRefused(ada + "budget_ms = 0\n", {"'character.budget_ms': 0 is not", "line 4"});
  expectRefused(ada + "record = \"\"\n", {"no name", "line 4"});
  expectRefused("character = 3\n", {"'character' has a wrong value", "[[character]]"});
  expectRefused("character = []\n", {"'character' has a wrong value", "[[character]]"});
  expectRefused(ada + "[[character.character]]\n", {"character ada: unknown key 'character.character'"});
  expectRefused("speed = 3\n" + ada, {"unknown key 'speed': cast.toml line 1"});
  EXPECT_NE(configErrorOf(ada).find("by strandcastd alone: hair.toml line 1"), std::string::npos);
}

TEST(Config, AFileThatCannotBeReadSaysSo) {
  Settings settings;
  EXPECT_THROW(readConfig("no/such/file.toml", settings), Error);
  EXPECT_THROW(readConfig("/", settings), Error);
}

TEST(Config, DamagedTextNeverDoesWorseThanAnError) {
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    std::string text = kFull;
    for (int hits = 1 + static_cast<int>(random() % 4); hits > 0; --hits)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    if (random() % 4 == 0) text.resize(random() % text.size());
    Settings settings;
    try {
      readConfigText(text, "hair.toml", settings);
    } catch (const Error&) {
    }
  }
  for (int round = 0; round < 1000; ++round) {
    std::string text = kCast;
    for (int hits = 1 + static_cast<int>(random() % 4); hits > 0; --hits)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    try {
      readCharactersText(text, "cast.toml");
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace strandcast
