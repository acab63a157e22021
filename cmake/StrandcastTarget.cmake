# strandcast_library(NAME SOURCES ... LINK ... [PRIVATE_LINK ...]): one library per folder, includes from the project's root.
function(strandcast_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(strandcast_${name} STATIC ${ARG_SOURCES})
  target_include_directories(strandcast_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(strandcast_${name} PUBLIC ${ARG_LINK} PRIVATE strandcast_options ${ARG_PRIVATE_LINK})
endfunction()

# strandcast_test(NAME SOURCES ... LINK ... [TIMEOUT s] [LABELS ...]): a GoogleTest program, found by ctest under its name.
# The label "threads" marks what the thread sanitizer is run on; the target thread_tests builds all of those. The target
# quick_tests builds, for the other sanitizers, all that are not labelled slow, gl (needs OpenGL) or programs.
function(strandcast_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE strandcast_options ${ARG_LINK} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    STRANDCAST_SOURCE_DIR="${PROJECT_SOURCE_DIR}" STRANDCAST_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
  foreach(group thread_tests quick_tests)
    if(NOT TARGET ${group})
      add_custom_target(${group})
    endif()
  endforeach()
  if("threads" IN_LIST ARG_LABELS)
    add_dependencies(thread_tests ${name})
  endif()
  if(NOT "slow" IN_LIST ARG_LABELS AND NOT "gl" IN_LIST ARG_LABELS AND NOT "programs" IN_LIST ARG_LABELS)
    add_dependencies(quick_tests ${name})
  endif()
endfunction()

# strandcast_fuzzer(NAME SOURCES ... LINK ...): a libFuzzer program with the fuzz preset. tests/ runs the same entry
# point over damaged files in every preset.
function(strandcast_fuzzer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(STRANDCAST_FUZZ)
    add_executable(${name} ${ARG_SOURCES})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} PRIVATE strandcast_options ${ARG_LINK})
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  endif()
endfunction()
