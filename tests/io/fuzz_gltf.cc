#include "tests/io/gltf_builder.h"
#include "tests/io/reader_checks.h"
#include "tests/io/sample_files.h"
#include "tests/io/skinned_arm.h"

// Run as: fuzz_gltf FOLDER. The folder, which may be empty at first, receives the seeds and the findings.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace strandcast::samples;
  ArmOptions swelling = smallArm();
  swelling.bulge = 0.05f;
  swelling.bulge_at_rest = 0.5f;
  strandcast::writeFuzzSeeds(*argc, *argv,
                             {glb(), gltf(), armGlb(smallArm()), armGltf(smallArm()), armGltf(swelling),
                              armGlb(swelling), gltfOfAllKinds()});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  strandcast::checkGltfReader(std::as_bytes(std::span(data, size)));
  strandcast::checkGltfSkinReader(std::as_bytes(std::span(data, size)));
  return 0;
}
