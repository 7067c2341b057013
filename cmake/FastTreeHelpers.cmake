# SPDX-License-Identifier: Apache-2.0
# What every target of the project is compiled with, and how a test is declared.

# The flags all three embodiments rely on: no fused multiply-add (it would change the bytes of a
# tree and break watertightness), and warnings.
function(fasttree_compile_options target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow
    # GCC 12 warns of impossible overlaps inside std::string (its bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(FASTTREE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${FASTTREE_SANITIZE}
                           -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${FASTTREE_SANITIZE})
  endif()
  if(FASTTREE_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage -fprofile-update=atomic)
    target_link_options(${target} PUBLIC --coverage)
  endif()
endfunction()

# fasttree_test(NAME name SOURCES a_test.cpp ... [LIBRARIES lib ...] [LABELS large ...])
# One GoogleTest executable; each of its tests is one of CTest's. Label `large` marks what the
# sanitizer run leaves out. Tests see the internal headers below src/.
function(fasttree_test)
  if(NOT FASTTREE_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  fasttree_compile_options(${ARG_NAME})
  target_include_directories(${ARG_NAME} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
  target_link_libraries(${ARG_NAME} PRIVATE fasttree GTest::gtest GTest::gtest_main rapidcheck
                        ${ARG_LIBRARIES})
  # RC_PARAMS: the same random cases in every run; another seed is a matter of hand.
  set(properties TIMEOUT 1200 ENVIRONMENT "RC_PARAMS=seed=2014")
  if(ARG_LABELS)
    list(APPEND properties LABELS "${ARG_LABELS}")
  endif()
  gtest_discover_tests(${ARG_NAME} DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
endfunction()
