# strandcast_embed_shaders(TARGET HEADER SHADER...): generates HEADER (included as "<folder>/<HEADER>") with one string
# constant per shader. #include "..." lines of shaders are replaced by the files, relative to the project's root, so that
# there is no shader search at run time. If glslangValidator is installed, a test validates each shader. The line
# `// variants: A=1 B=2 | A=2` of a shader lists the sets of #defines with which it is validated.
function(strandcast_embed_shaders target header)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  file(GLOB kernels CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/kernels/*.h ${PROJECT_SOURCE_DIR}/core/*.glsl ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*)
  add_custom_command(
    OUTPUT ${out}/${folder}/${header}
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUT=${out}/${folder}/${header} "-DSHADERS=${ARGN}"
            -DFOLDER=${CMAKE_CURRENT_SOURCE_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/EmbedShadersScript.cmake
    DEPENDS ${kernels} ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/EmbedShadersScript.cmake
    VERBATIM)
  target_sources(${target} PRIVATE ${out}/${folder}/${header})
  target_include_directories(${target} PRIVATE ${out})
  if(GLSLANG_VALIDATOR)
    foreach(shader ${ARGN})
      get_filename_component(name ${shader} NAME)
      add_test(NAME glsl_${folder}_${name}
        COMMAND ${CMAKE_COMMAND} -DVALIDATOR=${GLSLANG_VALIDATOR} -DSHADER=${out}/${folder}/${name}
                -P ${PROJECT_SOURCE_DIR}/cmake/ValidateShader.cmake)
      set_tests_properties(glsl_${folder}_${name} PROPERTIES LABELS gl)
    endforeach()
  endif()
endfunction()
