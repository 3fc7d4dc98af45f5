# One static library a room: kino_library(sensor DEPENDS kino::base PRIVATE ...) compiles every .cpp
# of the folder into kino_sensor with the alias kino::sensor. A room's dependencies are named in
# this one call and nowhere else.

# A room's sources are compiled a few together: their headers are read once, which halves the time
# of a full build. Names in anonymous namespaces must therefore differ within a room. Off in the
# preset `debug`, where a changed file is compiled alone, and its includes are checked.
option(KINO_UNITY "Compile the sources of a room together" ON)

function(kino_compile_options target)
  if(KINO_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    # It takes a .cpp that a unity file includes for a header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  target_include_directories(${target} PUBLIC ${CMAKE_SOURCE_DIR})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -Wno-missing-field-initializers)
  # Clang, which builds the fuzzers, warns of other things.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Werror>)
  # g++ 12 sees overlaps in "text" + std::string that are not there (GCC bug 105651).
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  # Bit-exact replays need one meaning for a*b+c: contraction only where a file asks for it.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  if(KINO_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${KINO_SANITIZE} -fno-omit-frame-pointer
      -fno-sanitize-recover=all)
    # Between a sanitizer's checks g++ 12 takes optional values for uninitialized.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    # g++ takes twice as long over checks that AddressSanitizer mostly covers; the fuzzers, built
    # by clang, have them.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND KINO_SANITIZE MATCHES "undefined")
      target_compile_options(${target} PUBLIC -fno-sanitize=null,alignment,vptr,object-size)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${KINO_SANITIZE})
  endif()
  # Files named *_avx2.cpp hold the SIMD twins of portable code and are reached only after a
  # run-time check of the processor; they include nothing that has inline functions of its own.
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "_avx2\\.cpp$")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma")
    endif()
  endforeach()
endfunction()

function(kino_library name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    add_library(kino_${name} INTERFACE)
    target_include_directories(kino_${name} INTERFACE ${CMAKE_SOURCE_DIR})
    target_link_libraries(kino_${name} INTERFACE ${ARG_DEPENDS})
  else()
    add_library(kino_${name} STATIC ${sources})
    kino_compile_options(kino_${name})
    target_link_libraries(kino_${name} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE})
  endif()
  add_library(kino::${name} ALIAS kino_${name})
endfunction()

# kino_program(kinoscope SOURCES a.cpp DEPENDS ...): an installed executable.
function(kino_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  kino_compile_options(${name})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# kino_shaders(TARGET dir/a.comp ...): compiles GLSL to SPIR-V at build time and embeds it as
# <name>_<stage>.inc (a list of numbers), with a true dependency file for shared headers.
function(kino_shaders target)
  foreach(shader IN LISTS ARGN)
    get_filename_component(file ${shader} NAME)
    string(REPLACE "." "_" symbol ${file})
    set(out ${CMAKE_CURRENT_BINARY_DIR}/shaders/${symbol}.inc)
    add_custom_command(OUTPUT ${out}
      COMMAND glslc --target-env=vulkan1.3 -O -MD -MF ${out}.d -mfmt=num
              -I ${CMAKE_SOURCE_DIR} -o ${out} ${CMAKE_CURRENT_SOURCE_DIR}/${shader}
      DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${shader} DEPFILE ${out}.d
      COMMENT "glslc ${shader}" VERBATIM)
    target_sources(${target} PRIVATE ${out})
    list(APPEND made ${out})
  endforeach()
  # All shaders' code without compiling anything else: what a checker of sources needs.
  if(NOT TARGET shader_code)
    add_custom_target(shader_code)
  endif()
  add_custom_target(${target}_shader_code DEPENDS ${made})
  add_dependencies(shader_code ${target}_shader_code)
  file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/shaders)
endfunction()

# kino_test(sensor LABELS unit DEPENDS kino::sensor): one GoogleTest program from *_test.cpp of the
# folder, one ctest entry. Sanitizers slow tests down five times and more, so of a program whose
# tests say the same thing over and over, a part may be enough there: ASAN and TSAN are GoogleTest
# filters for those builds (TSAN: where threads meet); the release build runs everything.
function(kino_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT;ASAN;TSAN" "LABELS;DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_test.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${name}_test ${sources})
  kino_compile_options(${name}_test)
  # GoogleTest's macros are most of the work here, and nothing that is measured.
  target_compile_options(${name}_test PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
  target_link_libraries(${name}_test PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest_main)
  set(filter)
  if(KINO_SANITIZE MATCHES "address" AND ARG_ASAN)
    set(filter --gtest_filter=${ARG_ASAN})
  elseif(KINO_SANITIZE MATCHES "thread" AND ARG_TSAN)
    set(filter --gtest_filter=${ARG_TSAN})
  endif()
  add_test(NAME ${name} COMMAND ${name}_test ${filter} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
endfunction()

# kino_fuzz(png DEPENDS kino::sensor): the libFuzzer driver fuzz/png_fuzz.cpp of this folder, only
# in the preset `fuzz`. Seeds lie in tests/data/fuzz/png. The same function of the driver runs on
# seeded mutations in every ordinary test run.
option(KINO_FUZZ "Build the libFuzzer drivers (clang only)" OFF)
function(kino_fuzz name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(NOT KINO_FUZZ)
    return()
  endif()
  add_executable(${name}_fuzz fuzz/${name}_fuzz.cpp ${ARG_SOURCES})
  kino_compile_options(${name}_fuzz)
  target_include_directories(${name}_fuzz PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_options(${name}_fuzz PRIVATE -fsanitize=fuzzer,address,undefined)
  target_link_libraries(${name}_fuzz PRIVATE ${ARG_DEPENDS})
  if(NOT TARGET fuzzers)
    add_custom_target(fuzzers)
  endif()
  add_dependencies(fuzzers ${name}_fuzz)
endfunction()
