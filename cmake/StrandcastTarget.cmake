# Programs and tests are compiled with -Og to save compile time: time-critical loops are in libraries. Not under the thread
# sanitizer, whose two tests then run longer than they compile.
if(NOT STRANDCAST_SANITIZE STREQUAL "thread")
  set(STRANDCAST_PROGRAM_OPTIONS $<$<NOT:$<CONFIG:Debug>>:-Og>)
endif()

# strandcast_precompile(GROUP [HEADERS ...] [LINK ...] [OPTIONS ...]): precompiles HEADERS and the commonest headers once, for
# all targets with the same flags. The debug preset has no precompiled headers and no unity builds (which halve the compile
# time of other presets), so that it finds missing includes.
function(strandcast_precompile group)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  file(CONFIGURE OUTPUT ${group}.cc CONTENT "")
  add_library(${group} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${group}.cc)
  target_link_libraries(${group} PRIVATE strandcast_options Eigen3::Eigen ${ARG_LINK})
  target_compile_options(${group} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(${group} PRIVATE ${ARG_HEADERS} <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <atomic> <chrono>
    <cmath> <cstdint> <filesystem> <fmt/format.h> <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <optional>
    <random> <span> <string> <thread> <vector>)
endfunction()
strandcast_precompile(library_headers)
if(STRANDCAST_SANITIZE MATCHES "address")
  strandcast_precompile(number_headers OPTIONS -O1)  # see strandcast_optimize_under_asan
endif()
if(NOT STRANDCAST_CLIENT)
  strandcast_precompile(program_headers HEADERS <CLI/CLI.hpp> <nlohmann/json.hpp> OPTIONS ${STRANDCAST_PROGRAM_OPTIONS})
  strandcast_precompile(test_headers HEADERS <gtest/gtest.h> LINK GTest::gtest OPTIONS ${STRANDCAST_PROGRAM_OPTIONS})
endif()

# strandcast_highway(SOURCE ...): excludes sources from unity builds, because they include themselves once per instruction set
# (Highway's foreach_target).
function(strandcast_highway)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# The asan preset has -fexpensive-optimizations: without it GCC omits vzeroupper after AVX code, and later scalar float code
# takes up to fifteen times as long.
#
# strandcast_optimize_under_asan(TARGET): for libraries in which tests spend their time. The asan preset has -Og, which saves a quarter of
# the compile time; under the address sanitizer these libraries get -O1 instead, with headers precompiled with -O1, because GCC
# takes the level from those. They also get no use-after-scope checks: with their thousands of local numbers these take a quarter
# of the compile time, and three fifths of the run time of searches in triangle trees. Without those checks GCC 12 gives false
# maybe-uninitialized warnings.
function(strandcast_optimize_under_asan target)
  if(NOT STRANDCAST_SANITIZE MATCHES "address")
    return()
  endif()
  target_compile_options(${target} PRIVATE -O1 -fno-sanitize-address-use-after-scope -Wno-maybe-uninitialized)
  set_target_properties(${target} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM number_headers)
endfunction()

# strandcast_large_unity_batches(TARGET): unity builds of sixteen files instead of eight. Precondition: no two files define the same local
# name.
function(strandcast_large_unity_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 16)
endfunction()

# strandcast_library(NAME SOURCES ... LINK ... [PRIVATE_LINK ...] [WITH_PROGRAM_OPTIONS] [LARGE_UNITY_BATCHES]): one library per folder, with includes
# relative to the project's root. WITH_PROGRAM_OPTIONS: compiled with the options of programs. LARGE_UNITY_BATCHES: see strandcast_large_unity_batches().
# BUILD_INTERFACE keeps the root and the options out of the installed package (ClientPackage.cmake).
function(strandcast_library name)
  cmake_parse_arguments(ARG "WITH_PROGRAM_OPTIONS;LARGE_UNITY_BATCHES" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(strandcast_${name} STATIC ${ARG_SOURCES})
  target_include_directories(strandcast_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_compile_features(strandcast_${name} PUBLIC cxx_std_20)
  target_link_libraries(strandcast_${name} PUBLIC ${ARG_LINK} PRIVATE $<BUILD_INTERFACE:strandcast_options> ${ARG_PRIVATE_LINK})
  if(ARG_LARGE_UNITY_BATCHES)
    strandcast_large_unity_batches(strandcast_${name})
  endif()
  if(ARG_WITH_PROGRAM_OPTIONS)
    target_compile_options(strandcast_${name} PRIVATE ${STRANDCAST_PROGRAM_OPTIONS})
    target_precompile_headers(strandcast_${name} REUSE_FROM program_headers)
  else()
    target_precompile_headers(strandcast_${name} REUSE_FROM library_headers)
  endif()
endfunction()

include(GoogleTest)

# strandcast_test(NAME SOURCES ... LINK ... [TIMEOUT s] [LABELS ...] [ENVIRONMENT A=b ...] [FILTER pattern] [ON_NETWORK]
# [COMPILES_SHADERS cost] [RUN_SERIAL] [WHOLE]): a GoogleTest program. Each test case is one entry of ctest, NAME.SUITE.CASE.
# ctest finds the cases when it starts.
# TIMEOUT: of one entry, 120 s by default; sanitizers triple it.
# LABELS: "threads" runs under the thread sanitizer; the target thread_tests builds all of these. The target quick_tests, for the
# other sanitizers, builds all tests without the labels slow, gl (needs OpenGL), measures (benchmarks and validation), programs
# and sources (reads only the project's files). Every entry also has the label NAME.
# FILTER: a --gtest_filter; other cases do not run.
# ON_NETWORK: entries run one at a time and start first, because they mostly wait.
# WHOLE: one entry, NAME, for all cases, because their common set-up takes longer than they do. With a sanitizer every program is
# one entry: the start of its process takes longer than most cases.
# COMPILES_SHADERS, with WHOLE: llvmpipe compiles shaders of the rod for minutes. Such entries run one at a time, highest cost
# first, so that later ones find common shaders in Mesa's disk cache.
function(strandcast_test name)
  cmake_parse_arguments(ARG "ON_NETWORK;RUN_SERIAL;WHOLE" "TIMEOUT;COMPILES_SHADERS;FILTER" "SOURCES;LINK;LABELS;ENVIRONMENT" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(STRANDCAST_SANITIZE)
    math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE strandcast_options ${ARG_LINK} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    STRANDCAST_SOURCE_DIR="${PROJECT_SOURCE_DIR}" STRANDCAST_BINARY_DIR="${PROJECT_BINARY_DIR}")
  target_precompile_headers(${name} REUSE_FROM test_headers)

  set(labels ${name} ${ARG_LABELS})
  set(properties TIMEOUT ${ARG_TIMEOUT})
  if(ARG_ON_NETWORK)
    list(APPEND properties RESOURCE_LOCK network COST 1000)
  elseif(ARG_COMPILES_SHADERS)
    list(APPEND properties RESOURCE_LOCK shaders COST ${ARG_COMPILES_SHADERS})
  endif()
  if(ARG_RUN_SERIAL)
    list(APPEND properties RUN_SERIAL ON)
  endif()
  if(ARG_WHOLE OR STRANDCAST_SANITIZE)
    set(filter)
    if(ARG_FILTER)
      set(filter --gtest_filter=${ARG_FILTER})
    endif()
    add_test(NAME ${name} COMMAND ${name} ${filter} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    set_tests_properties(${name} PROPERTIES ${properties} LABELS "${labels}" ENVIRONMENT "${ARG_ENVIRONMENT}")
  else()
    gtest_discover_tests(${name}
      TEST_PREFIX ${name}.
      TEST_FILTER "${ARG_FILTER}"
      TEST_LIST cases
      WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
      DISCOVERY_MODE PRE_TEST
      DISCOVERY_TIMEOUT 60)
    # Given to gtest_discover_tests(), properties that are lists would fall apart.
    set(more ${CMAKE_CURRENT_BINARY_DIR}/${name}_properties.cmake)
    list(JOIN properties " " properties)
    file(CONFIGURE OUTPUT ${more} CONTENT "if(cases)
  set_tests_properties(\${cases} PROPERTIES ${properties} LABELS \"${labels}\" ENVIRONMENT \"${ARG_ENVIRONMENT}\")
endif()
unset(cases)
" @ONLY)
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${more})
  endif()

  foreach(group thread_tests quick_tests)
    if(NOT TARGET ${group})
      add_custom_target(${group})
    endif()
  endforeach()
  if("threads" IN_LIST ARG_LABELS)
    add_dependencies(thread_tests ${name})
  endif()
  if(NOT "${ARG_LABELS}" MATCHES "slow|gl|measures|programs|sources")
    add_dependencies(quick_tests ${name})
  endif()
endfunction()

# strandcast_fuzzer(NAME SOURCES ... LINK ...): a libFuzzer program, in the fuzz preset only. tests/ runs the same entry point
# over damaged files in every preset.
function(strandcast_fuzzer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(STRANDCAST_FUZZ)
    add_executable(${name} ${ARG_SOURCES})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} PRIVATE strandcast_options ${ARG_LINK})
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  endif()
endfunction()
